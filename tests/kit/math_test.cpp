#include <ilaw/kit/math.hpp>
#include <ilaw/kit/pack.hpp>

#include "support/matchers.hpp"
#include "support/random.hpp"

#include <bit>
#include <cstring>

namespace {

using ilaw::kit::exp;
using ilaw::kit::exp_minus_one;
using ilaw::kit::infinity;
using ilaw::kit::length;
using ilaw::kit::log;
using ilaw::kit::log_one_plus;
using ilaw::kit::power;
using ilaw::testing::Random;

// The long double function of libm, rounded, is the reference.
TEST(Exp, IsWithinOneUlp) {
  Random random(3);
  for (int i = 0; i < 200000; ++i) {
    const double x = i % 2 ? random(-745.0, 709.7) : random(-745.0, 709.7) * 1e-3;
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

TEST(Log, IsWithinOneUlp) {
  Random random(4);
  for (int i = 0; i < 200000; ++i) {
    const double x = i % 2 ? std::exp2(random(-1074.0, 1024.0)) : random(0.5, 2.0);
    const auto expected = static_cast<double>(std::log(static_cast<long double>(x)));
    const double ulp = std::nextafter(std::abs(expected), infinity) - std::abs(expected);
    EXPECT_LE(std::abs(log(x) - expected), ulp) << x;
  }
}

TEST(Log, HasItsLimits) {
  EXPECT_EQ(log(1.0), 0.0);
  EXPECT_EQ(log(0.0), -infinity);
  EXPECT_EQ(log(infinity), infinity);
  EXPECT_TRUE(std::isnan(log(-1.0)));
  EXPECT_TRUE(std::isnan(log(std::nan(""))));
}

// Relatively, however small they are.
TEST(ExpMinusOne, IsWithinTwoUlpBelowZero) {
  Random random(7);
  for (int i = 0; i < 200000; ++i) {
    const double x = i % 2 ? -std::exp2(random(-300.0, 9.6)) : -random(0.3, 1.5);
    const auto expected = static_cast<double>(std::expm1(static_cast<long double>(x)));
    const double ulp = std::nextafter(std::abs(expected), infinity) - std::abs(expected);
    EXPECT_LE(std::abs(exp_minus_one(x) - expected), 2.0 * ulp) << x;
  }
  EXPECT_EQ(exp_minus_one(0.0), 0.0);
  EXPECT_EQ(exp_minus_one(-infinity), -1.0);
}

TEST(LogOnePlus, IsWithinTwoUlp) {
  Random random(8);
  for (int i = 0; i < 200000; ++i) {
    const double size = std::exp2(random(-300.0, 0.0)), x = i % 2 ? -0.5 * size : size;
    const auto expected = static_cast<double>(std::log1p(static_cast<long double>(x)));
    const double ulp = std::nextafter(std::abs(expected), infinity) - std::abs(expected);
    EXPECT_LE(std::abs(log_one_plus(x) - expected), 2.0 * ulp) << x;
  }
  EXPECT_EQ(log_one_plus(0.0), 0.0);
}

TEST(Packs, GiveTheBitsOfADouble) {
  using ilaw::kit::pack;
  Random random(6);
  const double special[] = {0.0, -0.0, infinity, -infinity, std::nan(""), 1e-310, 5e-324, -1.0};
  // One NaN is like another: its sign is the compiler's choice.
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(std::isnan(x) ? std::nan("") : x); };
  for (int i = 0; i < 20000; ++i) {
    double x[pack::size];
    for (double& one : x)
      one = i < 8 ? special[i] : i % 2 ? random(-760.0, 720.0) : exp(random(-760.0, 720.0));
    pack all;
    std::memcpy(static_cast<void*>(&all), x, sizeof x);
    const pack exps = exp(all), logs = log(all), minus_one = exp_minus_one(all), one_plus = log_one_plus(all);
    for (int lane = 0; lane < pack::size; ++lane) {
      ASSERT_EQ(bits(exps[lane]), bits(exp(x[lane]))) << "seed 6, x = " << x[lane];
      ASSERT_EQ(bits(logs[lane]), bits(log(x[lane]))) << "seed 6, x = " << x[lane];
      ASSERT_EQ(bits(minus_one[lane]), bits(exp_minus_one(x[lane]))) << "seed 6, x = " << x[lane];
      ASSERT_EQ(bits(one_plus[lane]), bits(log_one_plus(x[lane]))) << "seed 6, x = " << x[lane];
    }
  }
}

// The relative error of exp is the absolute one of y ln x, of which half an ulp is lost.
TEST(Power, IsAsAccurateAsItSays) {
  Random random(5);
  for (int i = 0; i < 200000; ++i) {
    const double x = std::exp2(random(-200.0, 200.0)), y = i % 4 ? random(0.1, 4.0) : 0.5 * (i % 16 / 4 + 1);
    const auto expected =
        static_cast<double>(std::pow(static_cast<long double>(x), static_cast<long double>(y)));
    EXPECT_LE(std::abs(power(x, y) / expected - 1.0), 2.3e-16 * (1.0 + std::abs(y * std::log(x))))
        << x << " " << y;
  }
}

TEST(Power, HasItsLimits) {
  EXPECT_EQ(power(0.0, 1.5), 0.0);
  EXPECT_EQ(power(0.0, 2.7), 0.0);
  EXPECT_EQ(power(1.0, 2.7), 1.0);
  EXPECT_EQ(power(4.0, 1.5), 8.0);
  EXPECT_EQ(power(infinity, 2.7), infinity);
}

TEST(Length, NeitherOverflowsNorUnderflows) {
  for (const double scale : {1e-320, 1e-300, 1e-160, 1.0, 1e160, 1e300})
    EXPECT_NEAR(length(3.0 * scale, 4.0 * scale) / (5.0 * scale), 1.0, scale < 1e-310 ? 1e-2 : 4e-16)
        << "scale " << scale;
  EXPECT_EQ(length(0.0, 0.0), 0.0);
  EXPECT_EQ(length(0.0, -2.0), 2.0);
}

}  // namespace
