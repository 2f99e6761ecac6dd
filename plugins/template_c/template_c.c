/* template_c - a law in plain C to copy: unilateral contact with friction mu(slip speed, temperature, time),
 * and the heat that it makes. See template_c.md for the equations.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <ilaw/plain_c.h>

#include <float.h>

enum { FRICTION, TEMPERATURE, PARTITION };
enum { HEAT, COUNTERPART_HEAT };

static const char* const axes[] = {"slip_speed", "temperature", "time"};
static const ilaw_parameter friction = ILAW_PLAIN_PARAMETER(
    "friction", "mu", "1", "Coefficient of friction; its axis slip_speed is the speed after the step.",
    .maximum = 1e6, .flags = ILAW_FLAG_REQUIRED | ILAW_FLAG_ALLOWS_PER_NODE, .axes = axes, .axis_count = 3);
static const ilaw_parameter temperature =
    ILAW_PLAIN_PARAMETER("temperature", "T", "K", "Temperature of the body at the node.", .maximum = DBL_MAX,
                         .default_value = 293.15, .flags = ILAW_FLAG_FIELD | ILAW_FLAG_ALLOWS_PER_NODE,
                         .axes = axes + 2, .axis_count = 1);
static const ilaw_parameter partition =
    ILAW_PLAIN_PARAMETER("partition", "p", "1", "Part of the heat that flows into the body.", .maximum = 1.0,
                         .default_value = 0.5);
static const ilaw_parameter* const parameters[] = {&friction, &temperature, &partition};

static const ilaw_amount heat = {sizeof heat, 0, "heat", "J", "Heat of friction into the body."};
static const ilaw_amount counterpart_heat = {sizeof heat, 0, "counterpart_heat", "J",
                                             "The same, into the obstacle."};
static const ilaw_amount* const amounts[] = {&heat, &counterpart_heat};
static const char* const references[] = {"Moreau (1988), Unilateral contact and dry friction"};

static double friction_at(const ilaw_node* node, double slip_speed) {
  const double computed[] = {slip_speed, 0.0, 0.0};
  return ilaw_value(node, FRICTION, computed);
}

/* The slip speed v in [low, v_free] with v + h_T mu(v) r_N = v_free, low where friction can stop the slip
 * there: secants, exact where mu is linear, and bisections in turn. */
static double slip_speed(const ilaw_node* node, double r_N, double low, double v_free) {
  double high = v_free, excess_low = low + node->h_T * (friction_at(node, low) * r_N) - v_free;
  double excess_high = node->h_T * (friction_at(node, high) * r_N);
  if (excess_low >= 0.0) return low;
  for (int i = 0; i < 100; ++i) {
    const double part = i % 2 ? 0.5 : excess_low / (excess_low - excess_high), v = low + part * (high - low);
    if (!(v > low && v < high) && i % 2) break;
    if (!(v > low && v < high)) continue;
    const double excess = v + node->h_T * (friction_at(node, v) * r_N) - v_free;
    if (excess == 0.0) return v;
    if (excess < 0.0)
      low = v, excess_low = excess;
    else
      high = v, excess_high = excess;
  }
  return high;
}

static const char* step(const ilaw_node* node, ilaw_node_result* result) {
  const double *n = node->n, v_N = ilaw_dot(node->v_free, n), before_N = ilaw_dot(node->v_previous, n);
  /* v_N = 0 after the step; a node that was leaving turns round with the speed that it had: no work is done.
   */
  const double after_N = fmin(0.0, -before_N), r_N = (after_N - v_N) / node->h_N;
  if (node->gap > 0.0 || !(r_N > 0.0)) return NULL;
  double v_T[3];
  ilaw_tangential(node->v_free, n, v_T);
  const double v_free = ilaw_length(v_T), scale = v_free > 0.0 ? v_free : 1.0;
  const double d[3] = {v_T[0] / scale, v_T[1] / scale, v_T[2] / scale},
               before = ilaw_dot(node->v_previous, d);
  /* Nor may friction do work on a slip that turned round within the step. */
  const double low = fmin(fmax(0.0, -before), v_free), v = slip_speed(node, r_N, low, v_free);
  const double holding = (v_free - low) / node->h_T, limit = friction_at(node, v) * r_N;
  const double r_T = v > low ? fmin(limit, holding) : holding;
  for (int c = 0; c < 3; ++c) result->r[c] = r_N * n[c] - r_T * d[c];
  result->status = v > 0.0 ? ILAW_SLIP : ILAW_STICK;
  const double slip = fmax(0.0, before + (v_free - node->h_T * r_T));
  const double loss = r_T > 0.0 ? 0.5 * r_T * slip : 0.0, p = node->value[PARTITION];
  result->energy[ILAW_ENERGY_FRICTION] = loss;
  result->energy[ILAW_ENERGY_IMPACT] = -0.5 * r_N * fmin(0.0, before_N + after_N);
  result->amounts[HEAT] = p * fmin(loss, DBL_MAX);
  result->amounts[COUNTERPART_HEAT] = (1.0 - p) * fmin(loss, DBL_MAX);
  return NULL;
}

static const ilaw_plain_law law = {
    .law =
        {ILAW_PLAIN_LAW, .id = "template_c", .title = "Friction by slip speed and temperature",
         .doc =
             "Contact without restitution; a coefficient of friction from a table, and the heat of friction.",
         .dimensions = ILAW_DIMENSION_1 | ILAW_DIMENSION_2 | ILAW_DIMENSION_3,
         .inputs = ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS,
         .permissions = ILAW_MAY_SKIP_FRESH | ILAW_MAY_SKIP_FREE, ILAW_PLAIN_LIST(parameters),
         ILAW_PLAIN_LIST(amounts), ILAW_PLAIN_LIST(references)},
    .step = step};
ILAW_PLAIN_LIBRARY("template_c", "1.0.0", "ilaw", "BSD-3-Clause", &law.law)
