/* protocol.c - a host in C99 for the protocols of ilaw.protocols: one point against the plane z = 0.
 *
 * Usage: protocol_c FILE. Prints displacement, velocity and the sum of the impulses.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#include <ilaw/loader.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 16 };

static char law[64], names[MOST][64];
static double values[MOST], mass, area, h, position[3], v[3], stiffness[3], force[3], wall[3];
static double u[3], v_free[3], v_before[3], gap, impulse[3], sum[3];
static const double normal[3] = {0.0, 0.0, 1.0};
static size_t parameters;
static int steps, restart;

static void fail(const char* what, const char* why) {
  fprintf(stderr, "protocol_c: %s: %s\n", what, why ? why : "refused");
  exit(1);
}

static void read_numbers(FILE* file, const char* name, double* to, int count) {
  for (int c = 0; c < count; ++c)
    if (fscanf(file, "%lf", &to[c]) != 1) fail(name, "no number");
}

static void read_protocol(const char* path) {
  FILE* file = fopen(path, "r");
  if (!file) fail(path, "cannot be opened");
  const struct {
    const char* name;
    double* to;
    int count;
  } known[] = {{"mass", &mass, 1},        {"area", &area, 1}, {"step", &h, 1},
               {"position", position, 3}, {"velocity", v, 3}, {"stiffness", stiffness, 3},
               {"force", force, 3},       {"wall", wall, 3}};
  char name[64];
  while (fscanf(file, "%63s", name) == 1) {
    double number;
    if (!strcmp(name, "law")) {
      if (fscanf(file, "%63s", law) != 1) fail(name, "no name");
      continue;
    }
    if (!strcmp(name, "parameter")) {
      if (parameters == MOST || fscanf(file, "%63s", names[parameters]) != 1)
        fail(name, "no name, or too many");
      read_numbers(file, name, &values[parameters++], 1);
      continue;
    }
    if (!strcmp(name, "steps") || !strcmp(name, "restart")) {
      read_numbers(file, name, &number, 1);
      *(strcmp(name, "steps") ? &restart : &steps) = (int)number;
      continue;
    }
    size_t k = 0;
    while (k < sizeof known / sizeof *known && strcmp(name, known[k].name)) ++k;
    if (k == sizeof known / sizeof *known) fail(name, "not known");
    read_numbers(file, name, known[k].to, known[k].count);
  }
  fclose(file);
}

static ilaw_interface* create_interface(void) {
  char message[512];
  ilaw_library* library;
  if (ilaw_library_open_named(law, &library, message, sizeof message) != ILAW_OK) fail("open", message);
  ilaw_argument given[MOST];
  const ilaw_argument* arguments[MOST];
  for (size_t k = 0; k < parameters; ++k) {
    given[k] = (ilaw_argument){.struct_size = sizeof given[k], .name = names[k], .number = values[k]};
    arguments[k] = &given[k];
  }
  const ilaw_setup setup = {.struct_size = sizeof setup,
                            .dimension = 3,
                            .delassus_form = ILAW_DELASSUS_SCALAR,
                            .frame = ILAW_FRAME_GLOBAL,
                            .numbers = ILAW_NUMBERS_DOUBLE,
                            .arguments = arguments,
                            .argument_count = parameters};
  ilaw_interface* interface;
  if (ilaw_interface_create(library, NULL, &setup, &interface, message, sizeof message) != ILAW_OK)
    fail("create", message);
  ilaw_library_close(library);
  return interface;
}

static ilaw_batch describe_batch(const double* inverse_mass, double* state) {
  return (ilaw_batch){.struct_size = sizeof(ilaw_batch),
                      .node_count = 1,
                      .position_step = h,
                      .v_free = {v_free, NULL, 3, 1},
                      .delassus = {inverse_mass, NULL, 1, 0},
                      .gap = {&gap, NULL, 1, 0},
                      .v_previous = {v_before, NULL, 3, 1},
                      .area = {&area, NULL, 1, 0},
                      .normal = {normal, NULL, 3, 1},
                      .state_in = {state, NULL, 0, 1},
                      .state_out = {state, NULL, 0, 1},
                      .impulse = {impulse, NULL, 3, 1}};
}

static void kick(const ilaw_interface* interface, ilaw_batch* batch, double time, double duration) {
  const double inverse_mass = 1.0 / mass;
  for (int c = 0; c < 3; ++c) {
    v_before[c] = v[c] - wall[c];
    v[c] += duration * inverse_mass * (force[c] - stiffness[c] * u[c]);
    v_free[c] = v[c] - wall[c];
  }
  gap = position[2] + u[2] - time * wall[2];
  batch->time = time;
  batch->velocity_step = duration;
  ilaw_report report = {.struct_size = sizeof report};
  if (ilaw_interface_evaluate(interface, batch, &report) != ILAW_OK) fail("evaluate", report.reason);
  for (int c = 0; c < 3; ++c) {
    v[c] += inverse_mass * impulse[c];
    sum[c] += impulse[c];
  }
}

int main(int argc, char** argv) {
  if (argc != 2) fail("usage", "protocol_c FILE");
  read_protocol(argv[1]);
  ilaw_interface* interface = create_interface();
  ilaw_instance_info info = {.struct_size = sizeof info};
  if (ilaw_interface_info(interface, &info) != ILAW_OK) fail("info", NULL);
  double* state = calloc(info.state_size + 1, sizeof *state);
  if (!state) fail("state", "out of memory");

  const double inverse_mass = 1.0 / mass;
  ilaw_batch batch = describe_batch(&inverse_mass, state);
  ilaw_report report = {.struct_size = sizeof report};
  if (ilaw_interface_initialise(interface, &batch, &report) != ILAW_OK) fail("initialise", report.reason);
  kick(interface, &batch, 0.0, 0.5 * h);
  for (int n = 1; n <= steps; ++n) {
    for (int c = 0; c < 3; ++c) u[c] += h * v[c];
    kick(interface, &batch, n * h, h);
    if (n == restart) { /* the state is all that an instance leaves */
      ilaw_interface_destroy(interface);
      interface = create_interface();
    }
  }
  for (int c = 0; c < 9; ++c) printf("%.17g\n", c < 3 ? u[c] : c < 6 ? v[c - 3] : sum[c - 6]);
  free(state);
  ilaw_interface_destroy(interface);
  return 0;
}
