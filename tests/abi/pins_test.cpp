// Members of structs stay where the frozen headers have them, and fill their structs without padding.
#include "pins.h"

#include <ilaw/ilaw.h>

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace {

void expect_to_stay(const ilaw_pin* was, const ilaw_pin* is) {
  int structs = 0;
  for (; was->name; ++was, ++is) {
    const std::string member = std::string(was->name) + "." + was->member;
    if (*was->member == '\0') {
      ++structs;
      EXPECT_GE(is->offset, was->offset) << "size of " << was->name;
      continue;
    }
    EXPECT_EQ(is->offset, was->offset) << member;
    EXPECT_EQ(is->size, was->size) << member;
  }
  EXPECT_EQ(structs, 13);
}

TEST(Pins, MembersStayWhereTheyWere) { expect_to_stay(ilaw_pins_1_0_frozen(), ilaw_pins_1_0_today()); }

// A member that was put into padding would change nothing that a size shows.
TEST(Pins, LeaveNoPadding) {
  std::size_t end = 0;
  for (const ilaw_pin* pin = ilaw_pins_1_0_frozen(); pin->name; ++pin) {
    EXPECT_EQ(pin->offset, end) << pin->name << "." << pin->member;
    end = *pin->member == '\0' ? 0 : end + pin->size;
  }
}

// The least that a reader accepts is what the frozen header of 1.0 has.
TEST(Pins, SizesOfVersionOneAreThoseOfItsStructs) {
  const std::map<std::string, std::size_t> least{{"ilaw_parameter", ILAW_PARAMETER_SIZE_1_0},
                                                 {"ilaw_state_variable", ILAW_STATE_VARIABLE_SIZE_1_0},
                                                 {"ilaw_amount", ILAW_AMOUNT_SIZE_1_0},
                                                 {"ilaw_axis", ILAW_AXIS_SIZE_1_0},
                                                 {"ilaw_argument", ILAW_ARGUMENT_SIZE_1_0},
                                                 {"ilaw_setup", ILAW_SETUP_SIZE_1_0},
                                                 {"ilaw_instance_info", ILAW_INSTANCE_INFO_SIZE_1_0},
                                                 {"ilaw_batch", ILAW_BATCH_SIZE_1_0},
                                                 {"ilaw_report", ILAW_REPORT_SIZE_1_0},
                                                 {"ilaw_law", ILAW_LAW_SIZE_1_0},
                                                 {"ilaw_plugin", ILAW_PLUGIN_SIZE_1_0}};
  std::size_t found = 0;
  for (const ilaw_pin* pin = ilaw_pins_1_0_frozen(); pin->name; ++pin) {
    if (*pin->member != '\0' || !least.count(pin->name)) continue;
    ++found;
    EXPECT_EQ(pin->offset, least.at(pin->name)) << pin->name;
  }
  EXPECT_EQ(found, least.size());
}

}  // namespace
