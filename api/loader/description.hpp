// description.hpp - checks everything that a library says of itself before anybody uses it, and keeps copies
// of its structs as this version knows them: a host may read any member, whatever minor version wrote the
// library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "checker.hpp"

#include <ilaw/ilaw.h>

#include <string>

namespace ilaw::loading {

// Throws refusal: which file, what was found, what was expected.
const ilaw_plugin* checked_plugin(const std::string& file, const ilaw_plugin* given, storage& kept);

// Origin of an instance; file and law name it in messages, minor is that of its library.
struct instance_origin {
  const std::string& file;
  const ilaw_law& law;
  std::uint16_t minor;
};

// Replaces arrays in the info by checked copies.
void check_instance_info(const instance_origin& origin, const ilaw_setup& setup, ilaw_instance_info& info,
                         storage& kept);

}  // namespace ilaw::loading
