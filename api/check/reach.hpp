// reach.hpp - the statuses and states that the nodes of a rule go through. A rule judges a law there alone.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace ilaw::check {

// Values of one state variable over all nodes and steps, and whether a step changed one.
struct Range {
  double least = std::numeric_limits<double>::infinity();
  double largest = -std::numeric_limits<double>::infinity();
  bool changed = false;
};

struct Reach {
  std::size_t steps = 0;                                  // of single nodes
  std::array<std::size_t, ILAW_STATUS_COUNT> statuses{};  // steps that ended in each
  std::map<std::string, Range> states;                    // by the name of the variable

  void add(const ilaw_instance_info& info, const std::vector<double>& before,
           const std::vector<double>& after, const std::vector<std::uint8_t>& status);
  void add(const Reach& other);
};

// Calls of evaluate from this thread. Rules that start threads compare them with the first one's calls.
Reach& reach_of_thread();

const char* name_of_status(std::size_t status);

// Statuses that "all" has and "one" has not, and state variables that no step of "one" changed.
std::vector<std::string> missing_in(const Reach& one, const Reach& all);

}  // namespace ilaw::check
