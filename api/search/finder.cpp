// SPDX-License-Identifier: BSD-3-Clause
#include "finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ilaw::search {
namespace {

// In mean edges: strain at which the tree is fitted again, reach of the facets that are kept beyond the
// closest one, and motion that a list of near points is good for.
constexpr double most_strain = 0.05, kept_reach = 0.5, most_motion = 0.5, most_margin = 0.25,
                 least_margin = 1e-3;
// Steps of the given reach that a list of near points should last for.
constexpr double steps_ahead = 8.0;
constexpr std::size_t group_size = 16;

Positions start_of(const ilaw_facets_setup& setup) { return {setup.dimension, setup.position, {}}; }

std::vector<std::int32_t> points_of(const ilaw_facets_setup& setup) {
  std::vector<std::int32_t> nodes(setup.points, setup.points + setup.point_count);
  for (std::int32_t& node : nodes) node -= setup.index_base;
  return nodes;
}

std::vector<Vec> places_of(const std::vector<std::int32_t>& nodes, const Positions& positions) {
  std::vector<Vec> places;
  for (const std::int32_t node : nodes) places.push_back(positions[node]);
  return places;
}

Box box_of(Vec p) { return {p, p}; }

}  // namespace

Finder::Finder(const ilaw_facets_setup& setup)
    : surface_(setup, start_of(setup)),
      nodes_(points_of(setup)),
      now_(places_of(nodes_, start_of(setup))),
      seen_([&] {
        std::vector<Vec> seen;
        for (const Vec p : now_) seen.push_back(surface_.axes().seen(p));
        return seen;
      }()),
      groups_(seen_, group_size),
      known_(nodes_.size()),
      pairs_found_(nodes_.size()),
      stamps_(nodes_.size(), -1),
      listed_(nodes_.size()) {
  near_.reserve(nodes_.size());
  longer_.reserve(nodes_.size());
  group_boxes_.reserve(groups_.size());
}

// Sums of a dozen terms of the size of the coordinates.
double Finder::rounding_rim() const {
  constexpr double part = 1e-6, ulps = 16.0;
  return std::max(part * surface_.shortest_edge(),
                  ulps * std::numeric_limits<double>::epsilon() * surface_.largest_coordinate());
}

// Between bounds of the tree and distances now, but for the motion of the point.
double Finder::doubt() const {
  constexpr double rounding = 1e-9;
  return surface_.strain() + rounding * surface_.mean_edge() + rounding_rim();
}

void Finder::update(const Positions& positions) {
  ++updates_;
  bool moved = surface_.follow(positions);
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Vec p = positions[nodes_[k]];
    Vec& now = now_[k];
    moved = moved || !(p.x == now.x && p.y == now.y && p.z == now.z);
    now = p;
  }
  if (!moved && updates_ > 1) return;
  ++stamp_;
  if (!(surface_.strain() <= most_strain * surface_.mean_edge())) {
    surface_.refit();
    ++refits_;
    ++fit_;
    is_listed_ = false;
  }
  double most = 0.0;
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    seen_[k] = surface_.axes().seen(now_[k]);
    const double way = square(seen_[k] - listed_[k]);
    most = way <= most ? most : way;
  }
  motion_ = std::sqrt(most) + surface_.strain() + strain_listed_;
}

// ---- near points ----------------------------------------------------------------------------------------

void Finder::find_near(ilaw_facets_nearby& nearby) {
  const double edge = surface_.mean_edge();
  const bool is_due = nearby.forced != 0 || !is_listed_ || !(motion_ + nearby.reach < horizon_) ||
                      !(motion_ <= most_motion * edge);
  if (is_due) {
    make_list(nearby.reach);
    listed_ = seen_;
    strain_listed_ = surface_.strain();
    motion_ = 2.0 * surface_.strain();
    is_listed_ = true;
    ++refreshes_;
  }
  nearby.is_new = is_due ? 1 : 0;
  nearby.count = static_cast<std::int64_t>(near_.size());
  nearby.points = near_.data();
  nearby.horizon = horizon_;
  nearby.slack = near_.empty() ? std::min({horizon_, most_motion * edge, turn_}) - motion_ : 0.0;
}

// The longer the margin, the longer the list lasts, and the longer it is. A list of none lasts until the
// first point may be there, so that a quarter of the margin is worth a try.
void Finder::make_list(double reach) {
  const double edge = surface_.mean_edge();
  double margin = std::clamp(steps_ahead * reach, least_margin * edge, most_margin * edge);
  Apart least;
  list_near(reach + margin, least);
  if (!near_.empty()) {
    std::swap(near_, longer_);
    Apart closer;
    list_near(reach + 0.25 * margin, closer);
    if (near_.empty()) {
      margin *= 0.25;
      least = closer;
    } else {
      std::swap(near_, longer_);
    }
  }
  horizon_ = reach + margin;
  turn_ = least.turn;
  if (near_.empty()) horizon_ = std::max(horizon_, least.distance);
}

void Finder::list_near(double horizon, Apart& least) {
  groups_.fit(group_boxes_, [&](std::int32_t k) { return box_of(seen_[static_cast<std::size_t>(k)]); });
  near_.clear();
  std::array<std::int32_t, Tree::most_depth> stack;
  std::size_t depth = 0;
  if (groups_.size() > 0) stack[depth++] = 0;
  while (depth > 0) {
    const auto group = static_cast<std::size_t>(stack[--depth]);
    const Tree::Node& node = groups_[group];
    if (is_apart(group_boxes_[group], horizon, least)) continue;
    if (node.right == 0) {
      near_.insert(near_.end(), groups_.items() + node.first, groups_.items() + node.end);
      continue;
    }
    stack[depth++] = node.right;
    stack[depth++] = static_cast<std::int32_t>(group) + 1;
  }
}

// Least of n . (p - x), for all points p, all x in a box, and all n between two.
double least_along(const Box& points, const Box& box, const Box& normals) {
  const auto least = [](double low, double high, double n_low, double n_high) {
    return std::min({low * n_low, low * n_high, high * n_low, high * n_high});
  };
  const Vec low = points.low - box.high, high = points.high - box.low;
  return least(low.x, high.x, normals.low.x, normals.high.x) +
         least(low.y, high.y, normals.low.y, normals.high.y) +
         least(low.z, high.z, normals.low.z, normals.high.z);
}

// A facet whose nodes move by m turns by 4 m/L at most, L being its shortest edge; twice that is allowed for
// skewed ones. It turns its back to a point at the distance d, c above it, from m (8 d/L + 2) = c on.
bool Finder::is_apart(const Box& points, double horizon, Apart& least) const {
  constexpr int most_visits = 64;  // else halves of the points are looked at
  const Tree& tree = surface_.tree();
  const double doubt = this->doubt(), enough = horizon + doubt;
  // The closest facet of any of the points is no farther than this.
  double most = infinity;
  for (std::size_t n = 0;;) {
    most = std::min(most, most_square(points, surface_.box(n)));
    if (tree[n].right == 0) break;
    const auto right = static_cast<std::size_t>(tree[n].right);
    n = most_square(points, surface_.box(n + 1)) <= most_square(points, surface_.box(right)) ? n + 1 : right;
  }
  const double far = std::sqrt(most) + 2.0 * doubt;
  Apart bound;
  const auto passes = [&](const Box& box, const Box& normals, bool& is_done) {
    const double distance = std::sqrt(least_square(points, box));
    is_done = distance > far;  // not the closest one of any
    if (is_done) return true;
    const double above = least_along(points, box, normals) - doubt;
    is_done = distance > enough && above > 0.0;
    if (is_done) {
      const double farthest = std::sqrt(most_square(points, box));
      bound.distance = std::min(bound.distance, distance);
      bound.turn = std::min(bound.turn, above / (8.0 * farthest / surface_.shortest_edge() + 2.0));
    }
    return distance > enough;
  };
  std::array<std::int32_t, Tree::most_depth> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  for (int visits = 0; depth > 0; ++visits) {
    if (visits == most_visits) return false;
    const auto n = static_cast<std::size_t>(stack[--depth]);
    const Tree::Node& node = tree[n];
    bool is_done = false;
    passes(surface_.box(n), surface_.normals(n), is_done);
    if (is_done) continue;
    if (node.right != 0) {
      stack[depth++] = node.right;
      stack[depth++] = static_cast<std::int32_t>(n) + 1;
      continue;
    }
    for (std::int32_t k = node.first; k < node.end; ++k) {
      const std::int32_t facet = tree.item(k);
      const Vec normal = surface_.slab(facet).n;
      passes(surface_.facet_box(facet), {normal, normal}, is_done);
      if (!is_done) return false;
    }
  }
  least.distance = std::min(least.distance, bound.distance - doubt);
  least.turn = std::min(least.turn, bound.turn);
  return true;
}

// ---- faces ----------------------------------------------------------------------------------------------

std::int64_t Finder::find_overlaps(const std::int32_t* points, std::uint32_t corner_count, double distance,
                                   std::int32_t* facets, std::int64_t capacity) const {
  Box face;
  for (std::uint32_t k = 0; k < corner_count; ++k) face.add(seen_[static_cast<std::size_t>(points[k])]);
  const double enough = square(distance + doubt());
  const Tree& tree = surface_.tree();
  std::array<std::int32_t, Tree::most_depth> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  std::int64_t found = 0;
  while (depth > 0) {
    const auto n = static_cast<std::size_t>(stack[--depth]);
    if (least_square(face, surface_.box(n)) > enough) continue;
    const Tree::Node& node = tree[n];
    if (node.right != 0) {
      stack[depth++] = node.right;
      stack[depth++] = static_cast<std::int32_t>(n) + 1;
      continue;
    }
    for (std::int32_t k = node.first; k < node.end; ++k) {
      if (least_square(face, surface_.facet_box(tree.item(k))) > enough) continue;
      if (found < capacity) facets[found] = tree.item(k);
      ++found;
    }
  }
  std::sort(facets, facets + std::min(found, capacity));
  return found;
}

// ---- the closest facet ----------------------------------------------------------------------------------

// Collects the facets with the least bounds.
class Finder::Gathering {
 public:
  Gathering(const Surface& surface, Known& known) : surface_(surface), known_(known) {
    known.count = 0;
    known.outside = infinity;
  }

  // Facets are kept up to this distance.
  double reach() const {
    const double kept = closest_ + 2.0 * kept_reach * surface_.mean_edge();
    return known_.count < Known::most ? kept : std::min(kept, known_.lower[Known::most - 1]);
  }
  void leave_out(double lower) { known_.outside = std::min(known_.outside, lower); }

  void add(std::int32_t facet, Vec place) {
    const Surface::Slab& slab = surface_.slab(facet);
    closest_ = std::min(closest_, norm(place - slab.center));
    const double lower = norm(slab.beside(place));
    if (!(lower <= reach())) return leave_out(lower);
    if (known_.count == Known::most) leave_out(known_.lower[--known_.count]);
    std::size_t k = known_.count++;
    for (; k > 0 && known_.lower[k - 1] > lower; --k) {
      known_.lower[k] = known_.lower[k - 1];
      known_.facet[k] = known_.facet[k - 1];
    }
    known_.lower[k] = lower;
    known_.facet[k] = facet;
  }

 private:
  const Surface& surface_;
  Known& known_;
  double closest_ = infinity;
};

void Finder::look_around(Known& known, Vec place, std::int64_t& looked_at) const {
  known.at = place;
  known.fit = fit_;
  Gathering gathering(surface_, known);
  const Tree& tree = surface_.tree();
  struct Visit {
    std::int32_t node;
    double lower;
  };
  std::array<Visit, Tree::most_depth> stack;
  std::size_t depth = 0;
  const auto lower_of = [&](std::size_t n) {
    return std::sqrt(least_square(box_of(place), surface_.box(n)));
  };
  stack[depth++] = {0, lower_of(0)};
  while (depth > 0) {
    const Visit visit = stack[--depth];
    if (!(visit.lower <= gathering.reach())) {
      gathering.leave_out(visit.lower);
      continue;
    }
    const auto n = static_cast<std::size_t>(visit.node);
    const Tree::Node& node = tree[n];
    if (node.right == 0) {
      for (std::int32_t k = node.first; k < node.end; ++k) gathering.add(tree.item(k), place);
      looked_at += node.end - node.first;
      continue;
    }
    Visit closer{visit.node + 1, lower_of(n + 1)},
        farther{node.right, lower_of(static_cast<std::size_t>(node.right))};
    if (farther.lower < closer.lower) std::swap(closer, farther);
    stack[depth++] = farther;
    stack[depth++] = closer;
  }
}

// Of two at the same distance the first one.
void Finder::try_facet(std::int32_t facet, Vec p, Pair& best, std::int64_t& looked_at) const {
  ++looked_at;
  const Projection at = surface_.project_on(facet, p);
  if (!(at.distance < best.at.distance || (at.distance == best.at.distance && facet < best.facet))) return;
  best.at = at;
  best.facet = facet;
}

// Whether the closest facet is among the known ones.
bool Finder::try_known(const Known& known, std::size_t point, Pair& best, std::int64_t& looked_at) const {
  const double doubt = this->doubt(), moved = doubt + norm(seen_[point] - known.at);
  for (std::size_t k = 0; k < known.count; ++k) {
    if (known.lower[k] - moved > best.at.distance) break;
    if (square(surface_.slab(known.facet[k]).beside(seen_[point])) > square(best.at.distance + doubt))
      continue;
    try_facet(known.facet[k], now_[point], best, looked_at);
  }
  return best.at.distance < known.outside - moved;
}

void Finder::try_all(std::size_t point, Pair& best, std::int64_t& looked_at) const {
  const double doubt = this->doubt();
  const Tree& tree = surface_.tree();
  std::array<std::int32_t, Tree::most_depth> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const auto n = static_cast<std::size_t>(stack[--depth]);
    const Tree::Node& node = tree[n];
    if (std::sqrt(least_square(box_of(seen_[point]), surface_.box(n))) - doubt > best.at.distance) continue;
    if (node.right != 0) {
      stack[depth++] = node.right;
      stack[depth++] = static_cast<std::int32_t>(n) + 1;
      continue;
    }
    for (std::int32_t k = node.first; k < node.end; ++k)
      try_facet(tree.item(k), now_[point], best, looked_at);
  }
}

const Pair& Finder::pair_of(std::size_t point, std::int64_t& looked_at) {
  Pair& pair = pairs_found_[point];
  if (stamps_[point] == stamp_) return pair;
  stamps_[point] = stamp_;
  Known& known = known_[point];
  pair = {};
  bool is_found = known.fit == fit_ && try_known(known, point, pair, looked_at);
  if (!is_found) {
    look_around(known, seen_[point], looked_at);
    pair = {};
    is_found = try_known(known, point, pair, looked_at);
  }
  if (!is_found) try_all(point, pair, looked_at);
  if (pair.facet < 0) return pair;
  place_point(now_[point], pair);
  if (!pair.is_at_border && pair.beside > rounding_rim() && pair.along < 0.0)
    choose_facing(known, now_[point], pair, looked_at);
  return pair;
}

void Finder::place_point(Vec p, Pair& pair) const {
  const Vec from = p - pair.at.point;
  pair.along = dot(pair.at.normal, from);
  pair.beside = norm(from - pair.along * pair.at.normal);
  pair.is_at_border = surface_.is_at_border(pair.facet, pair.at);
}

// Where several facets meet in the closest point, one may turn its back to a point that is in front of the
// surface: the one that faces it most tells its side, of two that meet in an edge always.
void Finder::choose_facing(const Known& known, Vec p, Pair& pair, std::int64_t& looked_at) const {
  const double as_close = pair.at.distance + rounding_rim();
  for (std::size_t k = 0; k < known.count; ++k) {
    Pair other;
    try_facet(known.facet[k], p, other, looked_at);
    if (!(other.at.distance <= as_close)) continue;
    place_point(p, other);
    if (std::fabs(other.along) > std::fabs(pair.along)) pair = other;
  }
}

void Finder::read_counts(ilaw_facets_counts& counts) const {
  counts.updates = updates_;
  counts.refreshes = refreshes_;
  counts.refits = refits_;
  counts.pairs = pairs_.load(std::memory_order_relaxed);
  counts.facets = facets_.load(std::memory_order_relaxed);
  counts.shortest_edge = surface_.shortest_edge();
  counts.motion = motion_;
}

}  // namespace ilaw::search
