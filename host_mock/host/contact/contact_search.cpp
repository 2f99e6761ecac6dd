// SPDX-License-Identifier: BSD-3-Clause
#include "contact/contact_search.hpp"

#include "base/large_pages.hpp"
#include "base/parallel.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace ilaw::host {
namespace {

// The largest speed is that of the largest square, which is 0 for smaller ones: nodes that come to
// rest on a spring have them, at gaps as small.
constexpr double least_speed = 0x1p-500;

double largest_offset_of(const InterfaceSetup& setup) {
  double largest = std::max(0.0, setup.common_gap_offset);
  for (const double own : setup.own_gap_offsets) largest = std::max(largest, setup.common_gap_offset + own);
  return largest;
}

}  // namespace

ContactSearch::ContactSearch(const InterfaceSetup& setup, const Law& law, const ContactArrays& contacts)
    : setup_(setup),
      law_(law),
      contacts_(contacts),
      axes_turn_(!law.axes().empty() && !setup.counterpart->keeps_normal()),
      finds_near_(setup.counterpart->finds_near()),
      largest_offset_(largest_offset_of(setup)) {}

void ContactSearch::choose(const StepView& step, const ObstacleMotion& obstacle, const MakeContact& make) {
  const Counterpart& counterpart = *setup_.counterpart;
  const double moving = counterpart.partners().empty() ? 1.0 : 2.0;
  const double closing_before = moving * std::max(step.speed_before, least_speed) + obstacle.speed_before(),
               closing_after = moving * std::max(step.speed_after, least_speed) + obstacle.speed();
  closing_ = step.dt * closing_after;
  const double clock = std::max(step.time, 0.0);  // before it, a run is prestressed
  acts_ = !(clock < setup_.birth || clock >= setup_.death);
  if (is_due(step, closing_before, closing_after)) refresh(step, make);
}

bool ContactSearch::is_due(const StepView& step, double closing_before, double closing_after) {
  if (!finds_near_) {
    const bool due = proximity_.refresh_due(step.dt, closing_before, closing_after) || is_hostile;
    if (!acts_) proximity_.invalidate();
    return due && acts_;
  }
  const double travelled = ProximityFilter::rounded_up(step.dt * closing_before),
               ahead = ProximityFilter::rounded_up(step.dt * closing_after);
  if (!acts_) {
    setup_.counterpart->pass_by(travelled);
    is_forced_ = true;
    return false;
  }
  const Approach approach{travelled, ahead + largest_offset_, is_forced_, near_.empty()};
  is_forced_ = is_hostile;
  return setup_.counterpart->find_near(step.u, approach);
}

bool ContactSearch::may_touch(double gap_bound) const {
  if (!finds_near_) return proximity_.may_touch(gap_bound);
  return !(gap_bound > setup_.counterpart->horizon() - largest_offset_);
}

NearContacts ContactSearch::chunk(std::ptrdiff_t number) const {
  const std::ptrdiff_t* const range = &chunk_starts_[static_cast<std::size_t>(number)];
  return {near_.data() + range[0], near_nodes_.data() + range[0], range[1] - range[0]};
}

void ContactSearch::look_again(int node_index) {
  const std::size_t chunk = static_cast<std::size_t>(node_index) / contact_chunk;
  if (chunk < far_.size()) far_[chunk] = {};
}

void ContactSearch::forget() {
  far_.clear();
  proximity_.invalidate();
  is_forced_ = true;
}

bool ContactSearch::may_skip() const {
  if (setup_.keeps_all_active || (!law_.may_skip_fresh() && !law_.may_skip_free())) return false;
  return !axes_turn_;
}

// Where all nodes of a chunk are far, it is looked at only if they may have come closer.
void ContactSearch::refresh(const StepView& step, const MakeContact& make) {
  const auto count = static_cast<std::ptrdiff_t>(setup_.nodes.size());
  is_near_.resize(setup_.nodes.size());
  far_.resize(static_cast<std::size_t>(chunks_of(count, contact_chunk)));
  for_each_chunk(static_cast<std::ptrdiff_t>(far_.size()), 1, [&](std::ptrdiff_t c, auto, auto) {
    const auto chunk = static_cast<std::size_t>(c);
    if (proximity_.may_touch(far_[chunk])) look_at(chunk, step);
  });
  const std::size_t known = contacts_.count();
  near_.clear();
  near_nodes_.clear();
  chunk_starts_.clear();
  for (std::size_t c = 0; c < far_.size(); ++c) {
    chunk_starts_.push_back(static_cast<std::ptrdiff_t>(near_.size()));
    if (far_[c].gap_bound > 0.0) continue;
    const std::size_t first = c * contact_chunk, end = std::min(first + contact_chunk, is_near_.size());
    for (std::size_t k = first; k < end; ++k) {
      if (!is_near_[k]) continue;
      near_.push_back(make(static_cast<int>(k)));
      near_nodes_.push_back(setup_.nodes[k]);
    }
  }
  chunk_starts_.push_back(static_cast<std::ptrdiff_t>(near_.size()));
  if (contacts_.count() == known) return;
  contacts_.keep_in_large_pages();
  host::keep_in_large_pages(near_);
  host::keep_in_large_pages(near_nodes_);
}

// Touched contacts stay near: only fresh ones, and those at rest, are known to do nothing at a
// distance.
void ContactSearch::look_at(std::size_t chunk, const StepView& step) {
  const std::size_t first = chunk * contact_chunk,
                    count = std::min<std::size_t>(contact_chunk, is_near_.size() - first);
  const bool skips = may_skip(), may_be_awake = law_.info().state_size > 0 || !law_.may_skip_fresh();
  std::array<double, contact_chunk> bounds;
  if (skips)
    setup_.counterpart->gap_bounds(static_cast<int>(first), static_cast<int>(count), step.u, step.time,
                                   bounds.data());
  std::size_t near = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const int contact = may_be_awake ? contacts_.index_of(first + i) : -1;
    const bool awake = contact >= 0 ? contacts_.must_be_evaluated(static_cast<std::size_t>(contact))
                                    : !law_.may_skip_fresh();
    const int node_index = static_cast<int>(first + i);
    const double gap =
        !skips ? 0.0
               : setup_.counterpart->known_gap(node_index, step.u, bounds[i] - setup_.gap_offset(node_index));
    const bool is_near = !setup_.is_left_out(node_index) &&
                         (awake || !skips || may_touch(gap) || setup_.counterpart->is_held(node_index));
    is_near_[first + i] = is_near ? 1 : 0;
    near += is_near ? 1 : 0;
    least = gap < least ? gap : least;
  }
  far_[chunk] = near > 0 || finds_near_ ? FarNodes{} : FarNodes{least, proximity_.way()};
}

}  // namespace ilaw::host
