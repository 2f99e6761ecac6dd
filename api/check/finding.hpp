// finding.hpp - what a rule has to say of a law: thrown where the rule is broken, or cannot be judged.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ilaw::check {

// Numbers of a node that repeat a finding.
struct NamedArray {
  std::string name;
  std::vector<double> values;
};

// A rule is broken. The rule says what is allowed, and "allowed" does where a number can be given.
struct Finding {
  std::string seen, allowed, setting{};
  std::vector<NamedArray> arrays{};
};

// The rule asks for what this law does not promise, or cannot be given.
struct NotJudged {
  std::string why;
};

}  // namespace ilaw::check
