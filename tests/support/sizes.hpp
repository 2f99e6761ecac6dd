// sizes.hpp - how many random cases or steps a test runs through: all of them with ILAW_TEST_WHOLE in the
// environment, as by .ci/night, else a quarter, so that the suite stays short.
#pragma once

#include <cstdlib>

namespace ilaw::testing {

inline int part_of(int whole) { return std::getenv("ILAW_TEST_WHOLE") ? whole : (whole + 3) / 4; }

// Of combinations of a few values: one of five, so that loops of two, three, four or six values are not in
// step.
inline bool is_in_part(int number) { return std::getenv("ILAW_TEST_WHOLE") || number % 5 == 0; }

}  // namespace ilaw::testing
