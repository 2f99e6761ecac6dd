// sizes.hpp - how many random cases a test runs through: all of them with ILAW_TEST_WHOLE in the environment,
// else a quarter, so that the suite stays short.
#pragma once

#include <cstdlib>

namespace ilaw::testing {

inline int part_of(int whole) { return std::getenv("ILAW_TEST_WHOLE") ? whole : (whole + 3) / 4; }

}  // namespace ilaw::testing
