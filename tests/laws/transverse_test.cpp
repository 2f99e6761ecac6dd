// A transverse H is h_N n n^T + h_T (I - n n^T), whatever form it is written in: laws give the same bits for
// it in the local frame, and nearly so in the host's axes.
#include "laws/random_nodes.hpp"

#include <tuple>

namespace ilaw::testing {
namespace {

constexpr std::size_t node_count = 250, steps = 20;

using Drawn = std::tuple<LawCase, std::uint32_t>;

std::string name_of_law(const ::testing::TestParamInfo<Drawn>& drawn) {
  return std::get<0>(drawn.param).name + "_" + std::to_string(std::get<1>(drawn.param)) + "D";
}

class Transverse : public ::testing::TestWithParam<Drawn> {
 protected:
  const LawCase& law() const { return std::get<0>(GetParam()); }

  // The same nodes with the same H in any form: isotropic ones of all forms but the scalar are drawn alike.
  RandomNodes nodes_of(std::uint32_t form) const {
    return {node_count, std::get<1>(GetParam()), form, Inertia::isotropic, 15};
  }

  static void draw(RandomNodes& nodes, std::size_t step) {
    nodes.draw();
    nodes.v_previous = nodes.v_free;
    for (std::size_t i = 0; i < nodes.count; ++i) {
      for (std::size_t c = 0; c < nodes.dimension; ++c)
        if (step % 2) nodes.v_previous[i][c] = nodes.uniform();
      nodes.gap[i] = nodes.uniform(-2.0, 1.0) * RandomNodes::step;
    }
  }

  static std::optional<std::string> difference(const Runner& a, const Runner& b) {
    for (std::size_t i = 0; i < a.r.size(); ++i)
      if (a.r[i] != b.r[i] || a.v[i] != b.v[i] || a.energy[i] != b.energy[i] || a.status[i] != b.status[i])
        return "node " + std::to_string(i) + ": " + text(a, i) + " and " + text(b, i);
    return a.state == b.state ? std::nullopt : std::optional<std::string>("states differ");
  }
  static std::string text(const Runner& run, std::size_t i) {
    std::ostringstream out;
    out.precision(17);
    out << "status " << int{run.status[i]} << ", r";
    for (const double component : run.r[i]) out << " " << component;
    return out.str();
  }

  // Both step over the same nodes, each with states of its own; set: what is done to the nodes of both
  // before.
  template <class Set>
  void expect_same_bits(RandomNodes& nodes, Axes axes, RandomNodes& others, Set set) const {
    Runner one(law().law, law().parameters, nodes, axes), other(law().law, law().parameters, others, axes);
    one.initialise();
    other.initialise();
    std::size_t acting = 0;
    for (std::size_t k = 0; k < steps && !HasFailure(); ++k) {
      draw(nodes, k);
      draw(others, k);
      set();
      one.time = other.time += RandomNodes::step;
      ASSERT_EQ(one.evaluate(), other.evaluate()) << "k " << k;
      const std::optional<std::string> found = difference(one, other);
      EXPECT_FALSE(found) << "step " << k << ", " << *found;
      for (const Vector& r : one.r) acting += r != Vector{};
    }
    EXPECT_GT(acting, node_count * steps / 20);
  }
};

TEST_P(Transverse, GivesTheBitsOfOtherFormsInTheLocalFrame) {
  for (const std::uint32_t form : {ILAW_DELASSUS_FULL, ILAW_DELASSUS_DIAGONAL}) {
    if (!serves(law(), form)) continue;
    RandomNodes nodes = nodes_of(ILAW_DELASSUS_TRANSVERSE), others = nodes_of(form);
    expect_same_bits(nodes, Axes::local, others, [&] { ASSERT_EQ(nodes.h, others.h); });
  }
}

TEST_P(Transverse, WithEqualValuesGivesTheBitsOfAScalar) {
  for (const Axes axes : {Axes::local, Axes::host}) {
    RandomNodes nodes = nodes_of(ILAW_DELASSUS_TRANSVERSE), others = nodes_of(ILAW_DELASSUS_SCALAR);
    expect_same_bits(nodes, axes, others, [&] {
      others.v_free = nodes.v_free;
      others.v_previous = nodes.v_previous;
      others.gap = nodes.gap;
      for (std::size_t i = 0; i < nodes.count; ++i) {
        for (std::size_t c = 1; c < 3; ++c) nodes.h[i][c][c] = nodes.h[i][0][0];
        others.h[i] = nodes.h[i];
      }
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, Transverse,
                         ::testing::Combine(::testing::ValuesIn(law_cases("properties")),
                                            ::testing::Values(2U, 3U)),
                         name_of_law);

// Without tangents, where laws work from the normal alone: the local result, turned.
class TransverseAlongNormals : public ::testing::TestWithParam<LawCase> {};

TEST_P(TransverseAlongNormals, GivesTheLocalResult) {
  const LawCase& law = GetParam();
  RandomNodes nodes(1000, 3, ILAW_DELASSUS_TRANSVERSE, Inertia::isotropic, 16);
  Runner local(law.law, law.parameters, nodes), turned(law.law, law.parameters, nodes, Axes::normals);
  local.initialise();
  turned.initialise();
  nodes.draw();
  for (std::size_t i = 0; i < nodes.count; ++i) {
    nodes.v_previous[i] = {nodes.uniform(), nodes.uniform(), nodes.uniform()};
    nodes.gap[i] = nodes.uniform(-2.0, 1.0) * RandomNodes::step;
  }
  ASSERT_EQ(local.evaluate(), ILAW_OK) << local.report.reason;
  ASSERT_EQ(turned.evaluate(), ILAW_OK) << turned.report.reason;
  for (std::size_t i = 0; i < nodes.count; ++i) {
    const Vector r = turned.local(i, turned.r[i], 1.0), v = turned.local(i, turned.v[i], 1.0);
    const double tolerance = 64 * ulp * (0.01 + std::sqrt(dot(r, r)));
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_NEAR(r[c], local.r[i][c], tolerance) << "node " << i;
      ASSERT_NEAR(v[c], local.v[i][c], 64 * ulp + 2.0 * tolerance) << "node " << i;
    }
  }
}

const std::vector<LawCase>& laws_without_tangents() {
  static const std::vector<LawCase> laws = [] {
    std::vector<LawCase> found = law_cases("properties");
    std::erase_if(found, [](const LawCase& law) { return law.parameters.numbers.contains("friction_2"); });
    return found;
  }();
  return laws;
}
INSTANTIATE_TEST_SUITE_P(Laws, TransverseAlongNormals, ::testing::ValuesIn(laws_without_tangents()),
                         name_of_case);

// An H that is refused as a full matrix is refused as two values, and the other way round; in 1D the second
// value is not read.
TEST(TransverseInertia, IsAcceptedWhereItIsPositiveDefinite) {
  const Parameters parameters{{{"friction", 0.3}}, {}};
  const double least = std::numeric_limits<double>::min();
  const auto code = [&](std::uint32_t form, std::uint32_t dimension, std::vector<double> h) {
    LawBatch node(make_law("coulomb", SetupBuilder(parameters, dimension, form)));
    node.v_free[0] = node.v_previous[0] = {-1.0, 0.5, 0.0};
    std::copy(h.begin(), h.end(), node.h[0].begin());
    return node.evaluate();
  };
  for (const auto& [n, t] : {std::pair{1.0, 1.0},
                             {2.0, 7.0},
                             {0.0, 1.0},
                             {1.0, 0.0},
                             {-1.0, 1.0},
                             {1.0, -1.0},
                             {least, least},
                             {0.5 * least, least},
                             {inf_value, 1.0},
                             {1.0, inf_value},
                             {nan_value, 1.0},
                             {1.0, nan_value},
                             {1.0, 0x1p41},
                             {1.0, 0x1p43},
                             {0x1p41, 1.0},
                             {0x1p43, 1.0},
                             {1e300, 1e299},
                             {1e300, 1.0}})
    for (const std::uint32_t dimension : {2U, 3U}) {
      const std::vector<double> full =
          dimension == 2 ? std::vector{n, t, 0.0} : std::vector{n, t, t, 0.0, 0.0, 0.0};
      EXPECT_EQ(code(ILAW_DELASSUS_TRANSVERSE, dimension, {n, t}), code(ILAW_DELASSUS_FULL, dimension, full))
          << n << " " << t << ", " << dimension << "D";
    }
  EXPECT_EQ(code(ILAW_DELASSUS_TRANSVERSE, 1, {2.0, nan_value}), ILAW_OK);
  EXPECT_EQ(code(ILAW_DELASSUS_TRANSVERSE, 1, {0.0, 1.0}), ILAW_BAD_NODES);
}

}  // namespace
}  // namespace ilaw::testing
