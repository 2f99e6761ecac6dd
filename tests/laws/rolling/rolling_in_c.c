/* rolling_in_c.c - friction, rolling and twisting in plain C, for a test: the root by bisection.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <ilaw/plain_c.h>

enum { FRICTION, ROLLING, TWISTING };
static const ilaw_parameter friction =
    ILAW_PLAIN_PARAMETER("friction", "mu", "1", "Coefficient of friction.", .maximum = 1e300);
static const ilaw_parameter rolling =
    ILAW_PLAIN_PARAMETER("rolling", "rho", "m", "Largest rolling moment over normal force.", .maximum = 1e300,
                         .flags = ILAW_FLAG_NEEDS_SPINS);
static const ilaw_parameter twisting =
    ILAW_PLAIN_PARAMETER("twisting", "tau", "m", "Largest twisting moment over normal force.",
                         .maximum = 1e300, .flags = ILAW_FLAG_NEEDS_SPINS);
static const ilaw_parameter* const parameters[] = {&friction, &rolling, &twisting};

/* x = -f/h, or where that is longer than `most`, as long as that. */
static void within(const double* f, double h, double most, double* x) {
  const double size = ilaw_length(f), factor = size > h * most ? -most / size : -1.0 / h;
  for (int c = 0; c < 3; ++c) x[c] = size > 0.0 ? factor * f[c] : 0.0;
}

/* |r| of the block [h + lambda, -k; -k, j] with q as it is there. */
static double length_at(const ilaw_node* node, double lambda, const double* v, const double* u, double most_q,
                        double* r, double* q) {
  const double a = node->h_T + lambda, k = node->k;
  double f[3];
  for (int c = 0; c < 3; ++c) f[c] = u[c] + k / a * v[c];
  within(f, node->j_T - k * k / a, most_q, q);
  for (int c = 0; c < 3; ++c) r[c] = -(v[c] - k * q[c]) / a;
  return ilaw_length(r);
}

static void solve(const ilaw_node* node, const double* v, const double* u, double most_r, double most_q,
                  double* r, double* q) {
  double low = 0.0, high = 1.0;
  if (length_at(node, 0.0, v, u, most_q, r, q) <= most_r) return;
  while (length_at(node, high, v, u, most_q, r, q) > most_r && high < 1e300) high *= 2.0;
  for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high))
    if (length_at(node, middle, v, u, most_q, r, q) > most_r)
      low = middle;
    else
      high = middle;
  length_at(node, high, v, u, most_q, r, q);
}

static const char* step(const ilaw_node* node, ilaw_node_result* result) {
  const double r_N = -ilaw_dot(node->v_free, node->n) / node->h_N;
  if (node->gap > 0.0 || !(r_N > 0.0)) return NULL;
  double v[3], u[3], r[3], q[3] = {0.0, 0.0, 0.0}, m[3];
  ilaw_tangential(node->v_free, node->n, v);
  ilaw_cross(node->spin_free, node->n, u);
  if (node->j_T > 0.0)
    solve(node, v, u, node->value[FRICTION] * r_N, node->value[ROLLING] * r_N, r, q);
  else
    within(v, node->h_T, node->value[FRICTION] * r_N, r);
  ilaw_cross(node->n, q, m);
  const double most = node->value[TWISTING] * r_N, w_N = ilaw_dot(node->spin_free, node->n);
  const double m_N = node->j_N > 0.0 ? -fmax(-most, fmin(most, w_N / node->j_N)) : 0.0;
  for (int c = 0; c < 3; ++c) result->r[c] = r_N * node->n[c] + r[c], result->m[c] = m_N * node->n[c] + m[c];
  result->status = ILAW_STICK;
  return NULL;
}

static const ilaw_plain_law law = {
    .law = {ILAW_PLAIN_LAW_OF(ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_TRANSVERSE |
                              ILAW_DELASSUS_TRANSVERSE_SPIN),
            .id = "rolling_in_c", .title = "Friction, rolling and twisting", .doc = "",
            .dimensions = ILAW_DIMENSION_3, .inputs = ILAW_INPUT_GAP | ILAW_INPUT_NORMAL,
            ILAW_PLAIN_LIST(parameters)},
    .step = step};

ILAW_PLAIN_LIBRARY("rolling_in_c", "1.0.0", "tests", "BSD-3-Clause", &law.law)
