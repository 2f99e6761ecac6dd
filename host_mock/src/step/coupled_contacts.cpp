// SPDX-License-Identifier: BSD-3-Clause
#include "step/coupled_contacts.hpp"

#include "step/dof_loops.hpp"
#include "step/newton.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace ilaw::host {
namespace {

// Of all nodes that its contacts have, the heaviest to the lightest.
double mass_ratio_of(const ContactGroup& group, const Model& model) {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for_each_contact(group, [&](const Interface& interface, int contact, Eigen::Index /*k*/) {
    interface.point(contact).for_each_node(interface.node_of(contact), [&](int node, double /*weight*/) {
      const double mass = model.mass()[Eigen::Index{node} * model.dimension()];
      least = std::min(least, mass);
      most = std::max(most, mass);
    });
  });
  return most / least;
}

}  // namespace

bool share_nodes(const Model& model, const Interfaces& interfaces) {
  std::vector<bool> seen(static_cast<std::size_t>(model.node_count()));
  for (const auto& interface : interfaces) {
    if (interface->setup().counterpart->shares_partners()) return true;
    if (interface->setup().has_driven_nodes) return true;  // blocks of contacts have one H per node
    for (const std::vector<int>* nodes : {&interface->nodes(), &interface->setup().counterpart->partners()})
      for (const int node : *nodes)
        if (std::vector<bool>::reference mark = seen[static_cast<std::size_t>(node)]; mark)
          return true;
        else
          mark = true;
  }
  return false;
}

CoupledContacts::CoupledContacts(const Model& model, Interfaces& interfaces)
    : model_(model),
      interfaces_(interfaces),
      dimension_(model.dimension()),
      colours_(interfaces.size(), Colours(model.node_count())) {
  for (const auto& interface : interfaces_) interface->evaluate_repeatedly();
}

// Which contacts may act follows from a bound on speeds. Where impulses of other contacts leave a
// node faster, the step is solved again with a larger one: whether that happens does not depend on
// which are active. The others are out of reach of any such speed, and evaluated once, for their
// states: on the way speeds may be larger.
CoupledContacts::Outcome CoupledContacts::solve(StepView step, Dofs& v) {
  const double speed = std::max(step.speed_before, step.speed_after);
  v_free_ = v;
  Outcome outcome{};
  step.speed_after = 2.0 * speed;
  for (bool bounded = false; !bounded;) {
    open(step);
    v = v_free_;
    iterate(step, speed, v, outcome);
    const double fastest = largest_speed(v, dimension_);
    bounded = !(fastest > step.speed_after);
    step.speed_after = 2.0 * fastest;
  }
  for (std::size_t i = 0; i < interfaces_.size(); ++i) answer(*interfaces_[i], colours_[i].idle(), step, v);
  outcome.energy = disagreement(v).energy;
  return outcome;
}

void CoupledContacts::open(const StepView& step) {
  acting_.clear();
  for (std::size_t i = 0; i < interfaces_.size(); ++i) {
    interfaces_[i]->open_step(step);
    colours_[i].assign(*interfaces_[i]);
    colours_[i].for_each_acting([&](const ContactList& contacts) {
      acting_.push_back({interfaces_[i].get(), contacts});
    });
  }
}

// Sweeps to the tolerance. Few are enough for most contacts; the others are taken island by island:
// the acceleration would else learn from contacts that have nothing to do with each other, and a
// single one that is hard to solve would keep all at work.
void CoupledContacts::iterate(const StepView& step, double speed, Dofs& v, Outcome& outcome) {
  const Sweeping all{acting_, step, speed, v};
  outcome = {0, 1.0, 0.0};
  out_of_reach_ = std::numeric_limits<double>::infinity();
  while (outcome.residual > tolerance && outcome.sweeps < patience) {
    const Residual found = sweep(all, outcome);
    if (outcome.sweeps == 1) out_of_reach_ = most_growth * found.size;
    if (found.size > out_of_reach_) return;
  }
  if (!(outcome.residual > tolerance)) return round_anew(all, outcome);
  outcome.residual = 0.0;
  int most = outcome.sweeps;
  for (const ContactGroup& island : islands_of(acting_)) {
    Outcome found{outcome.sweeps, residual(island, speed, v).relative(), 0.0, outcome.largest};
    accelerate({island, step, speed, v}, found);
    if (found.residual > tolerance && found.sweeps >= most_sweeps)
      solve_by_tangents({island, step, speed, v}, found);
    round_anew({island, step, speed, v}, found);
    most = std::max(most, found.sweeps);
    outcome.residual = std::max(outcome.residual, found.residual);
  }
  outcome.sweeps = most;
}

CoupledContacts::Residual CoupledContacts::sweep(const Sweeping& on, Outcome& outcome) {
  for (const auto& [interface, contacts] : on.group) answer(*interface, contacts, on.step, on.v);
  const Residual found = residual(on.group, on.speed, on.v);
  outcome.residual = found.relative();
  outcome.largest = std::max(outcome.largest, found.size);
  ++outcome.sweeps;
  return found;
}

void CoupledContacts::accelerate(const Sweeping& on, Outcome& outcome) {
  Anderson anderson;
  Dofs impulses_before = scaled_impulses(on.group);
  for (const int first = outcome.sweeps; outcome.residual > tolerance && outcome.sweeps < most_sweeps;) {
    if (outcome.sweeps >= long_patience) {
      search(on, outcome);
      continue;
    }
    if (outcome.sweeps > first && outcome.sweeps % 2 == 0) {
      const Dofs image = scaled_impulses(on.group);
      const Dofs next = image + anderson.correction(image, image - impulses_before);
      impulses_before = try_from(on, next, outcome) ? next : image;
    }
    if (sweep(on, outcome).size > out_of_reach_) return;
  }
}

// Newton's method, where the sweeps have not ended: mass ratios of 1e6 take too many, however they are
// accelerated. Where it does not solve them, either, or a law refuses what it is asked on the way, all is as
// it was.
void CoupledContacts::solve_by_tangents(const Sweeping& on, Outcome& outcome) {
  if (contact_count(on.group) * dimension_ > most_unknowns) return;
  const Dofs v = on.v;
  const std::vector<Vector> asked = asked_velocities(on.group);
  Outcome found = outcome;
  try {
    for (int k = 0; k < most_tangents; ++k) {
      if (!try_from(on, newton_impulses(on.group, on.group.front().interface->inverse_mass(), on.step, on.v),
                    found))
        break;
      sweep(on, found);
      if (found.residual > tolerance) continue;
      outcome = found;
      return;
    }
  } catch (const ilaw::error&) {  // in what follows it answers as before
  }
  on.v = v;
  answer_at(on.group, asked, on.step);
  outcome.sweeps = found.sweeps;
}

// Impulses that were large on the way and cancelled each other have left their rounding in v, which all laws
// may agree on: it is put together anew from where they ended, and swept on. Not where they still are large.
void CoupledContacts::round_anew(const Sweeping& on, Outcome& outcome) {
  constexpr double much = tolerance / std::numeric_limits<double>::epsilon();
  const auto has_rounded = [&] {
    const double size = residual(on.group, on.speed, on.v).size;
    return outcome.largest > much * size && !(size > run_away * out_of_reach_ / most_growth);
  };
  while (!(outcome.residual > tolerance) && outcome.sweeps < most_sweeps && has_rounded()) {
    outcome.largest = 0.0;
    if (!try_from(on, scaled_impulses(on.group), outcome)) return;
    do sweep(on, outcome);
    while (outcome.residual > tolerance && outcome.sweeps < most_sweeps);
  }
}

bool CoupledContacts::try_from(const Sweeping& on, const Dofs& scaled, Outcome& outcome) {
  const double largest = largest_made(on.group, scaled);
  if (!(scaled.allFinite() && largest <= out_of_reach_)) return false;
  move_to(on.group, scaled, on.v);
  outcome.largest = std::max(outcome.largest, largest);
  return true;
}

// Along the way that a sweep takes, to where the next one would go back. Sweeps of dissipative laws
// do not move apart, so that the part left along it only falls: it is bracketed by ever longer
// steps, then found by the Illinois method (Dowell and Jarratt 1971). This ends where the
// acceleration runs in circles: it knows no kinks, and mass ratios of 1e5 make the way from one to
// the next long.
void CoupledContacts::search(const Sweeping& on, Outcome& outcome) {
  constexpr double longer = 8.0, near = 1e-3;
  const Dofs start = scaled_impulses(on.group);
  sweep(on, outcome);
  const Dofs image = scaled_impulses(on.group), way = image - start;
  const auto is_over = [&] { return !(outcome.residual > tolerance && outcome.sweeps < most_sweeps); };
  double left = 1.0;  // of a sweep from start + t way, along the way
  const auto sweep_from = [&](double t) {
    const Dofs from = start + t * way;
    if (!try_from(on, from, outcome)) return false;
    sweep(on, outcome);
    left = (scaled_impulses(on.group) - from).dot(way) / way.squaredNorm();
    return true;
  };
  double low = 0.0, left_low = 1.0, high = longer;
  for (; !is_over(); high *= longer) {
    if (!sweep_from(high)) return void(try_from(on, image, outcome));
    if (!(left > 0.0)) break;
    low = high;
    left_low = left;
  }
  int kept_low = 0;  // in a row; negative: the higher end
  for (double left_high = left; !is_over();) {
    const double t = (low * left_high - high * left_low) / (left_high - left_low);
    if (!(t > low && t < high) || !sweep_from(t) || std::abs(left) < near) break;
    if (left > 0.0) {
      low = t;
      left_low = left;
      kept_low = std::min(kept_low, 0) - 1;
      if (kept_low < -1) left_high *= 0.5;
    } else {
      high = t;
      left_high = left;
      kept_low = std::max(kept_low, 0) + 1;
      if (kept_low > 1) left_low *= 0.5;
    }
  }
}

// What a law makes of v, for contacts that share no node.
void CoupledContacts::answer(Interface& interface, const ContactList& contacts, const StepView& step,
                             Dofs& v) {
  interface.gather(contacts, v, step);
  interface.evaluate(contacts, step);
  interface.apply(contacts, v);
}

// Every impulse is what its law answered to some velocity of its contact: how far the contact is
// from that velocity.
Vector CoupledContacts::since_answer(const Interface& interface, std::int32_t contact, const Dofs& v) {
  return interface.relative(contact, v) - interface.surface_velocity(contact) -
         interface.velocity_of(contact, interface.impulse(contact)) - interface.v_free(contact);
}

// That, beside the largest velocity there is, or that an impulse makes. Zero where all laws hold. Of
// contacts that may act: what the idle ones were evaluated with must not matter.
CoupledContacts::Residual CoupledContacts::residual(const ContactGroup& group, double speed, const Dofs& v) {
  Residual found{0.0, speed};
  for_each_contact(group, [&](const Interface& interface, int contact, Eigen::Index /*k*/) {
    const double own = interface.velocity_of(contact, interface.impulse(contact)).cwiseAbs().maxCoeff();
    found.change = std::max(found.change, since_answer(interface, contact, v).cwiseAbs().maxCoeff());
    found.size = std::max(found.size, own);
  });
  return found;
}

// The work of an impulse r is r.(v^- + v)/2: at a contact that is off by s from the velocity w that
// its law answered to, it is what the law accounts for plus r.s/2.
CoupledContacts::Disagreement CoupledContacts::disagreement(const Dofs& v) const {
  Disagreement all{};
  double worst = 0.0;
  for_each_contact(acting_, [&](const Interface& interface, int contact, Eigen::Index /*k*/) {
    const Vector off = since_answer(interface, contact, v);
    double work = 0.0, square = 0.0;
    for (Eigen::Index c = 0; c < off.size(); ++c) {
      work += interface.impulse(contact)[c] * off[c];
      square += off[c] * off[c];
    }
    const double energy = 0.5 * std::abs(work);
    all.energy += energy;
    if (!(energy > worst)) return;
    worst = energy;
    all.interface = &interface;
    all.node = interface.node_of(contact);
    all.velocity = std::sqrt(square);
  });
  return all;
}

// Where laws contradict each other they push each other up, to far more than any mass ratio asks
// for; or they go on until one of them breaks, and begin anew. A long column, which more sweeps
// would solve, does neither: it is told by its length.
std::string CoupledContacts::explain(const Dofs& v, const Outcome& outcome) const {
  constexpr double beyond_rounding = 1e-6;
  const double speed = out_of_reach_ / most_growth;  // of the first sweep
  const Disagreement found = disagreement(v);
  if (!found.interface) return "";
  const ContactGroup island = island_at(found.node);
  const Eigen::Index count = contact_count(island);
  const double ratio = mass_ratio_of(island, model_);
  const bool ran_away = residual(island, 0.0, v).size > run_away * ratio * speed;
  const bool is_stuck = found.velocity > beyond_rounding * speed && count <= few;
  if (!ran_away && !is_stuck) return "";
  std::array<char, 512> text{};
  std::snprintf(
      text.data(), text.size(),
      "contacts that share node %d find no velocity that suits them all: after %d sweeps '%s' (law '%s') "
      "is off by %.3g, which is worth the energy %.3g. %s: %td contacts hang together, with masses of 1:%.2g",
      found.node, outcome.sweeps, found.interface->name().c_str(), found.interface->setup().law.c_str(),
      found.velocity, found.energy,
      ran_away ? "Two laws there contradict each other"
               : "Laws there contradict each other, or are not solved",
      count, ratio);
  return text.data();
}

ContactGroup CoupledContacts::island_at(int node) const {
  for (ContactGroup& island : islands_of(acting_)) {
    bool has_node = false;
    for_each_contact(island, [&](const Interface& interface, int contact, Eigen::Index /*k*/) {
      has_node = has_node || interface.node_of(contact) == node;
    });
    if (has_node) return std::move(island);
  }
  return {};
}

// The largest velocity that one of them makes.
double CoupledContacts::largest_made(const ContactGroup& group, const Dofs& scaled) const {
  double largest = 0.0;
  for_each_contact(group, [&](const Interface& interface, int contact, Eigen::Index k) {
    const double most = scaled.segment(k * dimension_, dimension_).cwiseAbs().maxCoeff();
    largest = std::max(largest, std::sqrt(interface.delassus(contact)) * most);
  });
  return largest;
}

// From v_free anew: what large impulses would leave of each other is rounding.
void CoupledContacts::move_to(const ContactGroup& group, const Dofs& scaled, Dofs& v) const {
  const Eigen::Index d = dimension_;
  for_each_contact(group, [&](Interface& interface, int contact, Eigen::Index k) {
    interface.point(contact).for_each_node(interface.node_of(contact), [&](int node, double) {
      v.segment(node * d, d) = v_free_.segment(node * d, d);
    });
    interface.start_from(contact, scaled.segment(k * d, d) / std::sqrt(interface.delassus(contact)));
  });
  for (const auto& [interface, contacts] : group) interface->apply(contacts, v);
}

}  // namespace ilaw::host
