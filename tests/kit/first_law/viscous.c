/* viscous.c - the viscous layer of docs/first_law.md in plain C99.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <ilaw/plain_c.h>

enum { VISCOSITY };
static const ilaw_parameter viscosity = ILAW_PLAIN_PARAMETER(
    "viscosity", "c", "N.s/m^3", "Force per area and speed.", .maximum = 1e300, .flags = ILAW_FLAG_REQUIRED);
static const ilaw_parameter* const parameters[] = {&viscosity};
static const char* const references[] = {"docs/first_law.md"};

/* (I/(h c A) + H) r = -v_free where the gap is closed, and of this r the largest part that adds no energy. */
static const char* step(const ilaw_node* node, ilaw_node_result* result) {
  const double resistance = 1.0 / (node->velocity_step * node->value[VISCOSITY] * node->area);
  const double v_N = ilaw_dot(node->v_free, node->n), r_N = -v_N / (resistance + node->h_N);
  double v_T[3], r_T[3], mean[3];
  if (node->gap > 0.0 || resistance == INFINITY) return NULL; /* ILAW_FREE */
  ilaw_tangential(node->v_free, node->n, v_T);
  for (int c = 0; c < 3; ++c) {
    r_T[c] = -v_T[c] / (resistance + node->h_T);
    mean[c] = node->v_previous[c] + node->v_free[c];
  }
  /* Twice the work of the part s is s (normal + along) + s^2 (gained_N + gained_T). */
  const double normal = r_N * ilaw_dot(mean, node->n), along = ilaw_dot(r_T, mean);
  const double gained_N = node->h_N * r_N * r_N, gained_T = node->h_T * ilaw_dot(r_T, r_T);
  const double work = normal + along, gained = gained_N + gained_T;
  const double s = work + gained > 0.0 ? fmax(0.0, -work / gained) : 1.0;
  for (int c = 0; c < 3; ++c) result->r[c] = s * (r_N * node->n[c] + r_T[c]);
  /* A part that is negative is taken off the other. */
  const double lost_N = -0.5 * s * (normal + s * gained_N), lost_T = -0.5 * s * (along + s * gained_T);
  result->energy[ILAW_ENERGY_IMPACT] = fmax(0.0, lost_N + fmin(lost_T, 0.0));
  result->energy[ILAW_ENERGY_FRICTION] = fmax(0.0, lost_T + fmin(lost_N, 0.0));
  result->status = ILAW_BONDED;
  return NULL;
}

static const ilaw_plain_law law = {
    .law = {ILAW_PLAIN_LAW, .id = "viscous", .title = "Viscous layer",
            .doc = "A force -c A v where the gap is closed, solved implicitly.",
            .dimensions = ILAW_DIMENSION_1 | ILAW_DIMENSION_2 | ILAW_DIMENSION_3,
            .inputs = ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_AREA,
            .capabilities = ILAW_CAN_ADHERE, /* it holds back a node that leaves */
            .permissions = ILAW_MAY_SKIP_FRESH | ILAW_MAY_SKIP_FREE, ILAW_PLAIN_LIST(parameters),
            ILAW_PLAIN_LIST(references)},
    .step = step};
ILAW_PLAIN_LIBRARY("viscous", "1.0.0", "me", "BSD-3-Clause", &law.law)
