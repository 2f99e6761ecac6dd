// audit.hpp - each step of a run, judged from outside: the laws are asked anew through the C ABI, by
// instances of their own, what they answer to the velocities that the step ended with; momentum, energy and
// gaps are found from positions and velocities. Nothing is taken from a solver but its impulses.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace ilaw::host {

class AuditFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class AuditedInterface;

class Audit {
 public:
  // The scene and its integrator must live as long.
  Audit(const Scene& scene, const Integrator& integrator);
  ~Audit();

  // Around the half step of the start, of which a prestress has found the equilibrium, and each step after
  // it. Throws AuditFailure with the step, the node and the quantity.
  void open();
  void close();

 private:
  bool is_start() const { return integrator_.steps() == 0; }
  double velocity_step() const { return is_start() ? 0.5 * scene_.dt : scene_.dt; }
  void leave_out_driven(Dofs& of_dofs) const;
  void check_equilibrium() const;
  void check_momentum(const Dofs& impulse) const;
  void check_work(const Dofs& impulse) const;
  std::string step_text() const;

  const Scene& scene_;
  const Integrator& integrator_;
  Dofs inverse_mass_;
  double work_before_ = 0.0;
  std::vector<std::unique_ptr<AuditedInterface>> interfaces_;
};

}  // namespace ilaw::host
