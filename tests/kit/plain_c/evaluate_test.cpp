// Batches and results that a law in plain C refuses as one of the kit does, and fields that its tables read.
#include "support/small_batch.hpp"
#include "twins.hpp"

namespace ilaw::testing {
namespace {

using Call = ilaw_result(ILAW_CALL*)(const ilaw_instance*, const ilaw_batch*, ilaw_report*);
Call evaluate_of(const std::string& made_with) { return twin(made_with).law("twin")->evaluate; }
Call initialise_of(const std::string& made_with) { return twin(made_with).law("twin")->initialise; }

// Two nodes that close, with all that a batch of the law may have.
struct TwoNodes : SmallBatch {
  TwoNodes() : SmallBatch(2, {-1.0, 0.0, 0.0}, 1) {
    r = {{7.0, 7.0, 7.0}, {7.0, 7.0, 7.0}};
    b.velocity = ilaw::output(velocity, 3, 1);
    b.energy = ilaw::output(energy, 4, 1);
    b.amounts = &wear;
    b.per_node_parameters = &friction;
  }
  double velocity[6]{}, energy[8]{}, wears[2]{}, frictions[2] = {0.5, 0.5};
  ilaw_output wear = ilaw::output(wears, 1, 1);
  ilaw_input friction = ilaw::input(frictions, 1, 1);
};

struct WrongBatch {
  const char* reason;
  std::function<void(TwoNodes&)> spoil;
  bool spoils_initialise = false;
  std::int32_t code = ILAW_INVALID_ARGUMENT;
};

// The numbers of one array as floats.
template <class Array>
void swap_numbers(Array& a) {
  static float floats[12];
  a.values = nullptr;
  a.floats = floats;
}
template <class Array>
void give_both(Array& a) {
  static float floats[12];
  a.floats = floats;
}
void list(ilaw_batch& b, std::int64_t second, std::int32_t base, bool wide = true) {
  static std::int64_t index64[2];
  static std::int32_t index[2];
  index64[0] = index[0] = base;
  index64[1] = second;
  index[1] = static_cast<std::int32_t>(second);
  if (wide)
    b.index64 = index64;
  else
    b.index = index;
  b.index_base = base;
}

constexpr std::int64_t least_index = std::numeric_limits<std::int64_t>::min();
constexpr std::int32_t least_index32 = std::numeric_limits<std::int32_t>::min();
constexpr const char* others = "an array is of other numbers than the setup's, or has both pointers";

const std::vector<WrongBatch>& wrong_batches() {
  static const std::vector<WrongBatch> all = {
      {"v_free is null", [](TwoNodes& n) { n.b.v_free.values = nullptr; }},
      {"v_free is null", [](TwoNodes& n) { swap_numbers(n.b.v_free); }},
      {"delassus is null", [](TwoNodes& n) { n.b.delassus.values = nullptr; }},
      {"gap is null", [](TwoNodes& n) { n.b.gap.values = nullptr; }},
      {"v_previous is null", [](TwoNodes& n) { n.b.v_previous.values = nullptr; }},
      {"area is null", [](TwoNodes& n) { n.b.area.values = nullptr; }},
      {"impulse is null", [](TwoNodes& n) { n.b.impulse.values = nullptr; }},
      {"impulse is null", [](TwoNodes& n) { swap_numbers(n.b.impulse); }},
      {"per_node_parameters is null", [](TwoNodes& n) { n.b.per_node_parameters = nullptr; }},
      {"values of a per-node parameter are null", [](TwoNodes& n) { n.friction.values = nullptr; }},
      {"state_in is null", [](TwoNodes& n) { n.b.state_in.values = nullptr; }},
      {"state_out is null", [](TwoNodes& n) { n.b.state_out.values = nullptr; }, true},
      {others, [](TwoNodes& n) { give_both(n.b.v_free); }},
      {others, [](TwoNodes& n) { give_both(n.b.gap_offset); }},
      {others, [](TwoNodes& n) { swap_numbers(n.b.velocity); }},
      {others, [](TwoNodes& n) { give_both(n.b.energy); }},
      {others, [](TwoNodes& n) { give_both(n.wear); }},
      {others, [](TwoNodes& n) { give_both(n.friction); }},
      {others, [](TwoNodes& n) { give_both(n.b.state_in); }},
      {others, [](TwoNodes& n) { give_both(n.b.state_out); }},
      {"v_free has one component per node (component stride 0), expected a (d,n) array",
       [](TwoNodes& n) { n.b.v_free.component_stride = 0; }},
      {"v_previous has one component per node (component stride 0), expected a (d,n) array",
       [](TwoNodes& n) { n.b.v_previous.component_stride = 0; }},
      {"impulse has a stride of 0", [](TwoNodes& n) { n.b.impulse.node_stride = 0; }},
      {"impulse has a stride of 0", [](TwoNodes& n) { n.b.impulse.component_stride = 0; }},
      {"velocity has a stride of 0", [](TwoNodes& n) { n.b.velocity.node_stride = 0; }},
      {"velocity has a stride of 0", [](TwoNodes& n) { n.b.velocity.component_stride = 0; }},
      {"energy has a stride of 0", [](TwoNodes& n) { n.b.energy.component_stride = 0; }},
      {"an amount has a stride of 0", [](TwoNodes& n) { n.wear.node_stride = 0; }},
      {"state_out has a stride of 0", [](TwoNodes& n) { n.b.state_out.node_stride = 0; }, true},
      {"status_stride is 0", [](TwoNodes& n) { n.b.status_stride = 0; }},
      {"node_count is negative", [](TwoNodes& n) { n.b.node_count = -1; }, true},
      {"index_base is neither 0 nor 1", [](TwoNodes& n) { n.b.index_base = 2; }, true},
      {"a node of the index list lies below index_base", [](TwoNodes& n) { list(n.b, -1, 0); }, true},
      {"a node of the index list lies below index_base", [](TwoNodes& n) { list(n.b, 0, 1); }, true},
      {"a node of the index list lies below index_base", [](TwoNodes& n) { list(n.b, least_index, 1); },
       true},
      {"a node of the index list lies below index_base", [](TwoNodes& n) { list(n.b, least_index, 0); },
       true},
      {"a node of the index list lies below index_base", [](TwoNodes& n) { list(n.b, 0, 1, false); }, true},
      {"a node of the index list lies below index_base",
       [](TwoNodes& n) { list(n.b, least_index32, 1, false); }, true},
      {"index and index64 are both given",
       [](TwoNodes& n) {
         list(n.b, 1, 0, false);
         list(n.b, 1, 0, true);
       },
       true},
      {"time is not finite", [](TwoNodes& n) { n.b.time = nan_value; }, true},
      {"velocity_step is not a finite number > 0", [](TwoNodes& n) { n.b.velocity_step = 0.0; }},
      {"velocity_step is not a finite number > 0", [](TwoNodes& n) { n.b.velocity_step = nan_value; }},
      {"position_step is not a finite number > 0", [](TwoNodes& n) { n.b.position_step = inf_value; }},
      {"struct_size of the batch is none of any version", [](TwoNodes& n) { n.b.struct_size = 0; }, true},
      {"struct_size of the batch is none of any version",
       [](TwoNodes& n) { n.b.struct_size = ILAW_BATCH_SIZE_1_0 - 1; }, true},
      {"struct_size of the batch is none of any version", [](TwoNodes& n) { n.b.struct_size = 4097; }, true},
      {"struct_size of the batch is none of any version", [](TwoNodes& n) { n.b.struct_size = 0xFFFFFFFF; },
       true},
      {"flags of the batch are not known", [](TwoNodes& n) { n.b.flags = std::uint64_t{1} << 63; }, true,
       ILAW_UNSUPPORTED}};
  return all;
}

Parameters per_node_friction() {
  Parameters parameters;
  parameters.per_node = {"friction"};
  return parameters;
}

void expect_refused(const WrongBatch& wrong, const std::string& made_with, Call call,
                    const ilaw_instance* instance) {
  TwoNodes nodes;
  nodes.state = {7.0, 7.0};
  wrong.spoil(nodes);
  EXPECT_EQ(call(instance, &nodes.b, &nodes.report), wrong.code) << wrong.reason << ", " << made_with;
  EXPECT_STREQ(nodes.report.reason, wrong.reason) << made_with;
  EXPECT_EQ(nodes.report.bad_count, 0) << wrong.reason << ", " << made_with;
  EXPECT_EQ(nodes.report.first_bad_node, -1) << wrong.reason << ", " << made_with;
  for (const Vector& r : nodes.r) EXPECT_EQ(r, (Vector{7.0, 7.0, 7.0})) << wrong.reason << ", " << made_with;
  for (const double state : nodes.state) EXPECT_EQ(state, 7.0) << wrong.reason << ", " << made_with;
}

TEST(PlainC, RefusesBatchesAsTheKitDoes) {
  const Twins twins(per_node_friction());
  for (const WrongBatch& wrong : wrong_batches())
    for (const std::string made_with : {"c", "kit"}) {
      expect_refused(wrong, made_with, evaluate_of(made_with), twins.of(made_with));
      if (wrong.spoils_initialise)
        expect_refused(wrong, made_with, initialise_of(made_with), twins.of(made_with));
    }
}

TEST(PlainC, RefusesNullAndReportsAsTheKitDoes) {
  const Twins twins(per_node_friction());
  for (const std::string made_with : {"c", "kit"})
    for (const Call call : {evaluate_of(made_with), initialise_of(made_with)}) {
      TwoNodes nodes;
      EXPECT_EQ(call(nullptr, &nodes.b, &nodes.report), ILAW_INVALID_ARGUMENT) << made_with;
      EXPECT_STREQ(nodes.report.reason, "instance or batch is null") << made_with;
      EXPECT_EQ(call(twins.of(made_with), nullptr, &nodes.report), ILAW_INVALID_ARGUMENT) << made_with;
      for (const std::uint32_t size : {std::uint32_t{ILAW_REPORT_SIZE_1_0} - 1, 4097U, 0xFFFFFFFFU}) {
        nodes.report.struct_size = size;
        EXPECT_EQ(call(twins.of(made_with), &nodes.b, &nodes.report), ILAW_INVALID_ARGUMENT)
            << made_with << ", size " << size;
      }
      nodes.b.node_count = 0;
      nodes.b.v_free = {};
      EXPECT_EQ(call(twins.of(made_with), &nodes.b, nullptr), ILAW_OK) << made_with;
    }
}

// Inputs of the second of two nodes.
TEST(PlainC, RefusesNodesAsTheKitDoes) {
  const Twins twins(per_node_friction());
  const double wrongs[] = {nan_value, inf_value, -1.0};
  const struct {
    const char* reason;
    ilaw_input ilaw_batch::*array;
    bool refuses_negative;
  } inputs[] = {{"v_free is not finite", &ilaw_batch::v_free, false},
                {"H is not finite and positive definite", &ilaw_batch::delassus, true},
                {"the gap is not finite", &ilaw_batch::gap, false},
                {"v_previous is not finite", &ilaw_batch::v_previous, false},
                {"the area is not a finite number >= 0", &ilaw_batch::area, true},
                {"the state is not finite", &ilaw_batch::state_in, false}};
  for (const auto& input : inputs)
    for (const double wrong : wrongs)
      for (const std::string made_with : {"c", "kit"}) {
        if (wrong < 0.0 && !input.refuses_negative) continue;
        TwoNodes nodes;
        const double values[] = {1.0, 1.0, 1.0, wrong, 1.0, 1.0};
        nodes.b.*input.array = ilaw::input(values, 3, 1);
        EXPECT_EQ(evaluate_of(made_with)(twins.of(made_with), &nodes.b, &nodes.report), ILAW_BAD_NODES)
            << input.reason << ", " << made_with << ", " << wrong;
        EXPECT_STREQ(nodes.report.reason, input.reason) << made_with << ", " << wrong;
        EXPECT_EQ(nodes.report.bad_count, 1) << input.reason;
        EXPECT_EQ(nodes.report.first_bad_node, 1) << input.reason;
        EXPECT_EQ(nodes.status[1], ILAW_BAD_INPUT) << input.reason;
      }
}

// Results that break a promise: the node gets no impulse and keeps its state.
TEST(PlainC, RefusesResultsAsTheKitDoes) {
  const struct {
    const char *breaks, *reason;
    bool is_for_both;
  } results[] = {
      {"number", "the law gave an impulse that is not a number", true},
      {"state", "the impulse or the state overflows", true},
      {"large", "the impulse or the state overflows", true},
      {"pull", "the law pulled, which needs ", true},
      {"far", "the law acted out of reach, which ", false},
      {"nan_energy", "the law gave a dissipated energy below 0, or one that is not a number", false},
      {"negative_energy", "the law gave a dissipated energy below 0, or one that is not a number", false},
      {"amount", "the law gave an amount that is not a number", false},
      {"status", "the law gave a status that no step has", false},
      {"bad_status", "the law gave a status that no step has", false},
      {"stable", "the law gave a stable step that is not a number >= 0", false}};
  for (const auto& result : results)
    for (const std::string made_with : {"c", "kit"}) {
      if (made_with == "kit" && !result.is_for_both) continue;
      const Twins twins({{{"friction", 0.5}}, {{"breaks", result.breaks}}});
      TwoNodes nodes;
      const bool is_far = result.breaks == std::string("far");  // and fresh
      const double state = is_far ? 0.0 : 5.0;
      nodes.state = {state, state};
      nodes.gap = is_far ? 1.0 : 0.0;
      EXPECT_EQ(evaluate_of(made_with)(twins.of(made_with), &nodes.b, &nodes.report), ILAW_BAD_NODES)
          << result.breaks << ", " << made_with;
      ASSERT_NE(nodes.report.reason, nullptr) << result.breaks << ", " << made_with;
      EXPECT_THAT(nodes.report.reason, StartsWith(result.reason)) << made_with;
      EXPECT_EQ(nodes.report.bad_count, 2) << result.breaks;
      for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_EQ(nodes.r[k], Vector{}) << result.breaks << ", " << made_with;
        EXPECT_EQ(nodes.state[k], state) << result.breaks << ", " << made_with;
        EXPECT_EQ(nodes.status[k], ILAW_BAD_INPUT) << result.breaks << ", " << made_with;
        EXPECT_EQ(nodes.velocity[3 * k], -1.0) << result.breaks << ", " << made_with;
        EXPECT_EQ(nodes.wears[k], 0.0) << result.breaks << ", " << made_with;
        for (std::size_t e = 0; e < 4; ++e) EXPECT_EQ(nodes.energy[4 * k + e], 0.0) << result.breaks;
      }
    }
}

// A node that remembers something is not skipped, so it may act out of reach.
TEST(PlainC, ActsOutOfReachWhereItRemembersAsTheKitDoes) {
  const Twins twins({{{"friction", 0.5}}, {{"breaks", "far"}}});
  for (const std::string made_with : {"c", "kit"}) {
    TwoNodes nodes;
    nodes.gap = 1.0;
    nodes.state = {5.0, 5.0};
    EXPECT_EQ(evaluate_of(made_with)(twins.of(made_with), &nodes.b, &nodes.report), ILAW_OK) << made_with;
    EXPECT_EQ(nodes.r[0][0], 0.5) << made_with;
  }
}

// An impulse that a host of floats cannot have.
TEST(PlainC, RefusesImpulsesBeyondFloatsAsTheKitDoes) {
  for (const auto& [friction, code] : {std::pair{0x1p125, ILAW_OK}, {0x1p126, ILAW_BAD_NODES}})
    for (const std::string made_with : {"c", "kit"}) {
      const Twins twins({{{"friction", friction}}, {}}, ILAW_NUMBERS_FLOAT);
      SmallBatch node(1, {}, 1);
      const float zeros[3]{}, one = 1.0F;
      float r[3];
      node.b.v_free = node.b.v_previous = ilaw::input(zeros, 0, 1);
      node.b.delassus = node.b.area = ilaw::input(&one, 0, 1);
      node.b.gap = ilaw::input(zeros, 0, 1);
      node.b.impulse = ilaw::output(r, 3, 1);
      EXPECT_EQ(evaluate_of(made_with)(twins.of(made_with), &node.b, &node.report), code)
          << made_with << ", " << friction;
      EXPECT_EQ(r[0], code == ILAW_OK ? static_cast<float>(friction) : 0.0F) << made_with;
    }
}

// r_N of two nodes is their friction.
std::array<double, 2> friction_of(const std::string& made_with, const Parameters& parameters,
                                  const std::vector<ilaw_input>& per_node = {}) {
  const Twins twins(parameters);
  TwoNodes nodes;
  nodes.b.time = 0.5;
  if (!per_node.empty()) nodes.b.per_node_parameters = per_node.data();
  EXPECT_EQ(evaluate_of(made_with)(twins.of(made_with), &nodes.b, &nodes.report), ILAW_OK)
      << nodes.report.reason;
  return {nodes.r[0][0], nodes.r[1][0]};
}

// Wherever the field stands in the list of parameters, and however it is given.
TEST(PlainC, ReadsFieldsBeforeTablesOverThem) {
  for (const std::string made_with : {"c", "kit"})
    for (const std::string field : {"pressure", "temperature"}) {
      Parameters parameters;
      parameters.grids["friction"] = {{{field, {0.0, 300.0, 600.0}}}, {0.1, 0.5, 0.9}};
      parameters.numbers[field] = 600.0;
      EXPECT_THAT(friction_of(made_with, parameters), Each(0.9)) << made_with << ", " << field;
      parameters.numbers.clear();
      parameters.tables[field] = {0.0, 0.0, 1.0, 1200.0};
      EXPECT_THAT(friction_of(made_with, parameters), Each(0.9)) << made_with << ", " << field;
      parameters.tables.clear();
      parameters.per_node = {field};
      const double values[] = {600.0, 300.0};
      EXPECT_THAT(friction_of(made_with, parameters, {ilaw::input(values, 1, 1)}), ElementsAre(0.9, 0.5))
          << made_with << ", " << field;
    }
}

TEST(PlainC, ReadsTablesOverTwoFieldsAndTime) {
  Parameters parameters;
  parameters.grids["friction"] = {
      {{"temperature", {0.0, 600.0}}, {"pressure", {0.0, 2.0}}, {"time", {0.0, 1.0}}},
      {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0}};
  parameters.numbers = {{"temperature", 300.0}, {"pressure", 0.5}};
  for (const std::string made_with : {"c", "kit"})  // 4 * 0.5 + 2 * 0.25 + 0.5
    EXPECT_THAT(friction_of(made_with, parameters), Each(DoubleNear(3.0, 1e-15))) << made_with;
}

// In plain C a table may also be over what the law computes, here a slip speed of 2.
TEST(PlainC, ReadsTablesOverAFieldAndAComputedAxis) {
  Parameters parameters;
  parameters.grids["friction"] = {{{"slip_speed", {0.0, 4.0}}, {"temperature", {0.0, 600.0}}},
                                  {0.0, 1.0, 2.0, 3.0}};
  parameters.numbers = {{"temperature", 300.0}};
  const SetupBuilder setup(parameters);
  const Created created = create("c", &setup.setup);
  ASSERT_EQ(created.code, ILAW_OK) << created.message;
  TwoNodes nodes;
  ASSERT_EQ(evaluate_of("c")(created.instance, &nodes.b, &nodes.report), ILAW_OK);
  EXPECT_DOUBLE_EQ(nodes.wears[0], 1.5);
  twin("c").law("twin")->destroy(created.instance);
}

// Laws of twin.c that give v_smooth back; only one has it among its inputs.
TEST(PlainC, ReadsVSmoothWhereItIsGiven) {
  const double smooth[] = {1.0, 2.0, 3.0, 4.0, 5.0, nan_value};
  for (const std::string id : {"smooth", "free_velocity"}) {
    const SetupBuilder setup({});
    const ilaw::interface law(twin("c"), id, setup.setup);
    EXPECT_EQ(law.info().inputs, id == "smooth" ? std::uint32_t{ILAW_INPUT_V_SMOOTH} : 0U);
    TwoNodes nodes;
    EXPECT_EQ(law.law().evaluate(law.instance(), &nodes.b, &nodes.report), ILAW_OK) << id;
    EXPECT_THAT(nodes.r, Each(nodes.v)) << id;
    nodes.b.v_smooth = ilaw::input(smooth, 3, 1);
    const bool reads = id == "smooth";
    EXPECT_EQ(law.law().evaluate(law.instance(), &nodes.b, &nodes.report), reads ? ILAW_BAD_NODES : ILAW_OK);
    EXPECT_EQ(nodes.r[0], reads ? (Vector{1.0, 2.0, 3.0}) : nodes.v) << id;
    EXPECT_EQ(nodes.r[1], reads ? Vector{} : nodes.v) << id;
    if (reads) {
      EXPECT_STREQ(nodes.report.reason, "v_smooth is not finite");
    }
    give_both(nodes.b.v_smooth);
    EXPECT_EQ(law.law().evaluate(law.instance(), &nodes.b, &nodes.report),
              reads ? ILAW_INVALID_ARGUMENT : ILAW_OK)
        << id;
  }
}

}  // namespace
}  // namespace ilaw::testing
