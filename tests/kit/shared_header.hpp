// A header as an author writes it who knows nothing of instruction-set levels: what it defines has the same
// name at all of them.
#pragma once

struct shared_series {
  double ratio;

  [[gnu::noinline]] double sum(double x) const {
    double terms[64], total = 0.0;
    for (int k = 0; k < 64; ++k) terms[k] = x * ratio + k * x;
    for (const double term : terms) total += term;
    return total;
  }
};

[[gnu::noinline]] inline double shared_twice(double x) {
  double copies[32], total = 0.0;
  for (int k = 0; k < 32; ++k) copies[k] = x * (k + 1);
  for (const double copy : copies) total += copy;
  return total / 264.0;
}
