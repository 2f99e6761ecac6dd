// forces.hpp - the resultants that a scene asks for, as means over the time of a row: the sum of
// force times time over all rows is the impulse, however many steps a row has.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace ilaw::host {

class Forces {
 public:
  Forces(const Scene& scene, Integrator& integrator);

  // After the start: counted in the summary alone, for rows are means over steps.
  void add_start(const Integrator& integrator);
  // After every step.
  void add_step(const Integrator& integrator);

  // <name>.F0 ..., and <name>.M0 ... where a moment is asked for.
  std::vector<std::string> names() const;
  // In their order, means over the steps of the last row.
  const std::vector<double>& means() const { return means_; }
  // Begins a row after the one that ends at the time.
  void close_row(double time);

  // Per name the impulse of the whole run, and the largest size of the force at the start or in a row.
  nlohmann::json summary() const;

  // The points that moments are about, null for forces without one.
  nlohmann::json points() const;
  // The sums so far, by name, for the checkpoint.
  nlohmann::json state() const;
  // Returns the names that the state has not: their sums begin now.
  std::vector<std::string> load(const nlohmann::json& state);

 private:
  struct Resultant {
    Dofs impulse, moment;                    // since the last row; moment empty where none is asked for
    Dofs total;                              // impulse up to the last row, that of the start included
    double largest = 0.0, largest_at = 0.0;  // size of the force, and the time of its row
    std::int64_t steps = 0;                  // since the last row
  };
  void add(const ForceSetup& force, Resultant& sum, const Integrator& integrator, double duration);
  void add_at(int node, const double* impulse, const ForceSetup& force, Resultant& sum,
              const Dofs& displacement) const;

  nlohmann::json about(std::size_t k) const;  // null: no moment is asked for

  const Scene& scene_;
  std::vector<Resultant> sums_;  // by scene.output.forces
  std::vector<double> means_;
  Dofs of_load_;  // per degree of freedom
};

}  // namespace ilaw::host
