// refusal.hpp - what a law answered that no run can go on from.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace ilaw::host {

// Code and report that a law returned.
struct Answer {
  std::int32_t code;
  ilaw_report report;
};

struct Refusal {
  std::int32_t code = ILAW_OK;
  std::int64_t bad_count = 0;
  std::int32_t contact = -1;  // the first that is to blame; -1: none in particular
  int status = 0;             // that ABI 1 does not know, where the library is to blame
  const char* reason = nullptr;

  // count: entries of the batch's arrays. contacts: to which they belong, null where entry k is
  // contact k. A node that a library makes up is none.
  void add(const Answer& answer, std::size_t count, const std::int32_t* contacts = nullptr) {
    if (answer.code == ILAW_OK) return;
    const ilaw_report& report = answer.report;
    const auto entry = static_cast<std::size_t>(report.first_bad_node);
    std::int32_t first = -1;
    if (report.first_bad_node >= 0 && entry < count)
      first = contacts ? contacts[entry] : static_cast<std::int32_t>(entry);
    add({answer.code, report.bad_count, first, 0, report.reason});
  }
  // ABI 1 has eight statuses for ever: any other number is a broken library's.
  void add_unknown(const std::uint8_t* statuses, const std::int32_t* contacts, std::ptrdiff_t count) {
    std::uint8_t largest = 0;
    for (std::ptrdiff_t i = 0; i < count; ++i) largest = std::max(largest, statuses[i]);
    if (largest < ILAW_STATUS_COUNT) return;
    const std::ptrdiff_t i =
        std::find_if(statuses, statuses + count, [](std::uint8_t s) { return s >= ILAW_STATUS_COUNT; }) -
        statuses;
    add({ILAW_BAD_LIBRARY, 0, contacts[i], statuses[i], nullptr});
  }
  void add(const Refusal& other) {
    if (other.code == ILAW_OK) return;
    const std::int64_t all = bad_count + other.bad_count;
    if (code == ILAW_OK) *this = other;
    bad_count = all;
  }
};

}  // namespace ilaw::host
