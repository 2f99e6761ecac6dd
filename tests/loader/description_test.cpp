// A wrong description of a library is refused in words that name the mistake, whatever it is.
// SPDX-License-Identifier: BSD-3-Clause
#include <description.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>

namespace {

using ilaw::loading::checked_plugin;
using ilaw::loading::instance_descriptions;
using ilaw::loading::refusal;
using ilaw::loading::storage;

constexpr double infinity = std::numeric_limits<double>::infinity();
const void* const no_address = reinterpret_cast<const void*>(16);

// A library without fault, whose one law has a parameter of each kind and a variable of state. Made where it
// stays: it points into itself.
struct Description {
  std::array<const char*, 2> choices{"smooth", "rough"};
  std::array<const char*, 1> references{"Author (1999), Title"};
  ilaw_parameter number{}, choice{};
  ilaw_state_variable variable{};
  std::array<const char*, 2> axes{"time", "slip_speed"};
  ilaw_amount amount{sizeof amount, 0, "heat", "J", "Of friction."};
  std::array<const ilaw_amount*, 2> amounts{&amount, &amount};
  ilaw_law law{};
  ilaw_plugin plugin{};
  std::array<const ilaw_parameter*, 2> parameters{&number, &choice};
  std::array<const ilaw_state_variable*, 2> variables{&variable, &variable};
  std::array<const ilaw_law*, 2> laws{&law, &law};

  Description() {
    number.struct_size = choice.struct_size = sizeof number;
    number.kind = ILAW_KIND_NUMBER;
    number.name = "strength";
    number.symbol = "s";
    number.unit = "Pa";
    number.doc = "Of the bond.\n";
    number.maximum = 1.0;
    number.default_value = 0.5;
    number.flags = ILAW_FLAG_ALLOWS_PER_NODE | ILAW_FLAG_FIELD;
    number.axes = axes.data();
    number.axis_count = 2;
    choice.kind = ILAW_KIND_CHOICE;
    choice.name = "surface";
    choice.symbol = "";
    choice.unit = "1";
    choice.doc = "Its finish.";
    choice.maximum = choice.default_value = 1.0;
    choice.choices = choices.data();
    choice.choice_count = 2;
    variable = {sizeof variable, ILAW_KIND_SCALAR, "damage", "1", "Of the bond.", 1, 0, 0};
    law.struct_size = sizeof law;
    law.dimensions = ILAW_DIMENSION_1 | ILAW_DIMENSION_3;
    law.delassus_forms = ILAW_DELASSUS_SCALAR;
    law.frames = ILAW_FRAME_LOCAL;
    law.numbers = ILAW_NUMBERS_DOUBLE | ILAW_NUMBERS_FLOAT;
    law.inputs = ILAW_INPUT_GAP;
    law.id = "bond";
    law.title = "Bond";
    law.doc = "Holds.";
    law.references = references.data();
    law.reference_count = 1;
    law.parameters = parameters.data();
    law.parameter_count = 2;
    law.state_variables = variables.data();
    law.state_variable_count = 1;
    law.amounts = amounts.data();
    law.amount_count = 1;
    law.create = [](const char*, const ilaw_setup*, ilaw_instance**, char*, std::size_t) {
      return std::int32_t{ILAW_OK};
    };
    law.destroy = [](ilaw_instance*) {};
    law.info = [](const ilaw_instance*, ilaw_instance_info*) { return std::int32_t{ILAW_OK}; };
    law.initialise = law.evaluate = [](const ilaw_instance*, const ilaw_batch*, ilaw_report*) {
      return std::int32_t{ILAW_OK};
    };
    plugin = {sizeof plugin, ILAW_ABI_MAJOR, ILAW_ABI_MINOR, "bonds", "1.0",
              "tests",       "BSD",          laws.data(),    1,       0,
              nullptr};
  }
  Description(const Description&) = delete;
  Description& operator=(const Description&) = delete;

  std::string answer() const {
    storage kept;
    try {
      checked_plugin("bonds.so", &plugin, kept);
    } catch (const refusal& error) {
      EXPECT_EQ(error.code(), ILAW_BAD_LIBRARY) << error.what();
      return error.what();
    }
    return "";
  }
};

struct Fault {
  const char* name;
  void (*make)(Description&);
  const char* said;  // "": nothing is wrong with it

  friend void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }
};

class FaultyDescription : public testing::TestWithParam<Fault> {};

TEST_P(FaultyDescription, IsNamedWithWhatWasFoundAndExpected) {
  Description description;
  ASSERT_EQ(description.answer(), "");
  GetParam().make(description);
  const std::string wanted = GetParam().said;
  EXPECT_EQ(description.answer(), wanted.empty() ? "" : "bonds.so: " + wanted);
}

const Fault faulty_descriptions[] = {
    {"SmallLibrary", [](Description& d) { d.plugin.struct_size = 8; },
     "the description has struct_size 8, expected at least 64 and at most 4096"},
    {"OtherMajor", [](Description& d) { d.plugin.abi_major = 2; },
     "ABI version 2.0, expected major version 1"},
    {"NoLaws", [](Description& d) { d.plugin.law_count = 0; }, "law_count is 0, expected at least 1"},
    {"LawTwice", [](Description& d) { d.plugin.law_count = 2; }, "law 'bond' is declared twice"},
    {"SmallLaw", [](Description& d) { d.law.struct_size = 120; },
     "law 0: law has struct_size 120, expected at least 160 and at most 4096"},
    {"TitleNowhere", [](Description& d) { d.law.title = static_cast<const char*>(no_address); },
     "law 'bond': title is no readable text of at most 64 KiB"},
    {"ManyParameters", [](Description& d) { d.law.parameter_count = 4000000000U; },
     "law 'bond': parameters has 4000000000 entries, expected at most 10000"},
    {"DefaultAbove", [](Description& d) { d.number.default_value = 2.0; },
     "law 'bond': parameter 'strength': default 2 lies outside its own range"},
    {"NoVendor", [](Description& d) { d.plugin.vendor = nullptr; }, "vendor is null, expected a text"},
    {"LawsNull", [](Description& d) { d.plugin.laws = nullptr; }, "laws is null, expected 1 entries"},
    {"LawNull", [](Description& d) { d.laws[0] = nullptr; }, "law 0: law is null"},
    {"LawNowhere", [](Description& d) { d.laws[0] = static_cast<const ilaw_law*>(no_address); },
     "law 0: law points to memory that cannot be read"},
    {"LawsNowhere", [](Description& d) { d.plugin.laws = static_cast<const ilaw_law* const*>(no_address); },
     "laws points to memory that cannot be read"},
    {"HugeLaw", [](Description& d) { d.law.struct_size = 4097; },
     "law 0: law has struct_size 4097, expected at least 160 and at most 4096"},
    {"SpinsInThePlane",
     [](Description& d) {
       d.law.delassus_forms = ILAW_DELASSUS_TRANSVERSE_SPIN;
       d.law.dimensions = ILAW_DIMENSION_2;
     },
     "law 'bond': delassus_forms has spins, expected dimension 3 among dimensions"},
    {"ParameterWithoutSpins", [](Description& d) { d.number.flags |= ILAW_FLAG_NEEDS_SPINS; },
     "law 'bond': parameter 'strength' needs spins, expected a form with spins among delassus_forms"},
    {"AmountTwice", [](Description& d) { d.law.amount_count = 2; },
     "law 'bond': amount 'heat' is declared twice"},
    {"AmountsNull", [](Description& d) { d.law.amounts = nullptr; },
     "law 'bond': amounts is null, expected 1 entries"},
    {"SmallAmount", [](Description& d) { d.amount.struct_size = 8; },
     "law 'bond': amount 0: amount has struct_size 8, expected at least 32 and at most 4096"},
    {"AmountWithoutUnit", [](Description& d) { d.amount.unit = nullptr; },
     "law 'bond': amount 'heat': unit is null, expected a text"},
    {"AxisTwice", [](Description& d) { d.axes[1] = "time"; },
     "law 'bond': parameter 'strength': axis 'time' is declared twice"},
    {"AxesNull", [](Description& d) { d.number.axes = nullptr; },
     "law 'bond': parameter 'strength': axes is null, expected 2 entries"},
    {"AxisOfABadName", [](Description& d) { d.axes[0] = "Slip speed"; },
     "law 'bond': parameter 'strength': an axis is 'Slip speed', expected lower-case letters, digits "
     "and '_'"},
    {"LinesInADoc", [](Description& d) { d.law.doc = "two\n\tlines"; }, ""},
    {"BellInADoc", [](Description& d) { d.law.doc = "two\alines"; },
     "law 'bond': doc has bytes that are no UTF-8 or control characters"},
    {"LettersOfFourBytes", [](Description& d) { d.law.title = "\u00e9 \u20ac \U0001F600"; }, ""},
    {"TextWithoutEnd",
     [](Description& d) {
       static const std::string endless(70000, 'a');
       d.law.doc = endless.c_str();
     },
     "law 'bond': doc is no readable text of at most 64 KiB"},
    {"ReferenceNull", [](Description& d) { d.references[0] = nullptr; },
     "law 'bond': a reference is null, expected a text"},
    {"ParameterTwice", [](Description& d) { d.parameters[1] = &d.number; },
     "law 'bond': parameter 'strength' is declared twice"},
    {"UnknownKind", [](Description& d) { d.number.kind = 9; },
     "law 'bond': parameter 'strength': kind is 9, expected at most 2"},
    {"UnknownFlags", [](Description& d) { d.number.flags = 64; },
     "law 'bond': parameter 'strength': flags is 64, expected only the bits of 63"},
    {"RangeUpsideDown", [](Description& d) { d.number.minimum = 2.0; },
     "law 'bond': parameter 'strength': minimum 2 is not below maximum 1"},
    {"RangeOfNoNumbers", [](Description& d) { d.number.maximum = NAN; },
     "law 'bond': parameter 'strength': minimum 0 is not below maximum nan"},
    {"DefaultAtAnExcludedMinimum",
     [](Description& d) {
       d.number.flags |= ILAW_FLAG_EXCLUDES_MINIMUM;
       d.number.default_value = 0.0;
     },
     "law 'bond': parameter 'strength': default 0 lies outside its own range"},
    {"DefaultBelow", [](Description& d) { d.number.default_value = -1.0; },
     "law 'bond': parameter 'strength': default -1 lies outside its own range"},
    {"DefaultInfinite", [](Description& d) { d.number.default_value = infinity; },
     "law 'bond': parameter 'strength': default inf lies outside its own range"},
    {"DefaultInfiniteWhereAllowed",
     [](Description& d) {
       d.number.default_value = infinity;
       d.number.flags |= ILAW_FLAG_ALLOWS_INFINITY;
     },
     ""},
    {"NoDefaultWhereRequired",
     [](Description& d) {
       d.number.default_value = d.choice.default_value = NAN;
       d.number.flags = d.choice.flags = ILAW_FLAG_REQUIRED;
     },
     ""},
    {"NoChoices", [](Description& d) { d.choice.choice_count = 0; },
     "law 'bond': parameter 'surface': choice_count is 0, expected at least 1"},
    {"ChoiceNull", [](Description& d) { d.choices[1] = nullptr; },
     "law 'bond': parameter 'surface': a choice is null, expected a text"},
    {"VariableTwice", [](Description& d) { d.law.state_variable_count = 2; },
     "law 'bond': state variable 'damage' is declared twice"}};
INSTANTIATE_TEST_SUITE_P(Library, FaultyDescription, ::testing::ValuesIn(faulty_descriptions),
                         [](const auto& drawn) { return drawn.param.name; });

// Rules of several members: each by its name, and what each of them refuses.
TEST(Description, HasKnownBitsOfEveryMask) {
  const struct {
    std::uint32_t ilaw_law::*mask;
    std::string name, known;
    bool needed;
  } masks[] = {{&ilaw_law::dimensions, "dimensions", "14", true},
               {&ilaw_law::delassus_forms, "delassus_forms", "31", true},
               {&ilaw_law::frames, "frames", "3", true},
               {&ilaw_law::numbers, "numbers", "3", true},
               {&ilaw_law::inputs, "inputs", "63", false},
               {&ilaw_law::outputs, "outputs", "7", false},
               {&ilaw_law::capabilities, "capabilities", "7", false},
               {&ilaw_law::permissions, "permissions", "3", false}};
  for (const auto& [mask, name, known, needed] : masks) {
    Description made;
    const std::string at = "bonds.so: law 'bond': " + name + " is ";
    made.law.*mask |= 1U << 20;
    EXPECT_EQ(made.answer(), at + std::to_string(made.law.*mask) + ", expected only the bits of " + known);
    made.law.*mask = 0;
    EXPECT_EQ(made.answer(), needed ? at + "0, expected at least one of the bits of " + known : "");
  }
}

TEST(Description, LeavesWhatIsReservedAtZero) {
  Description d;
  const std::string law = "law 'bond': ";
  for (const auto& [reserved, where] : {std::pair{&d.plugin.reserved, std::string()},
                                        {&d.law.reserved, law},
                                        {&d.number.reserved, law + "parameter 'strength': "},
                                        {&d.variable.reserved, law + "state variable 'damage': "},
                                        {&d.amount.reserved, law + "amount 'heat': "}}) {
    *reserved = 5;
    EXPECT_EQ(d.answer(), "bonds.so: " + where + "reserved is 5, expected 0");
    *reserved = 0;
  }
}

TEST(Description, HasEveryFunction) {
  const auto without = [](const char* name, auto ilaw_law::*function) {
    Description made;
    made.law.*function = nullptr;
    EXPECT_EQ(made.answer(),
              "bonds.so: law 'bond': function '" + std::string(name) + "' is null, expected a function");
  };
  without("create", &ilaw_law::create);
  without("destroy", &ilaw_law::destroy);
  without("info", &ilaw_law::info);
  without("initialise", &ilaw_law::initialise);
  without("evaluate", &ilaw_law::evaluate);
}

// Overlong, two lines, a control of two bytes, half of a pair, beyond Unicode, cut short.
TEST(Description, HasTitlesAndNamesThatMayBePrinted) {
  Description made;
  for (const char* title :
       {"\xc0\xaf", "two\nlines", "\xc2\x9b[2J", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"}) {
    made.law.title = title;
    EXPECT_EQ(made.answer(), "bonds.so: law 'bond': title has bytes that are no UTF-8 or control characters");
  }
  for (const std::string id : {"", "2bonds", "bond{}"}) {
    made.law.id = id.c_str();
    EXPECT_EQ(made.answer(),
              "bonds.so: law 0: id is '" + id + "', expected lower-case letters, digits and '_'");
  }
}

TEST(Description, HasADefaultThatIsAnIndex) {
  Description made;
  for (const auto& [chosen, text] : {std::pair{0.5, "0.5"}, {-1.0, "-1"}, {2.0, "2"}}) {
    made.choice.default_value = chosen;
    EXPECT_EQ(made.answer(), std::string("bonds.so: law 'bond': parameter 'surface': default ") + text +
                                 " is no index of its choices");
  }
}

// ---- instances ------------------------------------------------------------------------------------------

// As create is asked for it: one parameter per node, one not.
struct Instance {
  ilaw_argument per_node{
      sizeof per_node, ILAW_KIND_VALUE_PER_NODE, "strength", 0.0, nullptr, nullptr, nullptr, 0, 0};
  ilaw_argument plain{sizeof plain, ILAW_KIND_VALUE_NUMBER, "delay", 0.0, nullptr, nullptr, nullptr, 0, 0};
  ilaw_argument nameless{
      sizeof nameless, ILAW_KIND_VALUE_PER_NODE, nullptr, 0.0, nullptr, nullptr, nullptr, 0, 0};
  std::array<const ilaw_argument*, 4> arguments{&per_node, nullptr, &nameless, &plain};
  std::array<const char*, 2> names{"strength", "strength"};
  ilaw_state_variable first{sizeof first, ILAW_KIND_VECTOR, "first", "m", "", 3, 0, 0};
  ilaw_state_variable second{sizeof second, ILAW_KIND_TANGENTIAL, "second", "m", "", 2, 0, 0};
  std::array<const ilaw_state_variable*, 2> variables{&first, &second};
  ilaw_amount heat{sizeof heat, 0, "heat", "J", ""}, wear{sizeof wear, 0, "wear", "m", ""};
  std::array<const ilaw_amount*, 2> amounts{&heat, &wear}, given{&wear, &wear};
  ilaw_law law{};
  ilaw_setup setup{};
  ilaw_instance_info info{};

  Instance() {
    law.id = "bond";
    law.permissions = ILAW_MAY_SKIP_FRESH;
    law.amounts = amounts.data();
    law.amount_count = 2;
    info.permissions = ILAW_MAY_SKIP_FRESH | ILAW_MAY_SKIP_FREE;
    info.amounts = given.data();
    info.amount_count = 1;
    setup.struct_size = sizeof setup;
    setup.dimension = 3;
    setup.arguments = arguments.data();
    setup.argument_count = 4;
    info.struct_size = sizeof info;
    info.state_variables = variables.data();
    info.state_variable_count = 2;
    info.state_size = 5;
    info.per_node_parameters = names.data();
    info.per_node_parameter_count = 1;
  }
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  std::string answer() const {
    instance_descriptions known;
    try {
      checked(known);
    } catch (const refusal& error) {
      return error.what();
    }
    return "";
  }
  // Given back at once: known to be the same only while it is kept.
  const ilaw::loading::instance_description* checked(instance_descriptions& known) const {
    auto* one = known.checked({"bonds.so", law, ILAW_ABI_MINOR}, setup, info);
    known.give_back(one);
    return one;
  }
};

// A host may make an instance for each node: 60 us each would be a minute for a million.
TEST(InstanceDescriptions, AreCheckedOnceEach) {
  Instance instance;
  instance_descriptions known;
  const auto first = instance.checked(known);
  EXPECT_EQ(instance.checked(known), first);
  instance.plain.number = 7.0;  // a value changes nothing of the description
  EXPECT_EQ(instance.checked(known), first);
}

// In memory that the library uses again, at the same addresses.
TEST(InstanceDescriptions, FollowEveryChange) {
  Instance instance;
  std::string unit = "m", name = "strength";
  instance.second.unit = unit.c_str();
  instance.names = {name.c_str(), name.c_str()};
  instance_descriptions known;
  const auto first = instance.checked(known);
  const std::pair<const char*, std::function<void()>> changes[] = {
      {"text", [&] { unit[0] = 's'; }},
      {"shorter text", [&] { unit[0] = '\0'; }},
      {"element", [&] { instance.second.flags = ILAW_FLAG_INTERNAL; }},
      {"array", [&] { std::swap(instance.variables[0], instance.variables[1]); }},
      {"amount", [&] { instance.given[0] = &instance.heat; }},
      {"info", [&] { instance.info.state_version = 1; }},
      {"law", [&] { instance.law.permissions = 0; }}};
  auto last = first;
  for (const auto& [what, change] : changes) {
    change();
    const auto now = instance.checked(known);
    EXPECT_EQ(now == last, std::string(what) == "law") << what;
    EXPECT_EQ(instance.checked(known), now) << what;
    last = now;
  }
  EXPECT_STREQ(last->info.state_variables[0]->unit, "");
  EXPECT_STREQ(last->info.amounts[0]->name, "heat");
  EXPECT_EQ(last->info.state_version, 1U);
  name[0] = 'S';
  EXPECT_THROW(instance.checked(known), refusal);
  instance.setup.dimension = 2;
  EXPECT_THROW(instance.checked(known), refusal);
}

// A library that writes a new one for each instance. Those in use stay.
TEST(InstanceDescriptions, AreForgottenWhenTooMany) {
  Instance instance;
  instance_descriptions known;
  auto* first = known.checked({"bonds.so", instance.law, ILAW_ABI_MINOR}, instance.setup, instance.info);
  for (std::uint32_t version = 1; version <= 7; ++version) {
    instance.info.state_version = version;
    instance.checked(known);
  }
  instance.info.state_version = 0;
  EXPECT_EQ(instance.checked(known), first);
  instance.info.state_version = 8;
  instance.checked(known);
  instance.info.state_version = 0;
  EXPECT_NE(instance.checked(known), first);
  EXPECT_EQ(first->info.state_size, 5U);
  known.give_back(first);
}

TEST(FaultyInstance, IsNamedWithWhatWasFoundAndExpected) {
  const std::string at = "bonds.so: law 'bond': instance: ";
  const auto said_of = [](void (*make)(Instance&)) {
    Instance instance;
    make(instance);
    return instance.answer();
  };
  EXPECT_EQ(said_of([](Instance&) {}), "");
  EXPECT_EQ(said_of([](Instance& i) { i.setup.dimension = 2; }),
            at + "state variable 'first': count is 3, expected 2");
  EXPECT_EQ(said_of([](Instance& i) { i.first.kind = ILAW_KIND_AXIS; }), "");
  EXPECT_EQ(said_of([](Instance& i) { i.second.count = 3; }),
            at + "state variable 'second': count is 3, expected 2");
  EXPECT_EQ(said_of([](Instance& i) { i.first.kind = 77; }),
            at + "state variable 'first': kind is 77, expected at most 4");
  EXPECT_EQ(said_of([](Instance& i) { i.first.flags = 256; }),
            at + "state variable 'first': flags is 256, expected only the bits of 1");
  EXPECT_THAT(said_of([](Instance& i) {
                i.first.kind = ILAW_KIND_HISTORY;
                i.first.count = UINT64_MAX - 1;
                i.info.state_size = 0;  // what the sum wraps to
              }),
              testing::StartsWith(at + "state variable 'first': count is 18446744073709551614"));
  EXPECT_EQ(said_of([](Instance& i) { i.info.capabilities = 1U << 20; }),
            at + "capabilities is 1048576, expected only the bits of 7");
  EXPECT_EQ(said_of([](Instance& i) { i.info.state_size = 6; }),
            at + "state_size is 6, expected the sum of the counts, 5, and at most 1048576");
  EXPECT_EQ(said_of([](Instance& i) {
              i.first.kind = i.second.kind = ILAW_KIND_HISTORY;
              i.first.count = i.second.count = 1 << 20;
              i.info.state_size = 2 << 20;
            }),
            at + "state_size is 2097152, expected the sum of the counts, 2097152, and at most 1048576");
  EXPECT_EQ(said_of([](Instance& i) { i.variables[1] = &i.first; }),
            at + "state variable 'first' is declared twice");
  EXPECT_EQ(said_of([](Instance& i) { i.info.per_node_parameter_count = 2; }),
            at + "per-node parameter 'strength' is declared twice");
  EXPECT_EQ(said_of([](Instance& i) { i.names[0] = "delay"; }),
            at + "per-node parameter 'delay' was not given per node");
  EXPECT_EQ(said_of([](Instance& i) { i.info.per_node_parameter_count = 0; }),
            at + "per_node_parameter_count is 0, expected 1, the parameters given per node");
  EXPECT_EQ(said_of([](Instance& i) {
              i.setup.arguments = nullptr;
              i.info.per_node_parameter_count = 0;
            }),
            "");
  EXPECT_EQ(said_of([](Instance& i) { i.info.balance_inputs = 1U << 20; }),
            "bonds.so: law 'bond': reads inputs 1048576, expected only the bits of 63");
  EXPECT_EQ(said_of([](Instance& i) { i.info.permissions = ILAW_MAY_SKIP_FREE; }),
            at + "permissions is 2, expected at least the law's, 1");
  EXPECT_EQ(said_of([](Instance& i) { i.info.permissions = 9; }),
            at + "permissions is 9, expected only the bits of 3");
  EXPECT_EQ(said_of([](Instance& i) { i.info.reserved = 9; }), at + "reserved is 9, expected 0");
  EXPECT_EQ(said_of([](Instance& i) { i.info.amount_count = 2; }), at + "amount 'wear' is declared twice");
  EXPECT_EQ(said_of([](Instance& i) { i.law.amount_count = 1; }), at + "amount 'wear' is none of the law's");
}

// ---- memory ---------------------------------------------------------------------------------------------

TEST(Readable, IsMemoryThatIsThereToItsLastByte) {
  const std::string text(3 * 4096, 'a');
  EXPECT_TRUE(ilaw::loading::readable(text.data(), text.size()));
  EXPECT_FALSE(ilaw::loading::readable(text.data(), 0));
  EXPECT_FALSE(ilaw::loading::readable(text.data(), std::size_t{1} << 46));
  EXPECT_FALSE(ilaw::loading::readable(text.data(), SIZE_MAX));
  EXPECT_FALSE(ilaw::loading::readable(nullptr, 1));
  EXPECT_FALSE(ilaw::loading::readable(no_address, 1));
}

TEST(Readable, EndsWithTheLastPage) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* const room = mmap(nullptr, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(room, MAP_FAILED);
  char* const begin = static_cast<char*>(room);
  ASSERT_EQ(mprotect(begin + page, page, PROT_NONE), 0);
  for (const std::size_t size : {std::size_t{1}, page - 1, page}) {
    EXPECT_TRUE(ilaw::loading::readable(begin + page - size, size)) << size;
    EXPECT_FALSE(ilaw::loading::readable(begin + page - size, size + 1)) << size;
  }
  munmap(room, 2 * page);
}

// The kernel is asked through a pipe: a host that has no descriptors left still loads libraries.
TEST(Readable, IsTakenOnTrustWithoutDescriptors) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::string said = Description().answer();
  const bool trusted = ilaw::loading::readable(no_address, 1);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(said, "");
  EXPECT_TRUE(trusted);
}

}  // namespace
