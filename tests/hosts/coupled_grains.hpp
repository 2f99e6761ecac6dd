// coupled_grains.hpp - a host of solid spheres of any size with the law rolling at all contacts, solved
// together by ilaw/coupled.h with spins and moments: central differences, contacts found anew in each step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laws/rolling/spheres.hpp"

#include <ilaw/coupled.hpp>

#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace coupled_grains {

using namespace ilaw::testing;

// Three steps that share no factor.
constexpr double steps[] = {1e-4, 3.7e-4, 7.3e-4};

struct Grain {
  double mass, radius;
  Vector x{}, v{}, w{};
  double inertia() const { return 0.4 * mass * radius * radius; }
};

// The plane normal.x = offset, at rest at the points of contact.
struct Wall {
  Vector normal{0.0, 0.0, 1.0};
  double offset = 0.0;
  Vector spin{}, spin_previous{};
};

class Grains {
 public:
  explicit Grains(const Parameters& parameters, double length_of_step)
      : h(length_of_step),
        law_(make_law("rolling",
                      SetupBuilder(parameters, 3, ILAW_DELASSUS_TRANSVERSE_SPIN, ILAW_FRAME_GLOBAL))) {}

  ilaw_coupled_report step() {
    find_contacts();
    read_bodies();
    ilaw_batch batch = batch_of_contacts();
    ilaw_contacts contacts =
        ilaw::contacts_of(law_, ILAW_DELASSUS_TRANSVERSE_SPIN, batch, body.data(), other.data());
    contacts.arm = ilaw::input(at(arm), 3, 1);
    contacts.counterpart_arm = ilaw::input(at(other_arm), 3, 1);
    if (walls_spin) {
      contacts.wall_spin = ilaw::input(at(wall_spin_), 3, 1);
      contacts.wall_spin_previous = ilaw::input(at(wall_spin_previous_), 3, 1);
    }
    const ilaw_coupled_report report = solver_.solve(bodies(), contacts, options);
    for (std::size_t i = 0; i < grains.size(); ++i) {
      grains[i].v = v_[i], grains[i].w = w_[i];
      grains[i].x = grains[i].x + h * v_[i];
    }
    for (std::size_t k = 0; k < body.size(); ++k) last_[key(k)] = {impulse[k], moment[k]};
    dissipated += report.energy[ILAW_ENERGY_FRICTION] + report.energy[ILAW_ENERGY_IMPACT];
    work += report.work;
    iterations += report.sweeps;
    return report;
  }
  void run(double time) {
    for (int k = 0; k < std::lround(time / h); ++k) step();
  }

  double kinetic() const {
    double twice = 0.0;
    for (const Grain& grain : grains)
      twice += grain.mass * dot(grain.v, grain.v) + grain.inertia() * dot(grain.w, grain.w);
    return 0.5 * twice;
  }

  double h;
  std::vector<Grain> grains;
  std::vector<Wall> walls;
  Vector pull{0.0, 0.0, -9.81}, torque{};  // acceleration, and torque on each grain
  double reach = 0.0;                      // contacts have gaps up to it
  bool walls_spin = false, begins_with_impulse = true, begins_with_moment = true;
  ilaw_coupled_options options = default_options();
  double dissipated = 0.0, work = 0.0;
  std::uint64_t iterations = 0;
  // The contacts of the last step.
  std::vector<std::int32_t> body, other;
  std::vector<Vector> normal, arm, other_arm, impulse, moment;
  std::vector<double> gap;

 private:
  struct Warm {
    Vector impulse{}, moment{};
  };
  static ilaw_coupled_options default_options() {
    ilaw_coupled_options made{};
    made.most_sweeps = 1000;
    made.tolerance = 1e-14;
    return made;
  }
  static double* at(std::vector<Vector>& of) { return of.empty() ? nullptr : of[0].data(); }
  std::pair<int, int> key(std::size_t k) const { return {body[k], other[k] < 0 ? -1 - wall_[k] : other[k]}; }

  void find_contacts() {
    body.clear(), other.clear(), wall_.clear(), normal.clear(), gap.clear();
    const auto count = static_cast<int>(grains.size());
    const auto add = [&](int a, int b, int of_wall, const Vector& n, double distance) {
      if (distance > reach) return;
      body.push_back(a), other.push_back(b), wall_.push_back(of_wall);
      normal.push_back(n), gap.push_back(distance);
    };
    for (int i = 0; i < count; ++i) {
      const Grain& grain = grains[static_cast<std::size_t>(i)];
      for (int j = 0; j < i; ++j) {
        const Grain& next = grains[static_cast<std::size_t>(j)];
        const Vector d = grain.x - next.x;
        add(i, j, -1, (1.0 / length(d)) * d, length(d) - grain.radius - next.radius);
      }
      for (std::size_t p = 0; p < walls.size(); ++p)
        add(i, -1, static_cast<int>(p), walls[p].normal,
            dot(walls[p].normal, grain.x) - walls[p].offset - grain.radius);
    }
    fill_contacts();
  }
  void fill_contacts() {
    const std::size_t count = body.size();
    for (auto* vectors : {&arm, &other_arm, &impulse, &moment, &wall_spin_, &wall_spin_previous_})
      vectors->assign(count, {});
    energy_.assign(count, {});
    for (std::size_t k = 0; k < count; ++k) {
      arm[k] = -grains[static_cast<std::size_t>(body[k])].radius * normal[k];
      if (other[k] >= 0) other_arm[k] = grains[static_cast<std::size_t>(other[k])].radius * normal[k];
      if (wall_[k] >= 0) {
        wall_spin_[k] = walls[static_cast<std::size_t>(wall_[k])].spin;
        wall_spin_previous_[k] = walls[static_cast<std::size_t>(wall_[k])].spin_previous;
      }
      const auto found = last_.find(key(k));
      if (found == last_.end()) continue;
      if (begins_with_impulse) impulse[k] = found->second.impulse;
      if (begins_with_moment) moment[k] = found->second.moment;
    }
    last_.clear();
  }
  void read_bodies() {
    const std::size_t count = grains.size();
    for (auto* vectors : {&v_, &w_, &v_previous_, &w_previous_}) vectors->assign(count, {});
    inverse_mass_.assign(count, 0.0), inverse_inertia_.assign(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      v_previous_[i] = grains[i].v, w_previous_[i] = grains[i].w;
      v_[i] = grains[i].v + h * pull;
      w_[i] = grains[i].w + (h / grains[i].inertia()) * torque;
      inverse_mass_[i] = 1.0 / grains[i].mass, inverse_inertia_[i] = 1.0 / grains[i].inertia();
    }
  }
  ilaw_batch batch_of_contacts() {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = static_cast<std::int64_t>(body.size());
    b.velocity_step = b.position_step = h;
    b.gap = ilaw::input(gap.data(), 1, 0);
    b.normal = ilaw::input(at(normal), 3, 1);
    b.impulse = ilaw::output(at(impulse), 3, 1);
    b.moment = ilaw::output(at(moment), 3, 1);
    if (!energy_.empty()) b.energy = ilaw::output(energy_[0].data(), ILAW_ENERGY_COUNT, 1);
    return b;
  }
  ilaw_bodies bodies() {
    ilaw_bodies b{};
    b.struct_size = sizeof b;
    b.dimension = 3;
    b.count = b.owned_count = static_cast<std::int64_t>(grains.size());
    b.inverse_mass = ilaw::input(inverse_mass_.data(), 1, 0);
    b.inverse_inertia = ilaw::input(inverse_inertia_.data(), 1, 0);
    b.v_free = ilaw::input(at(v_), 3, 1);
    b.spin_free = ilaw::input(at(w_), 3, 1);
    b.v_previous = ilaw::input(at(v_previous_), 3, 1);
    b.spin_previous = ilaw::input(at(w_previous_), 3, 1);
    b.velocity = ilaw::output(at(v_), 3, 1);
    b.spin = ilaw::output(at(w_), 3, 1);
    return b;
  }

  ilaw::interface law_;
  ilaw::coupled solver_;
  std::map<std::pair<int, int>, Warm> last_;
  std::vector<int> wall_;
  std::vector<Vector> wall_spin_, wall_spin_previous_, v_, w_, v_previous_, w_previous_;
  std::vector<double> inverse_mass_, inverse_inertia_;
  std::vector<std::array<double, ILAW_ENERGY_COUNT>> energy_;
};

}  // namespace coupled_grains
