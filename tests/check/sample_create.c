/* Instances of the law. */
#include "sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A refusal: one line, which rules may break. */
static int32_t refuse(char* message, size_t size, int32_t code, const char* name, const char* what) {
  if (breaks("prints-nothing")) fprintf(stderr, "sample: %s\n", what);
  if (message && size > 0)
    snprintf(message, size, "law 'sample': %s: %s", breaks("refusal-message") ? "\n" : name, what);
  if (message && breaks("refusal-message: beyond")) message[size] = '\0';
  if (message && breaks("refusal-message: endless")) memset(message, 'x', size);
  return code;
}

/* As described. */
static int is_allowed(const ilaw_parameter* p, double value) {
  if (value == INFINITY) return p->infinity_allowed != 0;
  return value <= p->maximum && (p->minimum_excluded ? value > p->minimum : value >= p->minimum);
}

static int in_range(const ilaw_parameter* p, double value) {
  if (isnan(value)) return breaks("parameter-nan");
  if (value == INFINITY && breaks("parameter-infinity")) return 1;
  if (p->kind == ILAW_PARAMETER_COUNT && value != floor(value) && !breaks("parameter-whole")) return 0;
  if (breaks("parameter-accepted") && strcmp(p->name, "friction") == 0 && value == 0.0) return 0;
  if (breaks("parameter-range") && isfinite(value)) return 1;
  return is_allowed(p, value);
}

static int is_table(const ilaw_parameter* p, const ilaw_argument* a) {
  uint64_t k;
  if (a->count < 1 || !a->values) return 0;
  for (k = 0; k < a->count; ++k) {
    if (breaks("table-shape")) continue;
    if (!isfinite(a->values[2 * k]) || (k > 0 && !(a->values[2 * k] > a->values[2 * k - 2]))) return 0;
    if (!is_allowed(p, a->values[2 * k + 1])) return 0;
  }
  return 1;
}

static int32_t read_quantity(quantity* to, const ilaw_parameter* p, const ilaw_argument* a) {
  if (a->kind == ILAW_VALUE_NUMBER && in_range(p, a->number)) {
    to->constant = a->number;
    return ILAW_OK;
  }
  if (a->kind == ILAW_VALUE_PER_NODE && (p->may_be & ILAW_MAY_BE_PER_NODE)) {
    to->per_node = 1;
    return ILAW_OK;
  }
  if (a->kind == ILAW_VALUE_TABLE && (p->may_be & ILAW_MAY_BE_TABLE) && is_table(p, a)) {
    free(to->table);
    to->table = malloc(2 * a->count * sizeof(double));
    if (!to->table) return ILAW_OUT_OF_MEMORY;
    memcpy(to->table, a->values, 2 * a->count * sizeof(double));
    to->count = a->count;
    return ILAW_OK;
  }
  return breaks("parameter-varying") && a->kind == ILAW_VALUE_PER_NODE ? ILAW_OK : ILAW_INVALID_PARAMETER;
}

static int32_t read_argument(ilaw_instance* made, const ilaw_argument* a) {
  const ilaw_parameter* p = parameter_named(a->name);
  quantity count = {0.0, NULL, 0, 0};
  int32_t code = ILAW_OK;
  if (!p) return breaks("parameter-unknown") ? ILAW_OK : ILAW_INVALID_PARAMETER;
  if (breaks("parameter-kind") && a->kind == 77) return ILAW_OK;
  if (strcmp(a->name, "damping") == 0) return read_quantity(&made->damping, p, a);
  if (strcmp(a->name, "friction") == 0) return read_quantity(&made->friction, p, a);
  if (strcmp(a->name, "wear") == 0) {
    code = read_quantity(&count, p, a);
    made->wear = count.constant;
    return code;
  }
  if (a->kind != ILAW_VALUE_TEXT || !a->text) return ILAW_INVALID_PARAMETER;
  made->mode = a->text;
  made->rough = strcmp(a->text, "rough") == 0;
  return made->rough || strcmp(a->text, "smooth") == 0 || breaks("parameter-choice") ? ILAW_OK
                                                                                     : ILAW_INVALID_PARAMETER;
}

static int serves(const ilaw_setup* setup) {
  const uint32_t form = setup->delassus_form;
  if (breaks("setups-served") && setup->dimension == 2) return 0;
  if (breaks("setup-unserved") && setup->dimension == 5) return 1;
  if (setup->dimension < 1 || setup->dimension > 3 || setup->frame > 1) return 0;
  if (form != ILAW_DELASSUS_SCALAR && form != ILAW_DELASSUS_DIAGONAL && form != ILAW_DELASSUS_FULL) return 0;
  return setup->flags == 0 || breaks("setup-flags");
}

static void describe_state(ilaw_instance* made) {
  ilaw_state_variable* v = &made->variable;
  v->struct_size = sizeof *v;
  v->kind = ILAW_STATE_SCALAR;
  v->name = breaks("state-described") ? "openings" : "closures";
  v->unit = "1";
  v->doc = "";
  v->count = 1;
  made->variables[0] = v;
  made->per_node[0] = "damping";
}

int32_t sample_create(const ilaw_setup* setup, ilaw_instance** result, char* message, size_t size) {
  ilaw_instance* made;
  int has_damping = breaks("parameter-missing");
  uint32_t k;
  if (!result) return ILAW_INVALID_ARGUMENT;
  if (!breaks("refusal-message: instance")) *result = NULL;
  if (message && size > 0) message[0] = '\0';
  if (!setup || setup->struct_size < ILAW_SETUP_SIZE_1_0) return ILAW_INVALID_ARGUMENT;
  if (breaks("sizes-long") && setup->struct_size > sizeof *setup) return ILAW_INVALID_ARGUMENT;
  if (!serves(setup))
    return refuse(message, size, breaks("setup-unserved: code") ? ILAW_INVALID_ARGUMENT : ILAW_UNSUPPORTED,
                  "setup", "is not served");
  made = calloc(1, sizeof *made);
  if (!made) return ILAW_OUT_OF_MEMORY;
  made->own = calloc(1, sizeof *made->own);
  memcpy(&made->setup, setup, sizeof made->setup);
  made->damping.constant = 1.0;
  made->friction.constant = 0.3;
  made->rough = breaks("parameter-default");
  made->wear = 1.0;
  describe_state(made);
  for (k = 0; k < setup->argument_count; ++k) {
    const ilaw_argument* a = setup->arguments[k];
    const int32_t code = a && a->name ? read_argument(made, a) : ILAW_INVALID_ARGUMENT;
    if (code != ILAW_OK) {
      sample_destroy(made);
      return refuse(message, size, code, a && a->name ? a->name : "argument", "is not allowed");
    }
    has_damping = has_damping || strcmp(a->name, "damping") == 0;
  }
  if (!has_damping) {
    sample_destroy(made);
    return refuse(message, size, ILAW_INVALID_PARAMETER, "damping", "is missing");
  }
  if (!breaks("setups-served: nothing")) *result = made;
  return ILAW_OK;
}

void sample_destroy(ilaw_instance* made) {
  if (!made || breaks("instances-end")) return;
  free(made->damping.table);
  free(made->friction.table);
  free(made->own);
  free(made);
}

int32_t sample_info(const ilaw_instance* made, ilaw_instance_info* info) {
  ilaw_instance_info full;
  const uint32_t size = info ? info->struct_size : 0;
  if (!made || size < ILAW_INSTANCE_INFO_SIZE_1_0 || breaks("functions-return: info"))
    return ILAW_INVALID_ARGUMENT;
  memset(&full, 0, sizeof full);
  full.struct_size = size;
  full.inputs = ILAW_INPUT_GAP | ILAW_INPUT_AREA;
  if (made->setup.frame == ILAW_FRAME_GLOBAL && !breaks("info-frame")) full.inputs |= ILAW_INPUT_NORMAL;
  if (made->setup.tangent_given && made->setup.dimension == 3) full.inputs |= ILAW_INPUT_TANGENT;
  if (breaks("info-within: inputs")) full.inputs |= 1U << 5;
  if (breaks("info-within: before")) full.inputs |= ILAW_INPUT_V_PREVIOUS;
  if (breaks("info-frame: local")) full.inputs |= ILAW_INPUT_NORMAL;
  if (breaks("info-frame: tangent")) full.inputs |= ILAW_INPUT_TANGENT;
  full.energy_inputs = ILAW_INPUT_V_PREVIOUS;
  full.state_variable_count = 1;
  full.state_size = 1;
  full.state_variables = made->variables;
  full.per_node_parameters = made->per_node;
  full.per_node_parameter_count = made->damping.per_node ? 1 : 0;
  full.capabilities = ILAW_CAN_REST | (breaks("info-within") ? ILAW_CAN_ADHERE : 0);
  full.state_version = 1 + (breaks("info-same") ? shared()->infos++ : 0);
  memcpy(info, &full, size < sizeof full ? size : sizeof full);
  if (breaks("sizes-long: info") && size > sizeof full)
    memset((char*)info + sizeof full, 0, size - sizeof full);
  return ILAW_OK;
}
