// matchers.hpp - gmock's matchers under their own names.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <string>

namespace ilaw::testing::matchers {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Lt;
using ::testing::Not;
using ::testing::Pointwise;
using ::testing::StartsWith;

// Vectors whose components differ from those of another by at most a tolerance.
MATCHER_P2(VectorNear, expected, tolerance, "") {
  return std::equal(arg.begin(), arg.end(), expected.begin(), expected.end(),
                    [&](double a, double b) { return std::abs(a - b) <= tolerance; });
}

// Arrays of the same bits: a NaN is itself, and -0 is not 0.
template <class Array>
bool same_bits(const Array& a, const Array& b) {
  return std::size(a) == std::size(b) &&
         (std::size(a) == 0 || std::memcmp(std::data(a), std::data(b), std::size(a) * sizeof a[0]) == 0);
}
MATCHER_P(SameBits, expected, "") { return same_bits(arg, expected); }

template <class... Values>
std::string given(const char* names, const Values&... values) {
  std::string text = std::string("given ") + names + " =";
  ((text += " " + ::testing::PrintToString(values)), ...);
  return text;
}

}  // namespace ilaw::testing::matchers

// Names the values of a case in what fails below: GIVEN(step, friction).
#define GIVEN(...) SCOPED_TRACE(::ilaw::testing::matchers::given(#__VA_ARGS__, __VA_ARGS__))

namespace ilaw::testing {
using namespace matchers;
}
namespace ilaw::host::testing {
using namespace ilaw::testing::matchers;
}
