// description.hpp - checks everything that a library says of itself before anybody uses it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <string>

namespace ilaw::loading {

// Throw refusal: which file, what was found, what was expected.
void check_plugin(const std::string& file, const ilaw_plugin* plugin);
void check_instance_info(const std::string& file, const ilaw_law& law, const ilaw_instance_info& info,
                         std::uint32_t dimension);

}  // namespace ilaw::loading
