// gnuplot.hpp - writes texts into scripts for gnuplot, and runs them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>

namespace ilaw::host {

// Of curves; the first seven are colours that colour-blind readers tell apart (Okabe and Ito 2008).
inline constexpr const char* curve_colours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00",
                                                "#56B4E9", "#000000", "#999999", "#8B5A2B", "#7A5FD0"};

// In single quotes, where gnuplot substitutes nothing.
std::string in_quotes(std::string_view text);

// The same, broken between words where it is longer than a line of so many letters; gnuplot joins
// the lines.
std::string in_lines(const std::string& words, std::size_t most, double& line_count);

// Runs the script that write gives, and keeps it under its name. Without a shell, and without
// gnuplot's warnings (an axis of a constant, say). Says on stderr why it failed.
bool draw_by_gnuplot(const std::filesystem::path& script, const std::function<void(std::ostream&)>& write);

// Removes the pictures of a folder whose names, without ending, match a regular expression, and
// their scripts; only what such a script stands beside.
void remove_pictures(const std::filesystem::path& folder, const std::string& names);

// What such a script sets its output to, for a picture that is to stand under its name only when it
// is whole.
std::string drawn_name(const std::filesystem::path& picture);

// A sheet of panels over logarithmic axes.
struct LogSheet {
  const char *size, *layout, *title_font;  // as gnuplot reads them
  std::string title;
};

// folder/name.png and .svg, by the script folder/name.gnuplot. The folder is absolute.
bool draw_log_sheet(const std::filesystem::path& folder, const std::string& name, const LogSheet& sheet,
                    const std::function<void(std::ostream&)>& panels);

}  // namespace ilaw::host
