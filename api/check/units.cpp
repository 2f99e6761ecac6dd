// SPDX-License-Identifier: BSD-3-Clause
#include "check/units.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace ilaw::check {
namespace {

using Power = Dimensions::Power;

const std::map<std::string, Power>& bases() {
  static const std::map<std::string, Power> known = {
      {"1", {0, 0, 0}},  {"kg", {1, 0, 0}},  {"m", {0, 1, 0}},    {"s", {0, 0, 1}},
      {"N", {1, 1, -2}}, {"J", {1, 2, -2}},  {"Pa", {1, -1, -2}}, {"Hz", {0, 0, -1}},
      {"W", {1, 2, -3}}, {"rad", {0, 0, 0}}, {"K", {0, 0, 0}}};
  return known;
}

void add(Power& to, const Power& power, double times) {
  to.mass += times * power.mass;
  to.length += times * power.length;
  to.time += times * power.time;
}

// One factor, "m^2": false where it is none.
bool add_factor(Dimensions& sum, const std::string& factor, double sign,
                const std::vector<std::string>& symbols) {
  const std::size_t caret = factor.find('^');
  const auto base = bases().find(factor.substr(0, caret));
  if (base == bases().end()) return false;
  if (caret == std::string::npos) {
    add(sum.fixed, base->second, sign);
    return true;
  }
  const std::string power = factor.substr(caret + 1);
  if (std::find(symbols.begin(), symbols.end(), power) != symbols.end()) {
    add(sum.by_symbol[power], base->second, sign);
    return true;
  }
  char* end = nullptr;
  const double exponent = std::strtod(power.c_str(), &end);
  if (power.empty() || *end != '\0') return false;
  add(sum.fixed, base->second, sign * exponent);
  return true;
}

double value_of(const Power& power, const Units& units, double times) {
  return std::pow(units.mass, times * power.mass) * std::pow(units.length, times * power.length) *
         std::pow(units.time, times * power.time);
}

}  // namespace

double Dimensions::in(const Units& units, const std::map<std::string, double>& values) const {
  double product = value_of(fixed, units, 1.0);
  for (const auto& [symbol, power] : by_symbol) product *= value_of(power, units, values.at(symbol));
  return product;
}

std::optional<Dimensions> parse_unit(const std::string& text, const std::vector<std::string>& symbols) {
  Dimensions sum;
  double sign = 1.0;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find_first_of("./", at), text.size());
    if (!add_factor(sum, text.substr(at, end - at), sign, symbols)) return std::nullopt;
    if (end < text.size()) sign = text[end] == '/' ? -1.0 : 1.0;
    at = end + 1;
  }
  return sum;
}

}  // namespace ilaw::check
