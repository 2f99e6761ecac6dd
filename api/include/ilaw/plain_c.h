/* plain_c.h - an interface law in plain C99. The author writes a description and `step`, the result at one
 * node; this header does the rest of what ilaw.h asks of a library: setups, parameters, tables, fields,
 * arrays of any layout and number type, both frames, bad nodes, amounts, the floating-point environment.
 *
 *   static const char* step(const ilaw_node* node, ilaw_node_result* result) { ... }
 *   static const ilaw_plain_law brake = {{ILAW_PLAIN_LAW, .id = "brake", ...}, step};
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

#define ILAW_BUILDING_PLUGIN
#include <ilaw/ilaw.h>

#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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

/* Null, or why the node's input is bad: a static text. */
typedef const char* (*ilaw_plain_step)(const ilaw_node* node, ilaw_node_result* result);

typedef struct ilaw_plain_law {
  ilaw_law law;
  ilaw_plain_step step;
} ilaw_plain_law;

/* Axis of a table: a place in the axes of the parameter, and the parameter that is this field, or -1. */
struct ilaw_plain_table {
  uint32_t axis_count, place[3];
  int field[3];
  uint64_t count[3];
  double *points[3], *values;
};

struct ilaw_instance {
  const ilaw_plain_law* plain;
  uint32_t dimension, per_node_count;
  ilaw_delassus_form form;
  ilaw_frame frame;
  ilaw_number_type numbers;
  int given[ILAW_PLAIN_MAX];
  ilaw_kind kind[ILAW_PLAIN_MAX];
  uint32_t slot[ILAW_PLAIN_MAX]; /* among the arrays per node */
  double number[ILAW_PLAIN_MAX];
  struct ilaw_plain_table table[ILAW_PLAIN_MAX];
  const char* per_node[ILAW_PLAIN_MAX];
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
/* Checks the pointers of an array: the mistake, or null. */
static inline const char* ilaw_plain_wrong_array(const ilaw_instance* own, const void* values,
                                                 const void* floats, int required) {
  if (!values && !floats) return required ? "an array is missing" : NULL;
  const int is_float = own->numbers == ILAW_NUMBERS_FLOAT;
  return (is_float ? floats && !values : values && !floats) ? NULL
                                                            : "an array is not of the setup's number type";
}

/* ---- parameters --------------------------------------------------------------------------------- */

static inline double ilaw_plain_between(double a, double b, double part) {
  return part == 0.0 || a == b ? a : part == 1.0 ? b : (1.0 - part) * a + part * b;
}

/* Value of parameter p where it may be a table over quantities that the law computes: `computed` has a number
 * for each axis of the parameter; those of "time" and of fields are not read. */
static inline double ilaw_value(const ilaw_node* node, uint32_t p, const double* computed) {
  const struct ilaw_plain_table* t = &node->instance->table[p];
  if (node->instance->kind[p] != ILAW_KIND_VALUE_TABLE) return node->value[p];
  uint64_t low[3] = {0, 0, 0};
  double part[3] = {0.0, 0.0, 0.0}, corner[8];
  for (uint32_t a = 0; a < t->axis_count; ++a) {
    const char* name = node->instance->plain->law.parameters[p]->axes[t->place[a]];
    const double x = t->field[a] >= 0            ? node->value[t->field[a]]
                     : strcmp(name, "time") == 0 ? node->time
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

static inline int ilaw_plain_is_allowed(const ilaw_parameter* p, double x) {
  if (x == INFINITY) return (p->flags & ILAW_FLAG_ALLOWS_INFINITY) != 0;
  if (p->kind == ILAW_KIND_INTEGER && x != floor(x)) return 0;
  return (p->flags & ILAW_FLAG_EXCLUDES_MINIMUM ? x > p->minimum : x >= p->minimum) && x <= p->maximum;
}

static inline double* ilaw_plain_copy(const double* x, uint64_t count) {
  double* copy = (double*)malloc(count * sizeof(double));
  if (copy) memcpy(copy, x, count * sizeof(double));
  return copy;
}

/* Null, or what is wrong with the table; empty where there is no memory. */
static inline const char* ilaw_plain_keep_table(ilaw_instance* own, uint32_t p, const ilaw_argument* a) {
  const ilaw_law* law = &own->plain->law;
  const ilaw_parameter* known = law->parameters[p];
  struct ilaw_plain_table* t = &own->table[p];
  uint64_t size = 1;
  if (a->axis_count < 1 || a->axis_count > 3 || !a->axes || !a->values) return "must have one to three axes";
  for (uint32_t i = 0; i < a->axis_count; ++i, ++t->axis_count) {
    const ilaw_axis* axis = a->axes[i];
    uint32_t place = 0;
    if (!axis || axis->struct_size < ILAW_AXIS_SIZE_1_0 || !axis->name || !axis->points || axis->count < 1)
      return "has an axis without a name or points";
    if (axis->count > ILAW_TABLE_MAX_VALUES / size) return "has more than 2^24 values";
    size *= axis->count;
    while (place < known->axis_count && strcmp(known->axes[place], axis->name) != 0) ++place;
    if (place == known->axis_count) return "cannot be a table over this axis";
    for (uint32_t j = 0; j < i; ++j)
      if (t->place[j] == place) return "has an axis twice";
    for (uint64_t k = 0; k < axis->count; ++k)
      if (!isfinite(axis->points[k]) || (k > 0 && !(axis->points[k] > axis->points[k - 1])))
        return "has an axis whose points do not increase";
    t->place[i] = place, t->count[i] = axis->count, t->field[i] = -1;
    for (uint32_t f = 0; f < law->parameter_count; ++f)
      if (strcmp(law->parameters[f]->name, axis->name) == 0) t->field[i] = (int)f;
    if (!(t->points[i] = ilaw_plain_copy(axis->points, axis->count))) return "";
  }
  for (uint64_t k = 0; k < size; ++k)
    if (!ilaw_plain_is_allowed(known, a->values[k])) return "has a value in its table that is out of range";
  return (t->values = ilaw_plain_copy(a->values, size)) ? NULL : "";
}

static inline const char* ilaw_plain_keep(ilaw_instance* own, uint32_t p, const ilaw_argument* a) {
  const ilaw_parameter* known = own->plain->law.parameters[p];
  const int is_choice = known->kind == ILAW_KIND_CHOICE;
  if (own->given[p]++) return "is given twice";
  if (known->flags & ILAW_FLAG_NEEDS_SPINS && own->form != ILAW_DELASSUS_TRANSVERSE_SPIN)
    return "needs spins, which this form of H has not";
  own->kind[p] = a->kind, own->number[p] = a->number;
  if (a->kind == ILAW_KIND_VALUE_NUMBER && !is_choice)
    return ilaw_plain_is_allowed(known, a->number) ? NULL : "is out of range";
  if (a->kind == ILAW_KIND_VALUE_TEXT && is_choice && a->text)
    for (uint32_t c = 0; c < known->choice_count; ++c)
      if (strcmp(known->choices[c], a->text) == 0) return own->number[p] = c, NULL;
  if (is_choice) return "is none of its choices";
  if (a->kind == ILAW_KIND_VALUE_TABLE) return ilaw_plain_keep_table(own, p, a);
  if (a->kind != ILAW_KIND_VALUE_PER_NODE || !(known->flags & ILAW_FLAG_ALLOWS_PER_NODE))
    return "cannot be given in this way";
  own->slot[p] = own->per_node_count;
  own->per_node[own->per_node_count++] = known->name;
  return NULL;
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
  for (uint32_t p = 0; own && p < ILAW_PLAIN_MAX; ++p) {
    free(own->table[p].values);
    for (int a = 0; a < 3; ++a) free(own->table[p].points[a]);
  }
  free(own);
}

static inline ilaw_result ilaw_plain_refuse(ilaw_result code, char* message, size_t size, const char* id,
                                            const char* why) {
  if (message && size > 0) snprintf(message, size, "%s: %s", id, why);
  return code;
}

/* Value and range of a number stand behind what is wrong. */
static inline ilaw_result ilaw_plain_refuse_argument(const ilaw_instance* own, const char* name, int p,
                                                     const char* why, char* message, size_t size) {
  const ilaw_parameter* known = p < 0 ? NULL : own->plain->law.parameters[p];
  char range[160] = "";
  if (!*why) return ilaw_plain_refuse(ILAW_OUT_OF_MEMORY, message, size, own->plain->law.id, "out of memory");
  if (known && own->given[p] && own->kind[p] == ILAW_KIND_VALUE_NUMBER)
    snprintf(range, sizeof range, ": found %.17g, expected %s%g to %g%s", own->number[p],
             known->flags & ILAW_FLAG_EXCLUDES_MINIMUM ? "above " : "", known->minimum, known->maximum,
             known->flags & ILAW_FLAG_ALLOWS_INFINITY ? " or inf" : "");
  if (message && size > 0)
    snprintf(message, size, "%s: parameter '%.80s' %s%s", own->plain->law.id, name, why, range);
  return ILAW_INVALID_PARAMETER;
}

static inline ilaw_result ilaw_plain_keep_all(ilaw_instance* own, const ilaw_setup* s, char* message,
                                              size_t size) {
  const ilaw_law* law = &own->plain->law;
  for (uint32_t p = 0; p < law->parameter_count; ++p) own->number[p] = law->parameters[p]->default_value;
  for (uint32_t i = 0; i < s->argument_count; ++i) {
    const ilaw_argument* a = s->arguments[i];
    uint32_t p = 0;
    if (!a || a->struct_size < ILAW_ARGUMENT_SIZE_1_0 || !a->name)
      return ilaw_plain_refuse(ILAW_INVALID_ARGUMENT, message, size, law->id,
                               "an argument is null or too small");
    while (p < law->parameter_count && strcmp(law->parameters[p]->name, a->name) != 0) ++p;
    if (p == law->parameter_count)
      return ilaw_plain_refuse_argument(own, a->name, -1, "is unknown", message, size);
    const char* why = ilaw_plain_keep(own, p, a);
    if (why) return ilaw_plain_refuse_argument(own, a->name, (int)p, why, message, size);
  }
  for (uint32_t p = 0; p < law->parameter_count; ++p) {
    const char* name = law->parameters[p]->name;
    if (law->parameters[p]->flags & ILAW_FLAG_REQUIRED && !own->given[p])
      return ilaw_plain_refuse_argument(own, name, (int)p, "is missing", message, size);
    for (uint32_t a = 0; a < own->table[p].axis_count; ++a)
      if (own->table[p].field[a] >= 0 && !own->given[own->table[p].field[a]])
        return ilaw_plain_refuse_argument(own, name, (int)p, "is a table over a field that is not given",
                                          message, size);
  }
  return ILAW_OK;
}

#define ILAW_PLAIN_IS_ONE(x, mask) (((x) & (mask)) != 0 && ((x) & ((x)-1)) == 0)
static inline ilaw_result ILAW_CALL ilaw_plain_create(const char* id, const ilaw_setup* s,
                                                      ilaw_instance** instance, char* message, size_t size) {
  const ilaw_plugin* plugin = ilaw_plain_plugin();
  const ilaw_law* law = NULL;
  if (message && size > 0) message[0] = '\0';
  if (!instance) return ILAW_INVALID_ARGUMENT;
  *instance = NULL;
  for (uint32_t k = 0; id && k < plugin->law_count; ++k)
    if (strcmp(plugin->laws[k]->id, id) == 0) law = plugin->laws[k];
  if (!law)
    return ilaw_plain_refuse(ILAW_INVALID_ARGUMENT, message, size, plugin->name, "has no law of this id");
  if (!s || s->struct_size < ILAW_SETUP_SIZE_1_0 || (s->argument_count && !s->arguments))
    return ilaw_plain_refuse(ILAW_INVALID_ARGUMENT, message, size, id, "the setup is null or too small");
  if (s->flags || s->dimension < 1 || s->dimension > 3 || !(1U << s->dimension & law->dimensions) ||
      (s->delassus_form == ILAW_DELASSUS_TRANSVERSE_SPIN && s->dimension != 3) ||
      !ILAW_PLAIN_IS_ONE(s->delassus_form, law->delassus_forms) ||
      !ILAW_PLAIN_IS_ONE(s->frame, law->frames) || !ILAW_PLAIN_IS_ONE(s->numbers, law->numbers))
    return ilaw_plain_refuse(ILAW_UNSUPPORTED, message, size, id,
                             "this dimension, form of H, frame, number type or flag is not served");
  ilaw_instance* own = (ilaw_instance*)calloc(1, sizeof *own);
  if (!own) return ilaw_plain_refuse(ILAW_OUT_OF_MEMORY, message, size, id, "out of memory");
  own->plain = (const ilaw_plain_law*)(const void*)law;
  own->dimension = s->dimension, own->form = s->delassus_form, own->frame = s->frame;
  own->numbers = s->numbers;
  fenv_t host;
  ilaw_plain_enter(&host);
  const ilaw_result code = ilaw_plain_keep_all(own, s, message, size);
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
  if (!own || !out || out->struct_size < ILAW_INSTANCE_INFO_SIZE_1_0) return ILAW_INVALID_ARGUMENT;
  const ilaw_law* law = &own->plain->law;
  ilaw_instance_info info;
  memset(&info, 0, sizeof info);
  info.struct_size = out->struct_size, info.inputs = ilaw_plain_inputs(own);
  info.state_size = info.state_variable_count = law->state_variable_count;
  info.state_variables = law->state_variables;
  info.per_node_parameters = own->per_node, info.per_node_parameter_count = own->per_node_count;
  info.capabilities = law->capabilities, info.permissions = law->permissions;
  info.amounts = law->amounts, info.amount_count = law->amount_count;
  memcpy(out, &info, out->struct_size < sizeof info ? out->struct_size : sizeof info);
  return ILAW_OK;
}

/* ---- batches ------------------------------------------------------------------------------------ */

static inline ilaw_result ilaw_plain_report(ilaw_report* report, ilaw_result code, int64_t count,
                                            int64_t first, const char* reason, double step) {
  if (report && report->struct_size >= ILAW_REPORT_SIZE_1_0) {
    report->bad_count = count, report->first_bad_node = first, report->reason = reason;
    report->stable_velocity_step = step;
  }
  return code;
}

static inline const char* ilaw_plain_wrong_call(const ilaw_instance* own, const ilaw_batch* b) {
  if (!own || !b) return "the instance is null, or the batch null or too small";
  if (b->node_count < 0 || (b->index && b->index64)) return "node_count is negative, or two lists are given";
  if (b->index_base != 0 && b->index_base != 1) return "index_base is neither 0 nor 1";
  if (!isfinite(b->time)) return "time is not finite";
  for (int64_t k = 0; k < b->node_count; ++k)
    if (ilaw_node_of(b, k) < 0) return "an index is below index_base";
  if (own->plain->law.state_variable_count == 0 || b->node_count == 0) return NULL;
  if (!b->state_out.values || b->state_out.floats) return "state_out is missing, or not of doubles";
  return b->node_count > 1 && b->state_out.node_stride == 0 ? "state_out has a node stride of 0" : NULL;
}

static inline const char* ilaw_plain_wrong_arrays(const ilaw_instance* own, const ilaw_batch* b) {
  const ilaw_law* law = &own->plain->law;
  const ilaw_inputs in = ilaw_plain_inputs(own);
  const int has_spins = own->form == ILAW_DELASSUS_TRANSVERSE_SPIN;
  const ilaw_output* outputs[] = {&b->impulse, &b->velocity, &b->energy, &b->moment, &b->spin};
  const struct {
    const ilaw_input* array;
    int is_read;
  } inputs[] = {{&b->v_free, 1},
                {&b->delassus, 1},
                {&b->gap, (in & ILAW_INPUT_GAP) != 0},
                {&b->v_previous, (in & ILAW_INPUT_V_PREVIOUS) != 0},
                {&b->area, (in & ILAW_INPUT_AREA) != 0},
                {&b->normal, (in & ILAW_INPUT_NORMAL) != 0},
                {&b->spin_free, has_spins},
                {&b->spin_previous, has_spins && (in & ILAW_INPUT_V_PREVIOUS)}};
  const char* wrong = NULL;
  if (!(b->velocity_step > 0.0 && b->velocity_step < INFINITY)) return "velocity_step is not finite and > 0";
  if (!(b->position_step > 0.0 && b->position_step < INFINITY)) return "position_step is not finite and > 0";
  if (b->node_count == 0) return NULL;
  for (size_t k = 0; k < sizeof inputs / sizeof *inputs && !wrong; ++k)
    if (inputs[k].is_read)
      wrong = ilaw_plain_wrong_array(own, inputs[k].array->values, inputs[k].array->floats, 1);
  if (!wrong && in & ILAW_INPUT_GAP)
    wrong = ilaw_plain_wrong_array(own, b->gap_offset.values, b->gap_offset.floats, 0);
  if (!wrong && own->per_node_count && !b->per_node_parameters) wrong = "per_node_parameters is missing";
  for (uint32_t k = 0; k < own->per_node_count && !wrong; ++k)
    wrong =
        ilaw_plain_wrong_array(own, b->per_node_parameters[k].values, b->per_node_parameters[k].floats, 1);
  const uint32_t fixed = has_spins ? 5 : 3;
  for (uint32_t k = 0; k < fixed + (b->amounts ? law->amount_count : 0) && !wrong; ++k) {
    const ilaw_output* a = k < fixed ? outputs[k] : &b->amounts[k - fixed];
    wrong = ilaw_plain_wrong_array(own, a->values, a->floats, a == &b->impulse || a == &b->moment);
    if ((a->values || a->floats) && a->node_stride == 0 && b->node_count > 1)
      wrong = "an output has a node stride of 0";
  }
  if (wrong || !law->state_variable_count) return wrong;
  return b->state_in.values && !b->state_in.floats ? NULL : "state_in is missing, or not of doubles";
}

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
    return "H is not positive definite";
  if (!ilaw_plain_vector(&b->spin_free, i, 3, node->spin_free)) return "spin_free is not finite";
  if (ilaw_plain_inputs(own) & ILAW_INPUT_V_PREVIOUS &&
      !ilaw_plain_vector(&b->spin_previous, i, 3, node->spin_previous))
    return "spin_previous is not finite";
  return NULL;
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
  node->h_N = node->h_T = ilaw_get(&b->delassus, i, 0);
  if (own->form != ILAW_DELASSUS_SCALAR && own->dimension > 1) node->h_T = ilaw_get(&b->delassus, i, 1);
  if (!(node->h_N > 0.0 && node->h_N < INFINITY && node->h_T > 0.0 && node->h_T < INFINITY))
    return "H is not positive definite";
  if (own->form == ILAW_DELASSUS_TRANSVERSE_SPIN) {
    const char* wrong = ilaw_plain_read_spins(own, b, i, node);
    if (wrong) return wrong;
  }
  if (in & ILAW_INPUT_GAP) {
    const int has_offset = b->gap_offset.values || b->gap_offset.floats;
    node->gap = ilaw_get(&b->gap, i, 0);
    if (has_offset) node->gap -= ilaw_get(&b->gap_offset, i, 0);
  }
  if (!isfinite(node->gap)) return "gap or gap_offset is not finite";
  if (in & ILAW_INPUT_V_PREVIOUS && !ilaw_plain_vector(&b->v_previous, i, own->dimension, node->v_previous))
    return "v_previous is not finite";
  if (in & ILAW_INPUT_AREA) node->area = ilaw_get(&b->area, i, 0);
  if (!(node->area >= 0.0 && node->area < INFINITY)) return "area is not finite and >= 0";
  if (in & ILAW_INPUT_NORMAL) {
    ilaw_plain_vector(&b->normal, i, own->dimension, node->n);
    if (!(fabs(ilaw_dot(node->n, node->n) - 1.0) <= 1e-6)) return "normal is not a unit vector";
  }
  for (uint32_t s = 0; s < law->state_variable_count; ++s)
    if (!isfinite(node->state[s] = ilaw_get(&b->state_in, i, s))) return "a state is not finite";
  for (uint32_t p = 0; p < law->parameter_count; ++p) {
    static const double none[3] = {0.0, 0.0, 0.0};
    node->value[p] = own->number[p];
    if (own->kind[p] == ILAW_KIND_VALUE_PER_NODE) {
      node->value[p] = ilaw_get(&b->per_node_parameters[own->slot[p]], i, 0);
      if (!ilaw_plain_is_allowed(law->parameters[p], node->value[p]))
        return "a value per node is out of range";
    }
    if (own->kind[p] == ILAW_KIND_VALUE_TABLE) node->value[p] = ilaw_value(node, p, none);
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

/* A copy of the batch of a host of any minor version; members that it lacks are zero. */
static inline const ilaw_batch* ilaw_plain_sized(const ilaw_batch* given, ilaw_batch* own) {
  if (!given || given->struct_size < ILAW_BATCH_SIZE_1_0) return NULL;
  memset(own, 0, sizeof *own);
  memcpy(own, given, given->struct_size < sizeof *own ? given->struct_size : sizeof *own);
  return own;
}

static inline int ilaw_plain_overflows(const ilaw_instance* own, const double* r) {
  const double limit = own->numbers == ILAW_NUMBERS_FLOAT ? 0x1p126 : INFINITY;
  return !(fabs(r[0]) < limit && fabs(r[1]) < limit && fabs(r[2]) < limit);
}

static inline ilaw_result ilaw_plain_walk(const ilaw_instance* own, const ilaw_batch* b,
                                          ilaw_report* report) {
  const char *refused = ilaw_plain_wrong_call(own, b), *reason = NULL;
  int64_t count = 0, first = -1;
  double stable = INFINITY;
  if (!refused && b->flags)
    return ilaw_plain_report(report, ILAW_UNSUPPORTED, 0, -1, "a flag is not known", 0.0);
  if (!refused) refused = ilaw_plain_wrong_arrays(own, b);
  if (!refused && b->node_count > 1 && b->status && b->status_stride == 0)
    refused = "status has a stride of 0";
  if (refused) return ilaw_plain_report(report, ILAW_INVALID_ARGUMENT, 0, -1, refused, 0.0);
  for (int64_t k = 0; k < b->node_count; ++k) {
    const int64_t i = ilaw_node_of(b, k);
    ilaw_node node;
    ilaw_node_result result;
    const char* bad = ilaw_plain_read(own, b, i, &node);
    memset(&result, 0, sizeof result);
    memcpy(result.state, node.state, sizeof result.state);
    result.stable_velocity_step = INFINITY;
    if (!bad) bad = own->plain->step(&node, &result);
    if (!bad && (ilaw_plain_overflows(own, result.r) || ilaw_plain_overflows(own, result.m)))
      bad = "the impulse or moment overflows";
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
  if (refused) return ilaw_plain_report(report, ILAW_INVALID_ARGUMENT, 0, -1, refused, 0.0);
  if (b->flags) return ilaw_plain_report(report, ILAW_UNSUPPORTED, 0, -1, "a flag is not known", 0.0);
  for (int64_t k = 0; k < b->node_count; ++k)
    for (uint32_t s = 0; s < own->plain->law.state_variable_count; ++s)
      ilaw_put(&b->state_out, ilaw_node_of(b, k), s, 0.0);
  return ilaw_plain_report(report, ILAW_OK, 0, -1, NULL, INFINITY);
}

typedef ilaw_result (*ilaw_plain_batch_function)(const ilaw_instance* own, const ilaw_batch* b,
                                                 ilaw_report* report);
/* A batch of any size, in the environment of laws. */
static inline ilaw_result ilaw_plain_call(ilaw_plain_batch_function function, const ilaw_instance* own,
                                          const ilaw_batch* given, ilaw_report* report) {
  ilaw_batch copy;
  fenv_t host;
  ilaw_plain_enter(&host);
  const ilaw_result code = function(own, ilaw_plain_sized(given, &copy), report);
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
#define ILAW_PLAIN_LIST(list) .list = list, .ILAW_PLAIN_COUNT_##list = ILAW_PLAIN_LENGTH(list)
#define ILAW_PLAIN_LENGTH(list) \
  (sizeof list / sizeof *list * sizeof(char[sizeof list / sizeof *list <= ILAW_PLAIN_MAX ? 1 : -1]))
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
