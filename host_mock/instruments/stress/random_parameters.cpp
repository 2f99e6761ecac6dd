// SPDX-License-Identifier: BSD-3-Clause
#include "stress/random_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

struct Range {
  double low, high;
};

// The range of a parameter without an upper bound, by its unit.
Range usual_range(const std::string& unit, double dt) {
  if (unit == "s") return {0.1 * dt, 1e4 * dt};
  if (unit == "1" || unit.empty()) return {1e-3, 1e6};
  if (unit == "s/m" || unit == "m") return {1e-3, 1e3};
  if (unit == "J/m^2") return {1e-6, 1e3};
  return {1e-6, 1e12};
}

double random_number(const ilaw_parameter& p, double dt, Draw& draw) {
  if (p.kind == ILAW_KIND_INTEGER)  // the largest is a state of 100 kB per node, which is only slow
    return draw.whole(static_cast<int>(std::ceil(p.minimum)),
                      static_cast<int>(std::min(p.maximum, p.minimum + 64.0)));
  if (draw.chance(0.15) && !(p.flags & ILAW_FLAG_EXCLUDES_MINIMUM)) return p.minimum;
  const bool is_bounded = p.maximum < std::numeric_limits<double>::max();
  if (draw.chance(0.15) && is_bounded) return p.maximum;
  const Range usual = usual_range(p.unit, dt);
  const bool is_usual = !is_bounded || p.maximum > usual.high;
  const double low = is_usual ? std::max(p.minimum, usual.low) : p.minimum;
  const double high = is_usual ? std::max(usual.high, low) : p.maximum;
  return is_usual && low > 0.0 ? draw.magnitude(low, high) : draw.uniform(low, high);
}

}  // namespace

json random_parameters(const ilaw_law& law, double dt, Draw& draw) {
  json made = json::object();
  for (std::uint32_t i = 0; i < law.parameter_count; ++i) {
    const ilaw_parameter& p = *law.parameters[i];
    if (!(p.flags & ILAW_FLAG_REQUIRED) && draw.chance(0.35)) continue;
    if (p.kind == ILAW_KIND_CHOICE)
      made[p.name] = p.choices[draw.whole(0, static_cast<int>(p.choice_count) - 1)];
    else if ((p.flags & ILAW_FLAG_ALLOWS_INFINITY) && draw.chance(0.15))
      made[p.name] = "inf";
    else
      made[p.name] = random_number(p, dt, draw);
  }
  return made;
}

}  // namespace ilaw::host
