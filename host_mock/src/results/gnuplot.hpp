// gnuplot.hpp - writes texts into scripts for gnuplot, and runs them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace ilaw::host {

// In single quotes, where gnuplot substitutes nothing.
std::string in_quotes(std::string_view text);

// Without a shell, and without gnuplot's warnings (an axis of a constant, say). Says on stderr why
// it failed.
bool run_gnuplot(const std::filesystem::path& script);

}  // namespace ilaw::host
