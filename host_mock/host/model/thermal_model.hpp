// thermal_model.hpp - nodes with a temperature: lumped heat capacities, and conduction in the undeformed
// elements with the shape functions of the stiffness,
//   C_i dT_i/dt = q_i - sum_j K_ij T_j,  K_ij = sum of k grad N_i . grad N_j over the integration points,
// C_i the lumped mass times the specific heat (Bathe 2014, Finite Element Procedures, sections 7.2 and 9.6).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

#include <limits>
#include <string>
#include <vector>

namespace ilaw::host {

// A set of nodes, with the cells of the mesh between them.
struct ThermalBody {
  std::string name;
  std::vector<int> nodes;
  double specific_heat, conductivity, initial_temperature;
};

class ThermalModel {
 public:
  ThermalModel(const Model& model, const std::vector<ThermalBody>& bodies);

  bool has_temperature(int node) const { return capacity_[node] > 0.0; }
  // Per node; 0 without a temperature.
  const Dofs& capacity() const { return capacity_; }
  const Dofs& initial_temperature() const { return initial_temperature_; }
  // Adds the heat that conduction brings to each node in a time.
  void add_conduction(const Dofs& temperature, double time, Dofs& heat) const;

  // The largest step at which Gershgorin's circles of C^-1 K end at 2/h, so that |1 - h lambda| <= 1, and the
  // body that has it. Where no K_ij between two nodes is positive, rows of I - h C^-1 K are also means.
  struct StableStep {
    double step = std::numeric_limits<double>::infinity();
    std::string body;
  };
  const StableStep& stable_step() const { return stable_step_; }

 private:
  // Conductance -K_ij between two nodes. As rows of K sum to 0, it is all of K, and heat is conserved.
  struct Link {
    int one, other;
    double conductance;
  };
  void add_body(const Model& model, const ThermalBody& body);

  Dofs capacity_, initial_temperature_;
  std::vector<Link> links_;
  StableStep stable_step_;
};

}  // namespace ilaw::host
