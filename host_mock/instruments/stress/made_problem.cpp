// SPDX-License-Identifier: BSD-3-Clause
#include "stress/made_problem.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ilaw::host {
namespace {

using Vector = std::array<double, 3>;
using Wrench = std::array<double, 6>;

// H of an axis along which nothing moves, relative to the largest (docs/hosts/coupled.md).
constexpr double held_delassus = 0x1p-24;

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector front(const Wrench& w) { return {w[0], w[1], w[2]}; }
Vector back(const Wrench& w) { return {w[3], w[4], w[5]}; }
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Wrench operator+(const Wrench& a, const Wrench& b) {
  Wrench sum;
  for (std::size_t c = 0; c < 6; ++c) sum[c] = a[c] + b[c];
  return sum;
}
Wrench operator-(const Wrench& a, const Wrench& b) {
  Wrench difference;
  for (std::size_t c = 0; c < 6; ++c) difference[c] = a[c] - b[c];
  return difference;
}
Wrench operator*(const std::array<Wrench, 6>& m, const Wrench& x) {
  Wrench product{};
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t c = 0; c < 6; ++c) product[row] += m[row][c] * x[c];
  return product;
}
Wrench scaled(const Wrench& a, const Wrench& by) {
  Wrench product;
  for (std::size_t c = 0; c < 6; ++c) product[c] = a[c] * by[c];
  return product;
}
Vector unit(Draw& draw) {
  const std::vector<double> n = draw.direction(3);
  return {n[0], n[1], n[2]};
}
Wrench random(Draw& draw, double size, int width) {
  Wrench made{};
  for (std::size_t c = 0; c < static_cast<std::size_t>(width); ++c) made[c] = draw.uniform(-size, size);
  return made;
}

}  // namespace

MadeProblem::MadeProblem(const std::vector<const interface*>& laws, ilaw_delassus_form form,
                         const MadeSetup& setup, Draw& draw)
    : form_(form), setup_(setup), laws_(laws) {
  draw_bodies(draw);
  make(draw);
}

void MadeProblem::draw_bodies(Draw& draw) {
  bodies_.resize(static_cast<std::size_t>(setup_.bodies));
  const int width = rotates() ? 6 : 3;
  for (Body& body : bodies_) {
    const double inverse = std::pow(10.0, -draw.uniform(0.0, setup_.mass_decades));
    body.inverse = {inverse, inverse, inverse, 0.0, 0.0, 0.0};
    if (setup_.no_freedom > 0.0)
      for (std::size_t c = 0; c < 3; ++c)
        if (draw.chance(setup_.no_freedom)) body.inverse[c] = 0.0;
    if (body.inverse[0] + body.inverse[1] + body.inverse[2] == 0.0) body.inverse[2] = inverse;
    for (std::size_t c = 3; c < static_cast<std::size_t>(width); ++c) body.inverse[c] = 2.5 * inverse;
    if (setup_.rotate)
      for (std::size_t c = 3; c < 6; ++c) body.inverse[c] *= draw.uniform(0.5, 2.0);
    body.solution = random(draw, setup_.speed, width);
    body.before = random(draw, setup_.speed, width);
  }
}

// Wedged: all at the first bodies, their normals in one plane, so that they press against each other.
// Redundant: several contacts of the same pair of bodies with the same normal.
void MadeProblem::draw_contact(Draw& draw, Contact& contact) {
  const int last = setup_.bodies - 1;
  contact.body = draw.whole(0, last);
  contact.counterpart = draw.chance(0.5) ? -1 : draw.whole(0, last);
  if (contact.counterpart == contact.body) contact.counterpart = -1;
  contact.normal = unit(draw);
  if (setup_.normals == MadeSetup::Normals::wedged) {
    const double angle = draw.uniform(0.0, 0.5), side = contacts_.size() % 2 ? 1.0 : -1.0;
    contact.normal = {side * std::cos(angle), 0.0, std::sin(angle)};
  }
  if (setup_.normals == MadeSetup::Normals::redundant && !contacts_.empty() && draw.chance(0.7)) {
    const Contact& twin = contacts_[static_cast<std::size_t>(draw.whole(0, contact_count() - 1))];
    contact.body = twin.body;
    contact.counterpart = twin.counterpart;
    contact.normal = twin.normal;
  }
  const double radius = 0.5;
  if (setup_.rotate) {
    for (std::size_t c = 0; c < 3; ++c) contact.arm[c] = draw.uniform(-1.0, 1.0);
    for (std::size_t c = 0; c < 3; ++c) contact.other_arm[c] = draw.uniform(-1.0, 1.0);
  } else if (rotates()) {
    for (std::size_t c = 0; c < 3; ++c) contact.arm[c] = -radius * contact.normal[c];
    for (std::size_t c = 0; c < 3; ++c) contact.other_arm[c] = radius * contact.normal[c];
  }
  contact.gap = setup_.gap * setup_.speed * setup_.step * draw.uniform(0.0, 1.0);
}

// Where nothing gives way to the impulse that a law needs, there is no solution; and one that rounding of its
// velocity changes is no measure.
bool MadeProblem::is_well_posed(const Contact& contact, const Wrench& v) const {
  constexpr double most_growth = 1e4, nudge = 1e-12, most_change = 1e-10;
  const Matrix h = delassus(contact);
  const Wrench needed = answer(contact, v);
  Wrench other = v;
  for (std::size_t c = 0; c < 6; ++c) other[c] += (c % 2 ? nudge : -nudge) * setup_.speed;
  const Wrench changed = h * (answer(contact, other) - needed);
  const double give = std::max({h[0][0], h[1][1], h[2][2]});
  for (std::size_t c = 0; c < 3; ++c)
    if (!(give * std::fabs(needed[c]) < most_growth * setup_.speed) ||
        !(std::fabs(changed[c]) < most_change * setup_.speed))
      return false;
  return true;
}

// A law's free velocity v is drawn, its impulse r is the law's, so that the contact moves by u = v + H r: the
// wall has the difference to the velocities of the bodies, and these have the impulses added to their free
// velocities. Laws that read v_smooth see u less all impulses, which is known when all are: made again, until
// impulses stay.
void MadeProblem::make(Draw& draw) {
  std::vector<Wrench> v_free;
  for (int k = 0; k < setup_.contacts; ++k) {
    Contact contact;
    contact.law = static_cast<std::size_t>(k) % laws_.size();
    draw_contact(draw, contact);
    contacts_.push_back(contact);
    Contact& made = contacts_.back();
    Wrench v = random(draw, setup_.speed, width());
    Wrench before = random(draw, setup_.speed, width());
    const double approach = dot(front(before), made.normal);
    const double push = -std::fabs(approach) - approach;  // towards each other
    for (std::size_t c = 0; c < 3; ++c) before[c] += push * made.normal[c];
    const auto turn = [&](double sign) {  // to approach, or to leave
      const double now = dot(front(v), made.normal), change = sign * std::fabs(now) - now;
      for (std::size_t c = 0; c < 3; ++c) v[c] += change * made.normal[c];
    };
    turn(draw.chance(setup_.open) ? 1.0 : -1.0);
    made.wall_before = relative(made, &Body::before) - before;
    made.state.assign(laws_[made.law]->info().state_size, 0.0);
    ilaw_batch batch{};
    batch.struct_size = sizeof batch;
    batch.node_count = 1;
    batch.velocity_step = batch.position_step = setup_.step;
    const double area = 1.0;
    batch.gap = ilaw::input(&made.gap, 1, 0);
    batch.area = ilaw::input(&area, 1, 0);
    batch.normal = ilaw::input(made.normal.data(), 3, 1);
    batch.state_out = ilaw::output(made.state.data(), 1, 1);
    laws_[made.law]->initialise(batch);
    made.wall = relative(made, &Body::free) - v;
    if (!is_well_posed(made, v)) turn(1.0);
    v_free.push_back(v);
  }
  const bool reads_smooth = std::any_of(laws_.begin(), laws_.end(), [](const interface* law) {
    return (law->info().inputs & ILAW_INPUT_V_SMOOTH) != 0;
  });
  for (int times = 0; times < (reads_smooth ? 20 : 1); ++times) {
    std::vector<Wrench> sums(bodies_.size(), Wrench{});
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      Contact& contact = contacts_[k];
      if (times == 0) contact.wall = relative(contact, &Body::free) - v_free[k];  // v_smooth is v_free
      contact.made = answer(contact, v_free[k]);
    }
    for (const Contact& contact : contacts_) add_impulse(contact, contact.made, sums);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      bodies_[b].free = bodies_[b].solution - scaled(bodies_[b].inverse, sums[b]);
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      Contact& contact = contacts_[k];
      const Wrench u = v_free[k] + delassus(contact) * contact.made;
      contact.wall = relative(contact, &Body::solution) - u;
      if (width() == 3) contact.wall[3] = contact.wall[4] = contact.wall[5] = 0.0;
    }
  }
}

void MadeProblem::add(const MadeProblem& other) {
  const auto first = static_cast<std::int32_t>(bodies_.size());
  bodies_.insert(bodies_.end(), other.bodies_.begin(), other.bodies_.end());
  for (Contact contact : other.contacts_) {
    contact.body += first;
    if (contact.counterpart >= 0) contact.counterpart += first;
    contacts_.push_back(contact);
  }
}

Wrench MadeProblem::relative(const Contact& contact, Wrench Body::*motion) const {
  const auto at = [&](std::int32_t b, const Vector& arm) {
    if (b < 0) return Wrench{};
    Wrench m = bodies_[static_cast<std::size_t>(b)].*motion;
    const Vector by_spin = cross(back(m), arm);
    for (std::size_t c = 0; c < 3; ++c) m[c] += by_spin[c];
    return m;
  };
  return at(contact.body, contact.arm) - at(contact.counterpart, contact.other_arm);
}

void MadeProblem::add_impulse(const Contact& contact, const Wrench& impulse,
                              std::vector<Wrench>& sums) const {
  const auto add = [&](std::int32_t b, const Vector& arm, double sign) {
    if (b < 0) return;
    Wrench& sum = sums[static_cast<std::size_t>(b)];
    const Vector moment = cross(arm, front(impulse));
    for (std::size_t c = 0; c < 3; ++c) {
      sum[c] += sign * impulse[c];
      sum[3 + c] += sign * (moment[c] + impulse[3 + c]);
    }
  };
  add(contact.body, contact.arm, 1.0);
  add(contact.counterpart, contact.other_arm, -1.0);
}

// B M^-1 B' of a contact alone, by unit impulses.
MadeProblem::Matrix MadeProblem::delassus(const Contact& contact) const {
  Matrix h{};
  for (std::size_t c = 0; c < static_cast<std::size_t>(width()); ++c) {
    Wrench unit_impulse{};
    unit_impulse[c] = 1.0;
    const auto by = [&](std::int32_t b, const Vector& arm) {
      if (b < 0) return Wrench{};
      const Vector moment = cross(arm, front(unit_impulse)), own = back(unit_impulse);
      const Wrench load{unit_impulse[0],    unit_impulse[1],    unit_impulse[2],
                        moment[0] + own[0], moment[1] + own[1], moment[2] + own[2]};
      Wrench m = scaled(bodies_[static_cast<std::size_t>(b)].inverse, load);
      const Vector by_spin = cross(back(m), arm);
      for (std::size_t i = 0; i < 3; ++i) m[i] += by_spin[i];
      return m;
    };
    const Wrench column = by(contact.body, contact.arm) + by(contact.counterpart, contact.other_arm);
    for (std::size_t row = 0; row < static_cast<std::size_t>(width()); ++row) h[row][c] = column[row];
  }
  if (form_ == ILAW_DELASSUS_FULL) {
    const double most = std::max({h[0][0], h[1][1], h[2][2]});
    for (std::size_t c = 0; c < 3; ++c) h[c][c] = h[c][c] > 0.0 ? h[c][c] : held_delassus * most;
  }
  return h;
}

// Velocity of a contact without the impulse of any.
Wrench MadeProblem::smooth(const Contact& contact) const {
  return relative(contact, &Body::free) - contact.wall;
}

Wrench MadeProblem::answer(const Contact& contact, const Wrench& v_free) const {
  const Matrix h = delassus(contact);
  const Vector& n = contact.normal;
  double along = 0.0;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t c = 0; c < 3; ++c) along += n[row] * h[row][c] * n[c];
  const double across = 0.5 * (h[0][0] + h[1][1] + h[2][2] - along);
  Wrench form{h[0][0], h[1][1], h[2][2], h[0][1], h[0][2], h[1][2]};
  if (form_ == ILAW_DELASSUS_SCALAR) form = {h[0][0]};
  if (form_ == ILAW_DELASSUS_TRANSVERSE) form = {along, across};
  if (form_ == ILAW_DELASSUS_TRANSVERSE_SPIN) {
    // A moment m moves the contact by k n x m: read k from H.
    const Wrench by = h * Wrench{0.0, 0.0, 0.0, n[1], n[2], n[0]};
    const Vector turned = cross(n, {n[1], n[2], n[0]});
    form = {along, across, dot(front(by), turned) / dot(turned, turned), h[3][3], h[3][3]};
  }
  const Wrench before = relative(contact, &Body::before) - contact.wall_before, without = smooth(contact);
  const double area = 1.0;
  std::vector<double> state(contact.state.size() + 1);
  Wrench made{};
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = 1;
  if (contact.has_broken) batch.flags = ILAW_BATCH_BREAK_BONDS;
  batch.time = batch.velocity_step = batch.position_step = setup_.step;
  batch.v_free = ilaw::input(v_free.data(), 6, 1);
  batch.v_previous = ilaw::input(before.data(), 6, 1);
  if (laws_[contact.law]->info().inputs & ILAW_INPUT_V_SMOOTH)
    batch.v_smooth = ilaw::input(without.data(), 6, 1);
  batch.delassus = ilaw::input(form.data(), 6, 1);
  batch.gap = ilaw::input(&contact.gap, 1, 0);
  batch.area = ilaw::input(&area, 1, 0);
  batch.normal = ilaw::input(n.data(), 3, 1);
  batch.state_in = ilaw::input(contact.state.data(), 1, 1);
  batch.state_out = ilaw::output(state.data(), 1, 1);
  batch.impulse = ilaw::output(made.data(), 6, 1);
  if (width() == 6) {
    batch.spin_free = ilaw::input(v_free.data() + 3, 6, 1);
    batch.spin_previous = ilaw::input(before.data() + 3, 6, 1);
    batch.moment = ilaw::output(made.data() + 3, 6, 1);
  }
  ilaw_report report{};
  report.struct_size = sizeof report;
  if (laws_[contact.law]->evaluate(batch, &report) != ILAW_OK)
    made.fill(std::numeric_limits<double>::quiet_NaN());
  return made;
}

double MadeProblem::scale() const {
  double most = 0.0;
  const auto add = [&](const Wrench& velocity) {
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::fabs(velocity[c]));
  };
  for (const Contact& contact : contacts_) {
    add(smooth(contact));
    add(relative(contact, &Body::before) - contact.wall_before);
    add(contact.wall);
    add({contact.gap / setup_.step});
  }
  return most;
}

MadeAudit MadeProblem::audit(Wrench Contact::*impulse, Wrench Body::*velocity) const {
  MadeAudit found;
  const auto note = [](double& most, double x) {
    if (!(x <= most)) most = std::isfinite(x) ? x : std::numeric_limits<double>::infinity();
  };
  std::vector<Wrench> sums(bodies_.size(), Wrench{});
  for (const Contact& contact : contacts_) add_impulse(contact, contact.*impulse, sums);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    const Wrench off = body.*velocity - (body.free + scaled(body.inverse, sums[b]));
    for (const double x : off) note(found.momentum, std::fabs(x));
  }
  for (const Contact& contact : contacts_) {
    const Matrix h = delassus(contact);
    const Wrench &r = contact.*impulse, u = relative(contact, velocity) - contact.wall;
    note(found.residual, least_error(contact, h, u - h * r, r));
  }
  found.residual /= scale();
  found.momentum /= scale();
  return found;
}

// Velocity by which an impulse is off the law's. Large friction coefficients, ruptures and softening bonds
// answer to the last digits of a velocity, so it counts as right if it is right at a velocity within the
// tolerance, which is looked for along four diagonals. So do gaps that a velocity within the tolerance
// closes.
double MadeProblem::least_error(const Contact& contact, const Matrix& h, const Wrench& v_free,
                                const Wrench& r) const {
  constexpr double known = 1e-10, small = 1e-9;
  const auto size_of = [&](const Wrench& impulse) {
    const Wrench velocity = h * impulse;
    double most = 0.0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(width()); ++c) {
      const double length = c < 3 ? 1.0 : std::sqrt((h[0][0] + h[1][1] + h[2][2]) / (3.0 * h[3][3]));
      if (const double x = length * std::fabs(velocity[c]); !(x <= most)) most = x;
    }
    return std::isfinite(most) ? most : std::numeric_limits<double>::infinity();
  };
  const auto error_at = [&](const Wrench& v) { return size_of(answer(contact, v) - r); };
  double least = error_at(v_free);
  if (contact.gap > 0.0 && contact.gap <= known * scale() * setup_.step) {
    Contact closed = contact;
    closed.gap = 0.0;
    least = std::min(least, least_error(closed, h, v_free, r));
  }
  for (std::size_t k = 0; k < 4 && least > small * scale(); ++k) {
    const Wrench direction{k & 1U ? known : -known, k & 2U ? known : -known, known};
    const auto nudged = [&](double part) {
      Wrench v = v_free;
      for (std::size_t c = 0; c < 3; ++c) v[c] += part * scale() * direction[c];
      return v;
    };
    // Where the answer passes by that impulse between both ends, or jumps over it.
    double low = -1.0, high = 1.0;
    const Wrench across = answer(contact, nudged(high)) - answer(contact, nudged(low));
    least = std::min({least, error_at(nudged(low)), error_at(nudged(high))});
    for (int bisections = 0; bisections < 50 && least > small * scale(); ++bisections) {
      const double middle = 0.5 * (low + high);
      const Wrench off = answer(contact, nudged(middle)) - r;
      least = std::min(least, size_of(off));
      double along = 0.0;
      for (std::size_t c = 0; c < off.size(); ++c) along += off[c] * across[c];
      (along > 0.0 ? high : low) = middle;
    }
  }
  return least;
}

MadeAudit MadeProblem::audit_of_solution() const { return audit(&Contact::made, &Body::solution); }

MadeAudit MadeProblem::audit(const ilaw_coupled_report& report) const {
  MadeAudit found = audit(&Contact::impulse, &Body::velocity);
  double work = 0.0, parts = 0.0;
  for (const Contact& contact : contacts_) {
    const Wrench sum = relative(contact, &Body::velocity) - contact.wall +
                       (relative(contact, &Body::before) - contact.wall_before);
    for (std::size_t c = 0; c < static_cast<std::size_t>(width()); ++c) {
      work += 0.5 * contact.impulse[c] * sum[c];
      parts += std::fabs(contact.impulse[c]) * (std::fabs(sum[c]) + scale());
    }
  }
  found.work = parts > 0.0 ? std::fabs(report.work - work) / parts : std::fabs(report.work);
  return found;
}

void MadeProblem::forget_impulses() {
  for (Contact& contact : contacts_) {
    contact.impulse = {};
    contact.has_broken = false;
  }
}

std::vector<double> MadeProblem::impulses() const {
  std::vector<double> all;
  for (const Contact& contact : contacts_)
    all.insert(all.end(), contact.impulse.begin(), contact.impulse.end());
  return all;
}

std::vector<double> MadeProblem::velocities() const {
  std::vector<double> all;
  for (const Body& body : bodies_) all.insert(all.end(), body.velocity.begin(), body.velocity.end());
  return all;
}

// A group per law, whose arrays are gathered from the contacts.
struct MadeProblem::Group {
  std::vector<std::size_t> contacts;
  std::vector<std::int32_t> body, counterpart;
  std::vector<double> gap, normal, arm, other_arm, wall, wall_before, impulse, state_in, state_out;
  std::vector<ilaw_status> status;
  double area = 1.0;
  ilaw_batch batch{};
  ilaw_contacts given{};

  void add(std::size_t k, const Contact& contact) {
    const auto append = [](std::vector<double>& to, const auto& values) {
      to.insert(to.end(), values.begin(), values.end());
    };
    contacts.push_back(k);
    body.push_back(contact.body);
    counterpart.push_back(contact.counterpart);
    gap.push_back(contact.gap);
    append(normal, contact.normal);
    append(arm, contact.arm);
    append(other_arm, contact.other_arm);
    append(wall, contact.wall);
    append(wall_before, contact.wall_before);
    append(impulse, contact.impulse);
    append(state_in, contact.state);
  }
  void describe(const interface& law, ilaw_delassus_form form, double step) {
    const auto states = static_cast<std::int64_t>(law.info().state_size);
    state_out = state_in;
    status.resize(contacts.size());
    batch.struct_size = sizeof batch;
    batch.node_count = static_cast<std::int64_t>(contacts.size());
    batch.time = batch.velocity_step = batch.position_step = step;
    batch.gap = ilaw::input(gap.data(), 1, 0);
    batch.area = ilaw::input(&area, 0, 0);
    batch.normal = ilaw::input(normal.data(), 3, 1);
    batch.state_in = ilaw::input(state_in.data(), states, 1);
    batch.state_out = ilaw::output(state_out.data(), states, 1);
    batch.impulse = ilaw::output(impulse.data(), 6, 1);
    batch.status = status.data();
    batch.status_stride = 1;
    const bool has_spins = form == ILAW_DELASSUS_TRANSVERSE_SPIN;
    if (has_spins) batch.moment = ilaw::output(impulse.data() + 3, 6, 1);
    given = contacts_of(law, form, batch, body.data(), counterpart.data());
    given.arm = ilaw::input(arm.data(), 3, 1);
    given.counterpart_arm = ilaw::input(other_arm.data(), 3, 1);
    given.wall_velocity = ilaw::input(wall.data(), 6, 1);
    given.wall_previous = ilaw::input(wall_before.data(), 6, 1);
    if (!has_spins) return;
    given.wall_spin = ilaw::input(wall.data() + 3, 6, 1);
    given.wall_spin_previous = ilaw::input(wall_before.data() + 3, 6, 1);
  }
};

ilaw_bodies MadeProblem::describe_bodies(std::vector<double>& inertia) {
  const auto stride = static_cast<std::int64_t>(sizeof(Body) / sizeof(double));
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = 3;
  bodies.count = bodies.owned_count = body_count();
  Body& first = bodies_.front();
  bodies.inverse_mass = ilaw::input(first.inverse.data(), stride, setup_.no_freedom > 0.0 ? 1 : 0);
  bodies.v_free = ilaw::input(first.free.data(), stride, 1);
  bodies.v_previous = ilaw::input(first.before.data(), stride, 1);
  bodies.velocity = ilaw::output(first.velocity.data(), stride, 1);
  if (!rotates()) return bodies;
  for (const Body& body : bodies_)
    inertia.insert(inertia.end(), {body.inverse[3], body.inverse[4], body.inverse[5], 0.0, 0.0, 0.0});
  bodies.inverse_inertia = ilaw::input(inertia.data(), 6, setup_.rotate ? 1 : 0);
  bodies.spin_free = ilaw::input(first.free.data() + 3, stride, 1);
  bodies.spin_previous = ilaw::input(first.before.data() + 3, stride, 1);
  bodies.spin = ilaw::output(first.velocity.data() + 3, stride, 1);
  return bodies;
}

ilaw_coupled_report MadeProblem::solve(coupled& solver, const ilaw_coupled_options& options) {
  std::vector<double> inertia;
  const ilaw_bodies bodies = describe_bodies(inertia);
  std::vector<Group> groups(laws_.size());
  for (std::size_t k = 0; k < contacts_.size(); ++k) groups[contacts_[k].law].add(k, contacts_[k]);
  std::vector<const ilaw_contacts*> given;
  for (std::size_t l = 0; l < laws_.size(); ++l) {
    groups[l].describe(*laws_[l], form_, setup_.step);
    given.push_back(&groups[l].given);
  }
  const ilaw_coupled_report report = solver.solve(bodies, given, options);
  for (const Group& group : groups)
    for (std::size_t i = 0; i < group.contacts.size(); ++i) {
      Contact& contact = contacts_[group.contacts[i]];
      std::copy_n(group.impulse.begin() + static_cast<std::ptrdiff_t>(6 * i), 6, contact.impulse.begin());
      const bool holds_bonds = laws_[contact.law]->info().capabilities & ILAW_CAN_HOLD_BONDS;
      contact.has_broken = holds_bonds && group.status[i] == ILAW_BROKEN;
    }
  if (!rotates())
    for (Body& body : bodies_) body.velocity[3] = body.velocity[4] = body.velocity[5] = 0.0;
  return report;
}

}  // namespace ilaw::host
