/* ball.c - a ball that rolls and spins on a plane, in C99: a host that hands spins to a law.
 *
 * Usage: ball_c LIBRARY SLOPE SPEED SPIN SECONDS. The plane falls along x by the angle SLOPE (rad); the ball
 * starts with SPEED along x and SPIN about the normal. Prints position, velocity, R w_y, w_z and what the law
 * has dissipated over the energy lost.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#include <ilaw/loader.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double mass = 0.3, radius = 0.05, gravity = 9.81, h = 1e-4;
static const double up[3] = {0.0, 0.0, 1.0};
static double x[3], v[3], w[3], dissipated;

static void fail(const char* what, const char* why) {
  fprintf(stderr, "ball_c: %s: %s\n", what, why ? why : "refused");
  exit(1);
}

static ilaw_interface* create_interface(const char* library_name) {
  char message[512];
  ilaw_library* library;
  if (ilaw_library_open(library_name, &library, message, sizeof message) != ILAW_OK) fail("open", message);
  const ilaw_argument friction = {.struct_size = sizeof friction, .name = "friction", .number = 0.5};
  const ilaw_argument rolling = {.struct_size = sizeof rolling, .name = "rolling_friction", .number = 2e-3};
  const ilaw_argument twisting = {
      .struct_size = sizeof twisting, .name = "twisting_friction", .number = 1e-3};
  const ilaw_argument* const arguments[] = {&friction, &rolling, &twisting};
  const ilaw_setup setup = {.struct_size = sizeof setup,
                            .dimension = 3,
                            .delassus_form = ILAW_DELASSUS_TRANSVERSE_SPIN,
                            .frame = ILAW_FRAME_GLOBAL,
                            .numbers = ILAW_NUMBERS_DOUBLE,
                            .arguments = arguments,
                            .argument_count = 3};
  ilaw_interface* interface;
  if (ilaw_interface_create(library, NULL, &setup, &interface, message, sizeof message) != ILAW_OK)
    fail("create", message);
  ilaw_library_close(library);
  return interface;
}

/* The velocity of the contact point, v + w x (-R n) for n along z. */
static void at_contact(double* out) {
  out[0] = v[0] - radius * w[1];
  out[1] = v[1] + radius * w[0];
  out[2] = v[2];
}

int main(int argc, char** argv) {
  if (argc != 6) fail("usage", "ball_c LIBRARY SLOPE SPEED SPIN SECONDS");
  ilaw_interface* interface = create_interface(argv[1]);
  const double slope = atof(argv[2]), inertia = 0.4 * mass * radius * radius;
  const double pull[3] = {gravity * sin(slope), 0.0, -gravity * cos(slope)};
  const double delassus[5] = {1.0 / mass, 1.0 / mass + radius * radius / inertia, radius / inertia,
                              1.0 / inertia, 1.0 / inertia};
  const double gap = 0.0;
  double free_v[3], previous_v[3], free_w[3], previous_w[3], r[3], m[3], energy[ILAW_ENERGY_COUNT];
  v[0] = atof(argv[3]), w[1] = v[0] / radius, w[2] = atof(argv[4]);

  ilaw_batch batch = {.struct_size = sizeof batch, .node_count = 1, .velocity_step = h, .position_step = h};
  batch.v_free = (ilaw_input){free_v, NULL, 3, 1};
  batch.v_previous = (ilaw_input){previous_v, NULL, 3, 1};
  batch.spin_free = (ilaw_input){free_w, NULL, 3, 1};
  batch.spin_previous = (ilaw_input){previous_w, NULL, 3, 1};
  batch.delassus = (ilaw_input){delassus, NULL, 5, 1};
  batch.gap = (ilaw_input){&gap, NULL, 1, 1};
  batch.normal = (ilaw_input){up, NULL, 3, 1};
  batch.impulse = (ilaw_output){r, NULL, 3, 1};
  batch.moment = (ilaw_output){m, NULL, 3, 1};
  batch.energy = (ilaw_output){energy, NULL, ILAW_ENERGY_COUNT, 1};

  const double at_start = 0.5 * mass * v[0] * v[0] + 0.5 * inertia * (w[1] * w[1] + w[2] * w[2]);
  const long steps = lround(atof(argv[5]) / h);
  for (long k = 1; k <= steps; ++k) {
    at_contact(previous_v);
    for (int c = 0; c < 3; ++c) v[c] += h * pull[c];
    at_contact(free_v);
    for (int c = 0; c < 3; ++c) previous_w[c] = free_w[c] = w[c];
    ilaw_report report = {.struct_size = sizeof report};
    batch.time = (double)k * h;
    if (ilaw_interface_evaluate(interface, &batch, &report) != ILAW_OK) fail("evaluate", report.reason);
    for (int c = 0; c < 3; ++c) v[c] += r[c] / mass;
    w[0] += (radius * r[1] + m[0]) / inertia; /* I w += (-R n) x r + m */
    w[1] += (-radius * r[0] + m[1]) / inertia;
    w[2] += m[2] / inertia;
    for (int c = 0; c < 3; ++c) x[c] += h * v[c];
    dissipated += energy[ILAW_ENERGY_FRICTION] + energy[ILAW_ENERGY_IMPACT];
  }
  const double lost =
      at_start + mass * pull[0] * x[0] -
      (0.5 * mass * (v[0] * v[0] + v[1] * v[1]) + 0.5 * inertia * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
  printf("%.17g %.17g %.17g %.17g %.17g\n", x[0], v[0], radius * w[1], w[2],
         lost > 0.0 ? dissipated / lost : 1.0);
  ilaw_interface_destroy(interface);
  return 0;
}
