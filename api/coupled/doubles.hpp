// doubles.hpp - the arrays of a call, which all hold doubles: an ilaw_input or ilaw_output of floats would
// pass for an absent one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/coupled.h>

#include <initializer_list>

namespace ilaw::coupled {

#define ILAW_IS_DOUBLES(text, array) \
  { (array).floats, text " has floats; expected doubles" }

struct DoublesOnly {
  const float* floats;
  const char* reason;
};

inline const char* complaint_of_floats(std::initializer_list<DoublesOnly> arrays) {
  for (const DoublesOnly& array : arrays)
    if (array.floats) return array.reason;
  return nullptr;
}

inline const char* complaint_of_floats(const ilaw_bodies& b) {
  return complaint_of_floats(
      {ILAW_IS_DOUBLES("inverse_mass of bodies", b.inverse_mass),
       ILAW_IS_DOUBLES("inverse_inertia of bodies", b.inverse_inertia),
       ILAW_IS_DOUBLES("v_free of bodies", b.v_free), ILAW_IS_DOUBLES("spin_free of bodies", b.spin_free),
       ILAW_IS_DOUBLES("v_previous of bodies", b.v_previous),
       ILAW_IS_DOUBLES("spin_previous of bodies", b.spin_previous),
       ILAW_IS_DOUBLES("velocity of bodies", b.velocity), ILAW_IS_DOUBLES("spin of bodies", b.spin),
       ILAW_IS_DOUBLES("impulse of bodies", b.impulse),
       ILAW_IS_DOUBLES("angular_impulse of bodies", b.angular_impulse)});
}

// The arrays that contacts have themselves, and those that they read or write of their batch.
inline const char* complaint_of_floats(const ilaw_contacts& c, const ilaw_batch& b) {
  return complaint_of_floats(
      {ILAW_IS_DOUBLES("arm", c.arm), ILAW_IS_DOUBLES("counterpart_arm", c.counterpart_arm),
       ILAW_IS_DOUBLES("wall_velocity", c.wall_velocity), ILAW_IS_DOUBLES("wall_previous", c.wall_previous),
       ILAW_IS_DOUBLES("body_weight", c.body_weight),
       ILAW_IS_DOUBLES("counterpart_weight", c.counterpart_weight), ILAW_IS_DOUBLES("wall_spin", c.wall_spin),
       ILAW_IS_DOUBLES("wall_spin_previous", c.wall_spin_previous), ILAW_IS_DOUBLES("gap", b.gap),
       ILAW_IS_DOUBLES("gap_offset", b.gap_offset), ILAW_IS_DOUBLES("area", b.area),
       ILAW_IS_DOUBLES("normal", b.normal), ILAW_IS_DOUBLES("tangent", b.tangent),
       ILAW_IS_DOUBLES("state_in", b.state_in), ILAW_IS_DOUBLES("state_out", b.state_out),
       ILAW_IS_DOUBLES("impulse", b.impulse), ILAW_IS_DOUBLES("moment", b.moment),
       ILAW_IS_DOUBLES("energy", b.energy)});
}

// The lists of a batch, whose lengths the instance says.
inline const char* complaint_of_floats(const ilaw_batch& b, const ilaw_instance_info& info) {
  for (std::uint32_t p = 0; b.per_node_parameters && p < info.per_node_parameter_count; ++p)
    if (const char* reason = complaint_of_floats(
            {ILAW_IS_DOUBLES("an array of per_node_parameters", b.per_node_parameters[p])}))
      return reason;
  for (std::uint32_t a = 0; b.amounts && a < info.amount_count; ++a)
    if (const char* reason = complaint_of_floats({ILAW_IS_DOUBLES("an array of amounts", b.amounts[a])}))
      return reason;
  return nullptr;
}

#undef ILAW_IS_DOUBLES

}  // namespace ilaw::coupled
