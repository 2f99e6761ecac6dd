// The motion before a bond counts in part where it would put energy in.
#include "laws/random_nodes.hpp"

namespace ilaw::testing {
namespace {

constexpr std::size_t count = 200;

double decades(Random& draw, double low, double high) { return std::pow(10.0, draw(low, high)); }

// Each entry beside the diagonal up to 0.9 of what it may be.
void couple(Matrix& m, std::size_t dimension, Random& draw) {
  double c[3] = {}, determinant = 0.0;
  while (determinant < 0.01) {
    for (double& each : c) each = draw(-0.9, 0.9);
    if (dimension == 2) c[1] = c[2] = 0.0;
    determinant = 1.0 - c[0] * c[0] - c[1] * c[1] - c[2] * c[2] + 2.0 * c[0] * c[1] * c[2];
  }
  for (const auto [i, j, k] : {std::array<std::size_t, 3>{0, 1, 0}, {0, 2, 1}, {1, 2, 2}})
    m[i][j] = m[j][i] = c[k] * std::sqrt(m[i][i] * m[j][j]);
}

void draw_nodes(RandomNodes& nodes, Runner& run) {
  Random& draw = nodes.uniform;
  nodes.draw();
  run.initialise();
  for (std::size_t i = 0; i < count; ++i) {
    const double before = decades(draw, -2.0, 1.0);
    for (std::size_t c = 0; c < 3; ++c) {
      nodes.v_free[i][c] = c < nodes.dimension ? draw() : 0.0;
      nodes.v_previous[i][c] = c < nodes.dimension ? before * draw() : 0.0;
    }
    if (nodes.form == ILAW_DELASSUS_FULL && nodes.dimension > 1) couple(nodes.h[i], nodes.dimension, draw);
    if (draw(0.0, 1.0) < 0.3) run.set("damage", i, draw(0.05, 0.95));
  }
}

// With w^+ = h (s v^- + v)/2, s is the least in [0, 1] with which r.v^- is not positive: 0, or the work on
// v^- is 0, or s is 1.
TEST(CohesiveEnergy, IsLeftAsItIsByTheLeastChange) {
  int whole = 0, part = 0, none = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    RandomNodes nodes(count, 3, ILAW_DELASSUS_FULL, Inertia::any, seed);
    const double step = RandomNodes::step, stiffness = decades(nodes.uniform, 4.0, 9.0);
    Runner run("cohesive", {{{"strength", inf_value}, {"toughness", 1.0}, {"stiffness", stiffness}}, {}},
               nodes);
    draw_nodes(nodes, run);
    ASSERT_EQ(run.evaluate(), ILAW_OK);
    for (std::size_t i = 0; i < count; ++i) {
      const Vector &r = run.r[i], &v = run.v[i], &u = nodes.v_previous[i];
      const Vector w{run.named("mean_opening", i), run.named("mean_slip_1", i), run.named("mean_slip_2", i)};
      const double pull = 0.5 * step * nodes.area[i] * stiffness;
      if (std::abs(r[0] + pull * w[0]) > 1e-6 * std::abs(r[0])) continue;  // contact
      double s = 0.0;
      for (std::size_t c = 0; c < 3; ++c) s += (2.0 / step * w[c] - v[c]) * u[c] / dot(u, u);
      const double work = dot(r, u) / std::sqrt(dot(r, r) * dot(u, u));
      ASSERT_GE(s, -1e-9) << "seed " << seed << ", node " << i;
      ASSERT_LE(s, 1.0 + 1e-9) << "seed " << seed << ", node " << i;
      if (s < 1.0 - 1e-9) {
        ASSERT_LE(work, 1e-9) << "seed " << seed << ", node " << i;
      }
      if (s > 1e-9) {
        ASSERT_GE(work, -1e-9) << "seed " << seed << ", node " << i;
      }
      ++(s <= 1e-9 ? none : s < 1.0 - 1e-9 ? part : whole);
    }
  }
  EXPECT_GT(none, 1000);
  EXPECT_GT(part, 500);
  EXPECT_GT(whole, 500);
}

}  // namespace
}  // namespace ilaw::testing
