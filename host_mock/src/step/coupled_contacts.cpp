// SPDX-License-Identifier: BSD-3-Clause
#include "step/coupled_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {

bool share_nodes(const Model& model, const Interfaces& interfaces) {
  std::vector<bool> seen(static_cast<std::size_t>(model.node_count()));
  for (const auto& interface : interfaces) {
    if (interface->setup().counterpart->shares_partners()) return true;
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
    : interfaces_(interfaces), colours_(interfaces.size(), Colours(model.node_count())) {
  for (const auto& interface : interfaces_) interface->evaluate_repeatedly();
}

// Which contacts may act follows from a bound on speeds. Where impulses of other contacts make a
// node faster, the step is solved again with a larger one: whether that happens does not depend on
// which are active.
CoupledContacts::Outcome CoupledContacts::solve(StepView step, Dofs& v) {
  const double speed = std::max(step.speed_before, step.speed_after);
  const Dofs v_free = v;
  Outcome outcome{};
  step.speed_after = 2.0 * speed;
  for (bool bounded = false; !bounded;) {
    open(step);
    v = v_free;
    const double fastest = iterate(step, speed, v, outcome);
    bounded = !(fastest > step.speed_after);
    step.speed_after = 2.0 * fastest;
  }
  for (const auto& interface : interfaces_) interface->accept(step, v);
  return outcome;
}

void CoupledContacts::open(const StepView& step) {
  for (std::size_t i = 0; i < interfaces_.size(); ++i) {
    interfaces_[i]->open_step(step);
    colours_[i].assign(*interfaces_[i]);
  }
}

// Sweeps to the tolerance. Returns the largest speed of a node that was moved, here as below.
double CoupledContacts::iterate(const StepView& step, double speed, Dofs& v, Outcome& outcome) {
  double fastest = 0.0;
  Anderson anderson;
  std::vector<double> impulses_before;
  outcome = {0, 1.0};
  for (; outcome.residual > tolerance && outcome.sweeps < most_sweeps; ++outcome.sweeps) {
    if (outcome.sweeps == patience) impulses_before = scaled_impulses();
    if (outcome.sweeps > patience && outcome.sweeps % 2 == 0)
      fastest = std::max(fastest, accelerate(anderson, impulses_before, v));
    fastest = std::max(fastest, sweep(step, v));
    outcome.residual = residual(speed, v);
  }
  return fastest;
}

// Evaluates every contact once, each against the impulses of the others.
double CoupledContacts::sweep(const StepView& step, Dofs& v) {
  double fastest = 0.0;
  for (std::size_t i = 0; i < interfaces_.size(); ++i) {
    const auto solve = [&](const ContactList& contacts) {
      interfaces_[i]->gather(contacts, v, step);
      interfaces_[i]->evaluate(contacts, step);
      fastest = std::max(fastest, interfaces_[i]->apply(contacts, v));
    };
    colours_[i].for_each_acting(solve);
    solve(colours_[i].idle());
  }
  return fastest;
}

// Calls visit(interface, contacts) with what may be solved at once, in a fixed order.
template <class Visit>
void CoupledContacts::for_each_acting(Visit visit) const {
  for (std::size_t i = 0; i < interfaces_.size(); ++i)
    colours_[i].for_each_acting([&](const ContactList& contacts) { visit(*interfaces_[i], contacts); });
}

// Every impulse is what its law answered to some velocity of its contact: how far the contact is
// from that velocity, relative to the largest velocity there is, or that an impulse makes. Zero
// where all laws hold. Of contacts that may act: what the idle ones were evaluated with must not
// matter.
double CoupledContacts::residual(double speed, const Dofs& v) const {
  double change = 0.0, size = speed;
  for_each_acting([&](const Interface& interface, const ContactList& contacts) {
    for (const std::int32_t contact : contacts) {
      const Vector own = interface.delassus(contact) * interface.impulse(contact);
      const Vector since =
          interface.relative(contact, v) - interface.obstacle_velocity() - own - interface.v_free(contact);
      change = std::max(change, since.cwiseAbs().maxCoeff());
      size = std::max(size, own.cwiseAbs().maxCoeff());
    }
  });
  return size > 0.0 ? change / size : 0.0;
}

// Times the root of their delassus: a norm in energy.
std::vector<double> CoupledContacts::scaled_impulses() const {
  std::vector<double> scaled;
  for_each_acting([&](const Interface& interface, const ContactList& contacts) {
    for (const std::int32_t contact : contacts)
      for (const double component : interface.impulse(contact))
        scaled.push_back(std::sqrt(interface.delassus(contact)) * component);
  });
  return scaled;
}

// Two sweeps took impulses_before to those there are, which are taken further.
double CoupledContacts::accelerate(Anderson& anderson, std::vector<double>& impulses_before, Dofs& v) {
  const std::vector<double> now = scaled_impulses();
  const auto count = static_cast<Eigen::Index>(now.size());
  const Eigen::Map<const Dofs> image(now.data(), count), before(impulses_before.data(), count);
  const Dofs correction = anderson.correction(image, image - before);
  Eigen::Index next = 0;
  double fastest = 0.0;
  for_each_acting([&](Interface& interface, const ContactList& contacts) {
    for (const std::int32_t contact : contacts) {
      const Eigen::Index d = interface.impulse(contact).size();
      interface.change_impulse(contact, correction.segment(next, d) / std::sqrt(interface.delassus(contact)));
      next += d;
    }
    fastest = std::max(fastest, interface.apply(contacts, v));
  });
  impulses_before = scaled_impulses();
  return fastest;
}

}  // namespace ilaw::host
