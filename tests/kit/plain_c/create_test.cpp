// Setups that a law in plain C refuses as one of the kit does: the code, and the words.
#include "twins.hpp"

namespace ilaw::testing {
namespace {

// What may be wrong with a setup of twin.c whose friction is 0.5: the setup's builder and its struct.
struct WrongSetup {
  const char* name;
  std::int32_t code;
  const char* message;
  Parameters parameters;
  std::function<void(ilaw_setup&)> spoil = [](ilaw_setup&) {};
};

Parameters with(std::map<std::string, double> numbers, std::map<std::string, std::string> texts = {}) {
  numbers.try_emplace("friction", 0.5);
  return {std::move(numbers), std::move(texts)};
}
Parameters with_tables(std::map<std::string, Parameters::Grid> grids) {
  Parameters parameters;
  if (grids.count("friction") == 0) parameters.numbers["friction"] = 0.5;
  parameters.grids = std::move(grids);
  return parameters;
}
Parameters over_temperature(double number) {
  Parameters parameters = with_tables({{"friction", {{{"temperature", {0.0, 600.0}}}, {0.0, 1.0}}}});
  if (number > 0.0) parameters.numbers["temperature"] = number;
  return parameters;
}
Parameters per_node(const char* name) {
  Parameters parameters = with({});
  parameters.per_node = {name};
  return parameters;
}

// The one argument of a setup, to be spoilt.
template <class Change>
auto argument(Change change) {
  return [change](ilaw_setup& setup) {
    static ilaw_argument changed;
    static const ilaw_argument* pointer = &changed;
    changed = *setup.arguments[0];
    change(changed);
    setup.arguments = &pointer;
  };
}

const std::vector<WrongSetup>& wrong_setups() {
  static const std::vector<WrongSetup> all = {
      {"out of range", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction' = -1.5 is not allowed: expected a number in [0, inf]",
       with({{"friction", -1.5}})},
      {"NaN", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'exponent' = nan is not allowed: expected a number in (0.5, 2.5]",
       with({{"exponent", nan_value}})},
      {"excluded minimum", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'exponent' = 0.5 is not allowed: expected a number in (0.5, 2.5]",
       with({{"exponent", 0.5}})},
      {"no end, but no infinity", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'temperature' = inf is not allowed: expected a number in [0, inf)",
       with({{"temperature", inf_value}})},
      {"all digits", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'exponent' = 2.5000000000000004 is not allowed: expected a number in (0.5, 2.5]",
       with({{"exponent", 2.5000000000000004}})},
      {"no whole number", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'count' = 2.5 is not allowed: expected a whole number in [1, 4096]",
       with({{"count", 2.5}})},
      {"unknown", ILAW_INVALID_PARAMETER,
       "law 'twin': unknown parameter 'fraction': expected one of pressure, friction, temperature, exponent, "
       "count, breaks",
       with({{"fraction", 0.5}})},
      {"missing",
       ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction' is missing: expected a number in [0, inf]",
       {}},
      {"given twice",
       ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction' is given twice",
       {{{"friction", 0.5}}, {}, {{"friction", {0.0, 1.0}}}}},
      {"text for a number", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'exponent' was given as a text (\"high\"): expected a number in (0.5, 2.5]",
       with({}, {{"exponent", "high"}})},
      {"number per node where none may be", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'count' was given as a value per node: expected a ", per_node("count")},
      {"unknown choice", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'breaks' = \"all\" is not allowed: expected one of \"none\", \"number\", \"state\"",
       with({}, {{"breaks", "all"}})},
      {"number for a choice", ILAW_INVALID_PARAMETER, nullptr, with({{"breaks", 1.0}})},
      {"unknown axis", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'pressure': axis 'temperature' of the table is unknown: expected one of 'time'",
       with_tables({{"pressure", {{{"temperature", {0.0, 1.0}}}, {0.0, 1.0}}}})},
      {"twice an axis", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction': the table has twice the axis time",
       with_tables({{"friction", {{{"time", {0.0}}, {"time", {0.0}}}, {1.0}}}})},
      {"points that do not increase", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction': point 1 of axis 'time' is 0.5: expected finite, increasing points",
       with_tables({{"friction", {{{"time", {0.5, 0.5}}}, {1.0, 1.0}}}})},
      {"a value of a table", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction' = -0.25 is not allowed: expected a number in [0, inf]",
       with_tables({{"friction", {{{"time", {0.0, 1.0}}}, {1.0, -0.25}}}})},
      {"a field that nobody gives", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction' is a table over 'temperature': expected a value, a value per node or "
       "a table over time for that",
       over_temperature(0.0)},
      {"a field that is a table over a field", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction' is a table over 'temperature': expected a value, a value per node or "
       "a table over time for that",
       [] {
         Parameters parameters = over_temperature(0.0);
         parameters.numbers["pressure"] = 1.0;
         parameters.grids["temperature"] = {{{"pressure", {0.0, 1.0}}}, {0.0, 1.0}};
         return parameters;
       }()},
      {"dimension", ILAW_UNSUPPORTED, "law 'twin': dimension 2 is not served: expected 3", with({}),
       [](ilaw_setup& s) { s.dimension = 2; }},
      {"dimension of no law", ILAW_UNSUPPORTED, "law 'twin': dimension 32 is not served: expected 3",
       with({}), [](ilaw_setup& s) { s.dimension = 32; }},
      {"form of H", ILAW_UNSUPPORTED, "law 'twin': form 4 of H is not served: expected one of 1", with({}),
       [](ilaw_setup& s) { s.delassus_form = ILAW_DELASSUS_FULL; }},
      {"two forms of H", ILAW_UNSUPPORTED, "law 'twin': form 9 of H is not served: expected one of 1",
       with({}), [](ilaw_setup& s) { s.delassus_form = 9; }},
      {"frame", ILAW_UNSUPPORTED, "law 'twin': frame 3 is ", with({}), [](ilaw_setup& s) { s.frame = 3; }},
      {"number type", ILAW_UNSUPPORTED, "law 'twin': number", with({}), [](ilaw_setup& s) { s.numbers = 4; }},
      {"flags", ILAW_UNSUPPORTED, "law 'twin': flags 0x10000000000 are not known: expected 0", with({}),
       [](ilaw_setup& s) { s.flags = std::uint64_t{1} << 40; }},
      {"has_tangent", ILAW_INVALID_ARGUMENT, "law 'twin': has_tangent 2 is unknown: expected 0 or 1",
       with({}), [](ilaw_setup& s) { s.has_tangent = 2; }},
      {"no arguments", ILAW_INVALID_ARGUMENT, "law 'twin': arguments is null, expected 1 pointers", with({}),
       [](ilaw_setup& s) { s.arguments = nullptr; }},
      {"argument without a name", ILAW_INVALID_ARGUMENT,
       "law 'twin': argument 0 is null, has no name or a struct_size not from 56 to 4096", with({}),
       argument([](ilaw_argument& a) { a.name = nullptr; })},
      {"argument of no kind", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction' was given as a value of unknown kind: expected a number in [0, inf]",
       with({}), argument([](ilaw_argument& a) { a.kind = 77; })},
      {"argument of no size", ILAW_INVALID_ARGUMENT,
       "law 'twin': argument 0 is null, has no name or a struct_size not from 56 to 4096", with({}),
       argument([](ilaw_argument& a) { a.struct_size = 0xFFFFFFFF; })},
      {"argument that is too small", ILAW_INVALID_ARGUMENT,
       "law 'twin': argument 0 is null, has no name or a struct_size not from 56 to 4096", with({}),
       argument([](ilaw_argument& a) { a.struct_size = ILAW_ARGUMENT_SIZE_1_0 - 1; })},
      {"table without axes", ILAW_INVALID_PARAMETER,
       "law 'twin': parameter 'friction': the table has no axis or more than three, expected 1 to 3",
       with({}), argument([](ilaw_argument& a) { a.kind = ILAW_KIND_VALUE_TABLE; })},
      {"setup of no size", ILAW_INVALID_ARGUMENT,
       "law 'twin': setup is null or its struct_size not from 48 to 4096", with({}),
       [](ilaw_setup& s) { s.struct_size = 0xFFFFFFFF; }},
      {"setup that is too large", ILAW_INVALID_ARGUMENT,
       "law 'twin': setup is null or its struct_size not from 48 to 4096", with({}),
       [](ilaw_setup& s) { s.struct_size = 4097; }},
      {"setup that is too small", ILAW_INVALID_ARGUMENT,
       "law 'twin': setup is null or its struct_size not from 48 to 4096", with({}),
       [](ilaw_setup& s) { s.struct_size = ILAW_SETUP_SIZE_1_0 - 1; }}};
  return all;
}

TEST(PlainC, RefusesSetupsAsTheKitDoes) {
  for (const WrongSetup& wrong : wrong_setups()) {
    for (const std::string made_with : {"c", "kit"}) {
      SetupBuilder setup(wrong.parameters);
      wrong.spoil(setup.setup);
      const Created created = create(made_with, &setup.setup);
      EXPECT_EQ(created.code, wrong.code) << wrong.name << ", " << made_with << ": " << created.message;
      EXPECT_EQ(created.instance, nullptr) << wrong.name << ", " << made_with;
      if (wrong.message) {
        EXPECT_THAT(created.message, HasSubstr(wrong.message)) << wrong.name << ", " << made_with;
      }
    }
  }
}

TEST(PlainC, RefusesCallsOfCreateAsTheKitDoes) {
  const SetupBuilder setup({{{"friction", 0.5}}, {}});
  for (const std::string made_with : {"c", "kit"}) {
    EXPECT_EQ(create(made_with, nullptr).code, ILAW_INVALID_ARGUMENT) << made_with;
    EXPECT_EQ(create(made_with, &setup.setup, "other").code, ILAW_INVALID_ARGUMENT) << made_with;
    EXPECT_EQ(create(made_with, &setup.setup, nullptr).code, ILAW_INVALID_ARGUMENT) << made_with;
    EXPECT_EQ(twin(made_with).law("twin")->create("twin", &setup.setup, nullptr, nullptr, 0),
              ILAW_INVALID_ARGUMENT)
        << made_with;
  }
}

// An axis of a table is a struct, too.
TEST(PlainC, RefusesAxesOfNoSize) {
  for (const std::string made_with : {"c", "kit"})
    for (const std::uint32_t size : {std::uint32_t{ILAW_AXIS_SIZE_1_0} - 1, 4097U, 0xFFFFFFFFU}) {
      const double points[] = {0.0, 1.0}, values[] = {0.0, 1.0};
      const ilaw_axis axis{size, 0, "time", points, 2}, *axes[] = {&axis};
      ilaw_argument argument{};
      argument.struct_size = sizeof argument;
      argument.kind = ILAW_KIND_VALUE_TABLE;
      argument.name = "friction";
      argument.values = values;
      argument.axes = axes;
      argument.axis_count = 1;
      const ilaw_argument* arguments[] = {&argument};
      SetupBuilder setup({});
      setup.setup.arguments = arguments;
      setup.setup.argument_count = 1;
      const Created created = create(made_with, &setup.setup);
      EXPECT_EQ(created.code, ILAW_INVALID_PARAMETER) << made_with << ", size " << size;
      EXPECT_EQ(
          created.message,
          "law 'twin': parameter 'friction': the table has an axis that is null or whose struct_size is "
          "of no version");
    }
}

// A message that is too long is cut.
TEST(PlainC, CutsMessages) {
  for (const std::string made_with : {"c", "kit"})
    for (const std::size_t size : {std::size_t{1}, std::size_t{20}}) {
      const SetupBuilder setup({{{"friction", -1.0}}, {}});
      std::string message(size + 4, '#');
      ilaw_instance* instance = nullptr;
      EXPECT_EQ(twin(made_with).law("twin")->create("twin", &setup.setup, &instance, message.data(), size),
                ILAW_INVALID_PARAMETER);
      EXPECT_EQ(message, std::string("law 'twin': parameter").substr(0, size - 1) + '\0' + "####")
          << made_with;
    }
}

TEST(PlainC, TellsItsStateVersion) {
  const Twins twins({{{"friction", 0.5}}, {}});
  for (const auto& [made_with, version] : {std::pair<std::string, std::uint32_t>{"c", 3}, {"kit", 1}}) {
    ilaw_instance_info info{};
    info.struct_size = sizeof info;
    ASSERT_EQ(twin(made_with).law("twin")->info(twins.of(made_with), &info), ILAW_OK);
    EXPECT_EQ(info.state_version, version) << made_with;
    for (const std::uint32_t size : {std::uint32_t{ILAW_INSTANCE_INFO_SIZE_1_0} - 1, 4097U, 0xFFFFFFFFU}) {
      info.struct_size = size;
      EXPECT_EQ(twin(made_with).law("twin")->info(twins.of(made_with), &info), ILAW_INVALID_ARGUMENT)
          << made_with << ", size " << size;
    }
  }
}

TEST(PlainC, HasAnyNumberOfReferences) { EXPECT_EQ(twin("c").law("twin")->reference_count, 17U); }

}  // namespace
}  // namespace ilaw::testing
