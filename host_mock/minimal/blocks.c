/* blocks.c - a small explicit code that hosts an interface law, in C99.
 *
 * Blocks on springs slide on a floor (z up): central differences with a lumped mass matrix, and at each step
 * the law's impulse. The last block hangs in the air and is no interface node. Usage: blocks_c LIBRARY
 * blocks.f90 is the same host in Fortran and prints the same bits.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#include <ilaw/loader.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCKS = 7, FLOOR_NODES = 6, STEPS = 3000 };
typedef double vectors[BLOCKS][3];

static const double h = 1e-3, gravity[3] = {0.0, 0.0, -10.0};
static const double mass[BLOCKS] = {1.0, 2.5, 0.7, 2.0, 1.5, 1.0, 0.8};
static const double stiffness[BLOCKS] = {0.0, 0.0, 0.0, 50.0, 20.0, 100.0, 30.0};
static const int32_t floor_nodes[FLOOR_NODES] = {0, 1, 2, 3, 4, 5};
static const double up[3] = {0.0, 0.0, 1.0};

static vectors u = {{0, 0, 0},       {0, 0, 0},        {0, 0, 0.05}, {0.4, -0.3, 0},
                    {0.06, 0.08, 0}, {-0.24, 0.32, 0}, {0, 0, 0.1}};
static vectors v = {{0.72, 0.96, 0}, {-1.6, 1.2, 0}, {1.8, 2.4, 0}};
static vectors v_previous, force, impulse;
static double inverse_mass[BLOCKS], energy[BLOCKS][ILAW_ENERGY_COUNT], friction_work[BLOCKS];
static uint8_t status[BLOCKS];

static void fail(const char* what, const char* why) {
  fprintf(stderr, "blocks_c: %s: %s\n", what, why);
  exit(1);
}

static void sum_forces(void) {
  for (int i = 0; i < BLOCKS; ++i)
    for (int c = 0; c < 3; ++c) force[i][c] = mass[i] * gravity[c] - stiffness[i] * u[i][c];
}

static void kick(double step) {
  for (int i = 0; i < BLOCKS; ++i)
    for (int c = 0; c < 3; ++c) v[i][c] += step * inverse_mass[i] * force[i][c];
}

static ilaw_interface* create_interface(const char* library_name) {
  char message[512];
  ilaw_library* library;
  if (ilaw_library_open(library_name, &library, message, sizeof message) != ILAW_OK) fail("open", message);

  const ilaw_argument friction = {.struct_size = sizeof friction, .name = "friction", .number = 0.3};
  const ilaw_argument activation = {.struct_size = sizeof activation,
                                    .kind = ILAW_KIND_VALUE_TEXT,
                                    .name = "activation",
                                    .text = "predictive"};
  const ilaw_argument* const arguments[] = {&friction, &activation};
  const ilaw_setup setup = {.struct_size = sizeof setup,
                            .dimension = 3,
                            .delassus_form = ILAW_DELASSUS_SCALAR,
                            .frame = ILAW_FRAME_GLOBAL,
                            .numbers = ILAW_NUMBERS_DOUBLE,
                            .arguments = arguments,
                            .argument_count = 2};
  ilaw_interface* interface;
  if (ilaw_interface_create(library, NULL, &setup, &interface, message, sizeof message) != ILAW_OK)
    fail("create", message);
  ilaw_library_close(library); /* the interface keeps it loaded */
  return interface;
}

static ilaw_batch describe_batch(const ilaw_instance_info* info, double* state) {
  const uint32_t given = ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_NORMAL;
  if ((info->inputs | info->balance_inputs) & ~given)
    fail("law", "reads an input that this code does not have");
  const int64_t state_size = (int64_t)info->state_size;
  return (ilaw_batch){.struct_size = sizeof(ilaw_batch),
                      .node_count = FLOOR_NODES,
                      .index = floor_nodes, /* the arrays below are the solver's own, over all its nodes */
                      .position_step = h,
                      .v_free = {&v[0][0], NULL, 3, 1},
                      .delassus = {inverse_mass, NULL, 1, 0},
                      .gap = {&u[0][2], NULL, 3, 0}, /* height over the floor: a component of u, in place */
                      .v_previous = {&v_previous[0][0], NULL, 3, 1},
                      .normal = {up, NULL, 0, 1}, /* the same at every node */
                      .state_in = {state, NULL, state_size, 1},
                      .state_out = {state, NULL, state_size, 1},
                      .impulse = {&impulse[0][0], NULL, 3, 1},
                      .energy = {&energy[0][0], NULL, ILAW_ENERGY_COUNT, 1},
                      .status = status,
                      .status_stride = 1};
}

/* A kick by all forces, then the impulse of the law. impulse and energy stay 0 outside floor_nodes. */
static void kick_with_law(const ilaw_interface* interface, ilaw_batch* batch, double time, double duration) {
  sum_forces();
  memcpy(v_previous, v, sizeof v);
  kick(duration); /* v is v_free now */

  ilaw_report report = {.struct_size = sizeof report};
  batch->time = time;
  batch->velocity_step = duration;
  if (ilaw_interface_evaluate(interface, batch, &report) != ILAW_OK) fail("evaluate", report.reason);

  for (int i = 0; i < BLOCKS; ++i) {
    for (int c = 0; c < 3; ++c) v[i][c] += inverse_mass[i] * impulse[i][c];
    friction_work[i] += energy[i][ILAW_ENERGY_FRICTION];
  }
}

int main(int argc, char** argv) {
  if (argc != 2) fail("usage", "blocks_c LIBRARY");
  ilaw_interface* interface = create_interface(argv[1]);
  ilaw_instance_info info = {.struct_size = sizeof info};
  if (ilaw_interface_info(interface, &info) != ILAW_OK) fail("info", "refused");
  double* state = calloc(BLOCKS * info.state_size + 1, sizeof *state);
  if (!state) fail("state", "out of memory");
  for (int i = 0; i < BLOCKS; ++i) inverse_mass[i] = 1.0 / mass[i];

  ilaw_batch batch = describe_batch(&info, state);
  ilaw_report report = {.struct_size = sizeof report};
  if (ilaw_interface_initialise(interface, &batch, &report) != ILAW_OK) fail("initialise", report.reason);
  kick_with_law(interface, &batch, 0.0, 0.5 * h); /* V_1/2 */
  for (int n = 0; n < STEPS; ++n) {
    for (int i = 0; i < BLOCKS; ++i)
      for (int c = 0; c < 3; ++c) u[i][c] += h * v[i][c];
    kick_with_law(interface, &batch, (n + 1) * h, h);
  }

  for (int i = 0; i < BLOCKS; ++i)
    printf("%2d %24.16E %24.16E %24.16E %24.16E %2d\n", i, u[i][0], u[i][1], u[i][2], friction_work[i],
           status[i]);
  free(state);
  ilaw_interface_destroy(interface);
  return 0;
}
