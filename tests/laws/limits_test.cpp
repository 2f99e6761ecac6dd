// Limits in which one law is another, for each form of H.
#include "laws/random_nodes.hpp"

#include <ostream>
#include <tuple>

namespace ilaw::testing {
namespace {

constexpr double inf_value = std::numeric_limits<double>::infinity();
constexpr std::size_t node_count = 1000, steps = 500;  // in 2D and 3D together: a million

struct Limit {
  const char* name;
  const char* law;
  Parameters parameters;
  const char* limit;
  Parameters limit_parameters;
  Inertia inertia = Inertia::any;
};
std::ostream& operator<<(std::ostream& out, const Limit& limit) { return out << limit.name; }

const std::map<std::string, std::string> moreau{{"activation", "moreau"}},
    predictive{{"activation", "predictive"}};

const std::vector<Limit> limits = {
    {"coulomb_without_friction_is_contact", "coulomb", {{{"friction", 0.0}}, {}}, "contact", {}},
    {"postit_without_adhesion_is_coulomb",
     "postit",
     {{{"friction", 0.4}, {"adhesion_limit", 0.0}}, {}},
     "coulomb",
     {{{"friction", 0.4}}, moreau}},
    {"tie_without_strength_is_contact", "tie", {{{"strength", 0.0}}, {}}, "contact", {{}, moreau}},
    {"cohesive_of_infinite_strength_is_tie",
     "cohesive",
     {{{"strength", inf_value}, {"toughness", 1.0}}, {}},
     "tie",
     {},
     Inertia::isotropic},
    {"cohesive_without_toughness_is_coulomb",
     "cohesive",
     {{{"strength", 1e3}, {"toughness", 0.0}, {"friction", 0.4}}, {}},
     "coulomb",
     {{{"friction", 0.4}}, predictive},
     Inertia::isotropic}};

using Drawn = std::tuple<Limit, std::uint32_t, std::uint32_t>;

std::string name_of(const ::testing::TestParamInfo<Drawn>& drawn) {
  const std::uint32_t form = std::get<1>(drawn.param);
  return std::string(std::get<0>(drawn.param).name) +
         (form == ILAW_DELASSUS_SCALAR     ? "_scalar_"
          : form == ILAW_DELASSUS_DIAGONAL ? "_diagonal_"
                                           : "_full_") +
         std::to_string(std::get<2>(drawn.param)) + "D";
}

class Limits : public ::testing::TestWithParam<Drawn> {};

TEST_P(Limits, GiveTheSameBits) {
  const auto& [limit, form, dimension] = GetParam();
  RandomNodes nodes(node_count, dimension, form, limit.inertia, 12);
  Runner run(limit.law, limit.parameters, nodes), other(limit.limit, limit.limit_parameters, nodes);
  run.initialise();
  other.initialise();
  int acting = 0;
  for (std::size_t k = 0; k < steps && !HasFailure(); ++k) {
    nodes.draw();
    nodes.v_previous = nodes.v_free;
    for (double& gap : nodes.gap) gap = 0.5 * nodes.uniform() * RandomNodes::step;
    run.time = other.time += RandomNodes::step;
    ASSERT_EQ(run.evaluate(), ILAW_OK) << run.report.reason;
    ASSERT_EQ(other.evaluate(), ILAW_OK) << other.report.reason;
    for (std::size_t i = 0; i < nodes.count; ++i) {
      acting += run.r[i][0] != 0.0;
      ASSERT_EQ(run.r[i], other.r[i]);
      ASSERT_EQ(run.v[i], other.v[i]);
    }
  }
  EXPECT_GT(acting, 100000);
}

INSTANTIATE_TEST_SUITE_P(Laws, Limits,
                         ::testing::Combine(::testing::ValuesIn(limits),
                                            ::testing::Values(std::uint32_t{ILAW_DELASSUS_SCALAR},
                                                              std::uint32_t{ILAW_DELASSUS_DIAGONAL},
                                                              std::uint32_t{ILAW_DELASSUS_FULL}),
                                            ::testing::Values(2U, 3U)),
                         name_of);

}  // namespace
}  // namespace ilaw::testing
