// units.hpp - SI units as parameters declare them, and their values in other units.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::check {

// Units as powers of two, which change no digit.
struct Units {
  double mass = 1.0, length = 1.0, time = 1.0;

  double velocity() const { return length / time; }
  double impulse() const { return mass * velocity(); }
};

// Powers of mass, length and time; those that hang on a parameter by its symbol.
struct Dimensions {
  struct Power {
    double mass = 0.0, length = 0.0, time = 0.0;
  };
  Power fixed;
  std::map<std::string, Power> by_symbol;

  double in(const Units& units, const std::map<std::string, double>& values) const;
};

// "N.s/m^2", "N/m^p" where p is a symbol; none where it is no such text.
std::optional<Dimensions> parse_unit(const std::string& text, const std::vector<std::string>& symbols);

}  // namespace ilaw::check
