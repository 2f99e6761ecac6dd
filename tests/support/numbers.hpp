// numbers.hpp - the numbers that tests of laws name again and again.
#pragma once

#include <limits>

namespace ilaw::testing {

inline constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
inline constexpr double inf_value = std::numeric_limits<double>::infinity();
inline constexpr double ulp = std::numeric_limits<double>::epsilon();  // of 1

}  // namespace ilaw::testing
