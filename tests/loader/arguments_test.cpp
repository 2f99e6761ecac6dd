// ilaw::parameters: arguments of create, with all that they point to.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include <gtest/gtest.h>

#include <string>
#include <utility>

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
