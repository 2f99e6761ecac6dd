// kernels.hpp - the velocity of a contact from those of its bodies, and what its impulse changes of theirs:
// one kernel for each kind of contact, chosen once per block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blocks.hpp"
#include "bodies.hpp"
#include "lanes.hpp"

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace ilaw::coupled {

enum class Kind {
  point,     // bodies with one mass each that do not rotate
  sphere,    // arms along the normal, one mass and one moment of inertia
  spin,      // the same, with a moment at the contact
  rigid,     // any arms, tensors, masses per axis
  points,    // weighted sets of bodies with one mass each that do not rotate
  weighted,  // any weighted sets
};

// Velocity at the end of an arm.
inline Vector velocity_at(const Body& body, const Vector& arm) {
  return body.velocity + cross(body.spin, arm);
}

// A body's velocity and inverse mass, its spin and inverse moment of inertia.
inline Lanes& velocity_row(Body& body) { return *lanes(body.velocity.data()); }
inline Lanes& spin_row(Body& body) { return *lanes(body.spin.data()); }
inline const Lanes& velocity_row(const Body& body) { return *lanes(body.velocity.data()); }
inline const Lanes& spin_row(const Body& body) { return *lanes(body.spin.data()); }

// Each kernel has relative(bodies, lane), and apply(lane, r, add), which calls add(body, impulse, moment),
// both with `width` components. Those of bodies with one mass and one moment of inertia have the same for
// four lanes from `lane` on, with the same bits.
class PointKernel {
 public:
  static constexpr std::size_t width = 3;
  explicit PointKernel(const Block& block) : body_(block.ends), other_(block.ends + block.stride) {}
  Vector relative(const Body* bodies, std::size_t q) const {
    return bodies[body_[q]].velocity - bodies[other_[q]].velocity;
  }
  template <class Add>
  void apply(std::size_t q, const Vector& r, Add&& add) const {
    add(body_[q], r, Vector{});
    add(other_[q], -1.0 * r, Vector{});
  }
  LanesVector relative_of_four(const Body* bodies, std::size_t q) const {
    Lanes row[4];
    for (std::size_t k = 0; k < 4; ++k)
      row[k] = velocity_row(bodies[body_[q + k]]) - velocity_row(bodies[other_[q + k]]);
    return columns_of(row);
  }
  void apply_four(std::size_t q, const LanesVector& r, Body* bodies) const {
    Lanes row[4];
    to_rows(r, row);
    for (std::size_t k = 0; k < 4; ++k) {
      Body &x = bodies[body_[q + k]], &y = bodies[other_[q + k]];
      if (moves(x)) velocity_row(x) += x.inverse_mass * row[k];
      if (moves(y)) velocity_row(y) += y.inverse_mass * -row[k];
    }
  }

 private:
  const std::int32_t *body_, *other_;
};

class SphereKernel {
 public:
  static constexpr std::size_t width = 3;
  explicit SphereKernel(const Block& block)
      : body_(block.ends),
        other_(block.ends + block.stride),
        normal_(block.column(block.layout->normal)),
        arm_(block.column(block.layout->arm)),
        other_arm_(block.column(block.layout->counterpart_arm)),
        stride_(block.stride) {}
  Vector relative(const Body* bodies, std::size_t q) const {
    const Body &x = bodies[body_[q]], &y = bodies[other_[q]];
    return x.velocity - y.velocity + cross(arm_[q] * x.spin - other_arm_[q] * y.spin, normal(q));
  }
  template <class Add>
  void apply(std::size_t q, const Vector& r, Add&& add) const {
    const Vector moment = cross(normal(q), r);
    add(body_[q], r, arm_[q] * moment);
    add(other_[q], -1.0 * r, -other_arm_[q] * moment);
  }
  LanesVector relative_of_four(const Body* bodies, std::size_t q) const {
    Lanes velocity[4], turning[4];
    for (std::size_t k = 0; k < 4; ++k) {
      const Body &x = bodies[body_[q + k]], &y = bodies[other_[q + k]];
      velocity[k] = velocity_row(x) - velocity_row(y);
      turning[k] = arm_[q + k] * spin_row(x) - other_arm_[q + k] * spin_row(y);
    }
    return columns_of(velocity) + cross(columns_of(turning), lanes(normal_ + q, stride_));
  }
  void apply_four(std::size_t q, const LanesVector& r, Body* bodies) const {
    Lanes impulse[4], moment[4];
    to_rows(r, impulse);
    to_rows(cross(lanes(normal_ + q, stride_), r), moment);
    for (std::size_t k = 0; k < 4; ++k) {
      Body &x = bodies[body_[q + k]], &y = bodies[other_[q + k]];
      add_rows(x, impulse[k], arm_[q + k] * moment[k]);
      add_rows(y, -impulse[k], -other_arm_[q + k] * moment[k]);
    }
  }

 protected:
  static void add_rows(Body& body, const Lanes& impulse, const Lanes& moment) {
    if (!moves(body)) return;
    velocity_row(body) += body.inverse_mass * impulse;
    spin_row(body) += body.inverse_inertia * moment;
  }
  Vector normal(std::size_t q) const { return {normal_[q], normal_[stride_ + q], normal_[2 * stride_ + q]}; }
  const std::int32_t *body_, *other_;
  const double *normal_, *arm_, *other_arm_;
  std::size_t stride_;
};

// The moment m of a contact acts at the body, -m at the counterpart.
class SpinKernel : public SphereKernel {
 public:
  static constexpr std::size_t width = 6;
  explicit SpinKernel(const Block& block) : SphereKernel(block) {}
  LanesWrench relative_of_four(const Body* bodies, std::size_t q) const {
    Lanes spin[4];
    for (std::size_t k = 0; k < 4; ++k)
      spin[k] = spin_row(bodies[body_[q + k]]) - spin_row(bodies[other_[q + k]]);
    return {SphereKernel::relative_of_four(bodies, q), columns_of(spin)};
  }
  void apply_four(std::size_t q, const LanesWrench& by, Body* bodies) const {
    Lanes impulse[4], moment[4], own[4];
    to_rows(by.linear, impulse);
    to_rows(cross(lanes(normal_ + q, stride_), by.linear), moment);
    to_rows(by.angular, own);
    for (std::size_t k = 0; k < 4; ++k) {
      Body &x = bodies[body_[q + k]], &y = bodies[other_[q + k]];
      add_rows(x, impulse[k], arm_[q + k] * moment[k] + own[k]);
      add_rows(y, -impulse[k], -other_arm_[q + k] * moment[k] - own[k]);
    }
  }
  Wrench relative(const Body* bodies, std::size_t q) const {
    const Vector v = SphereKernel::relative(bodies, q);
    const Vector w = bodies[body_[q]].spin - bodies[other_[q]].spin;
    return {v[0], v[1], v[2], w[0], w[1], w[2]};
  }
  template <class Add>
  void apply(std::size_t q, const Wrench& by, Add&& add) const {
    const Vector r{by[0], by[1], by[2]}, m{by[3], by[4], by[5]}, moment = cross(normal(q), r);
    add(body_[q], r, arm_[q] * moment + m);
    add(other_[q], -1.0 * r, -other_arm_[q] * moment - m);
  }
};

class RigidKernel {
 public:
  static constexpr std::size_t width = 3;
  explicit RigidKernel(const Block& block) : block_(block), layout_(*block.layout) {}
  Vector relative(const Body* bodies, std::size_t q) const {
    return velocity_at(bodies[block_.end(0, q)], block_.at(layout_.arm, q)) -
           velocity_at(bodies[block_.end(1, q)], block_.at(layout_.counterpart_arm, q));
  }
  template <class Add>
  void apply(std::size_t q, const Vector& r, Add&& add) const {
    add(block_.end(0, q), r, cross(block_.at(layout_.arm, q), r));
    add(block_.end(1, q), -1.0 * r, cross(r, block_.at(layout_.counterpart_arm, q)));
  }

 private:
  const Block& block_;
  const Layout& layout_;
};

// Weights of the counterpart's bodies are stored with a minus sign. With 17 ends, gather and scatter
// have a third of the instructions of WeightedKernel, and the same bits.
class PointsKernel {
 public:
  static constexpr std::size_t width = 3;
  explicit PointsKernel(const Block& block)
      : body_(block.ends),
        weight_(block.column(block.layout->weight)),
        stride_(block.stride),
        size_(static_cast<std::size_t>(block.layout->ends) * block.stride) {}
  Vector relative(const Body* bodies, std::size_t q) const {
    Vector sum{};
    for (std::size_t e = q; e < size_; e += stride_) sum = sum + weight_[e] * bodies[body_[e]].velocity;
    return sum;
  }
  template <class Add>
  void apply(std::size_t q, const Vector& r, Add&& add) const {
    for (std::size_t e = q; e < size_; e += stride_) add(body_[e], weight_[e] * r, Vector{});
  }
  LanesVector relative_of_four(const Body* bodies, std::size_t q) const {
    Lanes row[4]{};
    for (std::size_t e = q; e < size_; e += stride_)
      for (std::size_t k = 0; k < 4; ++k) row[k] += weight_[e + k] * velocity_row(bodies[body_[e + k]]);
    return columns_of(row);
  }
  void apply_four(std::size_t q, const LanesVector& r, Body* bodies) const {
    Lanes row[4];
    to_rows(r, row);
    for (std::size_t e = q; e < size_; e += stride_)
      for (std::size_t k = 0; k < 4; ++k)
        if (Body& x = bodies[body_[e + k]]; moves(x))
          velocity_row(x) += x.inverse_mass * (weight_[e + k] * row[k]);
  }

 private:
  const std::int32_t* body_;
  const double* weight_;
  std::size_t stride_, size_;
};

// As PointsKernel, with arms, tensors, masses per axis or weights that are matrices.
class WeightedKernel {
 public:
  static constexpr std::size_t width = 3;
  WeightedKernel(const Block& block, std::uint32_t body_count)
      : block_(block), layout_(*block.layout), body_count_(static_cast<int>(body_count)) {}
  Vector relative(const Body* bodies, std::size_t q) const {
    Vector sum{};
    for (int e = 0; e < layout_.ends; ++e)
      sum = sum + times(e, q, velocity_at(bodies[block_.end(e, q)], arm(e, q)), false);
    return sum;
  }
  template <class Add>
  void apply(std::size_t q, const Vector& r, Add&& add) const {
    for (int e = 0; e < layout_.ends; ++e) {
      const Vector impulse = times(e, q, r, true);
      add(block_.end(e, q), impulse, cross(arm(e, q), impulse));
    }
  }

 private:
  Vector arm(int e, std::size_t q) const {
    const int column = e < body_count_ ? layout_.arm : layout_.counterpart_arm;
    return column < 0 ? Vector{} : block_.at(column, q);
  }
  Vector times(int e, std::size_t q, const Vector& v, bool transposed) const {
    const double* w = block_.column(layout_.weight + e * layout_.weight_size) + q;
    if (layout_.weight_size == 1) return w[0] * v;
    const std::size_t s = block_.stride;
    if (transposed)
      return {w[0] * v[0] + w[3 * s] * v[1] + w[6 * s] * v[2],
              w[s] * v[0] + w[4 * s] * v[1] + w[7 * s] * v[2],
              w[2 * s] * v[0] + w[5 * s] * v[1] + w[8 * s] * v[2]};
    return {w[0] * v[0] + w[s] * v[1] + w[2 * s] * v[2], w[3 * s] * v[0] + w[4 * s] * v[1] + w[5 * s] * v[2],
            w[6 * s] * v[0] + w[7 * s] * v[1] + w[8 * s] * v[2]};
  }
  const Block& block_;
  const Layout& layout_;
  int body_count_;
};

template <class Kernel>
inline constexpr std::size_t width_of = std::remove_cvref_t<Kernel>::width;
template <class Kernel>
inline constexpr bool takes_four = requires(const Kernel& k, Body* b) {
  k.relative_of_four(b, 0);
};

// Calls visit with the kernel of a block.
template <class Visit>
void with_kernel(Kind kind, const Block& block, std::uint32_t body_count, Visit&& visit) {
  switch (kind) {
    case Kind::point:
      return visit(PointKernel(block));
    case Kind::sphere:
      return visit(SphereKernel(block));
    case Kind::spin:
      return visit(SpinKernel(block));
    case Kind::rigid:
      return visit(RigidKernel(block));
    case Kind::points:
      return visit(PointsKernel(block));
    case Kind::weighted:
      return visit(WeightedKernel(block, body_count));
  }
}

}  // namespace ilaw::coupled
