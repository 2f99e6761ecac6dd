/* create.h - the core of create for all laws, those of the kit (ilaw/kit.hpp) and those in plain C
 * (ilaw/plain_c.h): checks a setup against a law's description, reads the arguments, and refuses what is
 * wrong by name. C99 and C++.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef ILAW_CREATE_H
#define ILAW_CREATE_H

#include <ilaw/ilaw.h>

#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ILAW_CREATE_MAX = 32 };               /* parameters of a law */
enum { ILAW_CREATE_MAX_STRUCT = 4096 };      /* no struct of any version is larger */
enum { ILAW_TIME = -1, ILAW_COMPUTED = -2 }; /* sources of an axis that are no field */

/* Whether a writer of ABI 1 can have set this struct_size. */
static inline int ilaw_create_is_sized(uint32_t struct_size, size_t least) {
  return struct_size >= least && struct_size <= ILAW_CREATE_MAX_STRUCT;
}

/* ---- messages ----------------------------------------------------------------------------------- */

/* One line for the caller of create, "law '...': ...", why it fails; text that does not fit is cut. */
struct ilaw_message {
  const char* law;
  char* text;
  size_t size, used;
};
static inline struct ilaw_message ilaw_message_in(const char* law, char* text, size_t size) {
  const struct ilaw_message m = {law, text, text ? size : 0, 0};
  if (m.size > 0) text[0] = '\0';
  return m;
}
static inline void ilaw_message_write(struct ilaw_message* m, const char* format, va_list values) {
  if (m->used + 1 >= m->size) return;
  const int length = vsnprintf(m->text + m->used, m->size - m->used, format, values);
  if (length > 0) m->used += (size_t)length;
}
#if defined(__GNUC__)
#define ILAW_CREATE_PRINTF(text, values) __attribute__((format(printf, text, values)))
#else
#define ILAW_CREATE_PRINTF(text, values)
#endif
static inline ILAW_CREATE_PRINTF(2, 3) void ilaw_message_add(struct ilaw_message* m, const char* format,
                                                             ...) {
  va_list values;
  va_start(values, format);
  ilaw_message_write(m, format, values);
  va_end(values);
}
/* The beginning of a message, or all of it. Returns the code. */
static inline ILAW_CREATE_PRINTF(3, 4) ilaw_result
    ilaw_refuse(struct ilaw_message* m, ilaw_result code, const char* format, ...) {
  va_list values;
  ilaw_message_add(m, "law '%s': ", m->law);
  va_start(values, format);
  ilaw_message_write(m, format, values);
  va_end(values);
  return code;
}

/* With as few digits as read back to the same number, and with a dot whatever the locale of the host has. */
static inline void ilaw_message_add_number(struct ilaw_message* m, double x) {
  char text[48], *to = text;
  int digits = 15;
  do snprintf(text, sizeof text, "%.*g", digits, x);
  while (digits++ < 17 && strtod(text, NULL) != x);
  for (const char* c = text; *c; ++c)
    if (strchr("+-0123456789einfa", *c))
      *to++ = *c;
    else if (to == text || to[-1] != '.')
      *to++ = '.';
  ilaw_message_add(m, "%.*s", (int)(to - text), text);
}
/* A value as the host gives it. */
static inline void ilaw_message_add_value(struct ilaw_message* m, const ilaw_parameter* p, double x) {
  if (p->kind == ILAW_KIND_CHOICE)
    ilaw_message_add(m, "\"%s\"", p->choices[(uint32_t)x]);
  else
    ilaw_message_add_number(m, x);
}

/* What may be given to a parameter. */
static inline void ilaw_message_add_expected(struct ilaw_message* m, const ilaw_parameter* p) {
  const int is_endless = (p->flags & ILAW_FLAG_ALLOWS_INFINITY) || p->maximum == DBL_MAX;
  if (p->kind == ILAW_KIND_CHOICE) {
    ilaw_message_add(m, "expected one of ");
    for (uint32_t c = 0; c < p->choice_count; ++c)
      ilaw_message_add(m, "%s\"%s\"", c ? ", " : "", p->choices[c]);
    return;
  }
  ilaw_message_add(m, "expected a %snumber in %s", p->kind == ILAW_KIND_INTEGER ? "whole " : "",
                   p->flags & ILAW_FLAG_EXCLUDES_MINIMUM ? "(" : "[");
  ilaw_message_add_number(m, p->minimum);
  ilaw_message_add(m, ", ");
  if (is_endless)
    ilaw_message_add(m, "inf");
  else
    ilaw_message_add_number(m, p->maximum);
  ilaw_message_add(m, is_endless && !(p->flags & ILAW_FLAG_ALLOWS_INFINITY) ? ")" : "]");
}

/* ---- arguments ---------------------------------------------------------------------------------- */

/* A table: the place of each axis among the parameter's, and where its number comes from: the parameter that
 * is this field, or ILAW_TIME, or ILAW_COMPUTED. */
struct ilaw_table {
  uint32_t axis_count, place[3];
  int source[3];
  uint64_t count[3];
  double *points[3], *values; /* in one block, which begins at points[0] */
};
/* What create was given, by parameter. */
struct ilaw_arguments {
  int is_given[ILAW_CREATE_MAX];
  ilaw_kind kind[ILAW_CREATE_MAX];
  double number[ILAW_CREATE_MAX]; /* the default where nothing is given; of a choice its place */
  struct ilaw_table table[ILAW_CREATE_MAX];
  uint32_t per_node_count, per_node[ILAW_CREATE_MAX]; /* parameters with a value per node, as given */
  const char* per_node_names[ILAW_CREATE_MAX];
};

static inline void ilaw_arguments_free(struct ilaw_arguments* g) {
  for (int p = 0; p < ILAW_CREATE_MAX; ++p) free(g->table[p].points[0]);
}
static inline int ilaw_table_is_over_time_alone(const struct ilaw_table* t) {
  return t->axis_count == 1 && t->source[0] == ILAW_TIME;
}

/* Without math.h, whose names would stand beside those of the kit. */
static inline int ilaw_is_finite(double x) { return x - x == 0.0; }
static inline int ilaw_is_whole(double x) {
  if (x > -9007199254740992.0 && x < 9007199254740992.0) return x == (double)(int64_t)x;
  return ilaw_is_finite(x);
}
static inline int ilaw_is_allowed(const ilaw_parameter* p, double x) {
  if (x > DBL_MAX) return (p->flags & ILAW_FLAG_ALLOWS_INFINITY) != 0;
  if (p->kind == ILAW_KIND_INTEGER && !ilaw_is_whole(x)) return 0;
  return (p->flags & ILAW_FLAG_EXCLUDES_MINIMUM ? x > p->minimum : x >= p->minimum) && x <= p->maximum;
}
static inline ilaw_result ilaw_create_check_number(const ilaw_parameter* p, double x,
                                                   struct ilaw_message* m) {
  if (ilaw_is_allowed(p, x)) return ILAW_OK;
  const ilaw_result code = ilaw_refuse(m, ILAW_INVALID_PARAMETER, "parameter '%s' = ", p->name);
  ilaw_message_add_number(m, x);
  ilaw_message_add(m, " is not allowed: ");
  ilaw_message_add_expected(m, p);
  return code;
}

/* Checks axis i of the table of parameter p. */
static inline ilaw_result ilaw_create_keep_axis(const ilaw_law* law, const ilaw_parameter* p,
                                                const ilaw_axis* axis, uint32_t i, struct ilaw_table* t,
                                                struct ilaw_message* m) {
  const ilaw_result code = ILAW_INVALID_PARAMETER;
  uint32_t place = 0;
  while (place < p->axis_count && strcmp(p->axes[place], axis->name) != 0) ++place;
  if (place == p->axis_count) {
    ilaw_refuse(m, code, "parameter '%s': axis '%s' of the table is unknown: expected one of ", p->name,
                axis->name);
    for (uint32_t k = 0; k < p->axis_count; ++k) ilaw_message_add(m, "%s'%s'", k ? ", " : "", p->axes[k]);
    return code;
  }
  for (uint32_t j = 0; j < i; ++j)
    if (t->place[j] == place)
      return ilaw_refuse(m, code, "parameter '%s': the table has twice the axis %s", p->name, axis->name);
  for (uint64_t k = 0; k < axis->count; ++k)
    if (!ilaw_is_finite(axis->points[k]) || (k > 0 && axis->points[k] <= axis->points[k - 1])) {
      ilaw_refuse(m, code, "parameter '%s': point %llu of axis '%s' is ", p->name, (unsigned long long)k,
                  axis->name);
      ilaw_message_add_number(m, axis->points[k]);
      ilaw_message_add(m, ": expected finite, increasing points");
      return code;
    }
  t->place[i] = place;
  t->count[i] = axis->count;
  t->source[i] = strcmp(axis->name, "time") == 0 ? ILAW_TIME : ILAW_COMPUTED;
  for (uint32_t f = 0; f < law->parameter_count; ++f)
    if (strcmp(law->parameters[f]->name, axis->name) == 0) t->source[i] = (int)f;
  return ILAW_OK;
}

static inline ilaw_result ilaw_create_keep_table(const ilaw_law* law, const ilaw_parameter* p,
                                                 const ilaw_argument* a, struct ilaw_table* t,
                                                 struct ilaw_message* m) {
  const char* wrong = !a->values ? "no values" : NULL;
  uint64_t size = 1, stored = 0;
  if (a->axis_count < 1 || a->axis_count > 3 || !a->axes)
    wrong = "no axis or more than three, expected 1 to 3";
  for (uint32_t i = 0; !wrong && i < a->axis_count; ++i) {
    const ilaw_axis* axis = a->axes[i];
    if (!axis || !ilaw_create_is_sized(axis->struct_size, ILAW_AXIS_SIZE_1_0))
      wrong = "an axis that is null or whose struct_size is of no version";
    else if (!axis->name || !axis->points || axis->count < 1)
      wrong = "an axis without a name or point, expected at least 1 point";
    else if (axis->count > ILAW_TABLE_MAX_VALUES / size)
      wrong = "more than 16777216 values";
    if (wrong) break;
    const ilaw_result code = ilaw_create_keep_axis(law, p, axis, i, t, m);
    if (code != ILAW_OK) return code;
    size *= axis->count;
    stored += axis->count;
  }
  if (wrong)
    return ilaw_refuse(m, ILAW_INVALID_PARAMETER, "parameter '%s': the table has %s", p->name, wrong);
  for (uint64_t k = 0; k < size; ++k) {
    const ilaw_result code = ilaw_create_check_number(p, a->values[k], m);
    if (code != ILAW_OK) return code;
  }
  double* memory = (double*)malloc((stored + size) * sizeof(double));
  if (!memory)
    return ilaw_refuse(m, ILAW_OUT_OF_MEMORY, "out of memory for the table of parameter '%s'", p->name);
  t->axis_count = a->axis_count;
  for (uint32_t i = 0; i < t->axis_count; memory += t->count[i++])
    t->points[i] = (double*)memcpy(memory, a->axes[i]->points, t->count[i] * sizeof(double));
  t->values = (double*)memcpy(memory, a->values, size * sizeof(double));
  return ILAW_OK;
}

static inline ilaw_result ilaw_create_keep(const ilaw_law* law, const ilaw_setup* s, const ilaw_argument* a,
                                           struct ilaw_arguments* g, struct ilaw_message* m) {
  static const char* const kinds[] = {"a number", "a text", "a table", "a value per node"};
  const ilaw_result wrong = ILAW_INVALID_PARAMETER;
  uint32_t i = 0;
  while (i < law->parameter_count && strcmp(law->parameters[i]->name, a->name) != 0) ++i;
  if (i == law->parameter_count) {
    ilaw_refuse(m, wrong, "unknown parameter '%s': expected one of ", a->name);
    for (uint32_t k = 0; k < i; ++k) ilaw_message_add(m, "%s%s", k ? ", " : "", law->parameters[k]->name);
    return wrong;
  }
  const ilaw_parameter* p = law->parameters[i];
  const int is_choice = p->kind == ILAW_KIND_CHOICE;
  const char* text = a->kind == ILAW_KIND_VALUE_TEXT && a->text ? a->text : NULL;
  if (g->is_given[i]++) return ilaw_refuse(m, wrong, "parameter '%s' is given twice", p->name);
  if (p->flags & ILAW_FLAG_NEEDS_SPINS && s->delassus_form != ILAW_DELASSUS_TRANSVERSE_SPIN)
    return ilaw_refuse(m, wrong,
                       "parameter '%s' needs spins, form %u of H has none: expected 16 (transverse_spin)",
                       p->name, s->delassus_form);
  g->kind[i] = a->kind;
  if (a->kind == ILAW_KIND_VALUE_NUMBER && !is_choice) {
    g->number[i] = a->number;
    return ilaw_create_check_number(p, a->number, m);
  }
  for (uint32_t c = 0; is_choice && text && c < p->choice_count; ++c)
    if (strcmp(p->choices[c], text) == 0) {
      g->number[i] = c;
      return ILAW_OK;
    }
  if (a->kind == ILAW_KIND_VALUE_TABLE && p->axis_count > 0)
    return ilaw_create_keep_table(law, p, a, &g->table[i], m);
  if (a->kind == ILAW_KIND_VALUE_PER_NODE && p->flags & ILAW_FLAG_ALLOWS_PER_NODE) {
    g->per_node_names[g->per_node_count] = p->name;
    g->per_node[g->per_node_count++] = i;
    return ILAW_OK;
  }
  if (is_choice && text)
    ilaw_refuse(m, wrong, "parameter '%s' = \"%s\" is not allowed: ", p->name, text);
  else
    ilaw_refuse(m, wrong, "parameter '%s' was given as %s%s%s%s: ", p->name,
                a->kind < sizeof kinds / sizeof *kinds ? kinds[a->kind] : "a value of unknown kind",
                text ? " (\"" : "", text ? text : "", text ? "\")" : "");
  ilaw_message_add_expected(m, p);
  return wrong;
}

/* Fields that are axes must be given, as numbers, per node, or as tables over the time. */
static inline ilaw_result ilaw_create_check_fields(const ilaw_law* law, const struct ilaw_arguments* g,
                                                   struct ilaw_message* m) {
  for (uint32_t p = 0; p < law->parameter_count; ++p)
    for (uint32_t a = 0; a < g->table[p].axis_count; ++a) {
      const int field = g->table[p].source[a];
      if (field < 0) continue;
      if (g->is_given[field] &&
          (g->table[field].axis_count == 0 || ilaw_table_is_over_time_alone(&g->table[field])))
        continue;
      return ilaw_refuse(m, ILAW_INVALID_PARAMETER,
                         "parameter '%s' is a table over '%s': expected a value, a value per node or a table "
                         "over time for that",
                         law->parameters[p]->name, law->parameters[field]->name);
    }
  return ILAW_OK;
}

static inline ilaw_result ilaw_create_read_all(const ilaw_law* law, const ilaw_setup* s,
                                               struct ilaw_arguments* g, struct ilaw_message* m) {
  for (uint32_t p = 0; p < law->parameter_count; ++p) g->number[p] = law->parameters[p]->default_value;
  if (s->argument_count && !s->arguments)
    return ilaw_refuse(m, ILAW_INVALID_ARGUMENT, "arguments is null, expected %u pointers",
                       s->argument_count);
  for (uint32_t i = 0; i < s->argument_count; ++i) {
    const ilaw_argument* a = s->arguments[i];
    if (!a || !ilaw_create_is_sized(a->struct_size, ILAW_ARGUMENT_SIZE_1_0) || !a->name)
      return ilaw_refuse(m, ILAW_INVALID_ARGUMENT,
                         "argument %u is null, has no name or a struct_size not from %u to %u", i,
                         (unsigned)ILAW_ARGUMENT_SIZE_1_0, (unsigned)ILAW_CREATE_MAX_STRUCT);
    const ilaw_result code = ilaw_create_keep(law, s, a, g, m);
    if (code != ILAW_OK) return code;
  }
  for (uint32_t p = 0; p < law->parameter_count; ++p)
    if (law->parameters[p]->flags & ILAW_FLAG_REQUIRED && !g->is_given[p]) {
      ilaw_refuse(m, ILAW_INVALID_PARAMETER, "parameter '%s' is missing: ", law->parameters[p]->name);
      ilaw_message_add_expected(m, law->parameters[p]);
      return ILAW_INVALID_PARAMETER;
    }
  return ilaw_create_check_fields(law, g, m);
}

/* ---- setups ------------------------------------------------------------------------------------- */

/* Whether x is exactly one entry of a mask; if not, says so. names: of the bits. */
static inline int ilaw_create_serves(struct ilaw_message* m, const char* what, uint32_t x, const char* of,
                                     uint32_t mask, const char* const* names) {
  if ((x & mask) != 0 && (x & (x - 1)) == 0) return 1;
  ilaw_refuse(m, ILAW_UNSUPPORTED, "%s %u%s", what, x, of);
  ilaw_message_add(m, " is not served: expected one of");
  for (uint32_t k = 0; mask >> k != 0; ++k)
    if (mask >> k & 1U) ilaw_message_add(m, " %u (%s)", 1U << k, names[k]);
  return 0;
}

/* A setup of this version's size. */
static inline ilaw_result ilaw_create_check_setup(const ilaw_law* law, const ilaw_setup* s,
                                                  struct ilaw_message* m) {
  static const char* const forms[] = {"scalar", "diagonal", "full", "transverse", "transverse_spin"};
  static const char *const frames[] = {"local", "global"}, *const numbers[] = {"double", "float"};
  if (s->dimension < 1 || s->dimension > 3 || !(1U << s->dimension & law->dimensions)) {
    ilaw_refuse(m, ILAW_UNSUPPORTED, "dimension %u is not served: expected", s->dimension);
    for (unsigned d = 1; d <= 3; ++d)
      if (law->dimensions & 1U << d) ilaw_message_add(m, " %u", d);
    return ILAW_UNSUPPORTED;
  }
  if (!ilaw_create_serves(m, "form", s->delassus_form, " of H", law->delassus_forms, forms))
    return ILAW_UNSUPPORTED;
  if (s->delassus_form == ILAW_DELASSUS_TRANSVERSE_SPIN && s->dimension != 3)
    return ilaw_refuse(m, ILAW_UNSUPPORTED,
                       "dimension %u has no spins: expected 3 for form 16 (transverse_spin) of H",
                       s->dimension);
  if (!ilaw_create_serves(m, "frame", s->frame, "", law->frames, frames) ||
      !ilaw_create_serves(m, "number type", s->numbers, "", law->numbers, numbers))
    return ILAW_UNSUPPORTED;
  if (s->flags)
    return ilaw_refuse(m, ILAW_UNSUPPORTED, "flags 0x%llx are not known: expected 0",
                       (unsigned long long)s->flags);
  if (s->has_tangent > 1)
    return ilaw_refuse(m, ILAW_INVALID_ARGUMENT, "has_tangent %u is unknown: expected 0 or 1",
                       s->has_tangent);
  return ILAW_OK;
}

/* All of the above. g: zero before; to be freed after, also where it fails. */
static inline ilaw_result ilaw_create_read(const ilaw_law* law, const ilaw_setup* s, struct ilaw_arguments* g,
                                           struct ilaw_message* m) {
  const ilaw_result code = ilaw_create_check_setup(law, s, m);
  return code == ILAW_OK ? ilaw_create_read_all(law, s, g, m) : code;
}

#endif
