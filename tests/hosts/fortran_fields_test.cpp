// Fields, amounts and tables over axes from Fortran, against the table worked out here.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/matchers.hpp"

#include <ilaw/ilaw.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

extern "C" {
std::int32_t fortran_doubles(int way, int count, const double* v, const double* temperature, double* r,
                             double* heat, char* line);
std::int32_t fortran_floats(int count, const float* v, const float* temperature, float* r, float* heat,
                            char* line);
}

namespace {

using namespace ilaw::testing::matchers;
constexpr int count = 6;
constexpr double mass = 2.0, partition = 0.5;
enum way { right, no_field, no_amount, wrong_shape, wrong_pairs, by_number, other_kind, wrong_axis };

// Pairs (normal, tangential) velocity; temperatures stand in the second row of two.
template <class number>
struct nodes {
  std::array<number, 2 * count> v{-1, 2, -1, 3, -2, 9, -1, 5, -1.5, 2.5, -0.5, 4};
  std::array<number, 2 * count> temperature{0, 293, 0, 393, 0, 443, 0, 593, 0, 200, 0, 900};
  std::array<number, 2 * count> r{};
  std::array<number, count> heat{};
  std::string message;
  std::int32_t code = 0;
};

nodes<double> in_doubles(int way) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  nodes<double> made;
  char line[200];
  made.code = fortran_doubles(way, count, made.v.data(), made.temperature.data(), made.r.data(),
                              made.heat.data(), line);
  made.message = line;
  return made;
}

double between(double x, double low, double high, double at_low, double at_high) {
  const double part = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return at_low + part * (at_high - at_low);
}

// mu(speed, temperature): 0.6, 0.5, 0.4 at 0, 1, 4 m/s and 293 K, half of that at 593 K.
double friction(double speed, double temperature) {
  const double cold = speed < 1.0 ? between(speed, 0, 1, 0.6, 0.5) : between(speed, 1, 4, 0.5, 0.4);
  return cold * between(temperature, 293, 593, 1.0, 0.5);
}

void expect_law(const nodes<double>& found, const std::array<double, count>& temperature) {
  ASSERT_EQ(found.code, ILAW_OK) << found.message;
  for (std::size_t i = 0; i < count; ++i) {
    const double r_N = found.r[2 * i], r_T = found.r[2 * i + 1], v = found.v[2 * i + 1];
    const double slip = v + r_T / mass;
    EXPECT_NEAR(r_N, -mass * found.v[2 * i], 1e-15) << "node " << i;
    EXPECT_NEAR(r_T, -friction(slip, temperature[i]) * r_N, 1e-13) << "node " << i;
    EXPECT_NEAR(found.heat[i], -partition * r_T * (v + slip) / 2, 1e-13) << "node " << i;
  }
}

TEST(FortranFields, FrictionAndHeatFollowTheTable) {
  expect_law(in_doubles(right), {293, 393, 443, 593, 200, 900});
}

TEST(FortranFields, AFieldGivenAsANumberIsNotOffered) {
  expect_law(in_doubles(by_number), {443, 443, 443, 443, 443, 443});
}

TEST(FortranFields, FloatsAreTheDoublesRounded) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  nodes<float> found;
  char line[200];
  found.code = fortran_floats(count, found.v.data(), found.temperature.data(), found.r.data(),
                              found.heat.data(), line);
  ASSERT_EQ(found.code, ILAW_OK) << line;
  const nodes<double> wanted = in_doubles(right);
  for (std::size_t k = 0; k < 2 * count; ++k) EXPECT_EQ(found.r[k], static_cast<float>(wanted.r[k]));
  for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(found.heat[i], static_cast<float>(wanted.heat[i]));
}

struct refusal {
  int way;
  std::int32_t code;
  const char* message;
};

TEST(FortranFields, SaysWhatIsMissingOrWrong) {
  for (const refusal& wanted :
       {refusal{no_field, ILAW_INVALID_ARGUMENT, "reads 'temperature' per node"},
        refusal{no_amount, ILAW_UNSUPPORTED, "no amount 'wear'"},
        refusal{wrong_shape, ILAW_INVALID_PARAMETER,
                "parameter 'friction': a table has one value per point of its axis"},
        refusal{wrong_pairs, ILAW_INVALID_PARAMETER, "parameter 'friction': pairs (time, value)"},
        refusal{wrong_axis, ILAW_INVALID_PARAMETER, "'partition'"},
        refusal{other_kind, ILAW_INVALID_ARGUMENT, ""}}) {
    const nodes<double> found = in_doubles(wanted.way);
    EXPECT_EQ(found.code, wanted.code) << "way " << wanted.way << ": " << found.message;
    EXPECT_THAT(found.message, HasSubstr(wanted.message));
    EXPECT_EQ(found.r, (nodes<double>{}.r)) << "way " << wanted.way;
  }
}

}  // namespace
