// child.hpp - libraries are looked at in a process of its own: whatever their code does there, the
// program goes on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace ilaw::host {

// What work returns in a child process. Throws ilaw::error where work does, and std::runtime_error
// that tells how the process ended where it did not come so far.
std::string in_child(const std::function<std::string()>& work);

}  // namespace ilaw::host
