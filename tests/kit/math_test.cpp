#include <ilaw/kit/math.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using ilaw::kit::exp;
using ilaw::kit::infinity;
using ilaw::kit::length;

// The long double function of libm, rounded, is the reference.
TEST(Exp, IsWithinOneUlp) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-745.0, 709.7);
  for (int i = 0; i < 200000; ++i) {
    const double x = i % 2 ? uniform(random) : uniform(random) * 1e-3;
    const auto expected = static_cast<double>(std::exp(static_cast<long double>(x)));
    const double ulp = std::nextafter(expected, infinity) - expected;
    EXPECT_LE(std::abs(exp(x) - expected), ulp) << x;
  }
}

TEST(Exp, HasItsLimits) {
  EXPECT_EQ(exp(0.0), 1.0);
  EXPECT_EQ(exp(-infinity), 0.0);
  EXPECT_EQ(exp(-800.0), 0.0);
  EXPECT_EQ(exp(infinity), infinity);
  EXPECT_TRUE(std::isnan(exp(std::nan(""))));
}

TEST(Length, NeitherOverflowsNorUnderflows) {
  for (const double scale : {1e-320, 1e-300, 1e-160, 1.0, 1e160, 1e300})
    EXPECT_NEAR(length(3.0 * scale, 4.0 * scale) / (5.0 * scale), 1.0, scale < 1e-310 ? 1e-2 : 4e-16);
  EXPECT_EQ(length(0.0, 0.0), 0.0);
  EXPECT_EQ(length(0.0, -2.0), 2.0);
}

}  // namespace
