// The closest facets of points (ilaw/search.h): lists of points, how many facets are looked at, segments,
// overlaps and calls. python/test_search.py has which facet is found.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/random.hpp"

#include <ilaw/search.h>
#include <ilaw/arrays.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <thread>
#include <vector>

namespace {

std::atomic<long> allocations{0};

void* allocate(std::size_t size) {
  ++allocations;
  if (void* made = std::malloc(size)) return made;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
void operator delete(void* room) noexcept { std::free(room); }
void operator delete[](void* room) noexcept { std::free(room); }
void operator delete(void* room, std::size_t) noexcept { std::free(room); }
void operator delete[](void* room, std::size_t) noexcept { std::free(room); }

namespace {

using ilaw::testing::Random;
using Point = std::array<double, 3>;

Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point operator*(double s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }

struct Pairs {
  std::vector<std::int32_t> facet, place;
  std::vector<double> gap, normal, weights, approach;
};

// Nodes of a model, facets and points among them, and their search.
class Searched {
 public:
  std::vector<Point> start, now;
  std::vector<std::array<std::int32_t, 4>> facets;
  std::vector<std::int32_t> points;
  double rim = 0.0;

  void open() {
    ilaw_facets_setup setup{};
    setup.struct_size = sizeof setup;
    setup.dimension = 3;
    setup.corner_count = 4;
    setup.node_count = static_cast<std::int64_t>(start.size());
    setup.facet_count = static_cast<std::int64_t>(facets.size());
    setup.facets = facets.front().data();
    setup.point_count = static_cast<std::int64_t>(points.size());
    setup.points = points.data();
    setup.position = ilaw::input(start.front().data(), 3, 1);
    ilaw_facets* made = nullptr;
    ASSERT_EQ(ilaw_facets_create(&setup, &made), ILAW_OK);
    search.reset(made);
    now = start;
    update();
  }
  void update() {
    ilaw_facets_positions positions{};
    positions.struct_size = sizeof positions;
    positions.position = ilaw::input(now.front().data(), 3, 1);
    ASSERT_EQ(ilaw_facets_update(search.get(), &positions), ILAW_OK);
  }
  ilaw_facets_nearby near(double reach, bool anew = false) {
    ilaw_facets_nearby nearby{};
    nearby.struct_size = sizeof nearby;
    nearby.forced = anew ? 1 : 0;
    nearby.reach = reach;
    EXPECT_EQ(ilaw_facets_near(search.get(), &nearby), ILAW_OK);
    return nearby;
  }
  void find(Pairs& found, const std::int32_t* which, std::int64_t count, std::int64_t first = 0) {
    ilaw_facets_pairs_of asked{};
    asked.struct_size = sizeof asked;
    asked.count = count;
    asked.points = which;
    asked.rim = ilaw::input(&rim, 0, 0);
    asked.facet = found.facet.data() + first;
    asked.place = found.place.data() + first;
    asked.gap = ilaw::output(found.gap.data() + first, 1, 1);
    asked.normal = ilaw::output(found.normal.data() + 3 * first, 3, 1);
    asked.weights = ilaw::output(found.weights.data() + 4 * first, 4, 1);
    asked.approach = ilaw::output(found.approach.data() + first, 1, 1);
    EXPECT_EQ(ilaw_facets_pairs(search.get(), &asked), ILAW_OK);
  }
  Pairs room() const {
    const std::size_t n = points.size();
    return {std::vector<std::int32_t>(n), std::vector<std::int32_t>(n), std::vector<double>(n),
            std::vector<double>(3 * n),   std::vector<double>(4 * n),   std::vector<double>(n)};
  }
  Pairs all() {
    Pairs found = room();
    find(found, nullptr, static_cast<std::int64_t>(points.size()));
    return found;
  }
  ilaw_facets_counts counts() const {
    ilaw_facets_counts counts{};
    counts.struct_size = sizeof counts;
    EXPECT_EQ(ilaw_facets_count(search.get(), &counts), ILAW_OK);
    return counts;
  }

 private:
  struct Destroy {
    void operator()(ilaw_facets* search) const { ilaw_facets_destroy(search); }
  };

 public:
  std::unique_ptr<ilaw_facets, Destroy> search;
};

// A face of n x n facets with edges of 1, some of them halved into triangles, and place(x, y).
template <class Place>
Searched face(int n, bool has_triangles, Place place) {
  Searched made;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) made.start.push_back(place(i, j));
  for (std::int32_t j = 0; j < n; ++j)
    for (std::int32_t i = 0; i < n; ++i) {
      const std::int32_t a = j * (n + 1) + i, b = a + 1, c = b + n + 1, d = c - 1;
      if (has_triangles && (i + j) % 3 == 0) {
        made.facets.push_back({a, b, c, c});
        made.facets.push_back({a, c, d, d});
      } else {
        made.facets.push_back({a, b, c, d});
      }
    }
  return made;
}

void add_point(Searched& to, const Point& x) {
  to.points.push_back(static_cast<std::int32_t>(to.start.size()));
  to.start.push_back(x);
}

// Two plates of n x n facets with edges of 1: nodes of the upper one above the facets of the lower one.
Searched plates(int n, double gap, double aside) {
  Searched made = face(n, false, [](int i, int j) { return Point{double(i), double(j), 0.0}; });
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) add_point(made, {i + aside, j + aside, gap});
  made.open();
  return made;
}

Searched wavy(Random& draw, int points, double height, double wave = 0.5) {
  Searched made = face(6, true, [&](int i, int j) {
    return Point{i + draw(-0.2, 0.2), j + draw(-0.2, 0.2),
                 wave * (std::sin(1.3 * i) * std::cos(j) + draw(-0.2, 0.2))};
  });
  for (int k = 0; k < points; ++k)
    add_point(made, {draw(-2.0, 8.0), draw(-2.0, 8.0), draw(-0.5 * height, height)});
  made.open();
  return made;
}

void shake(Searched& all, Random& draw, double size) {
  for (Point& x : all.now) x = x + size * Point{draw(-1.0, 1.0), draw(-1.0, 1.0), draw(-1.0, 1.0)};
}

// ---- lists ----------------------------------------------------------------------------------------------

// Motions of all sizes: whoever has come within reach is in the list.
TEST(Facets, NearListsLeaveNobodyOut) {
  Random draw(34);
  std::int64_t left_out = 0, kept = 0;
  for (int scene = 0; scene < 12; ++scene) {
    Searched all = wavy(draw, 40, 1.0, 0.01);
    for (int k = 0; k < 40; ++k) add_point(all, {draw(2.0, 4.0), draw(2.0, 4.0), draw(1.5, 2.5)});
    all.open();
    const double size = draw.decades(-4.0, -2.0), reach = draw.decades(-3.0, -0.5);
    for (int step = 0; step < 60; ++step) {
      const Point common{draw(-1.0, 1.0), draw(-1.0, 1.0), draw(-1.0, 1.0)};
      for (Point& x : all.now) x = x + common;
      if (scene % 2 == 0) shake(all, draw, size);
      for (const std::int32_t point : all.points)
        all.now[static_cast<std::size_t>(point)][2] -= step < 45 ? 0.05 : -0.04;
      all.update();
      const ilaw_facets_nearby nearby = all.near(reach);
      kept += nearby.is_new == 0 ? 1 : 0;
      std::vector<bool> is_near(all.points.size());
      for (std::int64_t i = 0; i < nearby.count; ++i)
        is_near[static_cast<std::size_t>(nearby.points[i])] = true;
      const Pairs found = all.all();
      for (std::size_t k = 0; k < is_near.size(); ++k) {
        EXPECT_TRUE(is_near[k] || found.gap[k] > reach) << found.gap[k];
        EXPECT_TRUE(is_near[k] || nearby.is_new == 0 || found.gap[k] > nearby.horizon) << found.gap[k];
        left_out += is_near[k] ? 0 : 1;
      }
    }
  }
  EXPECT_GT(left_out, 100);
  EXPECT_GT(kept, 100);
}

// Two plates that fly and turn together, a thousand edges far: one list serves.
TEST(Facets, ACommonMotionCostsNothing) {
  Searched all = plates(10, 0.4, 0.3);
  (void)all.near(0.01);
  for (int step = 1; step <= 100; ++step) {
    const double angle = 0.05 * step, c = std::cos(angle), s = std::sin(angle);
    for (std::size_t k = 0; k < all.now.size(); ++k) {
      const Point x = all.start[k];
      all.now[k] = {c * x[0] - s * x[2] + 10.0 * step, x[1], s * x[0] + c * x[2] - 3.0 * step};
    }
    all.update();
    const ilaw_facets_nearby nearby = all.near(0.01);
    EXPECT_EQ(nearby.count, 0);
    EXPECT_GT(nearby.slack, 0.002);  // less than the distance: the plate below could turn its back
  }
  EXPECT_EQ(all.counts().updates, 101);
  EXPECT_EQ(all.counts().refreshes, 1);
  EXPECT_EQ(all.counts().refits, 0);
  EXPECT_EQ(all.counts().facets, 0);
  EXPECT_NEAR(all.counts().motion, 0.0, 1e-9);
  EXPECT_GT(all.counts().shortest_edge, 0.0);
  EXPECT_EQ(all.near(0.01, true).is_new, 1U) << "asked for anew";
  EXPECT_EQ(all.counts().refreshes, 2);
}

// ---- what it costs --------------------------------------------------------------------------------------

// Facets that are looked at per point and step.
double cost(int n, double gap, double speed) {
  constexpr int steps = 40;
  constexpr double tremor = 1e-3;
  Random draw(35);
  Searched all = plates(n, gap, 0.3);
  Pairs found = all.room();
  for (int step = 0; step < steps; ++step) {
    for (const std::int32_t point : all.points) all.now[static_cast<std::size_t>(point)][0] += speed;
    std::vector<Point> still = all.now;
    shake(all, draw, tremor);
    all.update();
    const ilaw_facets_nearby nearby = all.near(2.0 * (speed + 2.0 * tremor));
    all.find(found, nearby.points, nearby.count);
    all.now = still;
  }
  return static_cast<double>(all.counts().facets) / (steps * static_cast<double>(all.points.size()));
}

TEST(Facets, CostIsTheSamePerPointOnAnyMesh) {
  EXPECT_EQ(cost(20, 0.4, 0.0), 0.0);
  EXPECT_EQ(cost(80, 0.4, 0.0), 0.0);
  EXPECT_EQ(cost(80, 0.4, 0.03), 0.0);
  for (const double speed : {0.0, 0.03}) {
    const double coarse = cost(20, 0.0, speed), finer = cost(40, 0.0, speed), fine = cost(80, 0.0, speed);
    EXPECT_LT(finer, 1.15 * coarse);
    EXPECT_LT(fine, 1.15 * coarse);
    EXPECT_LT(fine, 4.0) << speed;
    EXPECT_GT(coarse, 0.9) << speed;
    RecordProperty(speed == 0.0 ? "resting" : "sliding", std::to_string(fine));
  }
}

TEST(Facets, AllocateNothingOnceMade) {
  Random draw(36);
  Searched all = wavy(draw, 100, 1.0);
  Pairs found = all.room();
  const long before = allocations;
  for (int step = 0; step < 100; ++step) {
    shake(all, draw, step % 7 == 0 ? 0.2 : 0.01);
    all.update();
    const ilaw_facets_nearby nearby = all.near(0.1);
    all.find(found, nearby.points, nearby.count);
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GT(all.counts().refits, 10);
}

// The same bits and the same counts, by one thread or four.
TEST(Facets, ThreadsChangeNoBit) {
  Pairs found[2];
  std::int64_t looked_at[2];
  for (const int threads : {1, 4}) {
    Random draw(37);
    Searched all = wavy(draw, 400, 1.0);
    const std::size_t which = threads == 1 ? 0 : 1;
    found[which] = all.room();
    std::vector<std::int32_t> numbers(400);
    for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = static_cast<std::int32_t>(k);
    for (int step = 0; step < 20; ++step) {
      shake(all, draw, 0.02);
      all.update();
      std::vector<std::thread> team;
      const std::int64_t share = 400 / threads;
      for (std::int64_t t = 0; t < threads; ++t)
        team.emplace_back([&, t] { all.find(found[which], numbers.data() + t * share, share, t * share); });
      for (std::thread& one : team) one.join();
    }
    looked_at[which] = all.counts().facets;
  }
  EXPECT_EQ(found[0].facet, found[1].facet);
  EXPECT_EQ(found[0].gap, found[1].gap);
  EXPECT_EQ(found[0].normal, found[1].normal);
  EXPECT_EQ(found[0].weights, found[1].weights);
  EXPECT_EQ(looked_at[0], looked_at[1]);
}

// ---- in the plane, and calls ----------------------------------------------------------------------------

// An outline of three segments, in numbers of Fortran and floats: points to the right of the way along them.
TEST(Facets, AreSegmentsInThePlane) {
  const float position[] = {0, 0, -1, 0, -2, 0, -2, -1, -0.5F, 0.25F, -1.0F, 0.5F, -2.25F, 0.25F, 0.5F, 0.0F};
  const std::int32_t facets[] = {1, 2, 2, 3, 3, 4}, points[] = {5, 6, 7, 8};
  ilaw_facets_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = setup.corner_count = 2;
  setup.index_base = 1;
  setup.node_count = 8;
  setup.facet_count = 3;
  setup.facets = facets;
  setup.point_count = 4;
  setup.points = points;
  setup.position = ilaw::input(position, 2, 1);
  ilaw_facets* search = nullptr;
  ASSERT_EQ(ilaw_facets_create(&setup, &search), ILAW_OK);
  ilaw_facets_positions positions{};
  positions.struct_size = sizeof positions;
  positions.position = setup.position;
  ASSERT_EQ(ilaw_facets_update(search, &positions), ILAW_OK);
  std::array<std::int32_t, 4> facet{}, place{};
  std::array<double, 4> gap{};
  std::array<double, 8> normal{}, weights{};
  ilaw_facets_pairs_of asked{};
  asked.struct_size = sizeof asked;
  asked.count = 4;
  asked.facet = facet.data();
  asked.place = place.data();
  asked.gap = ilaw::output(gap.data(), 1, 1);
  asked.normal = ilaw::output(normal.data(), 2, 1);
  asked.weights = ilaw::output(weights.data(), 2, 1);
  ASSERT_EQ(ilaw_facets_pairs(search, &asked), ILAW_OK);
  ilaw_facets_destroy(search);
  EXPECT_EQ(facet, (std::array<std::int32_t, 4>{0, 0, 1, 0}));
  EXPECT_EQ(place, (std::array<std::int32_t, 4>{ILAW_PLACE_OVER, ILAW_PLACE_OVER, ILAW_PLACE_BESIDE,
                                                ILAW_PLACE_BEYOND}));
  EXPECT_EQ(gap, (std::array<double, 4>{0.25, 0.5, std::hypot(0.25, 0.25), 0.5}));
  EXPECT_EQ(weights, (std::array<double, 8>{0.5, 0.5, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0}));
  EXPECT_EQ(normal, (std::array<double, 8>{0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0}));
}

// Faces of four points each, while the points sink through the facets and slide over them: no facet whose
// corners come close is missing, and few others are there.
TEST(Facets, FindThoseThatAFaceOverlaps) {
  Searched plate = plates(12, 0.3, 0.0);
  const std::size_t side = 13;
  std::vector<std::int32_t> faces;
  for (std::size_t j = 0; j + 1 < side; ++j)
    for (std::size_t i = 0; i + 1 < side; ++i)
      for (const std::size_t k : {j * side + i, j * side + i + 1, (j + 1) * side + i + 1, (j + 1) * side + i})
        faces.push_back(static_cast<std::int32_t>(k));
  ASSERT_EQ(plate.points.size(), side * side);
  std::vector<std::int64_t> first(faces.size() / 4 + 1);
  std::vector<std::int32_t> found(1);
  ilaw_facets_overlaps_of asked{};
  asked.struct_size = sizeof asked;
  asked.corner_count = 4;
  asked.count = static_cast<std::int64_t>(faces.size() / 4);
  asked.points = faces.data();
  asked.distance = 0.05;
  asked.first = first.data();
  const auto low_and_high = [&](const auto& nodes, std::size_t c) {
    double low = 1e9, high = -1e9;
    for (const std::int32_t node : nodes) {
      low = std::min(low, plate.now[static_cast<std::size_t>(node)][c]);
      high = std::max(high, plate.now[static_cast<std::size_t>(node)][c]);
    }
    return std::array{low, high};
  };
  for (int step = 0; step < 20; ++step) {
    for (const std::int32_t node : plate.points)
      plate.now[static_cast<std::size_t>(node)] =
          plate.now[static_cast<std::size_t>(node)] + Point{0.013, 0.007, -0.03};
    plate.update();
    asked.capacity = static_cast<std::int64_t>(found.size());
    asked.facets = found.data();
    ASSERT_EQ(ilaw_facets_overlaps(plate.search.get(), &asked), ILAW_OK);
    found.resize(std::max(found.size(), static_cast<std::size_t>(first.back())));
    asked.capacity = static_cast<std::int64_t>(found.size());
    asked.facets = found.data();
    ASSERT_EQ(ilaw_facets_overlaps(plate.search.get(), &asked), ILAW_OK);
    ASSERT_LE(first.back(), asked.capacity);
    std::int64_t close = 0;
    for (std::size_t f = 0; f + 1 < first.size(); ++f) {
      std::array<std::int32_t, 4> face;
      for (std::size_t k = 0; k < 4; ++k) face[k] = plate.points[static_cast<std::size_t>(faces[4 * f + k])];
      const auto begin = found.begin() + first[f], end = found.begin() + first[f + 1];
      for (std::size_t m = 0; m < plate.facets.size(); ++m) {
        double square = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
          const auto [low, high] = low_and_high(face, c);
          const auto [other_low, other_high] = low_and_high(plate.facets[m], c);
          square += std::pow(std::max({low - other_high, other_low - high, 0.0}), 2);
        }
        if (square > 0.05 * 0.05) continue;
        ++close;
        EXPECT_TRUE(std::binary_search(begin, end, static_cast<std::int32_t>(m))) << f << ' ' << m;
      }
    }
    EXPECT_LE(first.back(), 3 * close + 20);  // boxes lie along the axes of the surface
  }
  asked.capacity = -1;
  EXPECT_EQ(ilaw_facets_overlaps(plate.search.get(), &asked), ILAW_INVALID_ARGUMENT);
  asked.capacity = 0;
  faces[0] = static_cast<std::int32_t>(plate.points.size());
  EXPECT_EQ(ilaw_facets_overlaps(plate.search.get(), &asked), ILAW_INVALID_ARGUMENT);
}

TEST(Facets, RefuseWrongCalls) {
  const Searched right = plates(2, 0.0, 0.0);
  ilaw_facets_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.corner_count = 4;
  setup.node_count = static_cast<std::int64_t>(right.start.size());
  setup.facet_count = static_cast<std::int64_t>(right.facets.size());
  setup.facets = right.facets.front().data();
  setup.point_count = static_cast<std::int64_t>(right.points.size());
  setup.points = right.points.data();
  setup.position = ilaw::input(right.start.front().data(), 3, 1);
  const auto refused = [&](auto change) {
    ilaw_facets_setup wrong = setup;
    change(wrong);
    ilaw_facets* made = right.search.get();
    const bool is_refused = ilaw_facets_create(&wrong, &made) == ILAW_INVALID_ARGUMENT && !made;
    ilaw_facets_destroy(made == right.search.get() ? nullptr : made);
    return is_refused;
  };
  EXPECT_FALSE(refused([](ilaw_facets_setup&) {}));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.struct_size = 8; }));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.dimension = 1; }));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.dimension = 2; }));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.corner_count = 5; }));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.facet_count = 0; }));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.facets = nullptr; }));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.index_base = 1; }));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.node_count -= 1; }));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.point_count = -1; }));
  EXPECT_TRUE(refused([](ilaw_facets_setup& s) { s.position = {}; }));
  EXPECT_EQ(ilaw_facets_create(&setup, nullptr), ILAW_INVALID_ARGUMENT);
  EXPECT_EQ(ilaw_facets_update(right.search.get(), nullptr), ILAW_INVALID_ARGUMENT);
  ilaw_facets_nearby nearby{};
  nearby.struct_size = sizeof nearby;
  nearby.reach = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ilaw_facets_near(right.search.get(), &nearby), ILAW_INVALID_ARGUMENT);
  const std::int32_t outside = static_cast<std::int32_t>(right.points.size());
  ilaw_facets_pairs_of asked{};
  asked.struct_size = sizeof asked;
  asked.count = 1;
  asked.points = &outside;
  EXPECT_EQ(ilaw_facets_pairs(right.search.get(), &asked), ILAW_INVALID_ARGUMENT);
}

}  // namespace
