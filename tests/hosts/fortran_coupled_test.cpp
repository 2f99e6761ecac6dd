// The Fortran module of coupled contacts: contacts with closed forms.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <ilaw/coupled.h>

#include <cstddef>
#include <cstdlib>
#include <vector>

extern "C" {
int fortran_column(int count, double slide, double mu, double* impulses, double* v, double* w,
                   double* residual);
}

namespace {

struct Column {
  int code;
  double residual;
  std::vector<double> impulses, v, w;
};

Column column(int count, double slide, double mu) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  const auto size = static_cast<std::size_t>(3 * count);
  Column made{0, 1.0, std::vector<double>(size), std::vector<double>(size), std::vector<double>(size)};
  made.code =
      fortran_column(count, slide, mu, made.impulses.data(), made.v.data(), made.w.data(), &made.residual);
  return made;
}

// Masses 1, 2, ..., n from the floor up: contact k carries the weight of k to n, and nothing moves.
TEST(FortranCoupled, AColumnStaysAndItsContactsCarryWhatIsAbove) {
  constexpr int count = 8;
  const Column at_rest = column(count, 0.0, 0.3);
  ASSERT_EQ(at_rest.code, ILAW_OK);
  EXPECT_LE(at_rest.residual, 1e-14);
  double above = 0.0;
  for (int k = count; k >= 1; --k) {
    const auto i = static_cast<std::size_t>(3 * (k - 1));
    above += k * 1e-2;  // m g h
    EXPECT_NEAR(at_rest.impulses[i + 2], above, 1e-11) << "contact " << k;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(at_rest.v[i + c], 0.0, 1e-13) << "sphere " << k;
      EXPECT_NEAR(at_rest.w[i + c], 0.0, 1e-13) << "sphere " << k;
    }
  }
}

// One sphere of mass 1 and radius 1/2 that slides: r_T = mu m g h against it, which also turns it by R r_T /
// J.
TEST(FortranCoupled, FrictionTurnsASphere) {
  const Column sliding = column(1, 2.0, 0.1);
  ASSERT_EQ(sliding.code, ILAW_OK);
  EXPECT_NEAR(sliding.impulses[0], -1e-3, 1e-16);
  EXPECT_NEAR(sliding.v[0], 2.0 - 1e-3, 1e-15);
  EXPECT_NEAR(sliding.w[1], 0.5 * 1e-3 / 0.1, 1e-15);
}

}  // namespace
