// report.hpp - what a check found: as text, JSON, JUnit XML; the table of all rules.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/check.hpp"

#include <string>

namespace ilaw::check {

// Data needed to repeat a finding.
struct Checked {
  std::string file;
  std::vector<std::uint64_t> seeds;
  std::vector<Outcome> outcomes;
  std::string parameters{};  // as they were given

  bool all_passed() const;
};

std::string text_of(const Checked& checked);
std::string json_of(const Checked& checked);
std::string junit_of(const Checked& checked);

// Markdown: id, sentence, where the contract says so.
std::string table_of_rules();

}  // namespace ilaw::check
