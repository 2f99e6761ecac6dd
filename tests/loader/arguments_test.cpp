// ilaw::parameters: arguments of create, with all that they point to.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace {

TEST(Parameters, GiveNumbersTextsTablesAndPerNode) {
  ilaw::parameters given;
  given.number("friction", 0.3)
      .text("finish", "rough")
      .table("strength", {{"time", {0.0, 1.0}}, {"temperature", {1.0, 2.0, 4.0}}}, {1, 2, 3, 4, 5, 6})
      .per_node("temperature");
  ilaw_setup setup{};
  given.give(setup);
  ASSERT_EQ(setup.argument_count, 4U);
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(setup.arguments[i]->struct_size, sizeof(ilaw_argument));
  const ilaw_argument& number = *setup.arguments[0];
  EXPECT_EQ(number.kind, ilaw_kind{ILAW_KIND_VALUE_NUMBER});
  EXPECT_STREQ(number.name, "friction");
  EXPECT_EQ(number.number, 0.3);
  EXPECT_EQ(number.text, nullptr);
  EXPECT_EQ(number.values, nullptr);
  EXPECT_EQ(number.axes, nullptr);
  EXPECT_EQ(setup.arguments[1]->kind, ilaw_kind{ILAW_KIND_VALUE_TEXT});
  EXPECT_STREQ(setup.arguments[1]->text, "rough");
  const ilaw_argument& table = *setup.arguments[2];
  EXPECT_EQ(table.kind, ilaw_kind{ILAW_KIND_VALUE_TABLE});
  ASSERT_EQ(table.axis_count, 2U);
  EXPECT_EQ(table.axes[0]->struct_size, sizeof(ilaw_axis));
  EXPECT_STREQ(table.axes[1]->name, "temperature");
  ASSERT_EQ(table.axes[1]->count, 3U);
  EXPECT_EQ(table.axes[1]->points[2], 4.0);
  EXPECT_EQ(table.values[5], 6.0);
  EXPECT_EQ(setup.arguments[3]->kind, ilaw_kind{ILAW_KIND_VALUE_PER_NODE});
  EXPECT_STREQ(setup.arguments[3]->name, "temperature");
}

TEST(Parameters, StayValidWhenCopiedAndGivenAnew) {
  ilaw_setup setup{};
  ilaw::parameters copy;
  {
    ilaw::parameters first;
    first.table("s", {{"time", {0.0}}}, {7.0}).text("finish", "smooth");
    first.give(setup);
    copy = first;
  }
  copy.give(setup);
  EXPECT_STREQ(setup.arguments[0]->axes[0]->name, "time");
  EXPECT_EQ(setup.arguments[0]->values[0], 7.0);
  EXPECT_STREQ(setup.arguments[1]->text, "smooth");
  ilaw::parameters none;
  none.give(setup);
  EXPECT_EQ(setup.argument_count, 0U);
}

// Short texts stand in the objects themselves.
TEST(Parameters, StayValidWhenMoved) {
  ilaw_setup setup{};
  ilaw::parameters first;
  first.number("mu", 0.3).text("finish", "rough").table("s", {{"time", {0.0}}}, {7.0});
  first.give(setup);
  std::vector<ilaw::parameters> kept;
  for (int k = 0; k < 5; ++k) kept.emplace_back();  // grows, and moves those that it has
  kept.front() = std::move(first);
  first = ilaw::parameters();
  kept.resize(100);
  EXPECT_STREQ(setup.arguments[0]->name, "mu");
  EXPECT_STREQ(setup.arguments[1]->text, "rough");
  EXPECT_STREQ(setup.arguments[2]->axes[0]->name, "time");
  EXPECT_EQ(setup.arguments[2]->values[0], 7.0);
}

struct DescribedLaw {
  static constexpr const char* choices[] = {"smooth", "rough"};
  ilaw_parameter friction{}, count{}, finish{}, newer{};
  const ilaw_parameter* parameters[4] = {&friction, &count, &finish, &newer};
  ilaw_law law{};

  DescribedLaw() {
    friction.name = "friction";
    friction.flags = ILAW_FLAG_ALLOWS_INFINITY;
    count.name = "count";
    count.kind = ILAW_KIND_INTEGER;
    finish.name = "finish";
    finish.kind = ILAW_KIND_CHOICE;
    finish.choices = choices;
    finish.choice_count = 2;
    newer.name = "newer";
    newer.kind = ILAW_KIND_CHOICE + 1;
    law.id = "slide";
    law.parameters = parameters;
    law.parameter_count = 4;
  }
  DescribedLaw(const DescribedLaw&) = delete;
  DescribedLaw& operator=(const DescribedLaw&) = delete;

  std::string refusal_of(const std::string& name, const std::string& text) const {
    try {
      ilaw::parameters().set(law, name, text);
      return "";
    } catch (const ilaw::error& error) {
      EXPECT_EQ(error.code(), ILAW_INVALID_PARAMETER);
      return error.what();
    }
  }
};

// As an input file has them.
TEST(Parameters, SetTextsByTheLawsDescription) {
  const DescribedLaw known;
  ilaw::parameters given;
  given.set(known.law, "friction", "3e-1")
      .set(known.law, "friction", "inf")
      .set(known.law, "count", "-4")
      .set(known.law, "finish", "rough")
      .set(known.law, "newer", "0.5 m");
  ilaw_setup setup{};
  given.give(setup);
  ASSERT_EQ(setup.argument_count, 5U);
  EXPECT_EQ(setup.arguments[0]->kind, ilaw_kind{ILAW_KIND_VALUE_NUMBER});
  EXPECT_EQ(setup.arguments[0]->number, 0.3);
  EXPECT_EQ(setup.arguments[1]->number, INFINITY);
  EXPECT_EQ(setup.arguments[2]->number, -4.0);
  EXPECT_EQ(setup.arguments[3]->kind, ilaw_kind{ILAW_KIND_VALUE_TEXT});
  EXPECT_STREQ(setup.arguments[3]->text, "rough");
  EXPECT_STREQ(setup.arguments[4]->text, "0.5 m");
}

TEST(Parameters, NameWhatATextMayBe) {
  const DescribedLaw known;
  for (const char* text : {"", "fast", "0.3x", " 0.3", "0.3 ", "0,3", "nan", "-inf", "1e999", "0x1p3"})
    EXPECT_EQ(known.refusal_of("friction", text), std::string("law 'slide': parameter 'friction': found '") +
                                                      text + "', expected a number or inf");
  for (const char* text : {"2.5", "inf"})
    EXPECT_EQ(known.refusal_of("count", text),
              std::string("law 'slide': parameter 'count': found '") + text + "', expected a whole number");
  EXPECT_EQ(known.refusal_of("finish", "Rough"),
            "law 'slide': parameter 'finish': found 'Rough', expected one of smooth, rough");
  EXPECT_EQ(known.refusal_of("fricton", "0.3"),
            "law 'slide': unknown parameter 'fricton', expected one of friction, count, finish, newer");
}

std::string refusal_of(const std::vector<ilaw::parameters::axis>& axes, const std::vector<double>& values) {
  try {
    ilaw::parameters().table("s", axes, values);
    return "";
  } catch (const ilaw::error& error) {
    return error.what();
  }
}

// A law reads one value per point of the grid, whatever the table has.
TEST(Parameters, RefuseATableWithoutOneValuePerPoint) {
  const std::string said = "parameter 's': a table of 3 values; expected one value per point of its axes";
  EXPECT_EQ(refusal_of({{"time", {0.0, 1.0}}, {"speed", {0.0, 1.0}}}, {1, 2, 3}), said);
  EXPECT_EQ(refusal_of({}, {1, 2, 3}), said);
  EXPECT_EQ(refusal_of({{"time", {}}}, {1, 2, 3}), said);
  EXPECT_EQ(refusal_of({{"time", {0, 1, 2}}}, {1, 2, 3}), "");
}

}  // namespace
