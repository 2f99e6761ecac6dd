// SPDX-License-Identifier: BSD-3-Clause
#include "stress/made_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ilaw::host {

double MadeProblem::scale() const {
  double most = 0.0;
  for (const Contact& contact : contacts_)
    for (const Wrench& velocity : {smooth(contact), before(contact), contact.wall})
      most = std::max({most, velocity.head<3>().cwiseAbs().maxCoeff(), contact.gap / setup_.step});
  return most;
}

MadeAudit MadeProblem::audit(Wrench Contact::*impulse, Wrench Body::*velocity) const {
  MadeAudit found;
  const auto note = [](double& most, double x) {
    if (!(x <= most)) most = std::isfinite(x) ? x : std::numeric_limits<double>::infinity();
  };
  const std::vector<Wrench> sums = sums_of(impulse);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    const Wrench off = body.*velocity - (body.free + body.inverse.cwiseProduct(sums[b]));
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

// As a velocity of the contact, spins by the arm that its inertia has.
double MadeProblem::size_of(const Matrix& h, const Wrench& impulse) const {
  Wrench velocity = h * impulse;
  if (width() == 6) velocity.tail<3>() *= std::sqrt(h.topLeftCorner<3, 3>().trace() / (3.0 * h(3, 3)));
  const double most = velocity.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  return std::isfinite(most) ? most : std::numeric_limits<double>::infinity();
}

// Velocity by which an impulse is off the law's. Large friction coefficients, ruptures and softening bonds
// answer to the last digits of a velocity, so it counts as right if it is right at a velocity within the
// tolerance, which is looked for along four diagonals. So do gaps that a velocity within the tolerance
// closes; a gap within rounding counts as closed (coupled.h, tolerance).
double MadeProblem::least_error(const Contact& contact, const Matrix& h, const Wrench& v_free,
                                const Wrench& r) const {
  constexpr double known = 1e-10, small = 1e-9, rounded = 1e-14;
  const auto error_at = [&](const Wrench& v) { return size_of(h, answer(contact, v) - r); };
  double least = error_at(v_free);
  if (contact.gap > 0.0 && contact.gap <= known * scale() * setup_.step) {
    Contact closed = contact;
    closed.gap = 0.0;
    const double error_if_closed = least_error(closed, h, v_free, r);
    if (contact.gap <= rounded * scale() * setup_.step) return error_if_closed;
    least = std::min(least, error_if_closed);
  }
  for (std::size_t k = 0; k < 4 && least > small * scale(); ++k) {
    const Vector direction{k & 1U ? known : -known, k & 2U ? known : -known, known};
    const auto nudged = [&](double part) {
      Wrench v = v_free;
      v.head<3>() += part * scale() * direction;
      return v;
    };
    // Where the answer passes by that impulse between both ends, or jumps over it.
    double low = -1.0, high = 1.0;
    const Wrench across = answer(contact, nudged(high)) - answer(contact, nudged(low));
    least = std::min({least, error_at(nudged(low)), error_at(nudged(high))});
    for (int bisections = 0; bisections < 50 && least > small * scale(); ++bisections) {
      const double middle = 0.5 * (low + high);
      const Wrench off = answer(contact, nudged(middle)) - r;
      least = std::min(least, size_of(h, off));
      (off.dot(across) > 0.0 ? high : low) = middle;
    }
  }
  return least;
}

MadeAudit MadeProblem::audit_of_solution() const { return audit(&Contact::made, &Body::solution); }

MadeAudit MadeProblem::audit(const ilaw_coupled_report& report) const {
  MadeAudit found = audit(&Contact::impulse, &Body::velocity);
  double work = 0.0, parts = 0.0;
  for (const Contact& contact : contacts_) {
    const Wrench sum = relative(contact, &Body::velocity) - contact.wall + before(contact);
    work += 0.5 * contact.impulse.head(width()).dot(sum.head(width()));
    parts += contact.impulse.head(width()).cwiseAbs().dot(
        (sum.head(width()).cwiseAbs().array() + scale()).matrix());
  }
  found.work = parts > 0.0 ? std::fabs(report.work - work) / parts : std::fabs(report.work);
  return found;
}

}  // namespace ilaw::host
