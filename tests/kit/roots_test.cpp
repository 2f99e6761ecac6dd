// Root finders and searches of the kit against roots that are known in closed form, in single numbers and in
// packs whose lanes end after different numbers of steps.
#include <ilaw/kit/pack.hpp>
#include <ilaw/kit/roots.hpp>

#include "support/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace {

using ilaw::kit::changes_sign_again;
using ilaw::kit::dips;
using ilaw::kit::last_part;
using ilaw::kit::newton_between;
using ilaw::kit::root_between;
using ilaw::kit::root_trial;
using ilaw::kit::value_and_slope;

// x^n = c in [0, 2]: x = c^(1/n), with the derivative or a slope of one for all.
double root_of_power(double n, double c, double start, bool is_exact) {
  return root_between(0.0, 2.0, start, true, [&](double x) {
    return root_trial<double>{std::pow(x, n) - c, 1.0, is_exact ? n * std::pow(x, n - 1.0) : 1.0, 1.0,
                              is_exact};
  });
}

TEST(RootBetween, FindsPowersFromAnyStart) {
  for (const double n : {1.0, 2.0, 3.5, 9.0})
    for (const double c : {1e-3, 0.3, 1.0, 1.7})
      for (const double start : {0.0, 1e-9, 0.5, 2.0})
        for (const bool is_exact : {true, false})
          EXPECT_NEAR(root_of_power(n, c, start, is_exact), std::pow(c, 1.0 / n), 1e-13)
              << n << ", " << c << ", " << start << ", " << is_exact;
}

TEST(RootBetween, KeepsItsStartWhereInactive) {
  const auto f = [](double x) { return root_trial<double>{x - 1.0, 1.0, 1.0, 1.0, true}; };
  EXPECT_EQ(root_between(0.0, 2.0, 0.25, false, f), 0.25);
  EXPECT_EQ(root_between(0.0, 2.0, 0.25, true, f), 1.0);
}

// A jump across zero is found by bisection alone: no slope tells of it.
TEST(RootBetween, FindsAJump) {
  for (const double at : {1e-3, 0.7, 1.999}) {
    const double found = root_between(0.0, 2.0, 1.0, true, [&](double x) {
      return root_trial<double>{x < at ? -1.0 : 1.0, 1.0, 1.0, 1.0, false};
    });
    EXPECT_NEAR(found, at, 4e-16 * at);
  }
}

// x^2 = 2 c^2, where squares of x underflow or overflow.
TEST(RootBetween, FindsRootsOfAnySize) {
  ilaw::testing::Random random(7);
  for (int k = 0; k < 200; ++k)
    for (const bool is_exact : {true, false}) {
      const double c = random.decades(-305.0, 200.0);
      const double found = root_between(0.0, 2.0 * c, 2.0 * c, true, [&](double x) {
        return root_trial<double>{x / c * (x / c) - 2.0, 2.0 / c, 2.0 * x / c, c, is_exact};
      });
      EXPECT_NEAR(found / c, std::sqrt(2.0), 1e-14) << c << ", " << is_exact;
    }
}

// NaN is no root; a start from which f is none, but not at other places, is left.
TEST(RootBetween, IsNoNumberWhereItsFunctionIsNone) {
  const auto none = [](double) { return root_trial<double>{std::nan(""), 1.0, 1.0, 1.0, true}; };
  EXPECT_TRUE(std::isnan(root_between(0.0, 2.0, 1.0, true, none)));
  EXPECT_EQ(root_between(0.0, 2.0, 1.0, false, none), 1.0);
  ilaw::testing::Random random(8);
  for (int k = 0; k < 200; ++k) {
    const double root = random(0.1, 1.9), end = random(root, 2.0);
    const auto beside = [&](double x) {
      return root_trial<double>{x > end ? std::nan("") : x - root, 1.0, 1.0, 1.0, true};
    };
    EXPECT_NEAR(root_between(0.0, 2.0, random(0.0, 2.0), true, beside), root, 1e-15) << end;
  }
}

// f is called last at the result, so what it keeps belongs to that.
TEST(RootBetween, CallsItsFunctionLastAtTheRoot) {
  double last = 0.0;
  const double found = root_between(0.0, 2.0, 2.0, true, [&](double x) {
    last = x;
    return root_trial<double>{x * x - 2.0, 1.0, 2.0 * x, 1.0, true};
  });
  EXPECT_EQ(found, last);
}

TEST(NewtonBetween, FindsARootWhereNewtonLeavesTheBracket) {
  // atan leaves any bracket from beyond 1.39 on; log is steep at its low end.
  for (const double root : {1.5, 3.0, 9.75}) {
    const auto bent = [&](double x) {
      return value_and_slope<double>{std::atan(10.0 * (x - root)),
                                     10.0 / (1.0 + 100.0 * (x - root) * (x - root))};
    };
    EXPECT_NEAR(newton_between(1.0, 10.0, true, bent), root, 1e-14 * root);
    const auto steep = [&](double x) { return value_and_slope<double>{std::log(x / root), 1.0 / x}; };
    EXPECT_NEAR(newton_between(1.0, 10.0, true, steep), root, 1e-14 * root);
  }
  EXPECT_EQ(newton_between(1.0, 10.0, false, [](double x) { return value_and_slope<double>{x, 1.0}; }), 10.0);
}

TEST(LastPart, IsTheLastNumberAtWhichItHolds) {
  for (const double end : {1e-12, 0.3, 0.75, 1.0 - 0x1p-53}) {
    const double found = last_part<double>(true, [&](double part) { return part <= end; });
    EXPECT_LE(found, end);
    EXPECT_GE(std::nextafter(found, 1.0), end);
  }
  EXPECT_EQ(last_part<double>(true, [](double part) { return part <= 0.0; }), 0.0);
  EXPECT_EQ(last_part<double>(false, [](double) { return true; }), 0.0);
}

// (x - m)^2 + depth: it is not positive where the depth is not.
TEST(Dips, SeesTheLeastValueOfAValley) {
  for (const double middle : {0.01, 0.37, 0.5, 0.99})
    for (const double depth : {-1e-3, -1e-10, 1e-10, 1e-3})
      EXPECT_EQ(dips(0.0, 1.0, [&](double x) { return (x - middle) * (x - middle) + depth; }), depth < 0.0)
          << middle << ", " << depth;
  EXPECT_TRUE(dips(0.0, 1.0, [](double) { return std::nan(""); }));
}

// Products of (x_k - x), positive at 0: with one root there is one change, with three there are more.
TEST(ChangesSignAgain, CountsRoots) {
  const auto has_more = [](const std::vector<double>& roots) {
    return changes_sign_again([&](double x) {
      double product = 1.0;
      for (const double root : roots) product *= root - x;
      return product;
    });
  };
  for (const double root : {1e-4, 0.2, 0.5, 0.9}) EXPECT_FALSE(has_more({root})) << root;
  EXPECT_TRUE(has_more({0.1, 0.4, 0.8}));
  EXPECT_TRUE(has_more({0.9, 0.3, 0.3005}));
  EXPECT_TRUE(has_more({1e-3, 0.7, 0.70001}));
}

// Each lane of a pack gets the number that it gets alone, whatever its neighbours do.
TEST(RootsInPacks, AreThoseOfEachLane) {
  using pack = ilaw::kit::pack_of<2>;
  constexpr std::size_t lanes = pack::size;
  std::array<double, lanes> squares{}, found{}, alone{};
  for (std::size_t k = 0; k < lanes; ++k) squares[k] = std::array{1e-9, 3.999, 1.0, 0.25, 1e-3, 1.5}[k % 6];
  pack c;
  __builtin_memcpy(static_cast<void*>(&c), squares.data(), sizeof c);
  const pack root = root_between(pack(0.0), pack(2.0), pack(1.0), pack(0.0) == pack(0.0), [&](pack x) {
    return root_trial<pack>{x * x - c, 1.0, 2.0 * x, 1.0, pack(0.0) == pack(0.0)};
  });
  __builtin_memcpy(found.data(), &root, sizeof root);
  for (std::size_t k = 0; k < lanes; ++k) {
    alone[k] = root_between(0.0, 2.0, 1.0, true, [&](double x) {
      return root_trial<double>{x * x - squares[k], 1.0, 2.0 * x, 1.0, true};
    });
    EXPECT_EQ(found[k], alone[k]) << k;
  }
  const pack part = last_part<pack>(pack(0.0) == pack(0.0), [&](pack x) { return x * x <= 0.2 * c; });
  __builtin_memcpy(found.data(), &part, sizeof part);
  for (std::size_t k = 0; k < lanes; ++k)
    EXPECT_EQ(found[k], last_part<double>(true, [&](double x) { return x * x <= 0.2 * squares[k]; })) << k;
}

}  // namespace
