// Impacts with friction, through the ABI: energy, limits and forms of H. The proof is in
// docs/theory/resolved_impact.md.
#include "impact_runs.hpp"

#include "support/law_batch.hpp"

namespace ilaw::testing {
namespace {

// ---- energy

// A mass on springs of different h omega against a rough stop. The energy of a step is that of the scheme,
// and what the law stores.
double largest_gain(const Body& body, double h_omega, double h_omega_t, double middle, int steps) {
  NodeRun node("impact", rough(body.friction, body.restitution), h_omega);
  double before = INFINITY, gained = -INFINITY, size = 0.0;
  const double ratio = h_omega_t / h_omega * (h_omega_t / h_omega);
  struct {
    double u, v, x, y;
  } at{1.0, 0.0, 0.7, 0.3};  // y: velocity along the tangent
  for (int k = 0; k < steps; ++k) {
    node.gap = at.u;
    node.v_previous = {at.v, at.y, 0.0};
    if (node.step({at.v - h_omega * (at.u + middle), at.y - h_omega * ratio * at.x, 0.0}) != ILAW_OK)
      ADD_FAILURE() << node.report.reason;
    at.v = node.v[0];
    at.y = node.v[1];
    const double u = at.u + h_omega * at.v, x = at.x + h_omega * at.y;
    const double energy =
        0.5 * (at.v * at.v + at.y * at.y + (at.u + middle) * (u + middle) + ratio * at.x * x) +
        node.energy[ILAW_ENERGY_STORED];
    size = std::max(size, 0.5 * (at.v * at.v + at.y * at.y + (u + middle) * (u + middle) + ratio * x * x));
    gained = std::max(gained, energy - before);
    before = energy;
    at.u = u;
    at.x = x;
  }
  return gained / size;
}

TEST(RoughImpact, NeverGainsUpToTheCriticalStep) {
  for (const double restitution : {1.0, 0.8, 0.3})
    for (const double friction : {0.0, 0.1, 1.0, inf_value})
      for (const double h_omega : {0.1, 0.5, 1.0, 1.5, 1.9, 1.999})
        for (const double h_omega_t : {0.3, 1.7, 1.999})
          for (const double middle : {0.3, -0.2})
            EXPECT_LE(largest_gain({friction, restitution}, h_omega, h_omega_t, middle, 10000), 1e-14)
                << "mu " << friction << ", e " << restitution << ", h w " << h_omega << " and " << h_omega_t;
}

// ---- its limits, its state

TEST(RoughImpact, RefusesAnHThatCouples) {
  NodeRun node("impact", rough(0.5, 0.5), 1e-3, ILAW_DELASSUS_FULL);
  node.h = {1.0, 2.0, 2.0, 0.0, 0.0, 0.0};
  node.v_previous = {-1.0, 0.5, 0.0};
  EXPECT_EQ(node.step({-1.0, 0.5, 0.0}), ILAW_OK);
  EXPECT_GT(node.r[0], 0.0);
  for (const int entry : {2, 3, 4, 5}) {
    node.h = {1.0, 2.0, 2.0, 0.0, 0.0, 0.0};
    node.h[static_cast<std::size_t>(entry)] += 1e-4;
    EXPECT_EQ(node.step({-1.0, 0.5, 0.0}), ILAW_BAD_NODES) << "entry " << entry;
    EXPECT_STREQ(node.report.reason,
                 "H couples directions, or differs along the tangents, which these parameters do not serve");
  }
}

// H = diag(h_N, h_T, h_T) along random axes, which an ABI accepts to 1e-6: rounded to single precision as H
// is, or as far off as they may be. The impulse is that of the transverse form to the error of the axes.
TEST(RoughImpact, ServesAnIsotropicHAlongSingleAxes) {
  constexpr std::size_t count = 2000;
  constexpr double off = 0.99e-6;
  const auto batch_of = [](std::uint32_t form) {
    return LawBatch(make_law("impact", SetupBuilder(rough(0.3, 0.5), 3, form, ILAW_FRAME_GLOBAL, true)),
                    count);
  };
  LawBatch full = batch_of(ILAW_DELASSUS_FULL), transverse = batch_of(ILAW_DELASSUS_TRANSVERSE);
  Random random(11);
  const auto single = [](double x) { return double{static_cast<float>(x)}; };
  for (std::size_t i = 0; i < count; ++i) {
    const double h_n = random.decades(1.0), h_t = random.decades(1.0);
    Vector n = random.vector();
    n = (1.0 / length(n)) * n;
    Vector t = tangential(random.vector(), n);
    t = (1.0 / length(t)) * t;
    const auto entry = [&](std::size_t a, std::size_t b) {
      return (a == b ? h_t : 0.0) + (h_n - h_t) * n[a] * n[b];
    };
    full.h[i] = {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)};
    if (i % 2 == 0) {
      for (double& x : full.h[i]) x = single(x);
      for (std::size_t c = 0; c < 3; ++c) n[c] = single(n[c]), t[c] = single(t[c]);
    } else {
      n = (1.0 + 0.5 * off * (i % 4 == 1 ? 1.0 : -1.0)) * n;
      t = t + (i % 8 < 4 ? off : -off) * n;
    }
    transverse.h[i] = {h_n, h_t, 0.0, 0.0, 0.0, 0.0};
    full.normal[i] = transverse.normal[i] = n;
    full.tangent[i] = transverse.tangent[i] = t;
    const Vector v = random.vector();
    full.v_free[i] = full.v_previous[i] = transverse.v_free[i] = transverse.v_previous[i] = v;
  }
  ASSERT_EQ(full.evaluate(), ILAW_OK) << full.report.bad_count << ": " << full.report.reason;
  ASSERT_EQ(transverse.evaluate(), ILAW_OK);
  for (std::size_t i = 0; i < count; ++i)
    ASSERT_LE(length(full.r[i] - transverse.r[i]), 1e-5 * length(transverse.r[i])) << i;
}

}  // namespace
}  // namespace ilaw::testing
