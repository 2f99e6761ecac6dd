// counterpart.hpp - what the nodes of an interface touch: a rigid obstacle, other nodes, or a
// surface of another body.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"
#include "model/obstacle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace ilaw::host {

struct Partner {
  int node;
  double weight;
};

// The partners of a contact: the corners of a facet, or any number where weights are integrated.
class Partners {
 public:
  static constexpr std::size_t few = 4;

  Partners() = default;
  Partners(std::initializer_list<Partner> partners) {
    for (const Partner& partner : partners) add(partner);
  }
  void add(const Partner& partner) {
    if (count_ == few) many_.assign(few_.begin(), few_.end());
    if (count_ < few)
      few_[count_] = partner;
    else
      many_.push_back(partner);
    ++count_;
  }
  void clear() {
    count_ = 0;
    many_.clear();
  }
  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  const Partner* begin() const { return count_ <= few ? few_.data() : many_.data(); }
  const Partner* end() const { return begin() + count_; }

 private:
  std::size_t count_ = 0;
  std::array<Partner, few> few_{};
  std::vector<Partner> many_;  // all of them, where they are more than few
};

// Where a node faces its counterpart, and how. The relative velocity of the contact is
//   v = own_weight V_node - sum_i weight_i V_partner_i - (velocity of the obstacle).
struct ContactPoint {
  double gap = 0.0;
  Vector normal;
  Partners partners;
  bool is_beyond_border = false;  // beside the surface of a mesh
  double own_weight = 1.0;
  std::size_t own_partners = 0;  // the first ones, of the node's own body
  double area = 0.0;             // overlap of this step; 0: use the area of the setup
  double behind = 0.0;           // by which it lies behind a surface that it does not meet for that reason

  // As it was made, with the memory of its partners kept.
  void clear() {
    partners.clear();
    is_beyond_border = false;
    own_weight = 1.0;
    own_partners = 0;
    area = behind = 0.0;
  }
  // Calls visit(node, weight) for the contact's own node and its partners.
  template <class Visit>
  void for_each_node(int node, Visit visit) const {
    visit(node, own_weight);
    for (const Partner& partner : partners) visit(partner.node, -partner.weight);
  }
  // The same of the nodes of each side; the weights of a side have the sum 1.
  template <class OwnSide, class OtherSide>
  void for_each_side(int node, OwnSide own, OtherSide other) const {
    own(node, own_weight);
    std::size_t k = 0;
    for (const Partner& partner : partners)
      if (k++ < own_partners)
        own(partner.node, -partner.weight);
      else
        other(partner.node, partner.weight);
  }
  // H along an axis: inverse_mass is 1/m, or less where loads take a part of an impulse, per degree of
  // freedom.
  double delassus(const double* inverse_mass, int dimension, int node, int axis = 0) const;
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

// In the last places of the largest coordinate: of the dozen operations from a node, its facet and their
// normal.
inline constexpr double roundings_of_gaps = 16.0;

// What a surface is asked for in a step: the nodes that may come within reach.
struct Approach {
  double travelled;  // how far nodes and surface may have approached since the last step, at most
  double reach;      // the gap up to which nodes must be found
  bool is_forced;    // although the last list may be complete
  bool is_idle;      // no contact is asked for its gap before there is a new list
};

class Counterpart {
 public:
  virtual ~Counterpart() = default;

  // Where a node of the interface is, by node_index in its list, and its contact point.
  Vector position(int node_index, const Dofs& u) const;
  ContactPoint contact_point(int node_index, const Dofs& u, double time) const {
    ContactPoint found;
    find_contact(node_index, u, time, found);
    return found;
  }
  // The same, into a point whose memory is used again.
  virtual void find_contact(int node_index, const Dofs& u, double time, ContactPoint& found) const = 0;
  // A bound from below on the gap, cheap, that relative motion by a distance lowers by no more than
  // the distance.
  virtual double gap_bound(int node_index, const Dofs& u, double time) const {
    return contact_point(node_index, u, time).gap;
  }
  // The same of count nodes from the first on; several threads may ask at once.
  virtual void gap_bounds(int first, int count, const Dofs& u, double time, double* bounds) const;
  // A gap, less its offset, that is open by no more than the rounding of positions is closed: else a law that
  // acts at closed gaps alone would let a node at rest fall for a step, alone but not in the coupled solver
  // (coupled.h, rounding).
  double known_gap(int node_index, const Dofs& u, double gap) const {
    return gap > 0.0 && gap <= rounding_at(node_index, u) ? 0.0 : gap;
  }
  // Takes the displacements that contact points and gap bounds are asked for from here on.
  virtual void follow(const Dofs& /*u*/) {}
  // A surface that finds the nodes near it by itself (proximity_filter.hpp does it for the others): whether
  // its list is a new one, and the gap bound up to which nodes are in it.
  virtual bool finds_near() const { return false; }
  virtual bool find_near(const Dofs& /*u*/, const Approach& /*approach*/) { return true; }
  // A step in which nobody asks, since the interface does not act.
  virtual void pass_by(double /*travelled*/) {}
  virtual double horizon() const { return 0.0; }

  // Null where the nodes meet another body.
  virtual const Obstacle* obstacle() const { return nullptr; }
  bool turns() const { return obstacle() && obstacle()->turns(); }
  // An obstacle that is a plane.
  std::optional<FlatSurface> flat_at(double time) const {
    return obstacle() ? obstacle()->flat_at(time) : std::nullopt;
  }
  // Nodes that may be partners; empty for obstacles.
  const std::vector<int>& partners() const { return partners_; }
  // After a step: whether the law of a node was not ILAW_FREE, and where the node was.
  virtual void note_contact(int /*node_index*/, bool /*touches*/, const ContactPoint& /*point*/) {}
  // Whether it touched and has not left since. Such nodes must be evaluated in every step.
  virtual bool is_held(int /*node_index*/) const { return false; }
  // The part of that memory which a checkpoint takes along.
  virtual void save(std::ostream& /*out*/) const {}
  virtual void load(std::istream& /*in*/) {}
  // The law may hold nodes that left, or all of them at once. Where it stores energy, contact points have no
  // areas of their own, and bonds may reach far.
  virtual void expect_bonds(bool /*store_energy*/, bool /*at_once*/) {}
  // Whether some of its surface lies over the node's share of a face. Only faces that are integrated know.
  virtual bool has_overlap(int /*node_index*/) const { return true; }
  // Whether two contacts may have a partner in common.
  virtual bool shares_partners() const { return false; }
  virtual bool keeps_normal() const { return false; }

 protected:
  Counterpart(const Model& model, std::vector<int> nodes, std::vector<int> partners)
      : model_(model), nodes_(std::move(nodes)), partners_(std::move(partners)) {}

  const Model& model_;
  std::vector<int> nodes_, partners_;

 private:
  // Of a difference of coordinates at the node.
  double rounding_at(int node_index, const Dofs& u) const {
    const int d = model_.dimension(), first = d * nodes_[static_cast<std::size_t>(node_index)];
    double largest = 0.0;
    for (int dof = first; dof < first + d; ++dof)
      largest = std::max(largest, std::fabs(model_.position()[dof] + u[dof]));
    return roundings_of_gaps * std::numeric_limits<double>::epsilon() * largest;
  }
};

// Velocities of a turning surface in the steps before and after a time, where a node meets it.
struct SurfaceVelocities {
  Vector before, after;
};
inline SurfaceVelocities surface_velocities(const Counterpart& counterpart, int node_index, const Dofs& u,
                                            double time, const RigidSurface& there,
                                            const TurningRates& rates) {
  const SurfaceTurn turn =
      counterpart.obstacle()->unit_velocity(counterpart.position(node_index, u), there, time);
  return {turn.at(rates.before), turn.at(rates.after)};
}

// Turns an axis of a state, of which number(c) is the component c, with the counterpart.
template <class Number>
void turn_axis(const Counterpart& counterpart, Eigen::Index dimension, double from, double to,
               Number number) {
  Vector axis(dimension);
  for (Eigen::Index c = 0; c < dimension; ++c) axis[c] = number(static_cast<std::size_t>(c));
  axis = counterpart.obstacle()->turned(axis, from, to);
  for (Eigen::Index c = 0; c < dimension; ++c) number(static_cast<std::size_t>(c)) = axis[c];
}

class RigidCounterpart : public Counterpart {
 public:
  RigidCounterpart(const Model& model, std::vector<int> nodes, std::unique_ptr<const Obstacle> obstacle)
      : Counterpart(model, std::move(nodes), {}), obstacle_(std::move(obstacle)) {}
  void find_contact(int node_index, const Dofs& u, double time, ContactPoint& found) const override;
  void gap_bounds(int first, int count, const Dofs& u, double time, double* bounds) const override;
  const Obstacle* obstacle() const override { return obstacle_.get(); }
  bool keeps_normal() const override { return obstacle_->is_flat(); }

 private:
  std::unique_ptr<const Obstacle> obstacle_;
};

// One other node for each node, across a given normal.
class NodeCounterpart : public Counterpart {
 public:
  NodeCounterpart(const Model& model, std::vector<int> nodes, std::vector<int> partners, Vector normal)
      : Counterpart(model, std::move(nodes), std::move(partners)), normal_(std::move(normal)) {}
  void find_contact(int node_index, const Dofs& u, double time, ContactPoint& found) const override;
  bool keeps_normal() const override { return true; }

 private:
  Vector normal_;
};

}  // namespace ilaw::host
