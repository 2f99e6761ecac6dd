// description.hpp - checks everything that a library says of itself before anybody uses it, and keeps copies
// of its structs as this version knows them: a host may read any member, whatever minor version wrote the
// library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "checker.hpp"

#include <ilaw/ilaw.h>

#include <cstdint>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace ilaw::loading {

// Throws refusal: which file, what was found, what was expected.
const ilaw_plugin* checked_plugin(const std::string& file, const ilaw_plugin* given, storage& kept);

// Origin of an instance; file and law name it in messages, minor is that of its library.
struct instance_origin {
  const std::string& file;
  const ilaw_law& law;
  std::uint16_t minor;
};

// What an instance says of itself, with copies of its arrays; given is the info as the library wrote it.
struct instance_description {
  const ilaw_law* law;
  std::uint32_t dimension;
  std::set<std::string> per_node;  // parameters that the host gave so
  ilaw_instance_info given, info;
  storage kept = {};
  long users = 1;
};

// Those of a library. Instances that say the same are checked once: a host may make one for each node.
// Counted by hand, since std::shared_ptr needs glibc 2.32.
class instance_descriptions {
 public:
  instance_descriptions() = default;
  ~instance_descriptions();
  instance_descriptions(const instance_descriptions&) = delete;
  instance_descriptions& operator=(const instance_descriptions&) = delete;

  // To be given back.
  instance_description* checked(const instance_origin& origin, const ilaw_setup& setup,
                                const ilaw_instance_info& given);
  void give_back(instance_description* one);

 private:
  std::mutex guard_;
  std::vector<instance_description*> known_;  // each used here, too
};

}  // namespace ilaw::loading
