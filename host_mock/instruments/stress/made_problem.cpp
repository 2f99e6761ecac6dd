// SPDX-License-Identifier: BSD-3-Clause
#include "stress/made_problem.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace ilaw::host {
namespace {

// H of an axis along which nothing moves, relative to the largest (docs/hosts/coupled.md).
constexpr double held_delassus = 0x1p-24;

// From a velocity and a spin to those at the end of an arm.
Eigen::Matrix<double, 6, 6> at_end_of(const Eigen::Vector3d& arm) {
  Eigen::Matrix<double, 6, 6> made = Eigen::Matrix<double, 6, 6>::Identity();
  made.topRightCorner<3, 3>() << 0.0, arm[2], -arm[1], -arm[2], 0.0, arm[0], arm[1], -arm[0], 0.0;
  return made;
}

}  // namespace

// ---- velocities and impulses at contacts ----

template <class Visit>
void MadeProblem::for_bodies(const Contact& contact, Visit visit) const {
  const auto visit_side = [&](const std::vector<std::int32_t>& bodies, const std::vector<double>& weights,
                              const Matrix& at) {
    std::map<std::int32_t, Matrix> parts;  // a side may name a body twice
    for (std::size_t e = 0; e < bodies.size(); ++e) {
      if (bodies[e] < 0) continue;
      Matrix weight = Matrix::Identity();
      if (setup_.has_axes)
        weight.topLeftCorner<3, 3>() =
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&weights[9 * e]);
      else if (!weights.empty())
        weight *= weights[e];
      parts.try_emplace(bodies[e], Matrix::Zero()).first->second += weight * at;
    }
    for (const auto& [body, part] : parts) visit(static_cast<std::size_t>(body), part);
  };
  visit_side(contact.body, contact.weight, at_end_of(contact.arm));
  visit_side(contact.counterpart, contact.other_weight, Matrix(-at_end_of(contact.other_arm)));
}

MadeProblem::Wrench MadeProblem::relative(const Contact& contact, Wrench Body::*motion) const {
  Wrench sum = Wrench::Zero();
  for_bodies(contact, [&](std::size_t b, const Matrix& at) { sum += at * bodies_[b].*motion; });
  return sum;
}

std::vector<MadeProblem::Wrench> MadeProblem::sums_of(Wrench Contact::*impulse) const {
  std::vector<Wrench> sums(bodies_.size(), Wrench::Zero());
  for (const Contact& contact : contacts_)
    for_bodies(contact,
               [&](std::size_t b, const Matrix& at) { sums[b] += at.transpose() * contact.*impulse; });
  return sums;
}

// B M^-1 B' of a contact alone.
MadeProblem::Matrix MadeProblem::delassus(const Contact& contact) const {
  Matrix all = Matrix::Zero(), h = all;
  for_bodies(contact, [&](std::size_t b, const Matrix& at) {
    all += at * bodies_[b].inverse.asDiagonal() * at.transpose();
  });
  h.topLeftCorner(width(), width()) = all.topLeftCorner(width(), width());
  if (form_ == ILAW_DELASSUS_FULL)
    for (Eigen::Index c = 0; c < 3; ++c)
      if (!(h(c, c) > 0.0)) h(c, c) = held_delassus * all.diagonal().head<3>().maxCoeff();
  return h;
}

// ---- drawing ----

MadeProblem::MadeProblem(const std::vector<const interface*>& laws, ilaw_delassus_form form,
                         const MadeSetup& setup, Draw& draw)
    : form_(form), setup_(setup), laws_(laws) {
  draw_bodies(draw);
  std::vector<Wrench> v_free;
  for (int k = 0; k < setup_.contacts; ++k) {
    Contact contact;
    contact.law = static_cast<std::size_t>(k) % laws_.size();
    draw_contact(draw, contact);
    v_free.push_back(draw_velocity(draw, contact));
    contacts_.push_back(contact);
  }
  make(v_free);
  for (Contact& contact : contacts_)
    if (setup_.rounds_gaps && contact.gap == 0.0) contact.gap = 1e-15 * setup_.speed * setup_.step;
  sort_by_law();
}

MadeProblem::Wrench MadeProblem::random(Draw& draw, int count) const {
  Wrench made = Wrench::Zero();
  for (double& component : made.head(count)) component = draw.uniform(-setup_.speed, setup_.speed);
  return made;
}

void MadeProblem::draw_bodies(Draw& draw) {
  bodies_.resize(static_cast<std::size_t>(setup_.bodies));
  for (Body& body : bodies_) {
    const bool in_turn = setup_.normals == MadeSetup::Normals::pressed,
               is_first = (&body - bodies_.data()) % 2 == 0;
    const double inverse = std::pow(
        10.0, -(in_turn ? is_first ? 0.0 : setup_.mass_decades : draw.uniform(0.0, setup_.mass_decades)));
    body.inverse.head<3>().setConstant(inverse);
    if (setup_.no_freedom > 0.0)
      for (double& axis : body.inverse.head<3>())
        if (draw.chance(setup_.no_freedom)) axis = 0.0;
    if (body.inverse.isZero(0.0)) body.inverse[2] = inverse;
    if (rotates()) body.inverse.tail<3>().setConstant(2.5 * inverse);
    if (setup_.rotate)
      for (double& axis : body.inverse.tail<3>()) axis *= draw.uniform(0.5, 2.0);
    body.solution = random(draw, rotates() ? 6 : 3);
    body.before = random(draw, rotates() ? 6 : 3);
  }
}

// Wedged: all at the first bodies, their normals in one plane, so that they press against each other.
// Redundant: several contacts of the same pair of bodies with the same normal. Pressed: a light body between
// a heavy one and another one or a wall, by impulses up to what stops the heavy one, which nearly cancel.
void MadeProblem::draw_contact(Draw& draw, Contact& contact) {
  const int last = setup_.bodies - 1;
  contact.body = {draw.whole(0, last)};
  contact.counterpart = {draw.chance(0.5) ? -1 : draw.whole(0, last)};
  if (contact.counterpart == contact.body) contact.counterpart = {-1};
  draw_facets(draw, contact);
  contact.normal = Vector(draw.direction(3).data());
  if (setup_.normals == MadeSetup::Normals::wedged) {
    const double angle = draw.uniform(0.0, 0.5), side = contacts_.size() % 2 ? 1.0 : -1.0;
    contact.normal = {side * std::cos(angle), 0.0, std::sin(angle)};
  }
  if (setup_.normals == MadeSetup::Normals::redundant && !contacts_.empty() && draw.chance(0.7)) {
    const Contact& twin = contacts_[static_cast<std::size_t>(draw.whole(0, contact_count() - 1))];
    contact.body = twin.body;
    contact.counterpart = twin.counterpart;
    contact.weight = twin.weight;
    contact.other_weight = twin.other_weight;
    contact.normal = twin.normal;
  }
  if (setup_.normals == MadeSetup::Normals::pressed) {
    const bool is_second = contacts_.size() % 2 == 1;
    contact.body = {is_second ? contacts_.back().body[0] : draw.whole(0, last / 2) * 2};
    contact.counterpart = {is_second && draw.chance(0.3) ? -1
                                                         : std::min(draw.whole(0, last / 2) * 2 + 1, last)};
    if (is_second) contact.normal = -contacts_.back().normal;
    contact.pressure = is_second ? contacts_.back().pressure
                                 : setup_.speed * std::pow(10.0, draw.uniform(0.0, setup_.mass_decades));
  }
  constexpr double radius = 0.5, other_radius = 0.3;
  if (setup_.rotate) {
    for (Vector* arm : {&contact.arm, &contact.other_arm})
      for (double& component : *arm) component = draw.uniform(-1.0, 1.0);
  } else if (rotates()) {
    contact.arm = -radius * contact.normal;
    contact.other_arm = other_radius * contact.normal;
  }
  contact.gap = setup_.gap * setup_.speed * setup_.step * draw.uniform(0.0, 1.0);
}

// More bodies for both sides, some of them named twice.
void MadeProblem::draw_facets(Draw& draw, Contact& contact) const {
  if (setup_.ends == 1) return;
  const auto has = [](const std::vector<std::int32_t>& side, std::int32_t body) {
    return std::find(side.begin(), side.end(), body) != side.end();
  };
  for (auto [side, other] :
       {std::pair{&contact.body, &contact.counterpart}, {&contact.counterpart, &contact.body}})
    for (int e = 1; e < setup_.ends; ++e) {
      const std::int32_t body = draw.whole(-1, setup_.bodies - 1);
      side->push_back(has(*other, body) ? -1 : body);
    }
  for (std::vector<double>* weights : {&contact.weight, &contact.other_weight})
    for (int e = 0; e < setup_.ends; ++e)
      for (int c = 0; c < (setup_.has_axes ? 9 : 1); ++c)
        weights->push_back(setup_.has_axes ? (c % 4 == 0) + draw.uniform(-0.5, 0.5) : draw.uniform(0.1, 1.0));
}

// The free velocity of a contact, which approaches or leaves; its velocity before the step approaches.
MadeProblem::Wrench MadeProblem::draw_velocity(Draw& draw, Contact& contact) {
  const auto turn = [&](Wrench& v, double sign) {
    const double now = v.head<3>().dot(contact.normal);
    v.head<3>() += (sign * std::fabs(now) - now) * contact.normal;
  };
  Wrench v = random(draw, width()), v_before = random(draw, width());
  turn(v_before, -1.0);
  turn(v, contact.pressure == 0.0 && draw.chance(setup_.open) ? 1.0 : -1.0);
  v.head<3>() -= contact.pressure * contact.normal;
  contact.wall_before = relative(contact, &Body::before) - v_before;
  contact.wall = relative(contact, &Body::free) - v;  // v_smooth is v_free
  contact.state = first_state(contact);
  if (!is_well_posed(contact, v)) {
    turn(v, 1.0);
    contact.wall = relative(contact, &Body::free) - v;
  }
  return v;
}

// Where nothing gives way to the impulse that a law needs, there is no solution; and one that rounding of its
// velocity changes is no measure.
bool MadeProblem::is_well_posed(const Contact& contact, const Wrench& v) const {
  constexpr double most_growth = 1e4, nudge = 1e-12, most_change = 1e-10;
  const Matrix h = delassus(contact);
  const Wrench needed = answer(contact, v);
  Wrench other = v;
  for (Eigen::Index c = 0; c < 6; ++c) other[c] += (c % 2 ? nudge : -nudge) * setup_.speed;
  const Wrench changed = h * (answer(contact, other) - needed);
  const double give = h.diagonal().head<3>().maxCoeff();
  return (give * needed.head<3>().array().abs() < most_growth * setup_.speed).all() &&
         (changed.head<3>().array().abs() < most_change * setup_.speed).all();
}

// A law's free velocity v is drawn, its impulse r is the law's, so that the contact moves by u = v + H r: the
// wall has the difference to the velocities of the bodies, and these have the impulses added to their free
// velocities. Laws that read v_smooth see u less all impulses, which is known when all are: made again, until
// impulses stay.
void MadeProblem::make(const std::vector<Wrench>& v_free) {
  bool reads_any_smooth = false;
  for (std::size_t law = 0; law < laws_.size(); ++law) reads_any_smooth |= reads_smooth(law);
  for (int times = 0; times < (reads_any_smooth ? 20 : 1); ++times) {
    for (std::size_t k = 0; k < contacts_.size(); ++k) contacts_[k].made = answer(contacts_[k], v_free[k]);
    const std::vector<Wrench> sums = sums_of(&Contact::made);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      bodies_[b].free = bodies_[b].solution - bodies_[b].inverse.cwiseProduct(sums[b]);
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      Contact& contact = contacts_[k];
      contact.wall = relative(contact, &Body::solution) - (v_free[k] + delassus(contact) * contact.made);
      if (width() == 3) contact.wall.tail<3>().setZero();
    }
  }
}

void MadeProblem::add(const MadeProblem& other) {
  const auto first = static_cast<std::int32_t>(bodies_.size());
  bodies_.insert(bodies_.end(), other.bodies_.begin(), other.bodies_.end());
  for (Contact contact : other.contacts_) {
    for (std::vector<std::int32_t>* side : {&contact.body, &contact.counterpart})
      for (std::int32_t& body : *side)
        if (body >= 0) body += first;
    contacts_.push_back(contact);
  }
  sort_by_law();
}

// The solver is given a group of each law.
void MadeProblem::sort_by_law() {
  std::stable_sort(contacts_.begin(), contacts_.end(),
                   [](const Contact& a, const Contact& b) { return a.law < b.law; });
}

std::vector<double> MadeProblem::velocities() const {
  std::vector<double> all;
  for (const Body& body : bodies_) all.insert(all.end(), body.velocity.begin(), body.velocity.end());
  return all;
}

}  // namespace ilaw::host
