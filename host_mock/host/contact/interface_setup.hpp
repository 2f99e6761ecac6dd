// interface_setup.hpp - what an interface is made of, and a step from its side.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/table.hpp"
#include "contact/law_arguments.hpp"
#include "surface/counterpart.hpp"

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

// Setup of an interface whose nodes and partners have temperatures.
struct HeatSetup {
  std::optional<Table> obstacle_temperature;
};

// H of a driven axis as laws are given it, beside the largest of the node: they resolve 2^-42 of it.
inline constexpr double driven_delassus = 0x1p-40;

struct InterfaceSetup {
  std::string name, law, library;  // library: name or path
  std::string edges_of;            // the interface that these edge rows belong to; empty: no edge rows
  Arguments arguments;
  std::vector<int> nodes;
  std::vector<double> areas;  // per node: of the overlap at the start if there is one, else tributary
  double area_factor = 1.0;   // which they include
  std::unique_ptr<Counterpart> counterpart;
  double birth = 0.0, death = std::numeric_limits<double>::infinity();  // while birth <= t < death
  Vector tangent;                       // first tangent of all nodes; empty: none given
  double common_gap_offset = 0.0;       // taken off every gap: thickness, radius
  std::vector<double> own_gap_offsets;  // the same of each node, beside that; empty: none
  std::vector<std::uint8_t> left_out;   // per node: beside the surface where bonds begin; empty: none
  bool has_driven_nodes = false;        // motions drive some of its nodes or partners: H differs by axis
  bool keeps_all_active = false;        // also contacts that cannot be reached: same results, more work
  std::optional<HeatSetup> heat;

  // Area of a contact, for its law and its results.
  double area(int node_index, const ContactPoint& point) const {
    return point.area > 0.0 ? area_factor * point.area : areas[static_cast<std::size_t>(node_index)];
  }
  bool is_left_out(int node_index) const {
    return !left_out.empty() && left_out[static_cast<std::size_t>(node_index)] != 0;
  }
  double gap_offset(int node_index) const {
    if (own_gap_offsets.empty()) return common_gap_offset;
    return common_gap_offset + own_gap_offsets[static_cast<std::size_t>(node_index)];
  }
};

// A step from the interface's side. Speeds bound those of all nodes. Step 0 is the start: half a step of the
// velocity, from V_0, before a whole one of the position.
struct StepView {
  const Dofs& u;         // at time
  const Dofs& v_before;  // at the half step before time
  double time, dt;       // dt: of the position
  double speed_before;   // at the half step before time
  double speed_after;    // of v_free, and of what other contacts may make of it
  std::int64_t number;
  // The times that obstacles move from and to; they stand still where that is time itself.
  double since = number == 0 ? time : time - dt, until = time + dt;

  double velocity_step() const { return number == 0 ? 0.5 * dt : dt; }
};

using ContactList = std::vector<std::int32_t>;  // by contact_index

}  // namespace ilaw::host
