/* Instances of the law. */
#include "sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A refusal: one line, which rules may break. */
static ilaw_result refuse(char* message, size_t size, ilaw_result code, const char* name, const char* what) {
  disturb("calls-process: refusal");
  if (breaks("prints-nothing")) fprintf(stderr, "sample: %s\n", what);
  if (message && size > 0)
    snprintf(message, size, "law 'sample': %s: %s", breaks("refusal-message") ? "\n" : name, what);
  if (message && breaks("refusal-message: beyond")) message[size] = '\0';
  if (message && breaks("refusal-message: endless")) memset(message, 'x', size);
  return code;
}

/* As described. */
static int is_allowed(const ilaw_parameter* p, double value) {
  if (value == INFINITY) return (p->flags & ILAW_FLAG_ALLOWS_INFINITY) != 0;
  return value <= p->maximum &&
         (p->flags & ILAW_FLAG_EXCLUDES_MINIMUM ? value > p->minimum : value >= p->minimum);
}

static int in_range(const ilaw_parameter* p, double value) {
  if (isnan(value)) return breaks("parameter-nan");
  if (value == INFINITY && breaks("parameter-infinity")) return 1;
  if (p->kind == ILAW_KIND_INTEGER && value != floor(value) && !breaks("parameter-whole")) return 0;
  if (breaks("parameter-accepted") && strcmp(p->name, "friction") == 0 && value == 0.0) return 0;
  if (breaks("parameter-range") && isfinite(value)) return 1;
  return is_allowed(p, value);
}

/* The number of values of a table, 0 where its axes are none. */
static uint64_t grid_of(quantity* to, const ilaw_parameter* p, const ilaw_argument* a) {
  uint64_t size = 1, k;
  uint32_t n;
  if (a->axis_count < 1 || a->axis_count > 2 || !a->axes || !a->values) return 0;
  for (n = 0; n < a->axis_count; ++n) {
    const ilaw_axis* axis = a->axes[n];
    if (!axis || axis->struct_size < ILAW_AXIS_SIZE_1_0 || axis->count < 1 || !axis->points) return 0;
    if (axis->count > ILAW_TABLE_MAX_VALUES / size && !breaks("table-limit")) return 0;
    size *= axis->count;
    to->is_time[n] = strcmp(axis->name, "time") == 0;
    if (!to->is_time[n] && (p->axis_count < 2 || strcmp(axis->name, "temperature") != 0)) return 0;
    if (n > 0 && to->is_time[0] == to->is_time[1] && !breaks("table-axes")) return 0;
    for (k = 0; k < axis->count && !breaks("table-shape"); ++k)
      if (!isfinite(axis->points[k]) || (k > 0 && !(axis->points[k] > axis->points[k - 1]))) return 0;
  }
  return size;
}

static ilaw_result read_table(quantity* to, const ilaw_parameter* p, const ilaw_argument* a) {
  const uint64_t size = grid_of(to, p, a);
  uint64_t k;
  uint32_t n;
  if (size == 0 || to->axis_count > 0) return ILAW_INVALID_PARAMETER;
  if (size > ILAW_TABLE_MAX_VALUES) return ILAW_OK; /* of a broken rule */
  for (k = 0; k < size && !breaks("table-shape"); ++k)
    if (!is_allowed(p, a->values[k])) return ILAW_INVALID_PARAMETER;
  for (n = 0; n < a->axis_count; ++n, ++to->axis_count) {
    to->count[n] = a->axes[n]->count;
    to->points[n] = malloc(to->count[n] * sizeof(double));
    if (!to->points[n]) return ILAW_OUT_OF_MEMORY;
    memcpy(to->points[n], a->axes[n]->points, to->count[n] * sizeof(double));
  }
  to->values = malloc(size * sizeof(double));
  if (!to->values) return ILAW_OUT_OF_MEMORY;
  memcpy(to->values, a->values, size * sizeof(double));
  return ILAW_OK;
}

static ilaw_result read_quantity(ilaw_instance* made, quantity* to, const ilaw_parameter* p,
                                 const ilaw_argument* a) {
  const int is_refused = breaks("field-per-node") && (p->flags & ILAW_FLAG_FIELD);
  if (a->kind == ILAW_KIND_VALUE_NUMBER && in_range(p, a->number)) {
    to->constant = a->number;
    return ILAW_OK;
  }
  if (a->kind == ILAW_KIND_VALUE_PER_NODE && (p->flags & ILAW_FLAG_ALLOWS_PER_NODE) && !is_refused) {
    made->per_node[made->per_node_count++] = p->name;
    to->slot = made->per_node_count;
    return ILAW_OK;
  }
  if (a->kind == ILAW_KIND_VALUE_TABLE && p->axis_count > 0) return read_table(to, p, a);
  return breaks("parameter-varying") && a->kind == ILAW_KIND_VALUE_PER_NODE && !(p->flags & ILAW_FLAG_FIELD)
             ? ILAW_OK
             : ILAW_INVALID_PARAMETER;
}

static ilaw_result read_argument(ilaw_instance* made, const ilaw_argument* a) {
  const ilaw_parameter* p = parameter_named(a->name);
  quantity count;
  ilaw_result code = ILAW_OK;
  if (!p) return breaks("parameter-unknown") ? ILAW_OK : ILAW_INVALID_PARAMETER;
  if (breaks("parameter-kind") && a->kind == 77) return ILAW_OK;
  if (strcmp(a->name, "damping") == 0) return read_quantity(made, &made->damping, p, a);
  if (strcmp(a->name, "friction") == 0) return read_quantity(made, &made->friction, p, a);
  if (strcmp(a->name, "temperature") == 0) return read_quantity(made, &made->temperature, p, a);
  if (strcmp(a->name, "reach") == 0 && made->setup.delassus_form != ILAW_DELASSUS_TRANSVERSE_SPIN &&
      !breaks("parameter-spins"))
    return ILAW_INVALID_PARAMETER;
  if (strcmp(a->name, "wear") == 0 || strcmp(a->name, "reach") == 0) {
    memset(&count, 0, sizeof count);
    code = read_quantity(made, &count, p, a);
    *(strcmp(a->name, "wear") == 0 ? &made->wear : &made->reach) = count.constant;
    return code;
  }
  if (a->kind != ILAW_KIND_VALUE_TEXT || !a->text) return ILAW_INVALID_PARAMETER;
  made->mode = a->text;
  made->rough = strcmp(a->text, "rough") == 0;
  return made->rough || strcmp(a->text, "smooth") == 0 || breaks("parameter-choice") ? ILAW_OK
                                                                                     : ILAW_INVALID_PARAMETER;
}

static int serves(const ilaw_setup* setup) {
  const uint32_t form = setup->delassus_form;
  if (breaks("setups-served") && setup->dimension == 2) return 0;
  if (breaks("setup-unserved") && setup->dimension == 5) return 1;
  if (setup->dimension < 1 || setup->dimension > 3) return 0;
  if ((setup->frame & (setup->frame - 1) || !(setup->frame & sample_law()->frames)) && !breaks("setup-frame"))
    return 0;
  if (setup->numbers != ILAW_NUMBERS_DOUBLE && setup->numbers != ILAW_NUMBERS_FLOAT &&
      !breaks("setup-numbers"))
    return 0;
  if (form != ILAW_DELASSUS_SCALAR && form != ILAW_DELASSUS_DIAGONAL && form != ILAW_DELASSUS_FULL &&
      form != ILAW_DELASSUS_TRANSVERSE_SPIN)
    return 0;
  if (form == ILAW_DELASSUS_TRANSVERSE_SPIN && setup->dimension != 3 && !breaks("setup-unserved: spins"))
    return 0;
  return setup->flags == 0 || breaks("setup-flags");
}

static void describe_state(ilaw_instance* made) {
  ilaw_state_variable* v = &made->variable;
  v->struct_size = sizeof *v;
  v->kind = ILAW_KIND_SCALAR;
  v->name = breaks("state-described") ? "openings" : "closures";
  v->unit = "1";
  v->doc = "";
  v->count = 1;
  made->variables[0] = v;
}

/* A table over the temperature needs one. */
static int lacks_field(const ilaw_instance* made, int has_temperature) {
  uint32_t n;
  for (n = 0; n < made->friction.axis_count && !breaks("table-field"); ++n)
    if (!made->friction.is_time[n] && !has_temperature) return 1;
  return 0;
}

ilaw_result ILAW_CALL sample_create(const char* id, const ilaw_setup* setup, ilaw_instance** result,
                                    char* message, size_t size) {
  ilaw_instance* made;
  int has_damping = breaks("parameter-missing") || breaks("a default of .1"), has_temperature = 0;
  uint32_t k;
  disturb("calls-process");
  if (!result) return ILAW_INVALID_ARGUMENT;
  if (!breaks("refusal-message: instance")) *result = NULL;
  if (message && size > 0) message[0] = '\0';
  if ((!id || strcmp(id, "sample") != 0) && !breaks("create-id") &&
      !(breaks("description-constant: law") && id && strcmp(id, "example") == 0))
    return refuse(message, size, ILAW_INVALID_ARGUMENT, "id", "is none of this library's");
  if (!setup || setup->struct_size < ILAW_SETUP_SIZE_1_0) return ILAW_INVALID_ARGUMENT;
  if (breaks("sizes-long") && setup->struct_size > sizeof *setup) return ILAW_INVALID_ARGUMENT;
  if (!serves(setup))
    return refuse(message, size, breaks("setup-unserved: code") ? ILAW_INVALID_ARGUMENT : ILAW_UNSUPPORTED,
                  "setup", "is not served");
  made = calloc(1, sizeof *made);
  if (!made) return ILAW_OUT_OF_MEMORY;
  made->own = calloc(1, sizeof *made->own);
  memcpy(&made->setup, setup, sizeof made->setup);
  made->damping.constant = breaks("a default of .1") ? 0.1 : 1.0;
  made->friction.constant = 0.3;
  made->temperature.constant = 293.15;
  made->rough = breaks("parameter-default");
  made->wear = 1.0;
  made->reach = 0.5;
  describe_state(made);
  for (k = 0; k < setup->argument_count; ++k) {
    const ilaw_argument* a = setup->arguments[k];
    const ilaw_result code = a && a->struct_size >= ILAW_ARGUMENT_SIZE_1_0 && a->name ? read_argument(made, a)
                                                                                      : ILAW_INVALID_ARGUMENT;
    if (code != ILAW_OK) {
      sample_destroy(made);
      return refuse(message, size, code, a && a->name ? a->name : "argument", "is not allowed");
    }
    has_damping = has_damping || strcmp(a->name, "damping") == 0;
    has_temperature = has_temperature || strcmp(a->name, "temperature") == 0;
  }
  if (lacks_field(made, has_temperature)) {
    sample_destroy(made);
    return refuse(message, size, ILAW_INVALID_PARAMETER, "friction",
                  "is a table over a field that is not given");
  }
  if (!has_damping) {
    sample_destroy(made);
    return refuse(message, size, ILAW_INVALID_PARAMETER, "damping", "is missing");
  }
  if (!breaks("setups-served: nothing")) *result = made;
  return ILAW_OK;
}

static void end_table(quantity* given) {
  free(given->points[0]);
  free(given->points[1]);
  free(given->values);
}

void ILAW_CALL sample_destroy(ilaw_instance* made) {
  if (!made || breaks("instances-end")) return;
  disturb("calls-process: destroy");
  end_table(&made->damping);
  end_table(&made->friction);
  free(made->own);
  free(made);
}

static const ilaw_amount warmth = {sizeof warmth, 0, "warmth", "J", ""};
static const ilaw_amount* const other_amounts[] = {&warmth, &warmth};

ilaw_result ILAW_CALL sample_info(const ilaw_instance* made, ilaw_instance_info* info) {
  ilaw_instance_info full;
  const uint32_t size = info ? info->struct_size : 0;
  disturb("calls-process: info");
  if (!made || size < ILAW_INSTANCE_INFO_SIZE_1_0 || breaks("functions-return: info"))
    return ILAW_INVALID_ARGUMENT;
  memset(&full, 0, sizeof full);
  full.struct_size = size;
  full.inputs = ILAW_INPUT_GAP | ILAW_INPUT_AREA;
  if (made->setup.frame == ILAW_FRAME_GLOBAL && !breaks("info-frame")) full.inputs |= ILAW_INPUT_NORMAL;
  if (made->setup.has_tangent && made->setup.dimension == 3) full.inputs |= ILAW_INPUT_TANGENT;
  if (made->rough) full.inputs |= ILAW_INPUT_V_SMOOTH;
  if (breaks("info-within: inputs")) full.inputs |= 1U << 6;
  if (breaks("info-within: before")) full.inputs |= ILAW_INPUT_V_PREVIOUS;
  if (breaks("info-frame: local")) full.inputs |= ILAW_INPUT_NORMAL;
  if (breaks("info-frame: tangent")) full.inputs |= ILAW_INPUT_TANGENT;
  full.balance_inputs = ILAW_INPUT_V_PREVIOUS;
  full.state_variable_count = 1;
  full.state_size = 1;
  full.state_variables = made->variables;
  full.per_node_parameters = made->per_node;
  full.per_node_parameter_count = (uint32_t)made->per_node_count;
  full.capabilities = breaks("info-within") ? ILAW_CAN_ADHERE : sample_law()->capabilities;
  full.permissions = breaks("info-within: permissions") ? ILAW_MAY_SKIP_FREE : sample_law()->permissions;
  full.amounts = breaks("amounts-described") ? other_amounts : sample_law()->amounts;
  full.amount_count = AMOUNT_COUNT;
  full.state_version = 1 + (breaks("info-same") ? shared()->infos++ : 0);
  memcpy(info, &full, size < sizeof full ? size : sizeof full);
  if (breaks("sizes-long: info") && size > sizeof full)
    memset((char*)info + sizeof full, 0, size - sizeof full);
  return ILAW_OK;
}
