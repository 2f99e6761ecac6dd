/* static_host.c - a host and a law in C99 in one static program, without loader and C++ runtime, for any C
 * library.
 *
 * A point slides on a plane, with the friction of plugins/template_c, until it stops. Prints place, velocity
 * and heat in hexadecimal digits, the same for every C library and processor (tests/platforms/static.sh).
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#include <ilaw/ilaw.h>

#include <stdio.h>
#include <stdlib.h>

const ilaw_plugin* ILAW_CALL ILAW_ENTRY(void);

enum { STEPS = 1000 };

int main(void) {
  const double h = 1.0 / 512, mass = 2.0, inverse_mass = 1.0 / mass, gravity = 9.81;
  const ilaw_law* law = ILAW_ENTRY()->laws[0];
  const ilaw_argument friction = {.struct_size = sizeof friction, .name = "friction", .number = 0.3};
  const ilaw_argument* const arguments[] = {&friction};
  const ilaw_setup setup = {.struct_size = sizeof setup,
                            .dimension = 2,
                            .delassus_form = ILAW_DELASSUS_SCALAR,
                            .frame = ILAW_FRAME_LOCAL,
                            .numbers = ILAW_NUMBERS_DOUBLE,
                            .arguments = arguments,
                            .argument_count = 1};
  char message[256];
  ilaw_instance* instance;
  if (law->create(law->id, &setup, &instance, message, sizeof message) != ILAW_OK) {
    fprintf(stderr, "static_host: %s\n", message);
    return 1;
  }
  double u[2] = {0.0, 0.0}, v[2] = {0.0, 1.4}, before[2], impulse[2], gap, heat = 0.0, heat_of_step;
  const ilaw_output amounts[] = {{&heat_of_step, NULL, 1, 0}, {NULL, NULL, 0, 0}};
  ilaw_batch batch = {.struct_size = sizeof batch,
                      .node_count = 1,
                      .position_step = h,
                      .v_free = {v, NULL, 2, 1},
                      .delassus = {&inverse_mass, NULL, 1, 0},
                      .gap = {&gap, NULL, 1, 0},
                      .v_previous = {before, NULL, 2, 1},
                      .impulse = {impulse, NULL, 2, 1},
                      .amounts = amounts};
  for (int n = 0; n <= STEPS; ++n) { /* the start is half a kick */
    const double duration = n == 0 ? 0.5 * h : h;
    for (int c = 0; c < 2; ++c) {
      u[c] += n == 0 ? 0.0 : h * v[c];
      before[c] = v[c];
    }
    v[0] -= duration * gravity;
    gap = u[0];
    batch.time = n * h;
    batch.velocity_step = duration;
    ilaw_report report = {.struct_size = sizeof report};
    if (law->evaluate(instance, &batch, &report) != ILAW_OK) {
      fprintf(stderr, "static_host: %s\n", report.reason ? report.reason : "refused");
      return 1;
    }
    for (int c = 0; c < 2; ++c) v[c] += inverse_mass * impulse[c];
    heat += heat_of_step;
  }
  printf("u %a %a v %a %a heat %a\n", u[0], u[1], v[0], v[1], heat);
  law->destroy(instance);
  return 0;
}
