// triad.hpp - the argument of triad.cpp.
#pragma once

#include <cstdint>

namespace ilaw::testing {

struct Triad {
  std::int64_t count;
  double* a;
  const double *b, *c;
  double s;
};

}  // namespace ilaw::testing
