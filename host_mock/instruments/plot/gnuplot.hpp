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

// Colours of curves; the first seven are colours that colour-blind readers tell apart (Okabe and Ito 2008).
inline constexpr const char* curve_colours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00",
                                                "#56B4E9", "#000000", "#999999", "#8B5A2B", "#7A5FD0"};

// Settings of curves over a common abscissa, and of errors over logarithmic axes.
inline constexpr const char* grey_axes =
    "set border 3 linecolor rgb '#808080'\nset tics nomirror textcolor rgb 'black'\n"
    "set grid linewidth 1 linecolor rgb '#d0d0d0'\nset format x ''\nset format y '%.4g'\n";
inline constexpr const char* log_axes =
    "set datafile missing ''\nset logscale xy\nset format xy '10^{%T}'\nset grid\nset border 3\n"
    "set tics nomirror\nset ylabel 'relative error'\n";

// In single quotes, where gnuplot substitutes nothing.
std::string in_quotes(std::string_view text);

// The same, broken between words where it is longer than a line of so many letters; gnuplot joins
// the lines.
std::string in_lines(const std::string& words, std::size_t most, double& line_count);

struct Sheet {
  std::filesystem::path picture;  // absolute, without extension
  double width, height;           // pixels
  std::string multiplot = {};     // options of "set multiplot": layout and title
  std::string terminal = {};      // more options of the terminal, as "rounded"
  std::string data = {};          // data blocks
};

// Draws a sheet as picture.png and .svg, by a script picture.gnuplot that stays. panels writes what stands
// between "set multiplot" and its end. Runs without a shell, and without gnuplot's warnings (an axis of a
// constant, say). Says on stderr why it failed.
bool draw_sheet(const Sheet& sheet, const std::function<void(std::ostream&)>& panels);

// A panel below others: its key stands on the right, its name, turned, on the left. Pixels of the sheet.
struct PanelPlace {
  double top, bottom, right, label_x;
};
void place_panel(std::ostream& script, const Sheet& sheet, const PanelPlace& place, const std::string& label);

// Removes the pictures of a folder whose names, without ending, match a regular expression, and
// their scripts; only what such a script stands beside.
void remove_pictures(const std::filesystem::path& folder, const std::string& names);

}  // namespace ilaw::host
