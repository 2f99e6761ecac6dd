// H of contacts, from the bodies and their weights.
// SPDX-License-Identifier: BSD-3-Clause
#include "contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace ilaw::coupled {
namespace {

// H of an axis along which nothing moves, relative to the largest. A law is asked at v_free = u - H r, so a
// solution fulfils it at the velocity u of the bodies whatever this number is. Laws round by some 2^-52 over
// it.
constexpr double held_delassus = 0x1p-24;
// H below this part of the largest is rounding: nothing moves along the axis.
constexpr double no_delassus = 0x1p-50;

void write_form(Block& block, std::size_t lane, const Layout& layout, const Symmetric& h, std::uint32_t form,
                std::uint32_t dimension, const Vector& normal) {
  double* out = block.column(layout.delassus) + lane;
  const std::size_t s = block.stride;
  if (form == ILAW_DELASSUS_TRANSVERSE) {
    out[0] = dot(normal, h * normal);
    out[s] = 0.5 * (h[0] + h[1] + h[2] - out[0]);
  } else if (form == ILAW_DELASSUS_SCALAR || dimension == 1) {
    out[0] = std::max({h[0], h[1], h[2]});
  } else if (dimension == 2) {
    out[0] = h[0], out[s] = h[1], out[2 * s] = h[3];
  } else {
    for (std::size_t c = 0; c < 6; ++c) out[c * s] = h[c];
  }
}

}  // namespace

bool Contacts::is_held(const Block& block, std::size_t lane, std::size_t axis) const {
  if (!may_be_held() || given_.delassus_form != ILAW_DELASSUS_FULL || dimension_ == 1) return false;
  double most = 0.0;
  for (std::uint32_t c = 0; c < dimension_; ++c)
    most = std::max(most, block.column(layout_.delassus + static_cast<int>(c))[lane]);
  return axis < dimension_ &&
         block.column(layout_.delassus + static_cast<int>(axis))[lane] == held_delassus * most;
}

// A body that a side names twice has the sum of the weights, so that H is that of one body.
void Contacts::fill_weights(Block& block, std::size_t lane, std::int64_t k) const {
  const auto end_at = [&](std::uint32_t e) -> std::int32_t& { return block.ends[e * block.stride + lane]; };
  const auto weight_at = [&](std::uint32_t e, int c) -> double& {
    return block.column(layout_.weight + static_cast<int>(e) * layout_.weight_size + c)[lane];
  };
  for (std::uint32_t e = 0; e < ends(); ++e) {
    const bool first_side = e < body_count_;
    const ilaw_input& given = first_side ? given_.body_weight : given_.counterpart_weight;
    const std::uint32_t i = first_side ? e : e - body_count_;
    const double sign = first_side ? 1.0 : -1.0;
    if (layout_.weight_size == 1) {
      weight_at(e, 0) = sign * (given.values ? value(given, k, i) : 1.0);
      continue;
    }
    for (int c = 0; c < layout_.weight_size; ++c) weight_at(e, c) = 0.0;
    const auto d = static_cast<int>(dimension_);
    for (int row = 0; row < d; ++row)
      for (int column = 0; column < d; ++column) {
        const double unit = row == column ? 1.0 : 0.0;
        const std::int64_t at = (std::int64_t{i} * d + row) * d + column;
        weight_at(e, 3 * row + column) = sign * (given.values ? value(given, k, at) : unit);
      }
  }
  std::uint64_t seen = 0;  // by the last digits of bodies: few contacts name a body twice
  for (std::uint32_t f = 0; f < ends(); ++f) {
    if (f == body_count_) seen = 0;
    const std::uint64_t digits = std::uint64_t{1} << (static_cast<std::uint32_t>(end_at(f)) % 64U);
    const bool is_known = (seen & digits) != 0;
    seen |= digits;
    if (!is_known) continue;
    std::uint32_t e = f < body_count_ ? 0 : body_count_;
    while (end_at(e) != end_at(f)) ++e;
    for (int c = 0; e < f && c < layout_.weight_size; ++c) {
      weight_at(e, c) += weight_at(f, c);
      weight_at(f, c) = 0.0;
    }
  }
}

// The sum of B M^-1 B' over the bodies of a contact, by the velocity that a unit impulse makes at each.
void Contacts::fill_delassus(Block& block, std::size_t lane, const Bodies& bodies) const {
  if (kind_ == Kind::point || kind_ == Kind::sphere || kind_ == Kind::spin) {
    const Body& x = bodies.now()[block.ends[lane]];
    const Body& y = bodies.now()[block.ends[block.stride + lane]];
    const double h = x.inverse_mass + y.inverse_mass;
    block.column(layout_.delassus)[lane] = h;
    if (kind_ != Kind::point) {
      const double a = block.column(layout_.arm)[lane], b = block.column(layout_.counterpart_arm)[lane];
      block.column(layout_.delassus + 1)[lane] = h + x.inverse_inertia * a * a + y.inverse_inertia * b * b;
      if (has_spins()) fill_spin_delassus(block, lane, x.inverse_inertia, y.inverse_inertia);
      return;
    }
    if (layout_.delassus_size == 1) return;
    write_form(block, lane, layout_, {h, h, h, 0, 0, 0}, given_.delassus_form, dimension_,
               block.at(layout_.normal, lane));
    return;
  }
  Symmetric h = bodies.rotate() || layout_.weight_size > 1 ? coupled_delassus(block, lane, bodies)
                                                           : diagonal_delassus(block, lane, bodies);
  const double most = std::max({h[0], h[1], h[2]});
  for (std::uint32_t c = 0; c < dimension_; ++c)
    if (h[c] <= no_delassus * most) h[c] = held_delassus * most;
  write_form(block, lane, layout_, h, given_.delassus_form, dimension_, block.at(layout_.normal, lane));
}

// With arms a n and b n a moment m turns the bodies by j_x m and -j_y m, which moves the contact by
// -(a j_x + b j_y) n x m.
void Contacts::fill_spin_delassus(Block& block, std::size_t lane, double j_x, double j_y) const {
  const double a = block.column(layout_.arm)[lane], b = block.column(layout_.counterpart_arm)[lane];
  block.column(layout_.delassus + 2)[lane] = -(a * j_x + b * j_y);
  block.column(layout_.delassus + 3)[lane] = block.column(layout_.delassus + 4)[lane] = j_x + j_y;
  const double j = mean_spin_delassus(block, lane);
  block.column(layout_.length)[lane] = j > 0.0 ? std::sqrt(mean_delassus(block, lane) / j) : 0.0;
}

// For bodies without rotation, and weights that are numbers.
Symmetric Contacts::diagonal_delassus(const Block& block, std::size_t lane, const Bodies& bodies) const {
  Symmetric h{};
  for (int e = 0; e < layout_.ends; ++e) {
    const std::int32_t body = block.end(e, lane);
    if (body == bodies.wall()) continue;
    const double weight = layout_.weight < 0 ? 1.0 : block.column(layout_.weight + e)[lane];
    const Vector inverse = bodies.inertia_of(body).inverse_mass;
    for (std::size_t c = 0; c < 3; ++c) h[c] += weight * (inverse[c] * weight);
  }
  return h;
}

Symmetric Contacts::coupled_delassus(const Block& block, std::size_t lane, const Bodies& bodies) const {
  std::array<Vector, 3> rows{};
  with_kernel(kind_, block, body_count_, [&](const auto& kernel) {
    using Impulse = std::array<double, width_of<decltype(kernel)>>;
    for (std::size_t c = 0; c < 3; ++c) {
      Impulse unit{};
      unit[c] = 1.0;
      kernel.apply(lane, unit, [&](std::int32_t body, const Vector& impulse, const Vector& moment) {
        if (body == bodies.wall()) return;
        const Inertia inertia = bodies.inertia_of(body);
        const Vector v = scaled(inertia.inverse_mass, impulse), w = inertia.inverse_inertia * moment;
        for (std::size_t row = 0; row < 3; ++row) {
          Impulse axis{};
          axis[row] = 1.0;
          kernel.apply(lane, axis, [&](std::int32_t other, const Vector& i, const Vector& m) {
            if (other == body) rows[row][c] += dot(i, v) + dot(m, w);
          });
        }
      });
    }
  });
  return {rows[0][0], rows[1][1], rows[2][2], rows[1][0], rows[2][0], rows[2][1]};
}

}  // namespace ilaw::coupled
