// coupled_problem.hpp - bodies and contacts of one law, solved together by ilaw/coupled.h. A test adds bodies
// and contacts, changes their members, and solves; all arrays of the call are views of these members.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/law_runner.hpp"

#include <ilaw/coupled.hpp>

#include <utility>

namespace ilaw::testing {

using Numbers = std::map<std::string, double>;
using Texts = std::map<std::string, std::string>;

// A law in the host's axes.
inline ilaw::interface coupled_law(const std::string& name, std::uint32_t form, const Numbers& numbers = {},
                                   const Texts& texts = {}) {
  return make_law(name, SetupBuilder({numbers, texts}, 3, form, ILAW_FRAME_GLOBAL));
}
// The law of spheres whose contacts have moments; its lengths are parts of the radius.
inline ilaw::interface rolling_law(double radius = 0.5) {
  return coupled_law(
      "rolling", ILAW_DELASSUS_TRANSVERSE_SPIN,
      {{"friction", 0.4}, {"rolling_friction", 0.05 * radius}, {"twisting_friction", 0.02 * radius}});
}

struct CoupledProblem {
  struct Body {
    double mass = 2.0, inertia = 0.2, radius = 0.5;  // a solid sphere
    Vector x{}, v{}, w{}, v_before{}, w_before{}, inverse_mass{};
    std::array<double, 6> inverse_inertia{};
  };
  struct Contact {
    double gap = 0.0;
    Vector normal{0.0, 0.0, 1.0}, arm{}, other_arm{}, wall{}, wall_before{}, wall_spin{}, wall_spin_before{};
    Vector impulse{}, moment{};
    std::array<double, ILAW_ENERGY_COUNT> energy{};
    std::uint8_t status = ILAW_BROKEN;
  };

  CoupledProblem(ilaw::interface of, std::uint32_t form_of_h, std::size_t count = 0)
      : law(std::move(of)), form(form_of_h), rotates(form_of_h != ILAW_DELASSUS_SCALAR) {
    for (std::size_t i = 0; i < count; ++i) add_body({});
  }

  std::int32_t add_body(Body one) {
    const double m = 1.0 / one.mass, j = 1.0 / one.inertia;
    one.inverse_mass = {m, m, m};
    one.inverse_inertia = {j, j, j, 0.0, 0.0, 0.0};
    body.push_back(one);
    return static_cast<std::int32_t>(body.size()) - 1;
  }
  // other: -1 at a wall.
  Contact& add(std::int32_t a, std::int32_t other, const Contact& one) {
    ends.push_back(a);
    other_ends.push_back(other);
    return contact.emplace_back(one);
  }
  // Of spheres, along the normal n from the other one to a.
  Contact& touch(std::int32_t a, std::int32_t other, const Vector& n, double gap = 0.0) {
    Contact one{gap, n};
    one.arm = -at(a).radius * n;
    one.other_arm = (other < 0 ? at(a) : at(other)).radius * n;
    return add(a, other, one);
  }
  // Between points on facets; all contacts of a problem have as many ends. -1: no node.
  Contact& add(const std::vector<std::int32_t>& nodes, const std::vector<double>& weights,
               const std::vector<std::int32_t>& others, const std::vector<double>& other_weights,
               const Contact& one) {
    width = nodes.size(), other_width = others.size();
    ends.insert(ends.end(), nodes.begin(), nodes.end());
    other_ends.insert(other_ends.end(), others.begin(), others.end());
    weight.insert(weight.end(), weights.begin(), weights.end());
    other_weight.insert(other_weight.end(), other_weights.begin(), other_weights.end());
    return contact.emplace_back(one);
  }

  // Replaces the velocities of bodies.
  ilaw_coupled_report solve() { return solve(batch()); }
  ilaw_coupled_report solve(const ilaw_batch& b) { return solver.solve(bodies(), contacts(b), options); }
  // A step at fixed positions.
  ilaw_coupled_report step(double gravity = 0.0) {
    kick(gravity);
    return solve();
  }
  void kick(double gravity) {
    for (Body& one : body) {
      one.v_before = one.v, one.w_before = one.w;
      one.v[2] -= h * gravity;
    }
    time += h;
  }

  ilaw_batch batch() {
    const std::size_t size = law.info().state_size * contact.size();
    ilaw_batch b = unread_batch();
    if (state.size() != size) {
      state.assign(size, 0.0);
      b = unread_batch();
      EXPECT_EQ(law.initialise(b), ILAW_OK);
    }
    return b;
  }
  ilaw_bodies bodies() {
    ilaw_bodies b{};
    b.struct_size = sizeof b;
    b.dimension = 3;
    b.count = b.owned_count = static_cast<std::int64_t>(body.size());
    b.inverse_mass = ilaw::input(first(body, &Body::inverse_mass), stride<Body>, masses_per_axis ? 1 : 0);
    b.v_free = input(body, &Body::v), b.v_previous = input(body, &Body::v_before);
    b.velocity = output(body, &Body::v);
    if (!rotates) return b;
    const bool is_sphere = form == ILAW_DELASSUS_TRANSVERSE || form == ILAW_DELASSUS_TRANSVERSE_SPIN;
    b.inverse_inertia = ilaw::input(first(body, &Body::inverse_inertia), stride<Body>, is_sphere ? 0 : 1);
    b.spin_free = input(body, &Body::w), b.spin_previous = input(body, &Body::w_before);
    b.spin = output(body, &Body::w);
    return b;
  }
  ilaw_contacts contacts(const ilaw_batch& of) {
    ilaw_contacts c =
        ilaw::contacts_of(law, static_cast<ilaw_delassus_form>(form), of, ends.data(), other_ends.data());
    c.arm = input(contact, &Contact::arm), c.counterpart_arm = input(contact, &Contact::other_arm);
    if (has_wall) c.wall_velocity = input(contact, &Contact::wall);
    if (has_wall_before) c.wall_previous = input(contact, &Contact::wall_before);
    if (walls_spin) {
      c.wall_spin = input(contact, &Contact::wall_spin);
      c.wall_spin_previous = input(contact, &Contact::wall_spin_before);
    }
    if (weight.empty()) return c;
    c.weight_size = weight_size;
    c.body_count = static_cast<std::uint32_t>(width),
    c.counterpart_count = static_cast<std::uint32_t>(other_width);
    c.body_weight = ilaw::input(weight.data(), static_cast<std::int64_t>(width * weight_size), 1);
    c.counterpart_weight =
        ilaw::input(other_weight.data(), static_cast<std::int64_t>(other_width * weight_size), 1);
    return c;
  }

  double kinetic() const {
    double twice = 0.0;
    for (const Body& one : body) {
      twice += one.mass * dot(one.v, one.v);
      if (rotates) twice += one.inertia * dot(one.w, one.w);
    }
    return 0.5 * twice;
  }
  Vector momentum() const {
    Vector sum{};
    for (const Body& one : body) sum = sum + one.mass * one.v;
    return sum;
  }
  // Of all components.
  double largest_velocity() const {
    double most = 0.0;
    for (const Body& one : body)
      for (const double x : one.v) most = std::max(most, std::fabs(x));
    return most;
  }
  // Velocity of a contact, as coupled.h has it: the sum of w (v + spin x arm) of both sides, less the wall's.
  Vector relative(std::size_t k, bool before = false) const {
    const Contact& c = contact[k];
    Vector u = has_wall ? -c.wall : Vector{};
    if (before && has_wall_before) u = -c.wall_before;
    const auto add_side = [&](const std::vector<std::int32_t>& nodes, const std::vector<double>& weights,
                              std::size_t count, const Vector& arm, double sign) {
      for (std::size_t e = k * count; e < (k + 1) * count; ++e) {
        if (nodes[e] < 0) continue;
        const Body& one = at(nodes[e]);
        const double part = sign * (weights.empty() ? 1.0 : weights[e]);
        u = u + part * (before ? one.v_before : one.v);
        if (rotates) u = u + part * cross(before ? one.w_before : one.w, arm);
      }
    };
    add_side(ends, weight, width, c.arm, 1.0);
    add_side(other_ends, other_weight, other_width, c.other_arm, -1.0);
    return u;
  }

  const Body& at(std::int32_t i) const { return body[static_cast<std::size_t>(i)]; }
  std::vector<Vector> velocities() const { return all(body, &Body::v); }
  std::vector<Vector> spins() const { return all(body, &Body::w); }
  std::vector<Vector> impulses() const { return all(contact, &Contact::impulse); }

  ilaw::interface law;
  std::uint32_t form;
  bool rotates, masses_per_axis = false, has_wall = false, has_wall_before = false, walls_spin = false;
  std::vector<Body> body;
  std::vector<Contact> contact;
  std::vector<std::int32_t> ends, other_ends;
  std::vector<double> weight, other_weight, state;
  std::size_t width = 1, other_width = 1;
  std::uint32_t weight_size = 1;
  double h = 1e-3, time = 0.0, area = 1.0;
  ilaw_coupled_options options{};
  ilaw::coupled solver;

 private:
  template <class Item>
  static constexpr std::int64_t stride = sizeof(Item) / sizeof(double);
  template <class Item, class Numbers>
  static double* first(std::vector<Item>& of, Numbers Item::*part) {
    return of.empty() ? nullptr : (of[0].*part).data();
  }
  template <class Item, class Numbers>
  static ilaw_input input(std::vector<Item>& of, Numbers Item::*part) {
    return ilaw::input(first(of, part), stride<Item>, 1);
  }
  template <class Item, class Numbers>
  static ilaw_output output(std::vector<Item>& of, Numbers Item::*part) {
    return ilaw::output(first(of, part), stride<Item>, 1);
  }
  template <class Item>
  static std::vector<Vector> all(const std::vector<Item>& of, Vector Item::*part) {
    std::vector<Vector> found;
    for (const Item& one : of) found.push_back(one.*part);
    return found;
  }
  ilaw_batch unread_batch() {
    const auto states = static_cast<std::int64_t>(law.info().state_size);
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = static_cast<std::int64_t>(contact.size());
    b.time = time;
    b.velocity_step = b.position_step = h;
    b.area = ilaw::input(&area, 0, 0);
    b.normal = input(contact, &Contact::normal);
    b.state_in = ilaw::input(state.data(), states, 1);
    b.state_out = ilaw::output(state.data(), states, 1);
    b.impulse = output(contact, &Contact::impulse);
    b.energy = output(contact, &Contact::energy);
    if (form == ILAW_DELASSUS_TRANSVERSE_SPIN) b.moment = output(contact, &Contact::moment);
    if (contact.empty()) return b;
    b.gap = ilaw::input(&contact[0].gap, stride<Contact>, 0);
    b.status = &contact[0].status;
    b.status_stride = sizeof(Contact);
    return b;
  }
};

// Contacts with one body above the next, from the floor up.
inline void stack(CoupledProblem& problem, const std::vector<CoupledProblem::Body>& bodies) {
  std::int32_t below = -1;
  for (const CoupledProblem::Body& one : bodies) {
    const std::int32_t here = problem.add_body(one);
    problem.touch(here, below, {0.0, 0.0, 1.0});
    below = here;
  }
}

// 27 spheres in a cube, one against the next along the axes, with any velocities and spins.
inline CoupledProblem cube(ilaw::interface law, std::uint32_t form, unsigned seed) {
  CoupledProblem made(std::move(law), form, 27);
  for (std::int32_t i = 0; i < 27; ++i) {
    const int place[] = {i % 3, i / 3 % 3, i / 9}, step[] = {1, 3, 9};
    for (std::size_t c = 0; c < 3; ++c) {
      Vector n{};
      n[c] = 1.0;
      if (place[c] > 0) made.touch(i, i - step[c], n);
    }
  }
  Random random(seed);
  for (CoupledProblem::Body& one : made.body) one.v = random.vector();
  for (CoupledProblem::Body& one : made.body) one.w = random.vector();
  return made;
}

}  // namespace ilaw::testing
