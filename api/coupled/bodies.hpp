// bodies.hpp - velocities and inverse masses of the bodies.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "arrays.hpp"

#include <ilaw/coupled.h>

#include <cstdint>
#include <vector>

namespace ilaw::coupled {

class Ranks;

struct Motion {
  Vector velocity{}, spin{};
};

// One cache line: what an iteration reads and changes of a body that has one mass and one moment of inertia.
struct alignas(64) Body {
  Vector velocity{};
  double inverse_mass = 0.0;
  Vector spin{};
  double inverse_inertia = 0.0;
};

inline bool moves(const Body& body) { return body.inverse_mass != 0.0 || body.inverse_inertia != 0.0; }

// The inertia of bodies with a tensor, or with a mass per axis.
struct Inertia {
  Vector inverse_mass{};
  Symmetric inverse_inertia{};
};

class Bodies {
 public:
  // Why the host's struct is refused, or null.
  static const char* complaint(const ilaw_bodies* given);
  // Why their masses are refused, or null.
  const char* read(const ilaw_bodies& given);

  std::int64_t count() const { return given_.count; }
  std::uint32_t dimension() const { return given_.dimension; }
  bool rotate() const { return given_.inverse_inertia.values != nullptr; }
  bool are_spheres() const { return given_.inverse_inertia.component_stride == 0; }
  bool have_previous() const { return given_.v_previous.values != nullptr; }
  // One inverse mass and one inverse inertia each: `now` has all that an iteration needs.
  bool are_isotropic() const { return inertia_.empty(); }

  // Index of a fixed body behind the others, for the missing side of a contact with a wall.
  std::int32_t wall() const { return static_cast<std::int32_t>(given_.count); }
  bool is_movable(std::int32_t body) const { return movable_[static_cast<std::size_t>(body)] != 0; }
  // Position in the order of global numbers.
  std::int32_t rank(std::int32_t body) const {
    return ranks_.empty() ? body : ranks_[static_cast<std::size_t>(body)];
  }

  // Divides the masses by these numbers of copies of each body (Tonge, Benevolenski, Voroshilov 2012).
  void split(const std::vector<double>& copies);

  // Velocities in this iteration, with one fixed body behind the others.
  Body* now() { return now_.data(); }
  const Body* now() const { return now_.data(); }
  const Inertia* inertia() const { return inertia_.data(); }
  // Velocities before the step, without masses.
  const Body* previous() const { return previous_.data(); }
  Inertia inertia_of(std::int32_t body) const;
  // Largest component of the velocities without contacts.
  double free_speed() const;

  // Velocities without contacts plus the changes by impulses and their moments, one Motion per body. Returns
  // the largest change of a velocity, or of a spin as a velocity.
  double set(const std::vector<Motion>& impulses);
  // Replaces the changes since `start` by those that the impulses of all ranks make.
  void exchange(const std::vector<Motion>& start, Ranks& ranks);
  void write(const std::vector<Motion>& impulses) const;
  // Work of these impulses over the step with the present velocities.
  double work(const std::vector<Motion>& impulses) const;

 private:
  Motion change(std::size_t body, const Motion& impulse) const;
  void rank_by_id();

  ilaw_bodies given_{};
  std::vector<Body> free_, now_, previous_;
  std::vector<Inertia> inertia_;
  std::vector<std::uint8_t> movable_;
  std::vector<std::int32_t> ranks_, order_;
  std::vector<double> split_;
  std::vector<Motion> changes_;
};

}  // namespace ilaw::coupled
