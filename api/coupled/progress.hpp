// progress.hpp - how far the iterations over some contacts are: all of them, or an island.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/coupled.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace ilaw::coupled {

// How a method ended. Refused: it does not serve these contacts, or a law failed.
enum class Outcome { solved, stalled, refused, spent };

// What the caller asks for. rounding: a change of a contact's velocity below it that iterations no longer
// lower counts as solved.
struct Limits {
  std::uint32_t most = 0;
  double tolerance = 0.0, rounding = 0.0;
  double speed = 0.0;  // residuals are relative to no smaller velocity
};

struct Progress {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  // Beyond this growth of the largest velocity impulses are rounding alone: iterations end.
  static constexpr double max_growth = 0x1p50;
  // Iterations that have not lowered the change by a tenth, where that is below rounding: the last ones.
  static constexpr std::uint32_t plateau = 20;

  Limits limits;
  double scale = 0.0;  // largest velocity that the problem brings: residuals are relative to it
  std::uint32_t count = 0, method = ILAW_METHOD_GAUSS_SEIDEL;
  double change = infinity, square = infinity;  // of the last iteration: largest |H dr|, and sum of dr.H dr
  double size = 0.0;                            // largest velocity of a contact, or made by its impulse
  double least = infinity, least_in_first_half = infinity;  // change
  double lowered = infinity;                                // the change when it last fell by a tenth
  std::uint32_t since_lowered = 0;
  std::int32_t code = ILAW_OK;   // of a law that failed
  const char* reason = nullptr;  // of a code that is no law's
  bool is_cold = false;          // begins without impulses
  bool grows = false;            // impulses push against each other without end

  void note(double new_change, double new_square, double new_size) {
    ++count;
    change = new_change;
    square = new_square;
    size = new_size;
    // Contacts that nothing moves but their laws, such as the second impulse of an impact.
    constexpr double beyond = 1e3;
    if (!(scale > 0.0) || (count == 1 && is_cold && change > beyond * scale)) scale = limits.speed = change;
    least = std::min(least, change);
    if (count <= limits.most / 2) least_in_first_half = least;
    ++since_lowered;
    if (change < 0.9 * lowered) {
      lowered = change;
      since_lowered = 0;
    }
  }
  // The change, or the rounding of large impulses, which hides changes.
  double error() const {
    constexpr double large = 1e4;
    return size > large * scale ? std::max(change, std::numeric_limits<double>::epsilon() * size) : change;
  }
  double residual() const { return error() > 0.0 ? error() / scale : 0.0; }
  // Impulses are sums whose rounding no iteration lowers.
  double rounding() const { return 256.0 * std::numeric_limits<double>::epsilon() * size; }
  bool is_solved() const { return code >= 0 && is_within(std::max(limits.rounding, least_known())); }
  // The same, but below rounding iterations go on while they lower the change.
  bool is_done() const {
    return code >= 0 && is_within(since_lowered >= plateau ? std::max(limits.rounding, least_known()) : 0.0);
  }
  bool is_over() const { return code < 0 || count >= limits.most || size > max_growth * scale; }
  bool has_stalled() const { return !is_solved() && !(least < 0.9 * least_in_first_half); }

  // Impulses that are so large that their rounding is above 1e-8 of the scale solve nothing.
  bool is_known() const { return std::numeric_limits<double>::epsilon() * size <= 1e-8 * scale; }
  double least_known() const { return std::min(rounding(), 1e-8 * scale); }
  bool is_within(double known) const {
    return rounding() <= 2e-6 * scale && (residual() <= limits.tolerance || change <= known);
  }

  // From the impulses that are there, with as many iterations more, at least.
  Progress once_more(std::uint32_t more) const {
    Progress next;
    next.limits = limits;
    next.limits.most = std::max(limits.most, count + more);
    next.scale = scale;
    next.count = count;
    next.method = method;
    return next;
  }

  // Becomes the progress of both.
  void merge(const Progress& other) {
    const std::uint32_t longest = std::max(count, other.count);
    const std::uint32_t last = other.count > count ? other.method : method;
    const bool both = grows || other.grows;
    if (other.code < 0 || (code >= 0 && other.residual() > residual())) *this = other;
    count = longest;
    method = last;
    grows = both;
  }
};

}  // namespace ilaw::coupled
