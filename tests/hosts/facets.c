/* facets.c - ilaw/search.h from C: a row of points falls on a plate of 4 x 4 facets. Prints the pairs of the
 * points that are near at the end; exit code 1 if one of them is not as the plate's closed form.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <ilaw/search.h>

#include <math.h>
#include <stdio.h>

enum { side = 4, nodes = (side + 1) * (side + 1), count = 7 };

static int checked(ilaw_result code, const char* call) {
  if (code != ILAW_OK) fprintf(stderr, "%s: code %d\n", call, (int)code);
  return code == ILAW_OK;
}

static ilaw_input input(const double* values, int stride) {
  ilaw_input made = {0};
  made.values = values;
  made.node_stride = stride;
  made.component_stride = 1;
  return made;
}

static ilaw_output output(double* values, int stride) {
  ilaw_output made = {0};
  made.values = values;
  made.node_stride = stride;
  made.component_stride = 1;
  return made;
}

static int wrong(const double* x, int facet, double gap, const double* normal, const double* weights) {
  const double a = x[0] - floor(x[0]), b = x[1] - floor(x[1]);
  const double wanted[4] = {(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b};
  int bad = facet != side * (int)floor(x[1]) + (int)floor(x[0]) || fabs(gap - x[2]) > 1e-15 ||
            fabs(normal[2] - 1) > 1e-15;
  for (int k = 0; k < 4; ++k) bad = bad || fabs(weights[k] - wanted[k]) > 1e-15;
  return bad;
}

int main(void) {
  double x[3 * (nodes + count)] = {0}, u[3 * (nodes + count)] = {0};
  int32_t facets[4 * side * side], points[count], facet[count], place[count];
  double gap[count], normal[3 * count], weights[4 * count];
  for (int k = 0; k < nodes; ++k) {
    x[3 * k] = k % (side + 1);
    x[3 * k + 1] = k / (side + 1);
  }
  for (int f = 0; f < side * side; ++f) {
    const int first = f / side * (side + 1) + f % side;
    const int corners[4] = {first, first + 1, first + side + 2, first + side + 1};
    for (int k = 0; k < 4; ++k) facets[4 * f + k] = corners[k];
  }
  for (int k = 0; k < count; ++k) {
    double* const at = &x[3 * (nodes + k)];
    points[k] = nodes + k;
    at[0] = 0.27 + 0.51 * k;
    at[1] = 0.4 + 0.43 * k;
    at[2] = 1.0 + 0.3 * k;
  }

  ilaw_facets_setup setup = {0};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.corner_count = 4;
  setup.node_count = nodes + count;
  setup.facet_count = side * side;
  setup.facets = facets;
  setup.point_count = count;
  setup.points = points;
  setup.position = input(x, 3);
  ilaw_facets* search = NULL;
  if (!checked(ilaw_facets_create(&setup, &search), "ilaw_facets_create")) return 1;

  ilaw_facets_positions positions = {0};
  positions.struct_size = sizeof positions;
  positions.position = setup.position;
  positions.displacement = input(u, 3);
  ilaw_facets_nearby nearby = {0};
  nearby.struct_size = sizeof nearby;
  const double fall = 0.04; /* per step */
  for (int step = 0; step < 25; ++step) {
    for (int k = 0; k < count; ++k) u[3 * (nodes + k) + 2] -= fall;
    nearby.reach = fall;
    if (!checked(ilaw_facets_update(search, &positions), "ilaw_facets_update")) return 1;
    if (!checked(ilaw_facets_near(search, &nearby), "ilaw_facets_near")) return 1;
  }

  ilaw_facets_pairs_of pairs = {0};
  pairs.struct_size = sizeof pairs;
  pairs.count = nearby.count;
  pairs.points = nearby.points;
  pairs.facet = facet;
  pairs.place = place;
  pairs.gap = output(gap, 1);
  pairs.normal = output(normal, 3);
  pairs.weights = output(weights, 4);
  if (!checked(ilaw_facets_pairs(search, &pairs), "ilaw_facets_pairs")) return 1;
  int bad = nearby.count < 1;
  for (int k = 0; k < nearby.count; ++k) {
    const int node = nodes + nearby.points[k];
    const double now[3] = {x[3 * node] + u[3 * node], x[3 * node + 1] + u[3 * node + 1],
                           x[3 * node + 2] + u[3 * node + 2]};
    printf("point %d facet %d gap %.6f weights %.4f %.4f %.4f %.4f\n", (int)nearby.points[k], (int)facet[k],
           gap[k], weights[4 * k], weights[4 * k + 1], weights[4 * k + 2], weights[4 * k + 3]);
    bad = bad || wrong(now, facet[k], gap[k], &normal[3 * k], &weights[4 * k]) || place[k] != ILAW_PLACE_OVER;
  }
  ilaw_facets_destroy(search);
  return bad;
}
