/* The description of the law, and what its functions share. */
#include "sample.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define UNBOUNDED 1.7976931348623157e308

static const char* broken = "";
static pthread_t first_thread;
static shared_memory* block;

static ilaw_parameter damping = {sizeof(ilaw_parameter),
                                 ILAW_PARAMETER_NUMBER,
                                 "damping",
                                 "c",
                                 "N.s/m^3",
                                 "Pressure over speed.",
                                 0.0,
                                 UNBOUNDED,
                                 1.0,
                                 1,
                                 1,
                                 1,
                                 ILAW_MAY_BE_TABLE | ILAW_MAY_BE_PER_NODE,
                                 NULL,
                                 0,
                                 0};
static ilaw_parameter friction = {sizeof(ilaw_parameter),
                                  ILAW_PARAMETER_NUMBER,
                                  "friction",
                                  "mu",
                                  "1",
                                  "Coefficient of friction.",
                                  0.0,
                                  10.0,
                                  0.3,
                                  0,
                                  0,
                                  0,
                                  ILAW_MAY_BE_TABLE,
                                  NULL,
                                  0,
                                  0};
static ilaw_parameter wear = {sizeof(ilaw_parameter),
                              ILAW_PARAMETER_COUNT,
                              "wear",
                              "w",
                              "1",
                              "Thousandths of friction that each closure takes.",
                              0.0,
                              0x1p53, /* the next whole number is no double */
                              1.0,
                              0,
                              0,
                              0,
                              0,
                              NULL,
                              0,
                              0};
static const char* const modes[] = {"smooth", "rough"};
static ilaw_parameter mode = {sizeof(ilaw_parameter),
                              ILAW_PARAMETER_CHOICE,
                              "mode",
                              "",
                              "1",
                              "smooth halves friction.",
                              0.0,
                              1.0,
                              0.0,
                              0,
                              0,
                              0,
                              0,
                              modes,
                              2,
                              0};
static const ilaw_parameter* const parameters[] = {&damping, &friction, &wear, &mode};
static const ilaw_state_variable closures = {
    sizeof(ilaw_state_variable), ILAW_STATE_SCALAR, "closures", "1", "Steps that it was pushed.", 1, 0, 0};
static const ilaw_state_variable* const state_variables[] = {&closures};

static ilaw_law law = {sizeof(ilaw_law),
                       ILAW_DIMENSION_1 | ILAW_DIMENSION_2 | ILAW_DIMENSION_3,
                       ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_DIAGONAL | ILAW_DELASSUS_FULL,
                       ILAW_INPUT_GAP | ILAW_INPUT_AREA | ILAW_INPUT_V_PREVIOUS,
                       ILAW_OUTPUT_VELOCITY | ILAW_OUTPUT_STATUS | ILAW_OUTPUT_ENERGY,
                       ILAW_CAN_REST,
                       "sample",
                       "One-sided dashpot with friction",
                       "Keeps every rule, but the one that it is told to break.",
                       NULL,
                       parameters,
                       state_variables,
                       0,
                       4,
                       1,
                       0,
                       sample_create,
                       sample_destroy,
                       sample_info,
                       sample_initialise,
                       sample_evaluate,
                       sample_extension};
static const ilaw_law* const laws[] = {&law};
static ilaw_plugin plugin = {sizeof(ilaw_plugin),
                             ILAW_ABI_MAJOR,
                             ILAW_ABI_MINOR,
                             "sample",
                             "1.0",
                             "tests",
                             "BSD-3-Clause",
                             laws,
                             1,
                             0,
                             NULL};
static ilaw_plugin other_plugin; /* the same at another place */

int breaks(const char* rule) { return strcmp(broken, rule) == 0; }
shared_memory* shared(void) { return block; }
int on_first_thread(void) { return pthread_equal(first_thread, pthread_self()); }

const ilaw_parameter* parameter_named(const char* name) {
  int k;
  for (k = 0; k < 4; ++k)
    if (strcmp(parameters[k]->name, name) == 0) return parameters[k];
  return NULL;
}

static const void* library_extension(const char* name) {
  (void)name;
  return &damping;
}

const void* sample_extension(const char* name) {
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
  if (breaks("parameter-units")) friction.unit = "furlong";
  if (breaks("extension-unknown: library")) plugin.extension = library_extension;
  if (breaks("info-within: before")) law.inputs &= ~(uint32_t)ILAW_INPUT_V_PREVIOUS;
  if (breaks("energy-made")) law.outputs &= ~(uint32_t)ILAW_OUTPUT_ENERGY;
}
__attribute__((destructor)) static void end(void) { free(block); }

ILAW_EXPORT const ilaw_plugin* ILAW_ENTRY(void) {
  static int calls;
  const int again = calls++ % 2;
  if (breaks("description-constant: text")) law.doc = again ? "Keeps some rules." : "Keeps every rule.";
  if (breaks("description-constant: law")) law.id = again ? "example" : "sample";
  return breaks("description-constant") && again ? &other_plugin : &plugin;
}
