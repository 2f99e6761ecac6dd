/* grains.c - a small discrete-element code in C99: spheres that fall into a box, with rotation, friction and
 * pair contacts that are solved together.
 *
 * Usage: grains_c LIBRARY GRAINS STEPS SWEEPS [STEP [LAYERS]]. Prints the largest overlap over the diameter,
 * the kinetic energy over what the fall could have given, the worst residual, and sweeps per step. Given a
 * STEP (5e-3) it also says what that took; LAYERS lie on each other at the start, in a box as wide as needed.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#include <ilaw/coupled.h>
#include <ilaw/loader.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { PARTNERS = 24, FACES = 5 }; /* of a grain; of the box, which is open above */

static const double gravity = 10.0, radius = 0.5, mass = 1.0, skin = 0.1, spacing = 1.15;

static int grains, per_side, layers, cells, cells_above;
static double h = 5e-3, side, height;
static double (*x)[3], (*v)[3], (*w)[3], (*v_previous)[3], (*w_previous)[3];
static int *cell_head, *cell_next;

/* Data that a contact leaves for the next step, kept at its first grain. */
static int32_t (*partner)[PARTNERS];
static double (*kept_impulse)[PARTNERS][3], *kept_state;
static size_t state_size;

/* The contacts of a step. */
static int count, room;
static int32_t *body, *counterpart, *slot;
static double *gap, (*normal)[3], (*arm)[3], (*counterpart_arm)[3], (*impulse)[3], *state;

static void fail(const char* what, const char* why) {
  fprintf(stderr, "grains_c: %s: %s\n", what, why ? why : "refused");
  exit(1);
}

static void* array(size_t entries, size_t size) {
  void* zeroed = calloc(entries + 1, size);
  if (!zeroed) fail("memory", "out of it");
  return zeroed;
}

static ilaw_interface* create_interface(const char* library_name) {
  char message[512];
  ilaw_library* library;
  if (ilaw_library_open(library_name, &library, message, sizeof message) != ILAW_OK) fail("open", message);
  const ilaw_argument friction = {.struct_size = sizeof friction, .name = "friction", .number = 0.3};
  const ilaw_argument* const arguments[] = {&friction};
  const ilaw_setup setup = {.struct_size = sizeof setup,
                            .dimension = 3,
                            .delassus_form = ILAW_DELASSUS_TRANSVERSE, /* spheres that rotate */
                            .frame = ILAW_FRAME_GLOBAL,
                            .numbers = ILAW_NUMBERS_DOUBLE,
                            .arguments = arguments,
                            .argument_count = 1};
  ilaw_interface* interface;
  if (ilaw_interface_create(library, NULL, &setup, &interface, message, sizeof message) != ILAW_OK)
    fail("create", message);
  ilaw_library_close(library);
  return interface;
}

/* Grains on a lattice, each a little off its place, by a generator that is the same everywhere. */
static void place_grains(void) {
  uint32_t seed = 1;
  for (int i = 0; i < grains; ++i) {
    const int at[3] = {i % per_side, i / per_side % per_side, i / (per_side * per_side)};
    for (int c = 0; c < 3; ++c) {
      seed = seed * 1664525u + 1013904223u;
      x[i][c] = (at[c] + 0.5) * spacing + 0.1 * ((seed >> 8) / 16777216.0 - 0.5);
    }
  }
}

static int cell_of(double coordinate, int most) {
  const int cell = (int)floor(coordinate / (2 * radius + skin));
  return cell < 0 ? 0 : cell >= most ? most - 1 : cell;
}

static int cell_index(const int* at) { return (at[2] * cells + at[1]) * cells + at[0]; }

static void sort_into_cells(void) {
  for (int i = 0; i < cells * cells * cells_above; ++i) cell_head[i] = -1;
  for (int i = 0; i < grains; ++i) {
    const int at[3] = {cell_of(x[i][0], cells), cell_of(x[i][1], cells), cell_of(x[i][2], cells_above)};
    cell_next[i] = cell_head[cell_index(at)];
    cell_head[cell_index(at)] = i;
  }
}

/* n points from `other` (below 0: a face of the box) to grain i. */
static void add_contact(int i, int other, double distance, const double* n) {
  if (count == room) fail("contacts", "more than there is room for");
  body[count] = i;
  counterpart[count] = other;
  gap[count] = distance;
  slot[count] = -1;
  memset(impulse[count], 0, sizeof impulse[count]);
  for (int p = 0; p < PARTNERS; ++p)
    if (partner[i][p] == other) {
      slot[count] = p;
      memcpy(impulse[count], kept_impulse[i][p], sizeof impulse[count]);
      memcpy(state + count * state_size, kept_state + (i * PARTNERS + p) * state_size,
             state_size * sizeof *state);
    }
  for (int c = 0; c < 3; ++c) {
    normal[count][c] = n[c];
    arm[count][c] = -radius * n[c];
    counterpart_arm[count][c] = radius * n[c];
  }
  ++count;
}

static void add_walls(int i) {
  static const double inward[FACES][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  for (int face = 0; face < FACES; ++face) {
    const double along = x[i][face / 2];
    const double distance = (face == 1 || face == 3 ? side - along : along) - radius;
    if (distance < skin) add_contact(i, -1 - face, distance, inward[face]);
  }
}

/* A pair keeps its orientation for life: the grain of the higher number is the body. */
static void add_neighbours(int i) {
  const int at[3] = {cell_of(x[i][0], cells), cell_of(x[i][1], cells), cell_of(x[i][2], cells_above)};
  for (int k = 0; k < 27; ++k) {
    const int near[3] = {at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1};
    if (near[0] < 0 || near[0] >= cells || near[1] < 0 || near[1] >= cells || near[2] < 0 ||
        near[2] >= cells_above)
      continue;
    for (int j = cell_head[cell_index(near)]; j >= 0; j = cell_next[j]) {
      const double d[3] = {x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2]};
      const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      if (j >= i || length >= 2 * radius + skin) continue;
      const double n[3] = {d[0] / length, d[1] / length, d[2] / length};
      add_contact(i, j, length - 2 * radius, n);
    }
  }
}

/* New contacts get the law's first state, the others have theirs from the last step. */
static void initialise_new(const ilaw_interface* interface, const ilaw_batch* batch) {
  int32_t* fresh = array((size_t)count, sizeof *fresh);
  ilaw_batch part = *batch;
  part.node_count = 0;
  for (int k = 0; k < count; ++k)
    if (slot[k] < 0) fresh[part.node_count++] = k;
  part.index = fresh;
  ilaw_report report = {.struct_size = sizeof report};
  if (ilaw_interface_initialise(interface, &part, &report) != ILAW_OK) fail("initialise", report.reason);
  free(fresh);
}

static void keep(void) {
  for (int i = 0; i < grains; ++i)
    for (int p = 0; p < PARTNERS; ++p) partner[i][p] = INT32_MAX;
  for (int k = 0, p = 0; k < count; ++k) {
    p = k > 0 && body[k] == body[k - 1] ? p + 1 : 0;
    if (p == PARTNERS) fail("contacts", "too many at one grain");
    partner[body[k]][p] = counterpart[k];
    memcpy(kept_impulse[body[k]][p], impulse[k], sizeof impulse[k]);
    memcpy(kept_state + (body[k] * PARTNERS + p) * state_size, state + k * state_size,
           state_size * sizeof *state);
  }
}

static ilaw_coupled_report step(const ilaw_interface* interface, ilaw_coupled* solver, int n,
                                ilaw_coupled_options options) {
  for (int i = 0; i < grains; ++i)
    for (int c = 0; c < 3; ++c) x[i][c] += h * v[i][c];
  memcpy(v_previous, v, (size_t)grains * sizeof *v);
  memcpy(w_previous, w, (size_t)grains * sizeof *w);
  for (int i = 0; i < grains; ++i) v[i][2] -= h * gravity; /* v and w are v_free and spin_free now */

  sort_into_cells();
  count = 0;
  for (int i = 0; i < grains; ++i) {
    add_walls(i);
    add_neighbours(i);
  }
  const ilaw_batch batch = {.struct_size = sizeof batch,
                            .node_count = count,
                            .time = (n + 1) * h,
                            .velocity_step = h,
                            .position_step = h,
                            .gap = {gap, NULL, 1, 0},
                            .normal = {&normal[0][0], NULL, 3, 1},
                            .state_in = {state, NULL, (int64_t)state_size, 1},
                            .state_out = {state, NULL, (int64_t)state_size, 1},
                            .impulse = {&impulse[0][0], NULL, 3, 1}};
  initialise_new(interface, &batch);

  static const double inverse_mass = 1.0 / mass;
  const double inverse_inertia = 2.5 / (mass * radius * radius);
  const ilaw_bodies bodies = {.struct_size = sizeof bodies,
                              .dimension = 3,
                              .count = grains,
                              .owned_count = grains,
                              .inverse_mass = {&inverse_mass, NULL, 0, 0},
                              .inverse_inertia = {&inverse_inertia, NULL, 0, 0}, /* of spheres: one value */
                              .v_free = {&v[0][0], NULL, 3, 1},
                              .spin_free = {&w[0][0], NULL, 3, 1},
                              .v_previous = {&v_previous[0][0], NULL, 3, 1},
                              .spin_previous = {&w_previous[0][0], NULL, 3, 1},
                              .velocity = {&v[0][0], NULL, 3, 1},
                              .spin = {&w[0][0], NULL, 3, 1}};
  const ilaw_contacts contacts = {.struct_size = sizeof contacts,
                                  .delassus_form = ILAW_DELASSUS_TRANSVERSE,
                                  .law = ilaw_interface_law(interface),
                                  .instance = ilaw_interface_instance(interface),
                                  .batch = &batch,
                                  .body = body,
                                  .counterpart = counterpart,
                                  .arm = {&arm[0][0], NULL, 3, 1},
                                  .counterpart_arm = {&counterpart_arm[0][0], NULL, 3, 1}};
  const ilaw_contacts* const groups[] = {&contacts};
  ilaw_coupled_report report = {.struct_size = sizeof report};
  if (ilaw_coupled_solve(solver, &bodies, groups, 1, &options, &report) != ILAW_OK)
    fail("solve", report.reason);
  keep();
  return report;
}

static void make_room(void) {
  per_side = layers ? (int)ceil(sqrt((double)grains / layers)) : (int)ceil(cbrt(grains));
  side = per_side * spacing;
  height = ceil((double)grains / (per_side * per_side)) * spacing;
  cells = (int)(side / (2 * radius + skin)) + 1;
  cells_above = (int)(height / (2 * radius + skin)) + 2;
  x = array(grains, sizeof *x), v = array(grains, sizeof *v), w = array(grains, sizeof *w);
  v_previous = array(grains, sizeof *v), w_previous = array(grains, sizeof *w);
  cell_head = array((size_t)cells * cells * cells_above, sizeof *cell_head);
  cell_next = array(grains, sizeof *cell_next);
  partner = array(grains, sizeof *partner), kept_impulse = array(grains, sizeof *kept_impulse);
  kept_state = array(grains * PARTNERS * state_size, sizeof *kept_state);
  for (int i = 0; i < grains; ++i)
    for (int p = 0; p < PARTNERS; ++p) partner[i][p] = INT32_MAX;
  room = 10 * grains;
  body = array(room, sizeof *body), counterpart = array(room, sizeof *body), slot = array(room, sizeof *slot);
  gap = array(room, sizeof *gap), normal = array(room, sizeof *normal), arm = array(room, sizeof *arm);
  counterpart_arm = array(room, sizeof *arm), impulse = array(room, sizeof *impulse);
  state = array(room * state_size, sizeof *state);
}

static void print_costs(int steps, double contact_sweeps) {
  struct rusage used;
  getrusage(RUSAGE_SELF, &used);
  const double seconds = used.ru_utime.tv_sec + 1e-6 * used.ru_utime.tv_usec;
  printf("cpu [s] %.1f, a step [ms] %.2f, a sweep of a contact [ns] %.0f, memory of a contact [kB] %.2f\n",
         seconds, 1e3 * seconds / steps, 1e9 * seconds / contact_sweeps, (double)used.ru_maxrss / count);
}

int main(int argc, char** argv) {
  if (argc < 5 || argc > 7) fail("usage", "grains_c LIBRARY GRAINS STEPS SWEEPS [STEP [LAYERS]]");
  grains = atoi(argv[2]);
  if (argc > 5) h = atof(argv[5]);
  if (argc > 6) layers = atoi(argv[6]);
  const int steps = atoi(argv[3]);
  ilaw_interface* interface = create_interface(argv[1]);
  ilaw_instance_info info = {.struct_size = sizeof info};
  if (ilaw_interface_info(interface, &info) != ILAW_OK) fail("info", NULL);
  state_size = info.state_size;
  make_room();
  place_grains();

  ilaw_coupled* solver = ilaw_coupled_create();
  if (!solver) fail("solver", "out of memory");
  const ilaw_coupled_options options = {
      .struct_size = sizeof options, .most_sweeps = (uint32_t)atoi(argv[4]), .tolerance = 1e-8};
  double overlap = 0.0, residual = 0.0, sweeps = 0.0, contact_sweeps = 0.0, kinetic = 0.0;
  for (int n = 0; n < steps; ++n) {
    const ilaw_coupled_report report = step(interface, solver, n, options);
    sweeps += report.sweeps;
    contact_sweeps += (double)report.sweeps * count;
    residual = fmax(residual, report.residual);
    for (int k = 0; k < count; ++k) overlap = fmax(overlap, -gap[k]);
  }
  for (int i = 0; i < grains; ++i)
    for (int c = 0; c < 3; ++c)
      kinetic += 0.5 * mass * (v[i][c] * v[i][c] + 0.4 * radius * radius * w[i][c] * w[i][c]);
  printf("overlap %.3e kinetic %.3e residual %.1e sweeps %.1f contacts %d\n", overlap / (2 * radius),
         kinetic / (grains * mass * gravity * height), residual, sweeps / steps, count);
  if (argc > 5) print_costs(steps, contact_sweeps);
  ilaw_coupled_destroy(solver);
  ilaw_interface_destroy(interface);
  return 0;
}
