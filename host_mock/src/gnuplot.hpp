// gnuplot.hpp - runs gnuplot on a script.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace ilaw::host {

// Without a shell, and without gnuplot's warnings (an axis of a constant, say). Says on stderr why it failed.
bool run_gnuplot(const std::filesystem::path& script);

}  // namespace ilaw::host
