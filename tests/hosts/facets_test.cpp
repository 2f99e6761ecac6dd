// What the search of facets (ilaw/search.h) allocates: nothing but when it is made. python/test_search.py has
// what it finds.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/random.hpp"

#include <ilaw/search.h>
#include <ilaw/arrays.hpp>

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
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

// Points that move over and through a wavy surface of 6 x 6 facets.
TEST(Facets, AllocateNothingOnceMade) {
  constexpr std::int32_t side = 7, count = 100;
  Random draw(36);
  std::vector<Point> position;
  std::vector<std::array<std::int32_t, 4>> facets;
  std::vector<std::int32_t> points;
  for (std::int32_t k = 0; k < side * side; ++k) {
    const std::int32_t i = k % side, j = k / side;
    position.push_back({i + draw(-0.2, 0.2), j + draw(-0.2, 0.2), 0.5 * std::sin(1.3 * i) * std::cos(j)});
    if (i + 1 < side && j + 1 < side) facets.push_back({k, k + 1, k + side + 1, k + side});
  }
  for (std::int32_t k = 0; k < count; ++k) {
    points.push_back(side * side + k);
    position.push_back({draw(-2.0, 8.0), draw(-2.0, 8.0), draw(-0.5, 1.0)});
  }
  ilaw_facets_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.corner_count = 4;
  setup.node_count = side * side + count;
  setup.facet_count = static_cast<std::int64_t>(facets.size());
  setup.facets = facets.front().data();
  setup.point_count = count;
  setup.points = points.data();
  setup.position = ilaw::input(position.front().data(), 3, 1);
  ilaw_facets* search = nullptr;
  ASSERT_EQ(ilaw_facets_create(&setup, &search), ILAW_OK);

  std::vector<std::int32_t> facet(count), place(count);
  std::vector<double> gap(count), normal(3 * count), weights(4 * count), approach(count);
  ilaw_facets_pairs_of asked{};
  asked.struct_size = sizeof asked;
  asked.facet = facet.data(), asked.place = place.data();
  asked.gap = ilaw::output(gap.data(), 1, 1);
  asked.normal = ilaw::output(normal.data(), 3, 1);
  asked.weights = ilaw::output(weights.data(), 4, 1);
  asked.approach = ilaw::output(approach.data(), 1, 1);
  ilaw_facets_positions now{};
  now.struct_size = sizeof now;
  now.position = setup.position;
  ilaw_facets_nearby nearby{};
  nearby.struct_size = sizeof nearby;
  nearby.reach = 0.1;
  std::int64_t found = 0;
  const long before = allocations;
  for (int step = 0; step < 100; ++step) {
    const double size = step % 7 == 0 ? 0.2 : 0.01;
    for (Point& x : position)
      for (double& component : x) component += size * draw(-1.0, 1.0);
    EXPECT_EQ(ilaw_facets_update(search, &now), ILAW_OK);
    EXPECT_EQ(ilaw_facets_near(search, &nearby), ILAW_OK);
    asked.count = nearby.count;
    asked.points = nearby.points;
    EXPECT_EQ(ilaw_facets_pairs(search, &asked), ILAW_OK);
    found += nearby.count;
  }
  EXPECT_EQ(allocations - before, 0);
  ilaw_facets_counts counts{};
  counts.struct_size = sizeof counts;
  EXPECT_EQ(ilaw_facets_count(search, &counts), ILAW_OK);
  EXPECT_GT(counts.refits, 10);
  EXPECT_GT(found, 1000);
  ilaw_facets_destroy(search);
}

}  // namespace
