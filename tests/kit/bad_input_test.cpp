// What is bad input, and what is ordinary. That nothing happens at a bad node, and everything at the others,
// is for `ilaw check` (bad-input-*).
#include "kit_probe.hpp"
#include "mixed_nodes.hpp"

#include "support/law_cases.hpp"
#include "support/small_batch.hpp"

namespace ilaw::testing {
namespace {

// Tiny and huge but representable inputs are ordinary.
TEST(Extremes, AreSolvedWhereTheResultCanBeRepresented) {
  NodeRun node("coulomb", {{{"friction", 0.5}}, {}});
  for (const double scale : {5e-324, 1e-310, 1e-300, 1e-200, 1e200, 1e300})
    for (const double h : {1e-5, 1.0, 1e5}) {
      node.h[0] = h;
      node.v_previous = {};
      EXPECT_EQ(node.step({-scale, scale, 0.0}), ILAW_OK) << scale << " " << h;
      EXPECT_EQ(node.r[0], scale / h) << "h " << h;
      // A few ulp, where subnormal velocities have ulps of 5e-324.
      const double relative = 1e-15 + 5e-324 / scale;
      EXPECT_LE(std::abs(node.r[1] + 0.5 * (scale / h)), relative * (scale / h)) << "h " << h;
    }
}

// A velocity before the step that only the energies need: without it the motion is the same, and its
// dissipation is not known.
TEST(EnergyOutput, DoesNotChangeTheMotionWhereThePreviousVelocityIsNone) {
  std::vector<LawCase> served = law_cases("bad_input");
  served.push_back({"kit_probe", "kit_probe", probe_parameters, {}});
  for (const auto& [name, ignored, parameters, more] : served) {
    MixedNodes nodes(make_tested_law(name, SetupBuilder(parameters)), 270);
    if (nodes.law->info().inputs & ILAW_INPUT_V_PREVIOUS) continue;
    for (std::size_t i = 0; i < 270; i += 2) nodes.v_previous[i][i % 3] = i % 4 ? nan_value : inf_value;
    const MixedNodes with = nodes.stepped(), without = nodes.stepped({.outputs = false});
    EXPECT_EQ(with.report.bad_count, 0) << name << ": " << (with.report.reason ? with.report.reason : "");
    EXPECT_TRUE(same_bits(with.r, without.r) && same_bits(with.state, without.state)) << name;
    for (std::size_t i = 0; i < 270; i += 2)
      EXPECT_EQ(with.energy[i][0] + with.energy[i][1] + with.energy[i][2], 0.0) << name << i;
  }
}

TEST(Tangent, ThatIsNoneIsBadInput) {
  const SetupBuilder setup({{{"friction", 0.3}}, {}}, 3, ILAW_DELASSUS_SCALAR, ILAW_FRAME_GLOBAL, true);
  const ilaw::interface law = make_law("coulomb", setup);
  const double normal[] = {0.0, 0.0, 1.0};
  struct Given {
    Vector tangent;
    bool good;
  };
  for (const Given& given :
       {Given{{0.6, 0.8, 0.0}, true}, Given{{0.6, 0.8, 1e-7}, true}, Given{{0.6, 0.8, 1e-3}, false},
        Given{{0.0, 0.0, 1.0}, false}, Given{{0.3, 0.4, 0.0}, false}, Given{{0.0, 0.0, 0.0}, false},
        Given{{nan_value, 0.8, 0.0}, false}, Given{{0.6, inf_value, 0.0}, false}}) {
    SmallBatch node(1, {1.0, 0.5, -1.0});
    node.b.normal = ilaw::input(normal, 0, 1);
    node.b.tangent = ilaw::input(given.tangent.data(), 0, 1);
    EXPECT_EQ(law.evaluate(node.b, &node.report), given.good ? ILAW_OK : ILAW_BAD_NODES) << given.tangent[2];
    EXPECT_STREQ(node.report.reason,
                 given.good ? nullptr : "the tangent is not a unit vector orthogonal to the normal");
  }
}

// Whether H is definite does not depend on the axes: H = Q diag(1, 0.7, x) Q^T for any rotation Q.
TEST(FullDelassus, IsAcceptedOrRefusedWhateverItsRotation) {
  const SetupBuilder setup({{{"friction", 0.3}}, {}}, 3, ILAW_DELASSUS_FULL);
  const ilaw::interface law = make_law("coulomb", setup);
  const SetupBuilder diagonal_setup({{{"friction", 0.3}}, {}}, 3, ILAW_DELASSUS_DIAGONAL);
  const ilaw::interface diagonal = make_law("coulomb", diagonal_setup);
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  SmallBatch node(1, {-1.0, 0.5, 0.2});
  const auto code_of = [&](const ilaw::interface& served, const double* h) {
    node.b.delassus = ilaw::input(h, 0, 1);
    return served.evaluate(node.b);
  };
  for (const double scale : {1.0, 1e-200, 1e150})
    for (const auto& [smallest, good] :
         {std::pair{0.0, false}, {-1e-18, false}, {1e-15, false}, {1e-11, true}, {1e-3, true}}) {
      const double d[] = {scale * 1.0, scale * 0.7, scale * smallest};
      EXPECT_EQ(code_of(diagonal, d) == ILAW_OK, good) << smallest << ", diagonal, scale " << scale;
      int accepted = 0;
      for (int k = 0; k < 500; ++k) {
        double q[4], size = 0.0;
        for (double& c : q) {
          c = normal(random);
          size += c * c;
        }
        const double w = q[0], x = q[1], y = q[2], z = q[3], s = 2.0 / size;
        const double m[3][3] = {{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                                {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
                                {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
        const auto entry = [&](int a, int b) {
          return d[0] * m[a][0] * m[b][0] + d[1] * m[a][1] * m[b][1] + d[2] * m[a][2] * m[b][2];
        };
        const double h[] = {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)};
        accepted += code_of(law, h) == ILAW_OK;
      }
      EXPECT_EQ(accepted, good ? 500 : 0) << smallest << ", scale " << scale;
    }
}

}  // namespace
}  // namespace ilaw::testing
