/* plain_c.h - an interface law in plain C99. The author writes a description and `step`, the result at one
 * node; this header does the rest of what ilaw.h asks of a library: setups, parameters, tables, fields,
 * arrays of any layout and number type, both frames, bad nodes, amounts, the floating-point environment.
 *
 *   static const char* step(const ilaw_node* node, ilaw_node_result* result) { ... }
 *   static const ilaw_plain_law brake = {.law = {ILAW_PLAIN_LAW, .id = "brake", ...}, .step = step};
 *   ILAW_PLAIN_LIBRARY("brake", "1.0.0", "vendor", "licence", &brake.law)      one law or several
 *
 * Serves isotropic laws (the tangent of a host is not read) with scalar or transverse H, also with spins
 * (ILAW_PLAIN_LAW_OF), whose state consists of scalars that begin at 0, and which read all their inputs at
 * every step. plugins/template_c is an example. Compile with -ffp-contract=off: a fused multiply-add makes
 * the bits depend on the processor.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef ILAW_PLAIN_C_H
#define ILAW_PLAIN_C_H

#ifndef ILAW_BUILDING_PLUGIN
#define ILAW_BUILDING_PLUGIN
#endif
#include <ilaw/create.h>

#include <fenv.h>
#include <math.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

enum { ILAW_PLAIN_MAX = 16 }; /* parameters, state variables, amounts of a law */

/* A node in the axes of the host; n is the normal, vectors have zeros beyond the dimension. */
typedef struct ilaw_node {
  double time, velocity_step, position_step;
  double gap, area;   /* gap: without the offset; 0 where the law does not read them */
  double h_N, h_T;    /* H = h_N n n^T + h_T (I - n n^T) */
  double k, j_N, j_T; /* where H has spins, as they have; all 0 elsewhere */
  double n[3], v_free[3], v_previous[3], spin_free[3], spin_previous[3];
  double v_smooth[3]; /* v_free where the host gives none, or the law does not read it */
  double state[ILAW_PLAIN_MAX];
  double value[ILAW_PLAIN_MAX]; /* of each parameter of the law; see ilaw_value for tables */
  const ilaw_instance* instance;
} ilaw_node;

/* All zero when step begins, but state (the node's) and stable_velocity_step (INFINITY). */
typedef struct ilaw_node_result {
  double r[3], m[3], state[ILAW_PLAIN_MAX], energy[ILAW_ENERGY_COUNT], amounts[ILAW_PLAIN_MAX];
  double stable_velocity_step;
  ilaw_status status;
} ilaw_node_result;

/* Null, or why the node's input is bad: a static text. A result with a NaN, an overflow, a negative
 * dissipation or an unknown status, or one that breaks the law's own capabilities and permissions, makes
 * the node bad, too. */
typedef const char* (*ilaw_plain_step)(const ilaw_node* node, ilaw_node_result* result);

typedef struct ilaw_plain_law {
  ilaw_law law;
  ilaw_plain_step step;
  uint32_t state_version; /* raise it whenever step interprets a stored state differently */
} ilaw_plain_law;

struct ilaw_instance {
  const ilaw_plain_law* plain;
  uint32_t dimension;
  ilaw_delassus_form form;
  ilaw_frame frame;
  ilaw_number_type numbers;
  struct ilaw_arguments arguments;
  uint32_t slot[ILAW_PLAIN_MAX]; /* among the arrays per node */
  int rank[ILAW_PLAIN_MAX];      /* read first are numbers (0), then tables (1), then tables over these (2) */
};

/* Not ILAW_ENTRY itself: another library, opened with RTLD_GLOBAL, could take its name. */
static const ilaw_plugin* ilaw_plain_plugin(void);

/* ---- vectors ------------------------------------------------------------------------------------ */

static inline double ilaw_dot(const double* a, const double* b) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* Scaled by the largest component, whose square may overflow or underflow. */
static inline double ilaw_length(const double* a) {
  const double size = fmax(fmax(fabs(a[0]), fabs(a[1])), fabs(a[2]));
  if (!(size > 0.0) || isinf(size)) return size;
  const double unit[3] = {a[0] / size, a[1] / size, a[2] / size};
  return size * sqrt(ilaw_dot(unit, unit));
}

/* The part of a in the tangent plane of n. */
static inline void ilaw_tangential(const double* a, const double* n, double* out) {
  const double a_N = ilaw_dot(a, n);
  for (int c = 0; c < 3; ++c) out[c] = a[c] - a_N * n[c];
}

static inline void ilaw_cross(const double* a, const double* b, double* out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/* ---- arrays ------------------------------------------------------------------------------------- */

static inline double ilaw_get(const ilaw_input* a, int64_t node, int64_t c) {
  const int64_t k = node * a->node_stride + c * a->component_stride;
  return a->values ? a->values[k] : (double)a->floats[k];
}
static inline void ilaw_put(const ilaw_output* a, int64_t node, int64_t c, double x) {
  const int64_t k = node * a->node_stride + c * a->component_stride;
  if (a->values) a->values[k] = x;
  if (a->floats) a->floats[k] = (float)x;
}
static inline int64_t ilaw_node_of(const ilaw_batch* b, int64_t k) {
  return b->index ? (int64_t)b->index[k] - b->index_base : b->index64 ? b->index64[k] - b->index_base : k;
}
/* Checks the pointers of an array: the mistake, or null. missing: null for an array that may be absent. */
static inline const char* ilaw_plain_wrong_array(int is_float, const void* values, const void* floats,
                                                 const char* missing) {
  if (missing && !(is_float ? floats : values)) return missing;
  return (is_float ? values : floats) ? "an array is of other numbers than the setup's, or has both pointers"
                                      : NULL;
}
/* ---- parameters --------------------------------------------------------------------------------- */

static inline double ilaw_plain_between(double a, double b, double part) {
  return part == 0.0 || a == b ? a : part == 1.0 ? b : (1.0 - part) * a + part * b;
}

/* Value of parameter p where it may be a table over quantities that the law computes: `computed` has a number
 * for each axis of the parameter; those of "time" and of fields are not read. */
static inline double ilaw_value(const ilaw_node* node, uint32_t p, const double* computed) {
  const struct ilaw_table* t = &node->instance->arguments.table[p];
  if (t->axis_count == 0) return node->value[p];
  uint64_t low[3] = {0, 0, 0};
  double part[3] = {0.0, 0.0, 0.0}, corner[8];
  for (uint32_t a = 0; a < t->axis_count; ++a) {
    const double x = t->source[a] >= 0           ? node->value[t->source[a]]
                     : t->source[a] == ILAW_TIME ? node->time
                                                 : computed[t->place[a]];
    const double* points = t->points[a];
    uint64_t high = t->count[a] - 1;
    if (high == 0) continue;
    while (high - low[a] > 1) {
      const uint64_t middle = low[a] + (high - low[a]) / 2;
      if (x >= points[middle])
        low[a] = middle;
      else
        high = middle;
    }
    const double lower = points[low[a]], upper = points[high];
    part[a] = !(x > lower) ? 0.0 : x >= upper ? 1.0 : (x - lower) / (upper - lower);
  }
  const uint32_t corners = 1U << t->axis_count;
  for (uint32_t k = 0; k < corners; ++k) { /* the last axis varies fastest, also here */
    uint64_t at = 0;
    for (uint32_t a = 0; a < t->axis_count; ++a)
      at = at * t->count[a] + low[a] + (t->count[a] > 1 && (k >> (t->axis_count - 1 - a) & 1U) ? 1 : 0);
    corner[k] = t->values[at];
  }
  for (uint32_t a = 0, rest = corners / 2; a < t->axis_count; ++a, rest /= 2)
    for (uint32_t k = 0; k < rest; ++k) corner[k] = ilaw_plain_between(corner[k], corner[k + rest], part[a]);
  return corner[0];
}

/* ---- the floating-point environment -------------------------------------------------------------- */

/* Rounding to nearest, subnormal numbers and no traps until fesetenv(host) brings the host's back. */
static inline void ilaw_plain_enter(fenv_t* host) {
  fegetenv(host);
  fesetenv(FE_DFL_ENV);
#if defined(__SSE2__)
  _mm_setcsr(0x1F80); /* C99 does not say that FE_DFL_ENV ends flush-to-zero */
#endif
}

/* ---- instances ---------------------------------------------------------------------------------- */

static inline void ILAW_CALL ilaw_plain_destroy(ilaw_instance* own) {
  if (own) ilaw_arguments_free(&own->arguments);
  free(own);
}

/* The order in which parameters are read, and the places of those with a value per node. */
static inline void ilaw_plain_order(ilaw_instance* own) {
  const struct ilaw_arguments* given = &own->arguments;
  for (uint32_t k = 0; k < given->per_node_count; ++k) own->slot[given->per_node[k]] = k;
  for (uint32_t p = 0; p < own->plain->law.parameter_count; ++p)
    for (uint32_t a = 0; a < given->table[p].axis_count; ++a) {
      const int rank = given->table[p].source[a] == ILAW_TIME ? 1 : 2;
      if (own->rank[p] < rank) own->rank[p] = rank;
    }
}

static inline ilaw_result ILAW_CALL ilaw_plain_create(const char* id, const ilaw_setup* s,
                                                      ilaw_instance** instance, char* text, size_t size) {
  struct ilaw_message m = ilaw_message_in(id ? id : "null", text, size);
  const ilaw_plugin* plugin = ilaw_plain_plugin();
  const ilaw_law* law = NULL;
  if (!instance) return ILAW_INVALID_ARGUMENT;
  *instance = NULL;
  for (uint32_t k = 0; id && k < plugin->law_count; ++k)
    if (strcmp(plugin->laws[k]->id, id) == 0) law = plugin->laws[k];
  if (!law) return ilaw_refuse(&m, ILAW_INVALID_ARGUMENT, "library '%s' has no law of this id", plugin->name);
  if (!s || !ilaw_create_is_sized(s->struct_size, ILAW_SETUP_SIZE_1_0))
    return ilaw_refuse(&m, ILAW_INVALID_ARGUMENT, "setup is null or its struct_size not from %u to %u",
                       (unsigned)ILAW_SETUP_SIZE_1_0, (unsigned)ILAW_CREATE_MAX_STRUCT);
  fenv_t host;
  ilaw_plain_enter(&host);
  ilaw_instance* own = NULL;
  ilaw_result code = ILAW_OK;
  if (!(own = (ilaw_instance*)calloc(1, sizeof *own)))
    code = ilaw_refuse(&m, ILAW_OUT_OF_MEMORY, "out of memory");
  if (code == ILAW_OK) {
    own->plain = (const ilaw_plain_law*)(const void*)law;
    own->dimension = s->dimension, own->form = s->delassus_form, own->frame = s->frame;
    own->numbers = s->numbers;
    code = ilaw_create_read(law, s, &own->arguments, &m);
    if (code == ILAW_OK) ilaw_plain_order(own);
  }
  fesetenv(&host);
  if (code == ILAW_OK)
    *instance = own;
  else
    ilaw_plain_destroy(own);
  return code;
}

static inline ilaw_inputs ilaw_plain_inputs(const ilaw_instance* own) {
  const ilaw_inputs axes = ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT;
  return (own->plain->law.inputs & ~axes) | (own->frame == ILAW_FRAME_GLOBAL ? ILAW_INPUT_NORMAL : 0U);
}

static inline ilaw_result ILAW_CALL ilaw_plain_info(const ilaw_instance* own, ilaw_instance_info* out) {
  if (!own || !out || !ilaw_create_is_sized(out->struct_size, ILAW_INSTANCE_INFO_SIZE_1_0))
    return ILAW_INVALID_ARGUMENT;
  const ilaw_law* law = &own->plain->law;
  ilaw_instance_info info;
  memset(&info, 0, sizeof info);
  info.struct_size = out->struct_size, info.inputs = ilaw_plain_inputs(own);
  info.state_size = info.state_variable_count = law->state_variable_count;
  info.state_variables = law->state_variables;
  info.per_node_parameters = own->arguments.per_node_names;
  info.per_node_parameter_count = own->arguments.per_node_count;
  info.capabilities = law->capabilities, info.permissions = law->permissions;
  info.state_version = own->plain->state_version;
  info.amounts = law->amounts, info.amount_count = law->amount_count;
  memcpy(out, &info, out->struct_size < sizeof info ? out->struct_size : sizeof info);
  return ILAW_OK;
}

/* ---- batches ------------------------------------------------------------------------------------ */

static inline ilaw_result ilaw_plain_report(ilaw_report* report, ilaw_result code, int64_t count,
                                            int64_t first, const char* reason, double step) {
  if (!report) return code;
  report->bad_count = count, report->first_bad_node = first, report->reason = reason;
  report->stable_velocity_step = step;
  return code;
}

/* Whether an output has one place for two numbers. */
static inline int ilaw_plain_collides(const ilaw_output* a, int64_t nodes, uint32_t components) {
  return (a->values || a->floats) && ((nodes > 1 && components > 0 && a->node_stride == 0) ||
                                      (components > 1 && a->component_stride == 0));
}

static inline const char* ilaw_plain_wrong_call(const ilaw_instance* own, const ilaw_batch* b) {
  const uint32_t states = own->plain->law.state_variable_count;
  if (b->node_count < 0) return "node_count is negative";
  if (!isfinite(b->time)) return "time is not finite";
  if (b->index_base != 0 && b->index_base != 1) return "index_base is neither 0 nor 1";
  if (b->index && b->index64) return "index and index64 are both given";
  for (int64_t k = 0; (b->index || b->index64) && k < b->node_count; ++k)
    if ((b->index ? (int64_t)b->index[k] : b->index64[k]) < b->index_base)
      return "a node of the index list lies below index_base";
  if (states == 0 || b->node_count == 0) return NULL;
  if (ilaw_plain_collides(&b->state_out, b->node_count, states)) return "state_out has a stride of 0";
  return ilaw_plain_wrong_array(0, b->state_out.values, b->state_out.floats, "state_out is null");
}

/* A flat array of all degrees of freedom: its first numbers would be taken in silence for every component. */
#define ILAW_PLAIN_FLAT(name) name " has one component per node (component stride 0), expected a (d,n) array"

static inline const char* ilaw_plain_wrong_arrays(const ilaw_instance* own, const ilaw_batch* b) {
  const ilaw_law* law = &own->plain->law;
  const ilaw_inputs in = ilaw_plain_inputs(own);
  const int is_float = own->numbers == ILAW_NUMBERS_FLOAT;
  const uint32_t d = own->dimension, spins = own->form == ILAW_DELASSUS_TRANSVERSE_SPIN ? 3 : 0;
  const struct {
    const ilaw_input* array;
    int is_read;
    const char *missing, *flat; /* null: may be absent; no vector */
  } inputs[] = {
      {&b->v_free, 1, "v_free is null", ILAW_PLAIN_FLAT("v_free")},
      {&b->delassus, 1, "delassus is null", NULL},
      {&b->v_smooth, in & ILAW_INPUT_V_SMOOTH, NULL, ILAW_PLAIN_FLAT("v_smooth")},
      {&b->gap, in & ILAW_INPUT_GAP, "gap is null", NULL},
      {&b->gap_offset, in & ILAW_INPUT_GAP, NULL, NULL},
      {&b->v_previous, in & ILAW_INPUT_V_PREVIOUS, "v_previous is null", ILAW_PLAIN_FLAT("v_previous")},
      {&b->area, in & ILAW_INPUT_AREA, "area is null", NULL},
      {&b->normal, in & ILAW_INPUT_NORMAL, "normal is null", ILAW_PLAIN_FLAT("normal")},
      {&b->spin_free, spins != 0, "spin_free is null", ILAW_PLAIN_FLAT("spin_free")},
      {&b->spin_previous, spins && in & ILAW_INPUT_V_PREVIOUS, "spin_previous is null",
       ILAW_PLAIN_FLAT("spin_previous")}};
  const struct {
    const ilaw_output* array;
    uint32_t components;
    const char *missing, *stacked;
  } outputs[] = {{&b->impulse, d, "impulse is null", "impulse has a stride of 0"},
                 {&b->velocity, d, NULL, "velocity has a stride of 0"},
                 {&b->energy, ILAW_ENERGY_COUNT, NULL, "energy has a stride of 0"},
                 {&b->moment, spins, "moment is null", "moment has a stride of 0"},
                 {&b->spin, spins, NULL, "spin has a stride of 0"}};
  const char* wrong = NULL;
  if (!(b->velocity_step > 0.0 && b->velocity_step < INFINITY))
    return "velocity_step is not a finite number > 0";
  if (!(b->position_step > 0.0 && b->position_step < INFINITY))
    return "position_step is not a finite number > 0";
  if (b->node_count == 0) return NULL;
  if (b->status && b->node_count > 1 && b->status_stride == 0) return "status_stride is 0";
  for (size_t k = 0; k < sizeof inputs / sizeof *inputs && !wrong; ++k) {
    const ilaw_input* a = inputs[k].array;
    if (!inputs[k].is_read) continue;
    wrong = ilaw_plain_wrong_array(is_float, a->values, a->floats, inputs[k].missing);
    if (!wrong && (a->values || a->floats) && d > 1 && a->component_stride == 0) wrong = inputs[k].flat;
  }
  for (size_t k = 0; k < sizeof outputs / sizeof *outputs && !wrong; ++k) {
    const ilaw_output* a = outputs[k].array;
    if (outputs[k].components == 0) continue;
    wrong = ilaw_plain_wrong_array(is_float, a->values, a->floats, outputs[k].missing);
    if (ilaw_plain_collides(a, b->node_count, outputs[k].components)) wrong = outputs[k].stacked;
  }
  if (own->arguments.per_node_count && !b->per_node_parameters) return "per_node_parameters is null";
  for (uint32_t k = 0; k < own->arguments.per_node_count && !wrong; ++k)
    wrong =
        ilaw_plain_wrong_array(is_float, b->per_node_parameters[k].values, b->per_node_parameters[k].floats,
                               "values of a per-node parameter are null");
  for (uint32_t k = 0; b->amounts && k < law->amount_count && !wrong; ++k) {
    wrong = ilaw_plain_wrong_array(is_float, b->amounts[k].values, b->amounts[k].floats, NULL);
    if (ilaw_plain_collides(&b->amounts[k], b->node_count, 1)) wrong = "an amount has a stride of 0";
  }
  if (wrong || law->state_variable_count == 0) return wrong;
  return ilaw_plain_wrong_array(0, b->state_in.values, b->state_in.floats, "state_in is null");
}
#undef ILAW_PLAIN_FLAT

/* False where a number is not finite. */
static inline int ilaw_plain_vector(const ilaw_input* a, int64_t i, uint32_t dimension, double* out) {
  int is_finite = 1;
  for (uint32_t c = 0; c < 3; ++c) {
    out[c] = c < dimension ? ilaw_get(a, i, c) : 0.0;
    is_finite = is_finite && isfinite(out[c]);
  }
  return is_finite;
}

/* The same of k, J and spins. k^2 < h_T j_T, or the inverse mass were not positive definite. */
static inline const char* ilaw_plain_read_spins(const ilaw_instance* own, const ilaw_batch* b, int64_t i,
                                                ilaw_node* node) {
  node->k = ilaw_get(&b->delassus, i, 2);
  node->j_N = ilaw_get(&b->delassus, i, 3), node->j_T = ilaw_get(&b->delassus, i, 4);
  if (!(node->j_N > 0.0 && node->j_N < INFINITY && node->j_T > 0.0 && node->j_T < INFINITY) ||
      !(node->k / node->h_T * (node->k / node->j_T) < 1.0 - 1e-12))
    return "H is not finite and positive definite";
  if (ilaw_plain_vector(&b->spin_free, i, 3, node->spin_free) &&
      (!(ilaw_plain_inputs(own) & ILAW_INPUT_V_PREVIOUS) ||
       ilaw_plain_vector(&b->spin_previous, i, 3, node->spin_previous)))
    return NULL;
  return "spin_free or spin_previous is not finite";
}

/* Null, or why the input of the node is bad. */
static inline const char* ilaw_plain_read(const ilaw_instance* own, const ilaw_batch* b, int64_t i,
                                          ilaw_node* node) {
  const ilaw_law* law = &own->plain->law;
  const ilaw_inputs in = ilaw_plain_inputs(own);
  memset(node, 0, sizeof *node);
  node->instance = own, node->time = b->time, node->n[0] = 1.0;
  node->velocity_step = b->velocity_step, node->position_step = b->position_step;
  if (!ilaw_plain_vector(&b->v_free, i, own->dimension, node->v_free)) return "v_free is not finite";
  memcpy(node->v_smooth, node->v_free, sizeof node->v_smooth);
  if (in & ILAW_INPUT_V_SMOOTH && (b->v_smooth.values || b->v_smooth.floats) &&
      !ilaw_plain_vector(&b->v_smooth, i, own->dimension, node->v_smooth))
    return "v_smooth is not finite";
  node->h_N = node->h_T = ilaw_get(&b->delassus, i, 0);
  if (own->form != ILAW_DELASSUS_SCALAR && own->dimension > 1) node->h_T = ilaw_get(&b->delassus, i, 1);
  if (!(node->h_N > 0.0 && node->h_N < INFINITY && node->h_T > 0.0 && node->h_T < INFINITY))
    return "H is not finite and positive definite";
  if (own->form == ILAW_DELASSUS_TRANSVERSE_SPIN) {
    const char* wrong = ilaw_plain_read_spins(own, b, i, node);
    if (wrong) return wrong;
  }
  if (in & ILAW_INPUT_GAP) {
    const int has_offset = b->gap_offset.values || b->gap_offset.floats;
    node->gap = ilaw_get(&b->gap, i, 0);
    if (has_offset) node->gap -= ilaw_get(&b->gap_offset, i, 0);
  }
  if (!isfinite(node->gap)) return "the gap is not finite";
  if (in & ILAW_INPUT_V_PREVIOUS && !ilaw_plain_vector(&b->v_previous, i, own->dimension, node->v_previous))
    return "v_previous is not finite";
  if (in & ILAW_INPUT_AREA) node->area = ilaw_get(&b->area, i, 0);
  if (!(node->area >= 0.0 && node->area < INFINITY)) return "the area is not a finite number >= 0";
  if (in & ILAW_INPUT_NORMAL) {
    ilaw_plain_vector(&b->normal, i, own->dimension, node->n);
    if (!(fabs(ilaw_dot(node->n, node->n) - 1.0) <= 1e-6)) return "the normal is not a unit vector";
  }
  for (uint32_t s = 0; s < law->state_variable_count; ++s)
    if (!isfinite(node->state[s] = ilaw_get(&b->state_in, i, s))) return "the state is not finite";
  for (int rank = 0; rank <= 2; ++rank)
    for (uint32_t p = 0; p < law->parameter_count; ++p) {
      static const double none[3] = {0.0, 0.0, 0.0};
      if (own->rank[p] != rank) continue;
      node->value[p] = own->arguments.number[p];
      if (own->arguments.table[p].axis_count > 0) node->value[p] = ilaw_value(node, p, none);
      if (own->arguments.kind[p] != ILAW_KIND_VALUE_PER_NODE) continue;
      node->value[p] = ilaw_get(&b->per_node_parameters[own->slot[p]], i, 0);
      if (!ilaw_is_allowed(law->parameters[p], node->value[p])) return "a per-node parameter is out of range";
    }
  return NULL;
}

/* A node with bad input: no impulse, and what stands in the host's arrays. */
static inline void ilaw_plain_spoil(const ilaw_instance* own, const ilaw_batch* b, int64_t i, ilaw_node* node,
                                    ilaw_node_result* result) {
  memset(result, 0, sizeof *result);
  result->status = ILAW_BAD_INPUT, result->stable_velocity_step = INFINITY;
  ilaw_plain_vector(&b->v_free, i, own->dimension, node->v_free);
  if (own->form == ILAW_DELASSUS_TRANSVERSE_SPIN) ilaw_plain_vector(&b->spin_free, i, 3, node->spin_free);
  for (uint32_t s = 0; s < own->plain->law.state_variable_count; ++s)
    result->state[s] = ilaw_get(&b->state_in, i, s);
}

/* v = v_free + H r + k n x m, w = w_free + J m - k n x r. */
static inline void ilaw_plain_move(const ilaw_node* node, const ilaw_node_result* result, double* v,
                                   double* w) {
  const double r_N = ilaw_dot(result->r, node->n), m_N = ilaw_dot(result->m, node->n);
  double n_m[3], n_r[3];
  ilaw_cross(node->n, result->m, n_m);
  ilaw_cross(node->n, result->r, n_r);
  for (int c = 0; c < 3; ++c) {
    const double along_r = r_N * node->n[c], along_m = m_N * node->n[c];
    v[c] = node->v_free[c] + (node->h_N * along_r + node->h_T * (result->r[c] - along_r));
    w[c] = node->spin_free[c] + (node->j_N * along_m + node->j_T * (result->m[c] - along_m));
    if (node->k != 0.0) v[c] += node->k * n_m[c], w[c] -= node->k * n_r[c];
  }
}

static inline void ilaw_plain_write(const ilaw_instance* own, const ilaw_batch* b, int64_t i,
                                    const ilaw_node* node, const ilaw_node_result* result) {
  const ilaw_law* law = &own->plain->law;
  const int is_bad = result->status == ILAW_BAD_INPUT;
  double v[3], w[3];
  ilaw_plain_move(node, result, v, w);
  for (uint32_t c = 0; c < own->dimension; ++c) {
    ilaw_put(&b->impulse, i, c, result->r[c] + 0.0); /* never -0 */
    ilaw_put(&b->velocity, i, c, is_bad ? node->v_free[c] : v[c]);
    if (own->form != ILAW_DELASSUS_TRANSVERSE_SPIN) continue;
    ilaw_put(&b->moment, i, c, result->m[c] + 0.0);
    ilaw_put(&b->spin, i, c, is_bad ? node->spin_free[c] : w[c]);
  }
  for (uint32_t e = 0; e < ILAW_ENERGY_COUNT; ++e) ilaw_put(&b->energy, i, e, result->energy[e]);
  for (uint32_t a = 0; b->amounts && a < law->amount_count; ++a)
    ilaw_put(&b->amounts[a], i, 0, result->amounts[a]);
  for (uint32_t s = 0; s < law->state_variable_count; ++s) ilaw_put(&b->state_out, i, s, result->state[s]);
  if (b->status) b->status[i * b->status_stride] = result->status;
}

/* As ilaw.h defines it, each operation rounded. */
static inline int ilaw_plain_is_out_of_reach(const ilaw_node* node) {
  const double reach = node->gap + node->position_step * ilaw_dot(node->n, node->v_free);
  const double smooth = node->gap + node->position_step * ilaw_dot(node->n, node->v_smooth);
  return node->gap > 0.0 && reach > 0.0 && smooth > 0.0;
}

/* Null, or what no law may give. */
static inline const char* ilaw_plain_wrong_result(const ilaw_instance* own, const ilaw_node* node,
                                                  const ilaw_node_result* result) {
  const ilaw_law* law = &own->plain->law;
  const double *r = result->r, *m = result->m, *energy = result->energy;
  const double size = (fabs(r[0]) + fabs(r[1]) + fabs(r[2])) + (fabs(m[0]) + fabs(m[1]) + fabs(m[2]));
  /* An impulse of 2^126 or more overflows in a host that computes in floats. */
  const double guard = own->numbers == ILAW_NUMBERS_FLOAT ? 0x1p898 : 4.0;
  if (isnan(size)) return "the law gave an impulse that is not a number";
  int is_finite = isfinite(guard * size) != 0, is_fresh = 1;
  for (uint32_t s = 0; s < law->state_variable_count; ++s) {
    is_finite = is_finite && isfinite(result->state[s]);
    is_fresh = is_fresh && node->state[s] == 0.0;
  }
  if (!is_finite) return "the impulse or the state overflows";
  for (int e = 0; e < ILAW_ENERGY_COUNT; ++e)
    if (isnan(energy[e]) || (e != ILAW_ENERGY_STORED && energy[e] < 0.0))
      return "the law gave a dissipated energy below 0, or one that is not a number";
  for (uint32_t a = 0; a < law->amount_count; ++a)
    if (isnan(result->amounts[a])) return "the law gave an amount that is not a number";
  if (result->status >= ILAW_BAD_INPUT) return "the law gave a status that no step has";
  if (!(result->stable_velocity_step >= 0.0)) return "the law gave a stable step that is not a number >= 0";
  /* Normals are unit vectors to 1e-6. */
  if (!(law->capabilities & ILAW_CAN_ADHERE) && ilaw_dot(r, node->n) < -1e-6 * size)
    return "the law pulled, which needs ILAW_CAN_ADHERE among its capabilities";
  if (law->permissions & ILAW_MAY_SKIP_FRESH && is_fresh && size > 0.0 && ilaw_plain_is_out_of_reach(node))
    return "the law acted out of reach, which ILAW_MAY_SKIP_FRESH of its permissions excludes";
  return NULL;
}

static inline ilaw_result ilaw_plain_walk(const ilaw_instance* own, const ilaw_batch* b,
                                          ilaw_report* report) {
  const char *refused = ilaw_plain_wrong_call(own, b), *reason = NULL;
  int64_t count = 0, first = -1;
  double stable = INFINITY;
  if (!refused) refused = ilaw_plain_wrong_arrays(own, b);
  if (refused) return ilaw_plain_report(report, ILAW_INVALID_ARGUMENT, 0, -1, refused, INFINITY);
  for (int64_t k = 0; k < b->node_count; ++k) {
    const int64_t i = ilaw_node_of(b, k);
    ilaw_node node;
    ilaw_node_result result;
    const char* bad = ilaw_plain_read(own, b, i, &node);
    memset(&result, 0, sizeof result);
    memcpy(result.state, node.state, sizeof result.state);
    result.stable_velocity_step = INFINITY;
    if (!bad) bad = own->plain->step(&node, &result);
    if (!bad) bad = ilaw_plain_wrong_result(own, &node, &result);
    if (bad) ilaw_plain_spoil(own, b, i, &node, &result);
    if (bad && count++ == 0) first = i, reason = bad;
    ilaw_plain_write(own, b, i, &node, &result);
    if (result.stable_velocity_step < stable) stable = result.stable_velocity_step;
  }
  return ilaw_plain_report(report, count ? ILAW_BAD_NODES : ILAW_OK, count, first, reason, stable);
}

static inline ilaw_result ilaw_plain_first_states(const ilaw_instance* own, const ilaw_batch* b,
                                                  ilaw_report* report) {
  const char* refused = ilaw_plain_wrong_call(own, b);
  if (refused) return ilaw_plain_report(report, ILAW_INVALID_ARGUMENT, 0, -1, refused, INFINITY);
  for (int64_t k = 0; k < b->node_count; ++k)
    for (uint32_t s = 0; s < own->plain->law.state_variable_count; ++s)
      ilaw_put(&b->state_out, ilaw_node_of(b, k), s, 0.0);
  return ilaw_plain_report(report, ILAW_OK, 0, -1, NULL, INFINITY);
}

typedef ilaw_result (*ilaw_plain_batch_function)(const ilaw_instance* own, const ilaw_batch* b,
                                                 ilaw_report* report);
/* A batch of any size, whose members that the host lacks are zero, in the environment of laws. */
static inline ilaw_result ilaw_plain_call(ilaw_plain_batch_function function, const ilaw_instance* own,
                                          const ilaw_batch* given, ilaw_report* report) {
  ilaw_batch b;
  fenv_t host;
  if (report && !ilaw_create_is_sized(report->struct_size, ILAW_REPORT_SIZE_1_0))
    return ILAW_INVALID_ARGUMENT;
  if (!own || !given)
    return ilaw_plain_report(report, ILAW_INVALID_ARGUMENT, 0, -1, "instance or batch is null", INFINITY);
  if (!ilaw_create_is_sized(given->struct_size, ILAW_BATCH_SIZE_1_0))
    return ilaw_plain_report(report, ILAW_INVALID_ARGUMENT, 0, -1,
                             "struct_size of the batch is none of any version", INFINITY);
  memset(&b, 0, sizeof b);
  memcpy(&b, given, given->struct_size < sizeof b ? given->struct_size : sizeof b);
  if (b.flags)
    return ilaw_plain_report(report, ILAW_UNSUPPORTED, 0, -1, "flags of the batch are not known", INFINITY);
  ilaw_plain_enter(&host);
  const ilaw_result code = function(own, &b, report);
  fesetenv(&host);
  return code;
}

static inline ilaw_result ILAW_CALL ilaw_plain_evaluate(const ilaw_instance* own, const ilaw_batch* given,
                                                        ilaw_report* report) {
  return ilaw_plain_call(ilaw_plain_walk, own, given, report);
}

static inline ilaw_result ILAW_CALL ilaw_plain_initialise(const ilaw_instance* own, const ilaw_batch* given,
                                                          ilaw_report* report) {
  return ilaw_plain_call(ilaw_plain_first_states, own, given, report);
}

/* ---- descriptions ------------------------------------------------------------------------------- */

/* First members of a law: what this header serves and does for it. Forms: of H, any of SCALAR, TRANSVERSE and
 * TRANSVERSE_SPIN. */
#define ILAW_PLAIN_LAW ILAW_PLAIN_LAW_OF(ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_TRANSVERSE)
#define ILAW_PLAIN_LAW_OF(forms)                                                                          \
  .struct_size = sizeof(ilaw_law), .frames = ILAW_FRAME_LOCAL | ILAW_FRAME_GLOBAL,                        \
  .numbers = ILAW_NUMBERS_DOUBLE | ILAW_NUMBERS_FLOAT, .delassus_forms = forms,                           \
  .outputs = ILAW_OUTPUT_VELOCITY | ILAW_OUTPUT_STATUS | ILAW_OUTPUT_ENERGY, .create = ilaw_plain_create, \
  .destroy = ilaw_plain_destroy, .info = ilaw_plain_info, .initialise = ilaw_plain_initialise,            \
  .evaluate = ilaw_plain_evaluate

/* A parameter with further members by name. */
#define ILAW_PLAIN_PARAMETER(name_, symbol_, unit_, doc_, ...)                                           \
  {                                                                                                      \
    .struct_size = sizeof(ilaw_parameter), .name = name_, .symbol = symbol_, .unit = unit_, .doc = doc_, \
    __VA_ARGS__                                                                                          \
  }

/* `.parameters = list` and its count, for a list of that name; one that is too long does not compile. */
#define ILAW_PLAIN_LIST(list) \
  .list = list, .ILAW_PLAIN_COUNT_##list = ILAW_PLAIN_LENGTH(list, ILAW_PLAIN_MOST_##list)
#define ILAW_PLAIN_LENGTH(list, most) \
  (sizeof list / sizeof *list * sizeof(char[sizeof list / sizeof *list <= (most) ? 1 : -1]))
#define ILAW_PLAIN_MOST_parameters ILAW_PLAIN_MAX
#define ILAW_PLAIN_MOST_state_variables ILAW_PLAIN_MAX
#define ILAW_PLAIN_MOST_amounts ILAW_PLAIN_MAX
#define ILAW_PLAIN_MOST_references UINT32_MAX
#define ILAW_PLAIN_COUNT_parameters parameter_count
#define ILAW_PLAIN_COUNT_state_variables state_variable_count
#define ILAW_PLAIN_COUNT_amounts amount_count
#define ILAW_PLAIN_COUNT_references reference_count

#define ILAW_PLAIN_LIBRARY(name_, version_, vendor_, licence_, ...)              \
  static const ilaw_plugin* ilaw_plain_plugin(void) {                            \
    static const ilaw_law* const laws[] = {__VA_ARGS__};                         \
    static const ilaw_plugin plugin = {.struct_size = sizeof plugin,             \
                                       .abi_major = ILAW_ABI_MAJOR,              \
                                       .abi_minor = ILAW_ABI_MINOR,              \
                                       .name = name_,                            \
                                       .version = version_,                      \
                                       .vendor = vendor_,                        \
                                       .licence = licence_,                      \
                                       .laws = laws,                             \
                                       .law_count = sizeof laws / sizeof *laws}; \
    return &plugin;                                                              \
  }                                                                              \
  const ilaw_plugin* ILAW_CALL ILAW_ENTRY(void) { return ilaw_plain_plugin(); }

#endif
