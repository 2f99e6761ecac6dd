// SPDX-License-Identifier: BSD-3-Clause
#include "checker.hpp"

#include <string_view>

namespace ilaw::loading {

void checker::check_text(const char* t, const char* what, bool lines_allowed) const {
  if (!t) refuse(std::string(what) + " is null, expected a text");
  if (!readable_text(t)) refuse(std::string(what) + " is no readable text of at most 64 KiB");
  if (!clean_text(t, lines_allowed))
    refuse(std::string(what) + " has bytes that are no UTF-8 or control characters");
  kept_.remember(t);
}

void checker::name(const char* n, const char* what) const {
  text(n, what);
  const std::string_view name(n);
  bool good = !name.empty() && name.front() >= 'a' && name.front() <= 'z';
  for (const char c : name) good = good && ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_');
  if (!good)
    refuse(std::string(what) + " is '" + std::string(name) +
           "', expected lower-case letters, digits and '_'");
}

void checker::mask(std::uint32_t value, std::uint32_t known, const char* what) const {
  if ((value & ~known) != 0 && !newer_)
    refuse(std::string(what) + " is " + std::to_string(value) + ", expected only the bits of " +
           std::to_string(known));
}

void checker::choice_of(std::uint32_t value, std::uint32_t known, const char* what) const {
  mask(value, known, what);
  if ((value & known) == 0)
    refuse(std::string(what) + " is " + std::to_string(value) + ", expected at least one of the bits of " +
           std::to_string(known));
}

void checker::zero(std::uint32_t value, const char* what) const {
  if (value != 0 && !newer_) refuse(std::string(what) + " is " + std::to_string(value) + ", expected 0");
}

void checker::kind(std::uint32_t value, std::uint32_t largest, const char* what) const {
  if (value > largest && !newer_)
    refuse(std::string(what) + " is " + std::to_string(value) + ", expected at most " +
           std::to_string(largest));
}

}  // namespace ilaw::loading
