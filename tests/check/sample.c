/* The description of the law, and what its functions share. */
#include "sample.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define UNBOUNDED 1.7976931348623157e308

static const char* broken = "";
static pthread_t first_thread;
static shared_memory* block;

static const char* const axes[] = {"time", "temperature"};
static ilaw_parameter damping = {.struct_size = sizeof(ilaw_parameter),
                                 .name = "damping",
                                 .symbol = "c",
                                 .unit = "N.s/m^3",
                                 .doc = "Pressure over speed.",
                                 .maximum = UNBOUNDED,
                                 .flags = ILAW_FLAG_REQUIRED | ILAW_FLAG_EXCLUDES_MINIMUM |
                                          ILAW_FLAG_ALLOWS_INFINITY | ILAW_FLAG_ALLOWS_PER_NODE,
                                 .axes = axes,
                                 .axis_count = 1};
static ilaw_parameter friction = {.struct_size = sizeof(ilaw_parameter),
                                  .name = "friction",
                                  .symbol = "mu",
                                  .unit = "1",
                                  .doc = "Coefficient of friction.",
                                  .maximum = 10.0,
                                  .default_value = 0.3,
                                  .axes = axes,
                                  .axis_count = 2};
static ilaw_parameter temperature = {.struct_size = sizeof(ilaw_parameter),
                                     .name = "temperature",
                                     .symbol = "T",
                                     .unit = "K",
                                     .doc = "Of the body; friction may be a table over it.",
                                     .maximum = UNBOUNDED,
                                     .default_value = 293.15,
                                     .flags = ILAW_FLAG_FIELD | ILAW_FLAG_ALLOWS_PER_NODE};
static ilaw_parameter wear = {.struct_size = sizeof(ilaw_parameter),
                              .kind = ILAW_KIND_INTEGER,
                              .name = "wear",
                              .symbol = "w",
                              .unit = "1",
                              .doc = "Thousandths of friction that each closure takes.",
                              .maximum = 0x1p53, /* the next whole number is no double */
                              .default_value = 1.0};
static const char* const modes[] = {"smooth", "rough"};
static ilaw_parameter mode = {.struct_size = sizeof(ilaw_parameter),
                              .kind = ILAW_KIND_CHOICE,
                              .name = "mode",
                              .symbol = "",
                              .unit = "1",
                              .doc = "smooth halves friction.",
                              .maximum = 1.0,
                              .choice_count = 2,
                              .choices = modes};
static ilaw_parameter reach = {.struct_size = sizeof(ilaw_parameter),
                               .name = "reach",
                               .symbol = "b",
                               .unit = "m",
                               .doc = "Largest moment over the normal force.",
                               .maximum = UNBOUNDED,
                               .default_value = 0.5,
                               .flags = ILAW_FLAG_ALLOWS_INFINITY | ILAW_FLAG_NEEDS_SPINS};
static const ilaw_parameter* const parameters[] = {&damping, &friction, &wear, &mode, &temperature, &reach};
static const ilaw_state_variable closures = {
    sizeof(ilaw_state_variable), ILAW_KIND_SCALAR, "closures", "1", "Steps that it was pushed.", 1, 0, 0};
static const ilaw_state_variable* const state_variables[] = {&closures};
static ilaw_amount heat = {sizeof(ilaw_amount), 0, "heat", "J", "Half of what friction dissipates."};
static const ilaw_amount worn = {sizeof(ilaw_amount), 0, "wear", "m", "A millionth of a meter per joule."};
static const ilaw_amount* const amounts[] = {&heat, &worn};

static ilaw_law law = {
    .struct_size = sizeof(ilaw_law),
    .dimensions = ILAW_DIMENSION_1 | ILAW_DIMENSION_2 | ILAW_DIMENSION_3,
    .delassus_forms =
        ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_DIAGONAL | ILAW_DELASSUS_FULL | ILAW_DELASSUS_TRANSVERSE_SPIN,
    .frames = ILAW_FRAME_LOCAL | ILAW_FRAME_GLOBAL,
    .numbers = ILAW_NUMBERS_DOUBLE | ILAW_NUMBERS_FLOAT,
    .inputs = ILAW_INPUT_GAP | ILAW_INPUT_AREA | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_V_SMOOTH,
    .outputs = ILAW_OUTPUT_VELOCITY | ILAW_OUTPUT_STATUS | ILAW_OUTPUT_ENERGY,
    .permissions = ILAW_MAY_SKIP_FRESH | ILAW_MAY_SKIP_FREE,
    .id = "sample",
    .title = "One-sided dashpot with friction",
    .doc = "Keeps every rule, but the one that it is told to break.",
    .parameters = parameters,
    .state_variables = state_variables,
    .parameter_count = sizeof parameters / sizeof *parameters,
    .state_variable_count = 1,
    .amount_count = AMOUNT_COUNT,
    .amounts = amounts,
    .create = sample_create,
    .destroy = sample_destroy,
    .info = sample_info,
    .initialise = sample_initialise,
    .evaluate = sample_evaluate,
    .extension = sample_extension};
static const ilaw_law* const laws[] = {&law};
static ilaw_plugin plugin = {.struct_size = sizeof(ilaw_plugin),
                             .abi_major = ILAW_ABI_MAJOR,
                             .abi_minor = ILAW_ABI_MINOR,
                             .name = "sample",
                             .version = "1.0",
                             .vendor = "tests",
                             .licence = "BSD-3-Clause",
                             .laws = laws,
                             .law_count = 1};
static ilaw_plugin other_plugin; /* the same at another place */

int breaks(const char* rule) { return strcmp(broken, rule) == 0; }
shared_memory* shared(void) { return block; }
int on_first_thread(void) { return pthread_equal(first_thread, pthread_self()); }

const ilaw_law* sample_law(void) { return &law; }

const ilaw_parameter* parameter_named(const char* name) {
  uint32_t k;
  for (k = 0; k < law.parameter_count; ++k)
    if (strcmp(parameters[k]->name, name) == 0) return parameters[k];
  return NULL;
}

static const void* ILAW_CALL library_extension(const char* name) {
  (void)name;
  return &damping;
}

const void* ILAW_CALL sample_extension(const char* name) {
  (void)name;
  return breaks("extension-unknown") ? &damping : NULL;
}

__attribute__((constructor)) static void begin(void) {
  const char* named = getenv("ILAW_CHECK_BREAK");
  if (named) broken = named;
  first_thread = pthread_self();
  block = calloc(1, sizeof *block);
  other_plugin = plugin;
  if (breaks("library-opens")) law.title = NULL;
  if (breaks("description-units")) friction.unit = "furlong";
  if (breaks("description-units: amount")) heat.unit = "calorie";
  if (breaks("a default of .1")) {
    damping.flags &= ~(ilaw_parameter_flags)ILAW_FLAG_REQUIRED;
    damping.default_value = 0.1;
  }
  if (breaks("description-range")) wear.minimum = wear.maximum = 1.0;
  if (breaks("extension-unknown: library")) plugin.extension = library_extension;
  if (breaks("held-bonds")) law.capabilities = ILAW_CAN_HOLD_BONDS;
  if (breaks("info-within: before")) law.inputs &= ~(uint32_t)ILAW_INPUT_V_PREVIOUS;
  if (breaks("frame-turned")) law.frames = ILAW_FRAME_GLOBAL;
  disturb("loading-process");
  if (breaks("energy-made")) law.outputs &= ~(uint32_t)ILAW_OUTPUT_ENERGY;
}
__attribute__((destructor)) static void end(void) { free(block); }

ILAW_EXPORT const ilaw_plugin* ILAW_CALL ILAW_ENTRY(void) {
  static int calls;
  const int again = calls++ % 2;
  disturb("loading-process: entry");
  if (breaks("description-constant: text")) law.doc = again ? "Keeps some rules." : "Keeps every rule.";
  if (breaks("description-constant: law")) law.id = again ? "example" : "sample";
  return breaks("description-constant") && again ? &other_plugin : &plugin;
}
