// load.hpp - what acts on the nodes from outside.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/table.hpp"
#include "model/model.hpp"
#include "model/obstacle.hpp"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace ilaw::host {

// The step from time t_n to t_{n+1} = t_n + dt. Nodes move with its last velocity until the end of the next
// one. The half step that a run starts with, from V_0 to V_{1/2}, is {-dt/2, 0, dt}.
struct StepTimes {
  double before, after, until;

  double duration() const { return after - before; }
};

// Motions of all nodes: displacements at the end of the step, and velocities before it.
struct Motions {
  const Dofs &u, &v;
};

// Critical step of central difference with dampers at the velocity before: h^2 k + 2 h c <= 4 for all
// motions, k and c the stiffness and damping over mass (Jury's conditions).
inline double damped_critical_step(double k, double c) { return 4.0 / (c + std::sqrt(c * c + 4.0 * k)); }

class HeatLoad;

class Load {
 public:
  virtual ~Load() = default;
  // Adds the force at a time, on nodes that are displaced by u.
  virtual void add_force(double /*time*/, const Dofs& /*u*/, Dofs& /*force*/) const {}
  // Adds the impulses that fall into a step.
  virtual void add_impulse(StepTimes /*step*/, Dofs& /*impulse*/) const {}
  // Changes the velocity that a step would leave with, without interfaces, and adds the impulse that
  // this takes. before: what the step started with.
  virtual void correct(StepTimes /*step*/, Motions /*before*/, Dofs& /*v*/, Dofs& /*impulse*/) const {}
  // Reduces an impulse that interfaces add after a load that corrects velocities: a damper's own
  // velocity changes with it, and the holder of a driven node takes it all.
  virtual void transmit(StepTimes /*step*/, Dofs& /*impulse*/) const {}
  // Whether that is the same in all steps.
  virtual bool transmits_steadily() const { return true; }
  virtual bool corrects() const { return false; }
  // Where it damps explicitly: the largest rate of damping of a motion, force over mass and velocity, which
  // reduces the critical step.
  virtual double damping_rate(Motions /*at*/) const { return 0.0; }
  // Whether its work is that of damping.
  virtual bool damps() const { return false; }
  // Whether it also acts on nodes that a motion drives.
  virtual bool acts_on_driven() const { return true; }
  // Whether it is the same force at all times, and nothing else.
  virtual bool is_steady() const { return false; }
  // Where it acts on temperatures, and on no motion.
  virtual const HeatLoad* heat() const { return nullptr; }
  // Nodes whose motion is prescribed, and the axes along which it is.
  virtual const std::vector<int>& prescribed_nodes() const { return none_; }
  virtual const std::vector<int>& prescribed_axes() const { return none_; }

 private:
  static const std::vector<int> none_;
};

using Loads = std::vector<std::unique_ptr<Load>>;

// The critical step of a model with its explicit dampers.
double critical_step(const Model& model, const Loads& loads, Motions at);

// A force along a direction, of a size that follows a table. Gravity is one: an acceleration is the
// direction, the share of a node its mass.
class Force : public Load {
 public:
  // The size times its share acts on each node.
  Force(std::vector<int> nodes, std::vector<double> shares, Vector direction, Table history);
  void add_force(double time, const Dofs& u, Dofs& force) const override;
  bool is_steady() const override { return history_.is_constant(); }

 private:
  std::vector<int> nodes_;
  std::vector<double> shares_;
  Vector direction_;
  Table history_;
};

// An impulse at an instant s; it enters the step with t_n < s <= t_{n+1}.
class Shock : public Load {
 public:
  Shock(std::vector<int> nodes, double time, Vector impulse);
  void add_impulse(StepTimes step, Dofs& impulse) const override;

 private:
  std::vector<int> nodes_;
  double time_;
  Vector impulse_;
};

// Viscous damping by mass: the force -rate m (v_before + v)/2, with v the velocity at the end of the step.
class Damping : public Load {
 public:
  // history: a factor of the rate.
  Damping(const Model& model, std::vector<int> nodes, double rate, Table history);
  void correct(StepTimes step, Motions before, Dofs& v, Dofs& impulse) const override;
  void transmit(StepTimes step, Dofs& impulse) const override;
  bool corrects() const override { return true; }
  bool damps() const override { return true; }
  bool acts_on_driven() const override { return false; }
  bool transmits_steadily() const override { return history_.is_constant(); }

 private:
  // rate h/2 of a step.
  double part(StepTimes step) const { return 0.5 * rate_ * history_.at(step.after)[0] * step.duration(); }

  const Model& model_;
  std::vector<int> nodes_;
  double rate_;
  Table history_;
};

// Held temperatures, or a heat flux into nodes.
class HeatLoad : public Load {
 public:
  enum class Kind { temperature, flux };

  // history: temperature, or heat per area and time; the areas are those of the nodes.
  HeatLoad(Kind kind, NodeSet set, Table history)
      : kind_(kind), set_(std::move(set)), history_(std::move(history)) {}
  bool is_steady() const override { return true; }  // it is no force
  const HeatLoad* heat() const override { return this; }
  bool holds() const { return kind_ == Kind::temperature; }
  const NodeSet& set() const { return set_; }
  double at(double time) const { return history_.at(time)[0]; }

 private:
  Kind kind_;
  NodeSet set_;
  Table history_;
};

// Nodes that follow a given motion; axes that are not driven stay free.
class PrescribedMotion : public Load {
 public:
  PrescribedMotion(const Model& model, std::vector<int> nodes, std::vector<int> axes, Motion motion);
  // The impulse is the reaction of what holds the nodes.
  void correct(StepTimes step, Motions before, Dofs& v, Dofs& impulse) const override;
  void transmit(StepTimes step, Dofs& impulse) const override;
  bool corrects() const override { return true; }
  const std::vector<int>& prescribed_nodes() const override { return nodes_; }
  const std::vector<int>& prescribed_axes() const override { return axes_; }

 private:
  const Model& model_;
  std::vector<int> nodes_, axes_;
  Motion motion_;
};

}  // namespace ilaw::host
