// heat_exchange.hpp - the heat that contacts conduct in a step, all of them together:
//   Q_c = G_c h (D_c + theta_c dD_c),  D_c = T_counterpart - T_body,  C dT = C dT_free + sum_c a_c Q_c,
// where dT_free is the change of the temperatures without the exchange, and a_c has the weights of the
// contact. theta_c is fitted so that a contact which shares no node is exact under a constant heating
// (Liniger, Willoughby 1970). docs/theory/heat.md derives it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "surface/counterpart.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ilaw::host {

// The temperatures of the model's nodes at the start of the step, their changes without the exchange, and
// 1/C, which is 0 where a temperature is held.
struct NodeHeat {
  const Dofs &temperature, &change, &softness;
};

class HeatExchange {
 public:
  void clear();
  // conductance: G h, heat of the step per kelvin of difference; obstacle: its temperature, 0 if there is
  // none.
  void add(double conductance, double obstacle, int node, const ContactPoint& point);
  std::size_t count() const { return conductance_.size(); }
  // Returns the heat into the own side of each contact, in the order of add().
  const Dofs& solve(const NodeHeat& nodes);
  // Adds the heat of the solution to the nodes of the model.
  void add_heat(Dofs& heat) const;

 private:
  struct Entry {
    Eigen::Index body;  // place in nodes_
    double weight;
  };
  Eigen::Index body_of(int node);
  Dofs of_contacts(const Dofs& of_bodies) const;
  Dofs of_bodies(const Dofs& of_contacts) const;
  Dofs applied(const Dofs& heat) const;
  Dofs bodies_of(const Dofs& of_nodes) const;
  void set_coefficients(const NodeHeat& nodes);
  void find_heat(const Dofs& right);

  std::vector<double> conductance_, obstacle_;
  std::vector<Entry> entries_;            // of all contacts
  std::vector<std::size_t> first_ = {0};  // of each contact, and the end
  std::vector<int> nodes_;
  std::vector<std::int32_t> place_;  // of each node of the model in nodes_; -1: no contact has it
  Dofs softness_;                    // of the bodies
  Dofs theta_, resistance_;          // 1/(theta G h)
  Dofs diagonal_;                    // of the system
  Dofs heat_;
};

}  // namespace ilaw::host
