// SPDX-License-Identifier: BSD-3-Clause
#include "study/exact_parts.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace ilaw::host {
namespace {

// Where a function that is <= 0 at from and > 0 at to changes its sign, to the last bit.
template <class Function>
double sign_change(double from, double to, Function function) {
  for (double middle = 0.5 * (from + to); middle > from && middle < to; middle = 0.5 * (from + to))
    (function(middle) > 0.0 ? to : from) = middle;
  return to;
}

class Pull {
 public:
  explicit Pull(const std::vector<PostitPoint::Knot>& knots) : knots_(knots) {}

  double at(double time) const {
    const auto next = after(time);
    if (next == knots_.begin()) return next->force;
    const PostitPoint::Knot& last = *(next - 1);
    if (next == knots_.end()) return last.force;
    return last.force + (time - last.time) / (next->time - last.time) * (next->force - last.force);
  }
  double impulse(double from, double to) const {
    double sum = 0.0;
    while (from < to) {
      const auto next = after(from);
      const double until = next == knots_.end() ? to : std::min(next->time, to);
      sum += 0.5 * (at(from) + at(until)) * (until - from);
      from = until;
    }
    return sum;
  }

 private:
  std::vector<PostitPoint::Knot>::const_iterator after(double time) const {
    return std::upper_bound(knots_.begin(), knots_.end(), time,
                            [](double t, const PostitPoint::Knot& knot) { return t < knot.time; });
  }
  const std::vector<PostitPoint::Knot>& knots_;
};

// Motion since an instant under a force that is linear in time, or at rest on the plane.
struct Piece {
  double start, position, velocity, acceleration, jerk;

  double position_at(double time) const {
    const double s = time - start;
    return position + s * (velocity + s * (acceleration / 2.0 + s * jerk / 6.0));
  }
  double velocity_at(double time) const {
    const double s = time - start;
    return velocity + s * (acceleration + s * jerk / 2.0);
  }
};

class Story {
 public:
  explicit Story(const PostitPoint& point)
      : point_(point), pull_(point.knots), adhesion_(point.initial_adhesion) {}

  ExactNode tell() {
    if (adhesion_ == 0.0) take_off();
    for (const PostitPoint::Shock& shock : point_.shocks) {
      if (shock.time > point_.end) break;
      advance(shock.time);
      strike(shock.impulse);
    }
    advance(point_.end);
    const auto pieces = std::make_shared<const std::vector<Piece>>(std::move(pieces_));
    const auto at = [pieces](double time) {
      const auto next = std::upper_bound(pieces->begin() + 1, pieces->end(), time,
                                         [](double t, const Piece& piece) { return t < piece.start; });
      return *(next - 1);
    };
    return {[=](double time) { return at(time).position_at(time); },
            [=](double time) { return at(time).velocity_at(time); }, instants_};
  }

 private:
  // To a time before which no shock falls, from one kink of the force or of the window's sum to the
  // next.
  void advance(double to) {
    while (now_ < to) {
      const double until = std::min(to, next_kink());
      if (flies_)
        fly(until);
      else
        rest(until);
    }
  }

  double next_kink() const {
    double next = INFINITY;
    const auto consider = [&](double time) {
      if (time > now_) next = std::min(next, time);
    };
    for (const PostitPoint::Knot& knot : point_.knots) {
      consider(knot.time);
      consider(knot.time + point_.memory);
    }
    for (const PostitPoint::Shock& past : window_) consider(past.time + point_.memory);
    consider(holds_since_ + point_.memory);
    return next;
  }

  // The impulse that pulled at the bond within its memory, without the one that pressed it; that of the force
  // since it holds. A
  // shock counts at its own instant, even without memory.
  double pulled(double time) const {
    double sum = pull_.impulse(std::max(holds_since_, time - point_.memory), time);
    for (const PostitPoint::Shock& past : window_)
      if (past.time > time - point_.memory || past.time == time) sum -= past.impulse;
    return sum;
  }

  void rest(double until) {
    note_piece(0.0, 0.0);
    if (adhesion_ > 0.0 && point_.memory > 0.0) {
      if (pull_.at(0.5 * (now_ + until)) > 0.0) note_impulse(now_);
      if (const double breaks = rupture_before(until); breaks < until) {
        now_ = breaks;
        break_bond();
        return;
      }
    }
    now_ = until;
    if (adhesion_ == 0.0) take_off();
  }

  // Up to the next kink the sum is quadratic: it passes the adhesion on its way to its top. An impulse that
  // leaves the window at a kink counts before it and not after.
  double rupture_before(double until) const {
    const auto excess = [&](double time) { return pulled(time) - adhesion_ * at_the_limit; };
    const double margin = 1e-12 * (until - now_);
    const double from = now_ + margin, to = until - margin, middle = 0.5 * (from + to);
    const double curvature = excess(from) + excess(to) - 2.0 * excess(middle),
                 rise = excess(to) - excess(from);
    double top = to;
    if (curvature < 0.0) top = std::clamp(middle - 0.25 * rise / curvature * (to - from), from, to);
    return excess(top) > 0.0 ? sign_change(from, top, excess) : until;
  }

  // Pulled away, the motion is convex: it meets the plane before its velocity turns, or not at all.
  void fly(double until) {
    const double slope = (pull_.at(until) - pull_.at(now_)) / (until - now_);
    note_piece(pull_.at(now_) / point_.mass, slope / point_.mass);
    const Piece piece = pieces_.back();
    double low = until;
    if (piece.velocity < 0.0 && piece.velocity_at(until) > 0.0)
      low = sign_change(now_, until, [&](double time) { return piece.velocity_at(time); });
    if (piece.velocity < 0.0 && piece.position_at(low) <= 0.0) {
      now_ = sign_change(now_, low, [&](double time) { return -piece.position_at(time); });
      const double speed = piece.velocity_at(now_);
      x_ = v_ = 0.0;
      flies_ = false;
      press(-point_.mass * speed);
    } else {
      now_ = until;
      x_ = piece.position_at(until);
      v_ = piece.velocity_at(until);
    }
  }

  void strike(double impulse) {
    if (flies_) {
      v_ += impulse / point_.mass;
    } else if (impulse < 0.0) {
      press(-impulse);
    } else if (adhesion_ > 0.0 && pulled(now_) + impulse <= adhesion_ * at_the_limit) {
      window_.push_back({now_, -impulse});
      note_impulse(now_);
    } else {
      if (adhesion_ > 0.0) break_bond();
      v_ = impulse / point_.mass;
      flies_ = true;
    }
  }

  // R_Y = max(R_Y, min(eta S_N, R_Y,max)).
  void press(double impulse) {
    note_impulse(now_);
    if (adhesion_ == 0.0) holds_since_ = now_;
    window_.push_back({now_, impulse});
    const double efficiency = std::exp(-ruptures_ / point_.efficiency_decrease);
    const double gained = std::min(efficiency * std::max(-pulled(now_), 0.0), point_.adhesion_limit);
    adhesion_ = std::max(adhesion_, gained);
    if (adhesion_ == 0.0) take_off();
  }

  void break_bond() {
    instants_.last_rupture = now_;
    adhesion_ = 0.0;
    ruptures_ += 1.0;
    window_.clear();
    take_off();
  }
  // Nothing holds it against a pull, be it one that is about to grow from zero.
  void take_off() { flies_ = pull_.at(now_) > 0.0 || pull_.at(next_kink()) > 0.0; }

  void note_impulse(double time) {
    if (std::isnan(instants_.first_impulse)) instants_.first_impulse = time;
  }
  void note_piece(double acceleration, double jerk) { pieces_.push_back({now_, x_, v_, acceleration, jerk}); }

  static constexpr double at_the_limit = 1.0 + 1e-9;

  const PostitPoint& point_;
  const Pull pull_;
  double now_ = 0.0, x_ = 0.0, v_ = 0.0;
  bool flies_ = false;
  double adhesion_, ruptures_ = 0.0;
  double holds_since_ = 0.0;
  std::vector<PostitPoint::Shock> window_;  // impulses on the point since the last rupture
  std::vector<Piece> pieces_;
  ContactInstants instants_;
};

}  // namespace

ExactNode postit_motion(const PostitPoint& point) { return Story(point).tell(); }

}  // namespace ilaw::host
