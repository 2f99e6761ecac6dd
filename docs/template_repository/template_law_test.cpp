// Closed forms of template_law: r_N = <-v_free,N - <v_N^->>/(H + 1/(h c A)) where the gap is closed.
#include <ilaw/arrays.hpp>
#include <ilaw/loader.hpp>

#include <cmath>
#include <cstdio>
#include <exception>

namespace {

constexpr double h = 1e-3, c = 500.0, area = 2.0, delassus = 0.25;

ilaw::interface create(const char* file) {
  ilaw::parameters parameters;
  parameters.number("damping", c);
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_LOCAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  parameters.give(setup);
  return {ilaw::library(file), "template_law", setup};
}

// Normal impulse of a node.
double impulse(const ilaw::interface& law, double gap, double v_free, double v_before) {
  const double free[] = {v_free, 1.0, -2.0}, before[] = {v_before, 1.0, -2.0};
  double r[3] = {};
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = 1;
  batch.velocity_step = batch.position_step = h;
  batch.v_free = ilaw::input(free, 3, 1);
  batch.v_previous = ilaw::input(before, 3, 1);
  batch.delassus = ilaw::input(&delassus, 1, 0);
  batch.gap = ilaw::input(&gap, 1, 0);
  batch.area = ilaw::input(&area, 1, 0);
  batch.impulse = ilaw::output(r, 3, 1);
  if (law.evaluate(batch) != ILAW_OK) return NAN;
  return r[1] == 0.0 && r[2] == 0.0 ? r[0] : NAN;
}

int failures = 0;

void expect(const char* what, double found, double wanted) {
  if (std::abs(found - wanted) <= 1e-14 * std::abs(wanted)) return;
  std::printf("%s: found %.17g, expected %.17g\n", what, found, wanted);
  ++failures;
}

}  // namespace

int main(int, char** words) try {
  const ilaw::interface law = create(words[1]);
  const double resistance = delassus + 1.0 / (h * c * area);
  expect("approach", impulse(law, -0.01, -3.0, -3.0), 3.0 / resistance);
  expect("turning back", impulse(law, -0.01, -3.0, 1.0), 2.0 / resistance);
  expect("separation", impulse(law, -0.01, 3.0, 3.0), 0.0);
  expect("open gap", impulse(law, 0.01, -3.0, -3.0), 0.0);
  return failures;
} catch (const std::exception& failure) {
  std::printf("%s\n", failure.what());
  return 1;
}
