// Arrays of float: the results of evaluate for the same numbers, rounded once, in any layout.
#include "batch_runner.hpp"
#include "kit_probe.hpp"

#include "support/law_cases.hpp"

#include <numeric>

namespace ilaw::testing {
namespace {

// The same law for another type of the host's numbers.
ilaw::interface made_for(std::uint32_t numbers, const std::string& law, const Parameters& parameters,
                         int d = 3, std::uint32_t form = ILAW_DELASSUS_SCALAR,
                         std::uint32_t frame = ILAW_FRAME_LOCAL) {
  SetupBuilder builder(parameters, static_cast<std::uint32_t>(d), form, frame);
  builder.setup.numbers = numbers;
  return make_tested_law(law, builder);
}

void round_to_floats(std::vector<double>& values) {
  for (double& value : values) value = static_cast<float>(value);
}

// The arrays of a batch of doubles in floats, place by place; those of the state are left in doubles.
class FloatBatch {
 public:
  FloatBatch(const ilaw_batch& of, std::int64_t nodes, std::int64_t d, std::int64_t of_delassus)
      : b(of), nodes_(nodes) {
    b.v_free = input(of.v_free, d);
    b.delassus = input(of.delassus, of_delassus);
    b.gap = input(of.gap, 1);
    b.gap_offset = input(of.gap_offset, 1);
    b.v_previous = input(of.v_previous, d);
    b.area = input(of.area, 1);
    b.normal = input(of.normal, d);
    b.impulse = output(of.impulse, d, impulse_);
    b.velocity = output(of.velocity, d, velocity_);
    b.energy = output(of.energy, 4, energy_);
  }
  FloatBatch(const FloatBatch&) = delete;

  // Where an output is not that of a batch of doubles, rounded; what lies between the nodes counts as well.
  std::string difference_from(const ilaw_batch& doubles) const {
    return difference("impulse", impulse_, doubles.impulse) +
           difference("velocity", velocity_, doubles.velocity) +
           difference("energy", energy_, doubles.energy);
  }

  ilaw_batch b;

 private:
  static std::string difference(const char* name, const std::vector<float>& floats,
                                const ilaw_output& doubles) {
    for (std::size_t k = 0; k < floats.size(); ++k)
      if (floats[k] != static_cast<float>(doubles.values[k]))
        return std::string(name) + " at " + std::to_string(k) + ": " + std::to_string(floats[k]) + " for " +
               std::to_string(doubles.values[k]) + "\n";
    return "";
  }

  std::vector<float> copy(const ilaw_input& a, std::int64_t count) const {
    if (!a.values) return {};
    const std::int64_t size = (nodes_ - 1) * a.node_stride + (count - 1) * a.component_stride + 1;
    return {a.values, a.values + size};
  }
  ilaw_input input(const ilaw_input& a, std::int64_t count) {
    return ilaw::input(
        a.values ? inputs_.emplace_back(copy(a, count)).data() : static_cast<const float*>(nullptr),
        a.node_stride, a.component_stride);
  }
  ilaw_output output(const ilaw_output& a, std::int64_t count, std::vector<float>& own) const {
    own = copy(ilaw::input(a.values, a.node_stride, a.component_stride), count);
    return ilaw::output(a.values ? own.data() : static_cast<float*>(nullptr), a.node_stride,
                        a.component_stride);
  }

  std::int64_t nodes_;
  std::deque<std::vector<float>> inputs_;
  std::vector<float> impulse_, velocity_, energy_;
};

void expect_same_report(const ilaw_report& a, const ilaw_report& b) {
  EXPECT_EQ(a.bad_count, b.bad_count);
  EXPECT_EQ(a.first_bad_node, b.first_bad_node);
  EXPECT_STREQ(a.reason, b.reason);
  EXPECT_EQ(a.stable_velocity_step, b.stable_velocity_step);
}

class Floats : public ::testing::TestWithParam<LawCase> {
 protected:
  struct Both {
    ilaw::interface doubles, floats;
  };
  static Both made(int d, std::uint32_t form, std::uint32_t frame) {
    const auto make = [&](std::uint32_t numbers) {
      return made_for(numbers, GetParam().law, GetParam().parameters, d, form, frame);
    };
    return {make(ILAW_NUMBERS_DOUBLE), make(ILAW_NUMBERS_FLOAT)};
  }

  // Some steps in doubles and in floats, each with a state of its own; in the second one gaps have offsets.
  static void expect_doubles_rounded(const Both& law, Nodes nodes, const Layout& layout, bool global) {
    for (auto* values :
         {&nodes.v_free, &nodes.v_previous, &nodes.gap, &nodes.area, &nodes.normal, &nodes.delassus})
      round_to_floats(*values);
    const auto state_size = static_cast<std::int64_t>(law.doubles.info().state_size);
    Arrays doubles(nodes, state_size, layout, global), floats(nodes, state_size, layout, global);
    const FloatBatch first(floats.first_batch(), nodes.count, nodes.d, nodes.hc);
    ASSERT_EQ(law.floats.initialise(first.b), law.doubles.initialise(doubles.first_batch()));
    std::vector<double> v_free = nodes.v_free;
    for (int step = 1; step <= 3; ++step) {
      ASSERT_EQ(doubles.state.get(), floats.state.get()) << "step " << step;
      const auto batch_of = [&](Arrays& arrays) {
        ilaw_batch batch = arrays.batch(v_free, step * 1e-3);
        if (step == 2) batch.gap_offset = batch.area;
        return batch;
      };
      const ilaw_batch batch = batch_of(doubles);
      const FloatBatch mirrored(batch_of(floats), nodes.count, nodes.d, nodes.hc);
      ilaw_report report{}, float_report{};
      report.struct_size = float_report.struct_size = sizeof report;
      ASSERT_EQ(law.floats.evaluate(mirrored.b, &float_report), law.doubles.evaluate(batch, &report))
          << "step " << step;
      expect_same_report(float_report, report);
      ASSERT_EQ(mirrored.difference_from(batch), "") << "step " << step;
      ASSERT_EQ(doubles.status, floats.status) << "step " << step;
      if (layout.separate_state) std::swap(doubles.state, doubles.next);
      if (layout.separate_state) std::swap(floats.state, floats.next);
      for (double& value : v_free) value *= 0.5;
    }
    EXPECT_TRUE(floats.state.guarded());
  }
};

TEST_P(Floats, AreTheDoublesRounded) {
  std::vector<std::int32_t> order(270);
  std::iota(order.begin(), order.end(), 1);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL})
    for (const auto& [d, form, components] : {std::tuple{3, ILAW_DELASSUS_SCALAR, 1},
                                              {2, ILAW_DELASSUS_TRANSVERSE, 2},
                                              {3, ILAW_DELASSUS_FULL, 6}}) {
      if (!serves(GetParam(), static_cast<std::uint32_t>(form))) continue;
      SCOPED_TRACE(::testing::Message() << d << "D, form " << form << ", frame " << frame);
      const Both law = made(d, static_cast<std::uint32_t>(form), frame);
      const Nodes nodes(270, d, components);
      const bool global = frame == ILAW_FRAME_GLOBAL;
      for (const Layout& layout :
           {Layout{}, Layout{.soa = true, .separate_state = true}, Layout{.node_stride = 2, .outputs = false},
            Layout{.order = order, .index_base = 1},
            Layout{.soa = true, .order = order, .index_base = 1, .wide_index = true}})
        expect_doubles_rounded(law, nodes, layout, global);
    }
}

// Where no energies are asked, floats may be read and written in place. A block of nodes is far away, and
// some nodes are refused.
TEST_P(Floats, ThatStayWhereTheyAreAreTheDoublesRounded) {
  for (const char* level : {"baseline", "v3", "v4"}) {
    setenv("ILAW_ISA", level, 1);
    for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL})
      for (const int components : {1, 2}) {
        const std::uint32_t form = components == 1 ? ILAW_DELASSUS_SCALAR : ILAW_DELASSUS_TRANSVERSE;
        SCOPED_TRACE(::testing::Message() << level << ", form " << form << ", frame " << frame);
        const Both law = made(3, form, frame);
        Nodes nodes(403, 3, components);
        std::fill_n(nodes.gap.begin() + 128, 128, 2.0);
        nodes.v_free[3 * 5 + 1] = nodes.v_previous[3 * 261] = inf_value;
        nodes.delassus[static_cast<std::size_t>(components) * 140] = -1.0;
        const bool global = frame == ILAW_FRAME_GLOBAL;
        for (const Layout& layout :
             {Layout{.energy = false}, Layout{.outputs = false}, Layout{.soa = true, .energy = false},
              Layout{.soa = true, .separate_state = true, .outputs = false},
              Layout{.energy = false, .previous_in_columns = true},
              Layout{.energy = false, .velocity = false}})
          expect_doubles_rounded(law, nodes, layout, global);
      }
  }
  unsetenv("ILAW_ISA");
}

INSTANTIATE_TEST_SUITE_P(Laws, Floats, ::testing::ValuesIn(law_cases("contract")), name_of_case);
const LawCase laws_with_floats[] = {{"kit_probe", "kit_probe", probe_parameters, {}},
                                    {"pack_probe", "pack_probe", probe_parameters, {}},
                                    {"solver_probe", "solver_probe", {}, {}},
                                    {"tie", "tie_unbreakable", {}, {}}};
INSTANTIATE_TEST_SUITE_P(Kit, Floats, ::testing::ValuesIn(laws_with_floats), name_of_case);

// One closed node of coulomb, friction per node.
struct FloatNode {
  FloatNode() : law(made_for(ILAW_NUMBERS_FLOAT, "coulomb", {{}, {}, {}, {"friction"}})) {
    b.struct_size = sizeof b;
    b.node_count = 1;
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = b.v_previous = ilaw::input(v.data(), 3, 1);
    b.delassus = ilaw::input(&h, 1, 1);
    b.gap = ilaw::input(&gap, 1, 1);
    b.per_node_parameters = &parameter;
    b.impulse = ilaw::output(r.data(), 3, 1);
    b.velocity = ilaw::output(after.data(), 3, 1);
    b.status = &status;
    b.status_stride = 1;
    report.struct_size = sizeof report;
  }
  std::int32_t evaluate() { return law.evaluate(b, &report); }

  ilaw::interface law;
  std::array<float, 3> v{-1.0F, 0.25F, 0.0F}, r{}, after{};
  float h = 0.5F, gap = 0.0F, friction = 0.5F;
  ilaw_input parameter = ilaw::input(&friction, 1, 1);
  std::uint8_t status = 99;
  ilaw_batch b{};
  ilaw_report report{};
};

TEST(FloatArrays, HaveParametersPerNode) {
  FloatNode node;
  ASSERT_EQ(node.evaluate(), ILAW_OK);
  EXPECT_EQ(node.r, (std::array{2.0F, -0.5F, 0.0F}));
  node.friction = 0.125F;
  ASSERT_EQ(node.evaluate(), ILAW_OK);
  EXPECT_EQ(node.r, (std::array{2.0F, -0.25F, 0.0F}));
  node.friction = -1.0F;
  ASSERT_EQ(node.evaluate(), ILAW_BAD_NODES);
  EXPECT_STREQ(node.report.reason, "a per-node parameter is out of range");
}

// Twice an impulse that is accepted is a number, along any axis.
TEST(FloatArrays, RefuseImpulsesThatOverflowAFloat) {
  FloatNode node;
  node.h = 0x1p-125F;
  ASSERT_EQ(node.evaluate(), ILAW_OK);
  EXPECT_EQ(node.r[0], 0x1p125F);
  node.h = 0x1p-126F;
  ASSERT_EQ(node.evaluate(), ILAW_BAD_NODES);
  EXPECT_EQ(node.r, (std::array<float, 3>{}));
  EXPECT_EQ(node.after, node.v);
  EXPECT_EQ(node.status, ILAW_BAD_INPUT);
  EXPECT_EQ(node.report.first_bad_node, 0);
  EXPECT_STREQ(node.report.reason, "the impulse or the state overflows");
}

TEST(FloatArrays, RefuseWhatIsNoNumber) {
  for (float FloatNode::*member : {&FloatNode::h, &FloatNode::gap, &FloatNode::friction})
    for (const double bad : {nan_value, inf_value, -inf_value}) {
      FloatNode node;
      if (member == &FloatNode::friction && bad > 0.0) continue;  // infinite friction is some
      node.*member = static_cast<float>(bad);
      EXPECT_EQ(node.evaluate(), ILAW_BAD_NODES) << bad;
    }
}

// An array of doubles in a batch of floats is none of this law's.
TEST(FloatArrays, RefuseArraysOfDoubles) {
  FloatNode node;
  const double gap = 0.0;
  for (const bool both : {false, true}) {
    node.b.gap = ilaw::input(&gap, 1, 1);
    if (both) node.b.gap.floats = &node.gap;
    EXPECT_EQ(node.evaluate(), ILAW_INVALID_ARGUMENT);
    EXPECT_STREQ(
        node.report.reason,
        both ? "an array is of other numbers than the setup's, or has both pointers" : "gap is null");
  }
}

}  // namespace
}  // namespace ilaw::testing
