// refusal.hpp - what a law answered that no run can go on from.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

namespace ilaw::host {

// What a law answered: its code and report.
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

  // contacts: those of the batch, in its order.
  void add(const Answer& answer, const std::int32_t* contacts) {
    if (answer.code == ILAW_OK) return;
    const ilaw_report& report = answer.report;
    add({answer.code, report.bad_count, report.first_bad_node < 0 ? -1 : contacts[report.first_bad_node], 0,
         report.reason});
  }
  // Of a batch with an index list of contacts.
  void add_listed(const Answer& answer) {
    if (answer.code == ILAW_OK) return;
    const ilaw_report& report = answer.report;
    add({answer.code, report.bad_count, static_cast<std::int32_t>(report.first_bad_node), 0, report.reason});
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
