// counterpart.hpp - what the nodes of an interface touch: a rigid obstacle, other nodes, or a
// surface of another body.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"
#include "model/obstacle.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace ilaw::host {

// Where a node faces its counterpart, and how. The relative velocity of the contact is
//   v = V_node - sum_i weight_i V_partner_i - (velocity of the obstacle).
struct ContactPoint {
  static constexpr int most_partners = 4;

  double gap = 0.0;
  Vector normal;
  int partner_count = 0;
  std::array<int, most_partners> partners{};
  std::array<double, most_partners> weights{};
  bool is_beyond_border = false;  // beside the surface of a mesh

  // Calls visit(node, weight) for the contact's own node and its partners.
  template <class Visit>
  void for_each_node(int node, Visit visit) const {
    visit(node, 1.0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(partner_count); ++i) visit(partners[i], -weights[i]);
  }
  // H along an axis: inverse_mass is 1/m, or less where loads take a part of an impulse, per degree of
  // freedom.
  double delassus(const double* inverse_mass, int dimension, int node, int axis = 0) const;
};

// The steps before and after a time.
struct Steps {
  double since, time, until;
};

// How fast a rigid counterpart turns in the steps before and after a time.
struct TurningRates {
  TurningRate before, after;
};

// Gaps of some contacts, and normals, of as many components each as the model has dimensions.
struct Located {
  double *gaps, *normals;
};

// The axis along which a vector lies; D where it is none.
template <std::size_t D>
std::size_t axis_of(const std::array<double, D>& vector) {
  std::size_t axis = D;
  for (std::size_t c = 0; c < D; ++c) {
    if (vector[c] == 0.0) continue;
    if (axis < D) return D;
    axis = c;
  }
  return axis;
}

// Gaps of some nodes to a plane, in the order of operations of Plane.
template <int D>
void flat_gaps(const Model& model, const std::int32_t* nodes, std::ptrdiff_t count, const Dofs& u,
               const FlatSurface& flat, double* gaps) {
  const double *const start = model.position().data(), *const moved = u.data();
  std::array<double, D> displacement, point, normal;
  for (std::size_t c = 0; c < D; ++c) {
    const auto k = static_cast<Eigen::Index>(c);
    displacement[c] = flat.displacement[k];
    point[c] = flat.point[k];
    normal[c] = flat.normal[k];
  }
  if (const std::size_t c = axis_of(normal); c < D) {  // else it would add zeros alone
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const std::size_t k = D * static_cast<std::size_t>(nodes[i]) + c;
      gaps[i] = 0.0 + (start[k] + moved[k] - displacement[c] - point[c]) * normal[c];
    }
    return;
  }
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::size_t first = D * static_cast<std::size_t>(nodes[i]);
    double gap = 0.0;
    for (std::size_t c = 0; c < D; ++c)
      gap += (start[first + c] + moved[first + c] - displacement[c] - point[c]) * normal[c];
    gaps[i] = gap;
  }
}

class Counterpart {
 public:
  virtual ~Counterpart() = default;

  // The contact point of the node at node_index in the interface's list.
  virtual ContactPoint contact_point(int node_index, const Dofs& u, double time) const = 0;
  // The same of count nodes at once, where the counterpart is rigid.
  virtual void locate(const std::int32_t* node_indices, std::ptrdiff_t count, const Dofs& u, double time,
                      Located found) const;
  // A bound from below on the gap, cheap, that relative motion by a distance lowers by no more than
  // the distance.
  virtual double gap_bound(int node_index, const Dofs& u, double time) const = 0;
  // The same of count nodes from the first on; several threads may ask at once.
  virtual void gap_bounds(int first, int count, const Dofs& u, double time, double* bounds) const;
  // A rigid counterpart that is flat.
  virtual std::optional<FlatSurface> flat_at(double /*time*/) const { return {}; }
  // Called before the gap bounds of all nodes are taken anew.
  virtual void refresh(const Dofs& /*u*/) {}
  // How far nodes and counterpart may approach before the next refresh.
  virtual double validity() const { return std::numeric_limits<double>::infinity(); }

  // Mean velocity of a rigid counterpart between two times.
  virtual Vector velocity(double from, double to) const = 0;
  // Whether it is rigid and its surface moves along itself, too; then how fast it turns, and the
  // velocity of its surface at rate 1, where a node meets it.
  virtual bool turns() const { return false; }
  virtual TurningRates rates(const Steps& /*steps*/) const { return {}; }
  // How fast a plane that tilts nears any of the nodes at most, between two times, beside its velocity.
  virtual double tilting_speed(double /*from*/, double /*to*/, const Dofs& /*u*/) const { return 0.0; }
  // Whether its velocity, how it turns and where it is flat are the same in all steps.
  virtual bool stands_still() const { return true; }
  virtual SurfaceTurn unit_turn(int /*node_index*/, const Dofs& /*u*/, double /*time*/,
                                const RigidSurface& /*there*/) const {
    return {};
  }
  // A direction that turns with it, between two times.
  virtual Vector turned(const Vector& direction, double /*from*/, double /*to*/) const { return direction; }
  // Nodes that may be partners; empty for rigid counterparts.
  virtual const std::vector<int>& partners() const = 0;
  // After a step: whether the law of a node was not ILAW_FREE, and where the node was.
  virtual void note_contact(int /*node_index*/, bool /*touches*/, const ContactPoint& /*point*/) {}
  // Whether it touched and has not left since. Such nodes must be evaluated in every step.
  virtual bool is_held(int /*node_index*/) const { return false; }
  // The part of that memory which a checkpoint takes along.
  virtual void save(std::ostream& /*out*/) const {}
  virtual void load(std::istream& /*in*/) {}
  // Whether two contacts may have a partner in common.
  virtual bool shares_partners() const { return false; }
  virtual bool keeps_normal() const { return false; }
};

// Velocities of a turning surface in the steps before and after a time, where a node meets it.
struct SurfaceVelocities {
  Vector before, after;
};
inline SurfaceVelocities surface_velocities(const Counterpart& counterpart, int node_index, const Dofs& u,
                                            double time, const RigidSurface& there,
                                            const TurningRates& rates) {
  const SurfaceTurn turn = counterpart.unit_turn(node_index, u, time, there);
  return {turn.at(rates.before), turn.at(rates.after)};
}

// Turns an axis of a state, of which number(c) is the component c, with the counterpart.
template <class Number>
void turn_axis(const Counterpart& counterpart, Eigen::Index dimension, double from, double to,
               Number number) {
  Vector axis(dimension);
  for (Eigen::Index c = 0; c < dimension; ++c) axis[c] = number(static_cast<std::size_t>(c));
  axis = counterpart.turned(axis, from, to);
  for (Eigen::Index c = 0; c < dimension; ++c) number(static_cast<std::size_t>(c)) = axis[c];
}

// A rigid obstacle.
class RigidCounterpart : public Counterpart {
 public:
  RigidCounterpart(const Model& model, std::vector<int> nodes, std::unique_ptr<const Obstacle> obstacle);
  ContactPoint contact_point(int node_index, const Dofs& u, double time) const override;
  void locate(const std::int32_t* node_indices, std::ptrdiff_t count, const Dofs& u, double time,
              Located found) const override;
  double gap_bound(int node_index, const Dofs& u, double time) const override;
  void gap_bounds(int first, int count, const Dofs& u, double time, double* bounds) const override;
  std::optional<FlatSurface> flat_at(double time) const override { return obstacle_->flat_at(time); }
  Vector velocity(double from, double to) const override { return obstacle_->velocity(from, to); }
  bool turns() const override { return obstacle_->turns(); }
  TurningRates rates(const Steps& steps) const override {
    return {obstacle_->rate_before(steps.since, steps.time), obstacle_->rate_after(steps.time, steps.until)};
  }
  SurfaceTurn unit_turn(int node_index, const Dofs& u, double time,
                        const RigidSurface& there) const override {
    return obstacle_->unit_velocity(position(node_index, u), there, time);
  }
  Vector turned(const Vector& direction, double from, double to) const override {
    return obstacle_->turned(direction, from, to);
  }
  double tilting_speed(double from, double to, const Dofs& u) const override;
  bool stands_still() const override { return obstacle_->stands_still(); }
  const std::vector<int>& partners() const override { return none_; }
  bool keeps_normal() const override { return obstacle_->is_flat(); }

 private:
  Vector position(int node_index, const Dofs& u) const;
  void gaps_to(const FlatSurface& flat, const std::int32_t* nodes, std::ptrdiff_t count, const Dofs& u,
               double* gaps) const;

  const Model& model_;
  std::vector<int> nodes_, none_;
  std::unique_ptr<const Obstacle> obstacle_;
};

// One other node for each node, across a given normal.
class NodeCounterpart : public Counterpart {
 public:
  NodeCounterpart(const Model& model, std::vector<int> nodes, std::vector<int> partners, Vector normal);
  ContactPoint contact_point(int node_index, const Dofs& u, double time) const override;
  double gap_bound(int node_index, const Dofs& u, double time) const override {
    return contact_point(node_index, u, time).gap;
  }
  Vector velocity(double /*from*/, double /*to*/) const override { return Vector::Zero(model_.dimension()); }
  const std::vector<int>& partners() const override { return partners_; }
  bool keeps_normal() const override { return true; }

 private:
  const Model& model_;
  std::vector<int> nodes_, partners_;
  Vector normal_;
};

}  // namespace ilaw::host
