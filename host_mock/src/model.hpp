// model.hpp - what the integrator knows of a body: lumped mass, geometry, internal forces. Matrix-free.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <limits>

namespace ilaw::host {

// One value per degree of freedom: dimension consecutive values per node, as a (d,n) array.
using Dofs = Eigen::VectorXd;

class Model {
 public:
  virtual ~Model() = default;

  virtual int dimension() const = 0;
  int node_count() const { return static_cast<int>(mass().size()) / dimension(); }

  virtual const Dofs& mass() const = 0;      // lumped, per degree of freedom, > 0
  virtual const Dofs& position() const = 0;  // of the undeformed body
  virtual const Dofs& initial_velocity() const = 0;
  virtual const Eigen::VectorXd& tributary_area() const = 0;  // per node

  // Adds -f_int(u) to force. Models without internal forces add nothing.
  virtual void add_internal_forces(const Dofs& /*u*/, Dofs& /*force*/) const {}

  // The potential part of central difference's own energy, 1/2 u_n^T K u_{n+1} for a linear model; a
  // nonlinear one says in its page which discrete energy it closes.
  virtual double internal_energy(const Dofs& /*u*/, const Dofs& /*u_next*/) const { return 0.0; }

  // Largest stable step of central difference; infinite without internal forces.
  virtual double critical_step() const { return std::numeric_limits<double>::infinity(); }
};

}  // namespace ilaw::host
