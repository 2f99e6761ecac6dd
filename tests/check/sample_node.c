#include "sample_node.h"

#include <math.h>
#include <string.h>

/* Inputs and outputs of a node. */
typedef struct node {
  int d, global, floats, strays, rough;
  double v[3], smooth[3], n[3], t[3], h[3][3], gap, area, damping, friction, temperature;
  double closures, r[3], after[3], energy[4], amounts[AMOUNT_COUNT];
  int spins;
  double w[3], k, j_n, j_t, reach, m[3], spin[3];
  uint8_t status;
} node;

int64_t node_of(const ilaw_batch* b, int64_t k) {
  if (b->index) return b->index[k] - b->index_base;
  return b->index64 ? b->index64[k] - b->index_base : k;
}

double read_array(const ilaw_input* from, int64_t i, int c) {
  int64_t node_stride = from->node_stride, stride = from->component_stride;
  if (breaks("layout-components") && stride > 10) stride = 1;
  if (breaks("layout-strides") && stride == 2) stride = 1;
  if (breaks("layout-strides: negative") && stride < 0) stride = -stride;
  if (breaks("layout-shared") && node_stride == 0) node_stride = 1;
  i = i * node_stride + c * stride;
  return from->values ? from->values[i] : from->floats[i];
}

static int has(const ilaw_input* from) { return from->values || from->floats; }
static int is_wanted(const ilaw_output* to) { return to->values || to->floats; }

static void put(const ilaw_output* to, int64_t i, int c, double x) {
  i = i * to->node_stride + c * to->component_stride;
  if (to->values) to->values[i] = x;
  if (to->floats) to->floats[i] = (float)x;
}

/* The interval of an axis, and the part of it that lies before x. */
static uint64_t find(const quantity* given, uint32_t axis, double x, double* part) {
  const double* points = given->points[axis];
  const uint64_t count = given->count[axis];
  uint64_t k = 0;
  *part = 0.0;
  if (count == 1 || !(x > points[0])) return 0;
  while (k + 2 < count && x >= points[k + 1]) ++k;
  if (breaks("table-linear: beyond") && x > points[count - 1]) return k; /* the value before the last */
  *part = x >= points[k + 1] ? 1.0 : (x - points[k]) / (points[k + 1] - points[k]);
  if (breaks("table-linear")) *part = *part < 0.5 ? 0.0 : 1.0;
  return k;
}

static double between(double a, double b, double part) {
  return part == 0.0 || a == b ? a : part == 1.0 ? b : (1.0 - part) * a + part * b;
}

double value_at(const quantity* given, double time, double temperature) {
  const uint64_t rows = given->count[0];
  const uint64_t width = given->axis_count == 2 ? given->count[1] : 1;
  double part[2] = {0.0, 0.0}, row[2];
  uint64_t at[2] = {0, 0}, k;
  uint32_t n;
  if (given->axis_count == 0) return given->constant;
  for (n = 0; n < given->axis_count; ++n)
    at[n] = find(given, n, given->is_time[n] ? time : temperature, &part[n]);
  for (k = 0; k < 2; ++k) {
    const uint64_t i = at[0] + (given->count[0] > 1 ? k : 0), next = at[1] + (width > 1 ? 1 : 0);
    if (breaks("table-linear: order") && given->axis_count == 2)
      row[k] = between(given->values[at[1] * rows + i], given->values[next * rows + i], part[1]);
    else
      row[k] = between(given->values[i * width + at[1]], given->values[i * width + next], part[1]);
  }
  return between(row[0], row[1], part[0]);
}

static double sum_of(const ilaw_input* from, const ilaw_batch* b, int width) {
  double sum = (double)from->node_stride;
  int64_t k;
  int c;
  for (k = 0; k < b->node_count; ++k)
    for (c = 0; c < width; ++c) sum += read_array(from, node_of(b, k), c) * (double)(1 + k % 7 + 3 * c);
  return sum;
}

spin_arrays spins_of(const ilaw_batch* batch) {
  spin_arrays spins;
  memset(&spins, 0, sizeof spins);
  spins.free = batch->spin_free, spins.previous = batch->spin_previous;
  spins.moment = batch->moment, spins.after = batch->spin;
  return spins;
}

/* The sum of all values on which a result may depend. */
static double sum_of_all(const ilaw_instance* made, const ilaw_batch* b) {
  const int d = (int)made->setup.dimension;
  const spin_arrays spins = spins_of(b);
  double sum = b->time + b->velocity_step + sum_of(&b->v_free, b, d) + sum_of(&b->delassus, b, 1) +
               sum_of(&b->gap, b, 1) + sum_of(&b->area, b, 1) + sum_of(&b->state_in, b, 1);
  if (is_wanted(&b->energy)) sum += sum_of(&b->v_previous, b, d);
  if (has(&b->tangent)) sum += sum_of(&b->tangent, b, d);
  if (has(&b->gap_offset)) sum += sum_of(&b->gap_offset, b, 1);
  if (has(&b->normal)) sum += sum_of(&b->normal, b, d);
  if (has_smooth(made, b)) sum += sum_of(&b->v_smooth, b, d);
  if (has(&spins.free)) sum += sum_of(&spins.free, b, d);
  return sum;
}

/* The text of an argument that may be gone. */
static int is_mode(const char* text) {
  return text && (strcmp(text, "rough") == 0 || strcmp(text, "smooth") == 0);
}

/* One node in about 10^5, by the bits of its velocity. */
static int is_rare(const node* at) {
  uint64_t bits;
  memcpy(&bits, &at->v[0], sizeof bits);
  return (bits >> 32 ^ bits) * 0x9E3779B97F4A7C15U >> 32 < 0x100000000U / 100000;
}

/* Whether a broken rule asks for another result of this call. */
static int strays(const ilaw_instance* made, const ilaw_batch* b) {
  const memory* own = made->own;
  if (breaks("smooth-absent")) return made->rough && !has_smooth(made, b);
  if (breaks("smooth-unasked")) return !made->rough && has(&b->v_smooth);
  if (breaks("purity-history")) return own->saw_nine && b->node_count == 13;
  if (breaks("purity-steps")) return own->largest_step > 5.0 * b->velocity_step;
  if (breaks("purity-instances")) return shared()->last != made && shared()->before == made;
  if (breaks("purity-threads")) return !on_first_thread();
  if (breaks("index-32")) return b->index != NULL;
  if (breaks("index-64")) return b->index64 != NULL;
  if (breaks("state-in-place")) return b->state_in.values == b->state_out.values;
  if (breaks("batch-parts")) return b->node_count == 7;
  if (breaks("batch-large")) return b->node_count > 100;
  if (breaks("outputs-asked")) return !is_wanted(&b->energy) && is_wanted(&b->velocity);
  if (breaks("gap-offset")) return has(&b->gap_offset);
  if (breaks("amounts-asked")) return b->amounts && !is_wanted(&b->amounts[HEAT]);
  if (breaks("table-constant"))
    return made->friction.axis_count > 0 && made->friction.values[0] == made->friction.values[1];
  if (breaks("per-node-constant")) return made->damping.slot != 0;
  if (breaks("setup-copied")) return own->started && !is_mode(made->mode);
  return breaks("purity-twice") && own->started > 1;
}

void remember(const ilaw_instance* made, const ilaw_batch* b) {
  memory* own = made->own;
  if (breaks("purity-twice")) {
    const double sum = sum_of_all(made, b);
    own->started = sum == own->last_sum ? 2 : 1;
    own->last_sum = sum;
  } else if (breaks("history-carried") && has(&b->normal) && b->time != own->first_time) {
    const double normal = read_array(&b->normal, node_of(b, 0), 0); /* whether it turned */
    own->started = b->time != b->velocity_step && normal != own->last_sum;
    own->last_sum = normal;
    own->first_time = b->time;
  } else if (breaks("setup-copied") && is_mode(made->mode)) {
    own->started = 1;
  } else if (breaks("restart") && !own->started) {
    own->started = 1;
    own->first_time = b->time;
  } else if (breaks("purity-history") && b->node_count == 9) {
    own->saw_nine = 1;
  } else if (breaks("purity-steps") && b->velocity_step > own->largest_step) {
    own->largest_step = b->velocity_step;
  }
}

static void gather_delassus(node* at, const ilaw_instance* made, const ilaw_batch* b, int64_t i) {
  static const int rows[3] = {0, 0, 1}, columns[3] = {1, 2, 2};
  const uint32_t form = made->setup.delassus_form;
  int a, c;
  if (at->spins) {
    const double h_n = read_array(&b->delassus, i, 0), h_t = read_array(&b->delassus, i, 1);
    for (a = 0; a < 3; ++a)
      for (c = 0; c < 3; ++c) at->h[a][c] = (h_n - h_t) * at->n[a] * at->n[c] + (a == c ? h_t : 0.0);
    at->k = read_array(&b->delassus, i, 2);
    at->j_n = read_array(&b->delassus, i, 3);
    at->j_t = read_array(&b->delassus, i, 4);
    return;
  }
  for (c = 0; c < at->d; ++c) at->h[c][c] = read_array(&b->delassus, i, form == ILAW_DELASSUS_SCALAR ? 0 : c);
  for (c = 0; form == ILAW_DELASSUS_FULL && c < at->d * (at->d - 1) / 2; ++c)
    at->h[rows[c]][columns[c]] = at->h[columns[c]][rows[c]] = read_array(&b->delassus, i, at->d + c);
}

static void gather(node* at, const ilaw_instance* made, const ilaw_batch* b, int64_t k) {
  const spin_arrays spins = spins_of(b);
  const int64_t i = node_of(b, k);
  int c;
  memset(at, 0, sizeof *at);
  at->d = (int)made->setup.dimension;
  at->spins = made->setup.delassus_form == ILAW_DELASSUS_TRANSVERSE_SPIN;
  at->reach = made->reach;
  at->global = made->setup.frame == ILAW_FRAME_GLOBAL;
  at->n[0] = 1.0;
  at->t[1] = 1.0;
  for (c = 0; c < at->d; ++c) {
    at->v[c] = read_array(&b->v_free, i, c);
    if (at->spins && has(&spins.free)) at->w[c] = read_array(&spins.free, i, c);
    if (at->global) at->n[c] = read_array(&b->normal, i, c);
    if (at->global && at->d == 3 && made->setup.has_tangent) at->t[c] = read_array(&b->tangent, i, c);
  }
  if (at->global && at->d == 2) {
    at->t[0] = -at->n[1];
    at->t[1] = at->n[0];
  }
  read_smooth(made, b, k, at->smooth);
  gather_delassus(at, made, b, i);
  at->gap = has(&b->gap_offset) ? read_array(&b->gap, i, 0) - read_array(&b->gap_offset, i, 0)
                                : read_array(&b->gap, i, 0);
  at->area = read_array(&b->area, i, 0);
  at->rough = made->rough;
  at->floats = made->setup.numbers == ILAW_NUMBERS_FLOAT;
  at->temperature = made->temperature.constant;
  if (made->temperature.slot)
    at->temperature = read_array(&b->per_node_parameters[made->temperature.slot - 1], i, 0);
  at->damping = value_at(&made->damping, b->time, at->temperature);
  at->friction = value_at(&made->friction, b->time, at->temperature);
  at->closures = read_array(&b->state_in, i, 0);
}

static double dot(const double* a, const double* b) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }
/* to += s n x a */
static void add_cross(double* to, double s, const double* n, const double* a) {
  to[0] += s * (n[1] * a[2] - n[2] * a[1]);
  to[1] += s * (n[2] * a[0] - n[0] * a[2]);
  to[2] += s * (n[0] * a[1] - n[1] * a[0]);
}

static int definite(const node* at) {
  const double(*h)[3] = at->h;
  const double minor = h[0][0] * h[1][1] - h[0][1] * h[0][1];
  const double h_t = 0.5 * (h[0][0] + h[1][1] + h[2][2] - dot(at->n, h[0]) * at->n[0] -
                            dot(at->n, h[1]) * at->n[1] - dot(at->n, h[2]) * at->n[2]);
  int c;
  for (c = 0; c < at->d; ++c)
    if (!(h[c][c] > 0.0) || !isfinite(h[c][c])) return 0;
  if (at->spins && (!(at->j_n > 0.0 && at->j_t > 0.0) || isinf(at->j_n) || isinf(at->j_t))) return 0;
  if (at->spins && !(at->k / h_t * (at->k / at->j_t) < 1.0) && !breaks("bad-input-definite: spins")) return 0;
  if (breaks("bad-input-definite") || at->d == 1) return 1;
  if (!(minor > 0.0) || at->d == 2) return minor > 0.0;
  return h[2][2] * minor - h[1][2] * (h[0][0] * h[1][2] - h[0][1] * h[0][2]) +
             h[0][2] * (h[0][1] * h[1][2] - h[1][1] * h[0][2]) >
         0.0;
}

static int near_one(double value) { return fabs(value - 1.0) < 1e-6; }

static const char* defect(node* at, const ilaw_instance* made, const ilaw_batch* b) {
  int c;
  for (c = 0; c < at->d; ++c)
    if (!(isfinite(at->v[c]) || (breaks("bad-input-report: not a number") && isnan(at->v[c]))) ||
        !isfinite(at->w[c]))
      return "v_free or spin_free is not finite";
  for (c = 0; c < at->d && !breaks("bad-input-report: v_smooth"); ++c)
    if (!isfinite(at->smooth[c]) && has_smooth(made, b)) return "v_smooth is not finite";
  if (!definite(at)) return "H is not positive definite";
  if (!isfinite(at->gap)) return "the gap is not finite";
  if (!(at->area >= 0.0) || !isfinite(at->area)) return "the area is not a number >= 0";
  if (!near_one(dot(at->n, at->n))) return "the normal is no unit vector";
  if (made->setup.has_tangent && at->d == 3 &&
      (!near_one(dot(at->t, at->t)) || !(fabs(dot(at->t, at->n)) < 1e-6)))
    return "the tangent is no unit vector";
  if (!(at->temperature >= 0.0) || isinf(at->temperature)) return "temperature is out of range";
  if (!(at->damping > 0.0) && !breaks("per-node-range")) return "damping is out of range";
  if (breaks("foreign-state") && isnan(at->closures)) at->closures = 0.0;
  if (!(at->closures >= 0.0 && at->closures <= 9e15 && floor(at->closures) == at->closures))
    return "the state is none that the law can have written";
  if (breaks("good-input-served: rest") && dot(at->v, at->v) == 0.0) return "the slip has no direction";
  if (breaks("good-input-served")) {
    const double steps = fabs(at->gap) / (b->position_step * sqrt(dot(at->v, at->v)));
    if (steps > 1.0 && steps < 1.03) return "the gap is not liked";
  }
  return NULL;
}

/* The coefficient of friction, wrong where a rule is to be broken by it. */
static double spoilt_friction(const node* at, const ilaw_instance* made, const ilaw_batch* b,
                              const double* tangential) {
  const double along = dot(tangential, at->t);
  if (breaks("friction-cone")) return 1.5 * at->friction + 0.1;
  if (breaks("restart"))
    return at->friction * (1.0 - 1e-6 * (b->time - made->own->first_time) / b->velocity_step);
  if (breaks("form-agreement") && made->setup.delassus_form != ILAW_DELASSUS_SCALAR)
    return 0.99 * at->friction;
  if (breaks("frame-indifference") && at->global && (at->d == 2 || made->setup.has_tangent))
    return 0.99 * at->friction;
  if (breaks("frame-turned") && at->d == 3 && at->global && !made->setup.has_tangent)
    return at->friction * (1.0 - 0.1 * fabs(at->n[0]));
  if (breaks("history-carried") && made->own->started) return 0.9 * at->friction;
  if (breaks("isotropy") && at->d == 3 && (!at->global || made->setup.has_tangent))
    return at->friction * (1.0 - 0.3 * along * along / (1e-300 + dot(tangential, tangential)));
  if (breaks("mirror") && at->d == 2 && along < 0.0) return 0.9 * at->friction;
  return at->friction * (made->rough ? 1.0 : 0.5);
}

/* The normal part of v_smooth. */
static double smooth_of(const node* at) {
  if (breaks("frame-indifference: v_smooth") || breaks("frame-turned: v_smooth")) return at->smooth[0];
  return dot(at->n, at->smooth);
}

/* In the order of operations of "out of reach" (ilaw.h). */
static int meets(const node* at, const ilaw_batch* b) {
  if (at->gap <= 0.0 || !at->rough) return at->gap <= 0.0;
  if (breaks("skip-fresh: v_smooth") || breaks("skip-free: v_smooth"))
    return at->gap / b->position_step <= -smooth_of(at);
  return at->gap + b->position_step * smooth_of(at) <= 0.0;
}

static double softened(const node* at, double r) {
  const double smooth = smooth_of(at);
  if (breaks("mirror: v_smooth") && at->smooth[1] < 0.0) r *= 0.9;
  if (breaks("isotropy: v_smooth") && !at->global) r *= 1.0 - 0.1 * fabs(at->smooth[1]);
  return smooth > (breaks("units: v_smooth") ? 0.1 : 0.0) ? 0.5 * r : r;
}

static double normal_impulse(const node* at, const ilaw_batch* b, double normal, double delassus) {
  const double compliance = isinf(at->damping) ? 0.0 : 1.0 / (b->velocity_step * at->damping * at->area);
  double r = meets(at, b) && normal < 0.0 ? -normal / (delassus + compliance) : 0.0;
  if (at->rough) r = softened(at, r);
  if (breaks("energy-made: v_smooth") && r > 0.0) r = fabs(smooth_of(at)) / (delassus + compliance);
  if (breaks("stable-step-bound") && !isinf(at->damping)) /* explicit */
    r = at->gap <= 0.0 && normal < 0.0 ? -normal * b->velocity_step * at->damping * at->area : 0.0;
  if (breaks("complementarity") && at->gap <= 0.0 && normal > 0.0) r = -0.1 * normal / delassus;
  if (breaks("energy-made")) r *= 3.0;
  if (breaks("units") && fabs(normal) < 0.1) r = 0.0;
  return r;
}

/* The impulse; returns how much of the cone it fills, 0 without friction. */
static double solve(node* at, const ilaw_instance* made, const ilaw_batch* b) {
  double normal = dot(at->n, at->v), along[3], delassus = 0.0, trace = 0.0, speed, r, most, least;
  int a, c;
  for (c = 0; c < 3; ++c) along[c] = at->v[c] - normal * at->n[c];
  for (a = 0; a < at->d; ++a) {
    trace += at->h[a][a];
    for (c = 0; c < at->d; ++c) delassus += at->n[a] * at->h[a][c] * at->n[c];
  }
  speed = at->d > 1 ? sqrt(dot(along, along)) : 0.0;
  r = normal_impulse(at, b, normal, delassus);
  most = spoilt_friction(at, made, b, along) / (1.0 + 1e-3 * made->wear * at->closures) * r;
  if (breaks("friction-pressure") && !at->global && r == 0.0 && at->gap <= 0.0) most = 0.1 * speed / trace;
  least = speed / trace < most ? speed / trace : most;
  if (at->strays) r *= 1.0 + 4e-16;
  if (breaks("frame-indifference: backward") && at->d == 1 && at->n[0] < 0.0) r *= 1.001;
  if (at->floats && breaks("floats-rounded")) r *= 1.0 + 1e-6;
  for (c = 0; c < at->d; ++c) at->r[c] = r * at->n[c] - (least > 0.0 ? least * (along[c] / speed) : 0.0);
  for (a = 0; a < at->d; ++a) {
    at->after[a] = at->v[a];
    for (c = 0; c < at->d; ++c) at->after[a] += at->h[a][c] * at->r[c];
  }
  at->status = r == 0.0 ? ILAW_FREE : least <= 0.0 ? ILAW_CLOSED : ILAW_SLIP;
  if (breaks("status-stick") && least > 0.0) at->status = ILAW_STICK;
  if (r < 0.0 || (r == 0.0 && least > 0.0)) at->status = ILAW_BONDED;
  if (breaks("status-meaning")) at->status = ILAW_FREE;
  if (breaks("status-meaning: number")) at->status = ILAW_STATUS_COUNT;
  if (breaks("status-meaning: closed")) at->status = ILAW_CLOSED;
  return r;
}

/* m = -part w with the part in which neither r nor m does work: at most 1/(2 (j_N + j_T)), as r takes less
 * than 1/(2 h_T), since H and J with their coupling k are at most twice their diagonal. */
static void turn(node* at, double r_n) {
  const double speed = sqrt(dot(at->w, at->w)), most = r_n > 0.0 ? at->reach * r_n : 0.0;
  double part = 0.5 / (at->j_n + at->j_t), w_n = dot(at->w, at->n);
  int c;
  if (!at->spins) return;
  if (!(part * speed < most)) part = speed > 0.0 ? most / speed : 0.0;
  if (breaks("mirror: moment") && w_n < 0.0) part *= 0.9;
  if (breaks("isotropy: moment") && !at->global)
    part *= 1.0 - 0.3 * at->w[1] * at->w[1] / (1e-300 + speed * speed);
  if (breaks("frame-indifference: moment") && !at->global) part *= 0.99;
  if (breaks("units: moment") && speed < 0.3) part = 0.0;
  if (breaks("energy-made: moment")) part = -part;
  if (breaks("friction-pressure: moment") && r_n == 0.0 && at->gap <= 0.0) part = 0.1;
  for (c = 0; c < 3; ++c) at->m[c] = -part * at->w[c] + 0.0;
  if (breaks("frame-turned: moment") && at->global) at->m[0] = -at->m[0];
  for (c = 0; c < 3; ++c)
    at->spin[c] = at->w[c] + at->j_t * at->m[c] + (at->j_n - at->j_t) * dot(at->n, at->m) * at->n[c];
  if (!breaks("velocity-output: moment")) add_cross(at->after, at->k, at->n, at->m);
  if (!breaks("velocity-output: spin")) add_cross(at->spin, -at->k, at->n, at->r);
}

static void measure(node* at) {
  const double dissipated = at->energy[ILAW_ENERGY_FRICTION] + at->energy[ILAW_ENERGY_IMPACT];
  at->amounts[HEAT] = 0.5 * at->energy[ILAW_ENERGY_FRICTION];
  at->amounts[WORN] = 1e-6 * at->amounts[HEAT];
  if (breaks("heat-dissipated")) at->amounts[HEAT] = 2.0 * dissipated;
  if (breaks("heat-dissipated: negative")) at->amounts[HEAT] = -at->amounts[HEAT];
  if (breaks("amounts-zero") && at->status == ILAW_FREE && at->gap <= 0.0) at->amounts[WORN] = 1e-9;
  if (breaks("amounts-zero: no number")) at->amounts[WORN] = NAN;
}

static void account(node* at, const ilaw_batch* b, int64_t i) {
  const spin_arrays spins = spins_of(b);
  double mean[3] = {0.0, 0.0, 0.0}, mean_spin[3] = {0.0, 0.0, 0.0}, normal, impact, twist;
  int c;
  if (!is_wanted(&b->energy) && !b->amounts) return;
  for (c = 0; c < at->d && has(&b->v_previous); ++c)
    mean[c] = 0.5 * (read_array(&b->v_previous, i, c) + at->after[c]);
  for (c = 0; at->spins && c < 3 && has(&spins.previous); ++c)
    mean_spin[c] = 0.5 * (read_array(&spins.previous, i, c) + at->spin[c]);
  for (c = 0; c < at->d && breaks("energy-balance: v_smooth"); ++c)
    mean[c] += 0.5 * (at->smooth[c] - at->v[c]);
  twist = -dot(at->m, mean_spin);
  if (breaks("energy-balance: moment")) twist = -twist;
  normal = dot(at->n, at->r);
  impact = -normal * dot(at->n, mean);
  at->energy[ILAW_ENERGY_IMPACT] = impact;
  at->energy[ILAW_ENERGY_FRICTION] = -dot(at->r, mean) - impact + twist;
  if (breaks("energy-friction")) {
    at->energy[ILAW_ENERGY_FRICTION] += impact;
    at->energy[ILAW_ENERGY_IMPACT] = 0.0;
  }
  if (breaks("energy-rupture") && normal == 0.0) at->energy[ILAW_ENERGY_RUPTURE] = 1e-3;
  if (breaks("energy-balance: position step"))
    at->energy[ILAW_ENERGY_IMPACT] *= b->position_step / b->velocity_step;
  if (breaks("energy-balance")) at->energy[ILAW_ENERGY_IMPACT] *= 2.0;
  for (c = 0; c < 4 && !breaks("energy-parts"); ++c)
    if (!(at->energy[c] > 0.0)) at->energy[c] = 0.0;
  if (breaks("energy-parts: stored")) at->energy[ILAW_ENERGY_STORED] = 1.0;
  if (breaks("energy-parts: no number")) at->energy[ILAW_ENERGY_IMPACT] = NAN;
  measure(at);
}

/* The last node of eleven is left out. */
static int leaves_out(const char* output, const ilaw_batch* b, int64_t k) {
  return b->node_count == 11 && k == 10 && breaks(output);
}

static void write_node(const node* at, const ilaw_batch* b, int64_t k, const double* state) {
  const spin_arrays spins = spins_of(b);
  const int64_t i = node_of(b, k);
  const int has_spins = spins.moment.values || spins.moment.floats;
  const int64_t state_stride =
      breaks("layout-strides: state") && !has_spins ? b->state_in.node_stride : b->state_out.node_stride;
  const double factor = breaks("floats-rounded: moment") && at->floats ? 1.0 + 1e-6 : 1.0;
  int c;
  for (c = 0; c < at->d && !leaves_out("outputs-written: impulse", b, k); ++c)
    put(&b->impulse, i, c, at->r[c]);
  if (!leaves_out("outputs-written: state", b, k))
    memcpy(&b->state_out.values[i * state_stride], state, sizeof *state);
  for (c = 0; c < 4 && !leaves_out("outputs-written: energy", b, k); ++c)
    put(&b->energy, i, c, at->energy[c]);
  for (c = 0; b->amounts && c < AMOUNT_COUNT && !leaves_out("outputs-written: amounts", b, k); ++c)
    put(&b->amounts[c], i, 0, at->amounts[c]);
  if (b->status && !leaves_out("outputs-written: status", b, k)) b->status[i * b->status_stride] = at->status;
  for (c = 0; c < at->d && !leaves_out("outputs-written", b, k); ++c)
    put(&b->velocity, i, c, breaks("velocity-output") ? at->v[c] : at->after[c]);
  for (c = 0; at->spins && c < 3; ++c) {
    if (!breaks("outputs-written: moment") || at->status != ILAW_FREE)
      put(&spins.moment, i, c, factor * at->m[c]);
    if (!leaves_out("outputs-written: spin", b, k)) put(&spins.after, i, c, at->spin[c]);
  }
}

static int out_of_reach(const node* at, const ilaw_batch* b) {
  return at->gap > 0.0 && at->gap + b->position_step * dot(at->n, at->v) > 0.0;
}

/* The node itself, or of a broken rule the first one of each four. */
static int64_t giver_of_damping(const ilaw_batch* b, int64_t k) {
  const int shares = breaks("batch-order: pack") || breaks("batch-parts: pack") ||
                     breaks("batch-large: pack") || breaks("per-node-constant: pack");
  return node_of(b, shares ? k - k % 4 : k);
}

static const char* step_good(node* at, const ilaw_instance* made, const ilaw_batch* b, int64_t k) {
  const int64_t i = node_of(b, k);
  const double closures = at->closures, r = solve(at, made, b);
  double next = closures + (r != 0.0 && !breaks("closures stay") ? 1.0 : 0.0);
  const double bound = at->floats && !breaks("impulse-finite: floats") ? 0x1p126 : INFINITY;
  int c, finite = 1;
  turn(at, r);
  account(at, b, i);
  for (c = 0; c < at->d; ++c)
    finite = finite && fabs(at->r[c]) < bound && (fabs(at->m[c]) < bound || breaks("impulse-finite: moment"));
  if (!finite && !breaks("impulse-finite")) return "the impulse overflows";
  if (breaks("skip-fresh") && closures == 0.0 && b->time == b->velocity_step && out_of_reach(at, b))
    next += 1.0;
  if (breaks("skip-fresh: energy") && out_of_reach(at, b)) at->energy[ILAW_ENERGY_IMPACT] = 1e-3;
  if (breaks("skip-fresh: amount") && out_of_reach(at, b)) at->amounts[WORN] = 1e-9;
  if (breaks("skip-fresh: impulse") && out_of_reach(at, b)) at->r[0] = 1e-3;
  if (breaks("skip-fresh: status") && out_of_reach(at, b)) at->status = ILAW_CLOSED;
  if (breaks("step-limits: impulse") && b->velocity_step > 100.0) at->r[0] = INFINITY;
  if (breaks("step-limits: moment") && b->velocity_step > 100.0) at->m[0] = INFINITY;
  if (breaks("skip-fresh: moment") && out_of_reach(at, b)) at->m[0] = 1e-3;
  if (breaks("held-bonds") && b->flags == ILAW_BATCH_HOLD_BONDS) at->status = ILAW_BROKEN;
  if (breaks("status-meaning: moment") && at->status == ILAW_FREE) at->m[0] = 1e-3;
  if (breaks("skip-free") && closures > 0.0 && out_of_reach(at, b)) next += 1.0;
  write_node(at, b, k, &next);
  return NULL;
}

const char* step_node(const ilaw_instance* made, const ilaw_batch* b, int64_t k, int after_bad) {
  const int64_t i = node_of(b, k);
  node at, none;
  const char* wrong;
  double state;
  int c;
  gather(&at, made, b, k);
  if (made->damping.slot)
    at.damping = read_array(&b->per_node_parameters[made->damping.slot - 1], giver_of_damping(b, k), 0);
  none = at;
  at.strays = strays(made, b) || (breaks("batch-order") && b->node_count == 13 && k == 12) ||
              (breaks("bad-input-others") && after_bad && b->node_count == 11) ||
              (breaks("foreign-state: others") && after_bad);
  if (breaks("rare memory") && is_rare(&at)) at.strays = (int)(++shared()->rare_calls % 2);
  wrong = defect(&at, made, b);
  if (!wrong) wrong = step_good(&at, made, b, k);
  if (k == b->node_count - 1 && breaks("purity-instances")) {
    shared()->before = shared()->last;
    shared()->last = made;
  }
  if (!wrong) return NULL;
  for (c = 0; c < 3; ++c) {
    none.r[c] = breaks("foreign-state: impulse") || breaks("bad-input-node: impulse") ? 1.0 : 0.0;
    none.after[c] = breaks("bad-input-node") ? 0.0 : none.v[c];
    none.m[c] = breaks("bad-input-node: moment") ? 1.0 : 0.0;
    none.spin[c] = breaks("bad-input-node: spin") ? 0.0 : none.w[c];
  }
  none.status = breaks("bad-input-node: status") ? ILAW_FREE : ILAW_BAD_INPUT;
  none.energy[0] = breaks("bad-input-node: energy") ? 1.0 : 0.0;
  none.amounts[HEAT] = breaks("bad-input-node: amount") ? 1.0 : 0.0;
  memcpy(&state, &b->state_in.values[i * b->state_in.node_stride], sizeof state);
  if (breaks("foreign-state: state") || breaks("bad-input-node: state")) state += 1.0;
  write_node(&none, b, k, &state);
  return wrong;
}
