// How the variables of a state lie in it. That a state which the law cannot have written is bad input is for
// `ilaw check` (foreign-state).
#include "kit_probe.hpp"

#include "support/small_batch.hpp"

namespace ilaw::testing {
namespace {

std::size_t offset_of(const ilaw_instance_info& info, const std::string& name) {
  std::size_t at = 0;
  for (std::uint32_t k = 0; k < info.state_variable_count; at += info.state_variables[k++]->count)
    if (info.state_variables[k]->name == name) break;
  return at;
}

// Three nodes that touch, with states of their own.
struct Three : SmallBatch {
  explicit Three(const ilaw::interface& law)
      : SmallBatch(3, {-1.0, 0.5, 0.0}, law.info().state_size), size(law.info().state_size) {
    b.normal = ilaw::input(normal, 0, 1);
    EXPECT_EQ(law.initialise(b), ILAW_OK);
  }

  std::size_t size;  // of a state
  const double normal[3] = {0.6, 0.0, 0.8};
};

// Bookkeeping is marked, so that pictures and tables can leave it out.
TEST(StateVariables, SayWhichAreInternal) {
  const ilaw::interface law = make_probe(ILAW_FRAME_GLOBAL);
  const ilaw_instance_info info = law.info();
  const std::map<std::string, std::uint32_t> expected = {{"count", 0},
                                                         {"sum", 0},
                                                         {"slip", 0},
                                                         {"last", ILAW_FLAG_INTERNAL},
                                                         {"before_last", ILAW_FLAG_INTERNAL},
                                                         {"frame_normal", ILAW_FLAG_INTERNAL},
                                                         {"frame_tangent", ILAW_FLAG_INTERNAL}};
  ASSERT_EQ(info.state_variable_count, expected.size());
  for (std::uint32_t k = 0; k < info.state_variable_count; ++k)
    EXPECT_EQ(info.state_variables[k]->flags, expected.at(info.state_variables[k]->name))
        << info.state_variables[k]->name;
}

// A tangential vector takes d-1 doubles of the state, a vector d.
TEST(StateVariables, HaveTheSizeOfTheirKind) {
  for (const std::uint32_t d : {1U, 2U, 3U}) {
    const ilaw::interface law = make_tested_law("kit_probe", SetupBuilder(probe_parameters, d));
    EXPECT_EQ(law.info().state_size, 1 + d + (d - 1) + 2) << d;
    for (std::uint32_t k = 0; k < law.info().state_variable_count; ++k) {
      if (law.info().state_variables[k]->kind == ILAW_KIND_TANGENTIAL) {
        EXPECT_EQ(law.info().state_variables[k]->count, d - 1) << "d " << d << ", k " << k;
      }
    }
  }
}

// One tangential vector alone is a state of nothing in one dimension.
TEST(StateVariables, MayBeOneTangentialVector) {
  for (const std::uint32_t d : {1U, 2U, 3U}) {
    const ilaw::interface law = make_tested_law("path_probe", SetupBuilder({}, d));
    ASSERT_EQ(law.info().state_size, d - 1);
    constexpr std::size_t count = 21;
    std::vector<double> v(count * d, 2.0), r(count * d, 1.0), state(count * (d - 1), 0.5);
    const double h = 1.0, gap = 1.0;
    const auto size = static_cast<std::int64_t>(d);
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = count;
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = ilaw::input(v.data(), size, 1);
    b.delassus = ilaw::input(&h, 0, 0);
    b.gap = ilaw::input(&gap, 0, 0);
    b.impulse = ilaw::output(r.data(), size, 1);
    if (d > 1) {
      b.state_in = ilaw::input(state.data(), size - 1, 1);
      b.state_out = ilaw::output(state.data(), size - 1, 1);
    }
    ASSERT_EQ(law.evaluate(b), ILAW_OK) << d;
    EXPECT_EQ(r, std::vector<double>(count * d, 0.0));
    EXPECT_EQ(state, std::vector<double>(count * (d - 1), 2.5));
  }
}

// Hosts find the variables in the order in which they are described: that of struct state, which is another
// one in kit_probe, is the law's own affair.
TEST(StateVariables, StandInTheOrderOfTheirEntries) {
  const ilaw::interface law = make_probe();
  Three nodes(law);
  ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_OK);
  for (std::size_t i = 0; i < 3; ++i) {
    const double* state = &nodes.state[i * nodes.size];
    const double* sum = state + offset_of(law.info(), "sum");
    const double* slip = state + offset_of(law.info(), "slip");
    EXPECT_EQ(state[offset_of(law.info(), "count")], 1.0) << i;
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(sum[c], nodes.r[i][c]) << i << ", " << c;
    for (std::size_t c = 0; c < 2; ++c)
      EXPECT_EQ(slip[c], 1e-3 * (nodes.v[c + 1] + nodes.r[i][c + 1])) << i << ", " << c;
  }
}

}  // namespace
}  // namespace ilaw::testing
