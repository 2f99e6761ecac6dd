/* twin.c - the law of twin.cpp in plain C: r_N = mu where the gap is closed, unless it breaks a promise; the
 * amount is mu, too, at a slip speed of 2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <ilaw/plain_c.h>

enum { PRESSURE, FRICTION, TEMPERATURE, EXPONENT, COUNT, BREAKS };
enum {
  NONE,
  NUMBER,
  STATE,
  LARGE,
  PULL,
  FAR,
  NAN_ENERGY,
  NEGATIVE_ENERGY,
  AMOUNT,
  STATUS,
  BAD_STATUS,
  STABLE
};

static const char* const axes[] = {"temperature", "pressure", "time", "slip_speed"};
static const char* const choices[] = {"none",   "number", "state",      "large",
                                      "pull",   "far",    "nan_energy", "negative_energy",
                                      "amount", "status", "bad_status", "stable"};
/* The one field is listed before the parameter that is a table over it, the other behind. */
static const ilaw_parameter pressure = ILAW_PLAIN_PARAMETER(
    "pressure", "", "Pa", "", .maximum = DBL_MAX, .flags = ILAW_FLAG_FIELD | ILAW_FLAG_ALLOWS_PER_NODE,
    .axes = axes + 2, .axis_count = 1);
static const ilaw_parameter friction =
    ILAW_PLAIN_PARAMETER("friction", "", "1", "", .maximum = DBL_MAX,
                         .flags = ILAW_FLAG_REQUIRED | ILAW_FLAG_ALLOWS_PER_NODE | ILAW_FLAG_ALLOWS_INFINITY,
                         .axes = axes, .axis_count = 4);
static const ilaw_parameter temperature = ILAW_PLAIN_PARAMETER(
    "temperature", "", "K", "", .maximum = DBL_MAX, .default_value = 300.0,
    .flags = ILAW_FLAG_FIELD | ILAW_FLAG_ALLOWS_PER_NODE, .axes = axes + 1, .axis_count = 2);
static const ilaw_parameter exponent =
    ILAW_PLAIN_PARAMETER("exponent", "", "1", "", .minimum = 0.5, .maximum = 2.5, .default_value = 1.0,
                         .flags = ILAW_FLAG_EXCLUDES_MINIMUM);
static const ilaw_parameter count = ILAW_PLAIN_PARAMETER(
    "count", "", "1", "", .kind = ILAW_KIND_INTEGER, .minimum = 1.0, .maximum = 4096.0, .default_value = 1.0);
static const ilaw_parameter breaks =
    ILAW_PLAIN_PARAMETER("breaks", "", "1", "", .kind = ILAW_KIND_CHOICE, .choices = choices,
                         .choice_count = sizeof choices / sizeof *choices);
static const ilaw_parameter* const parameters[] = {&pressure, &friction, &temperature,
                                                   &exponent, &count,    &breaks};
static const ilaw_state_variable steps = {
    .struct_size = sizeof steps, .name = "steps", .unit = "1", .doc = "", .count = 1};
static const ilaw_state_variable* const state_variables[] = {&steps};
static const ilaw_amount wear = {sizeof wear, 0, "wear", "m", ""};
static const ilaw_amount* const amounts[] = {&wear};
static const char* const references[] = {"1",  "2",  "3",  "4",  "5",  "6",  "7",  "8", "9",
                                         "10", "11", "12", "13", "14", "15", "16", "17"};

static const char* step(const ilaw_node* node, ilaw_node_result* result) {
  const double computed[] = {0.0, 0.0, 0.0, 2.0};
  const int mistake = (int)node->value[BREAKS], is_closed = node->gap <= 0.0;
  double r_N = is_closed || mistake == FAR ? node->value[FRICTION] : 0.0;
  result->state[0] += is_closed ? 1.0 : 0.0;
  result->status = is_closed ? ILAW_CLOSED : ILAW_FREE;
  result->amounts[0] = ilaw_value(node, FRICTION, computed);
  if (mistake == NUMBER) r_N = NAN;
  if (mistake == STATE) result->state[0] = NAN;
  if (mistake == LARGE) r_N = 0.5 * DBL_MAX;
  if (mistake == PULL) r_N = -1.0;
  if (mistake == NAN_ENERGY) result->energy[ILAW_ENERGY_STORED] = NAN;
  if (mistake == NEGATIVE_ENERGY) result->energy[ILAW_ENERGY_RUPTURE] = -1.0;
  if (mistake == AMOUNT) result->amounts[0] = NAN;
  if (mistake == STATUS) result->status = 200;
  if (mistake == BAD_STATUS) result->status = ILAW_BAD_INPUT;
  if (mistake == STABLE) result->stable_velocity_step = NAN;
  for (int c = 0; c < 3; ++c) result->r[c] = r_N * node->n[c];
  return NULL;
}

/* Gives its v_smooth back as the impulse. */
static const char* echo(const ilaw_node* node, ilaw_node_result* result) {
  for (int c = 0; c < 3; ++c) result->r[c] = node->v_smooth[c];
  result->status = ILAW_BONDED;
  return NULL;
}

static const ilaw_plain_law twin = {
    .law = {ILAW_PLAIN_LAW, .id = "twin", .title = "Push", .doc = "", .dimensions = ILAW_DIMENSION_3,
            .inputs = ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_AREA,
            .permissions = ILAW_MAY_SKIP_FRESH, ILAW_PLAIN_LIST(parameters), ILAW_PLAIN_LIST(state_variables),
            ILAW_PLAIN_LIST(amounts), ILAW_PLAIN_LIST(references)},
    .step = step,
    .state_version = 3};
static const ilaw_plain_law smooth = {
    .law = {ILAW_PLAIN_LAW, .id = "smooth", .title = "Echo of v_smooth", .doc = "",
            .dimensions = ILAW_DIMENSION_3, .inputs = ILAW_INPUT_V_SMOOTH, .capabilities = ILAW_CAN_ADHERE},
    .step = echo};
static const ilaw_plain_law free_velocity = {
    .law = {ILAW_PLAIN_LAW, .id = "free_velocity", .title = "The same, without the input", .doc = "",
            .dimensions = ILAW_DIMENSION_3, .capabilities = ILAW_CAN_ADHERE},
    .step = echo};
ILAW_PLAIN_LIBRARY("twins", "1.0.0", "tests", "BSD-3-Clause", &twin.law, &smooth.law, &free_velocity.law)
