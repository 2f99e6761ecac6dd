/* A law that gives r = 0, described in plain C99, with one thing wrong in each variant but GOOD, NEWER_MINOR,
 * and NUMBER_1 and NUMBER_2, two builds of one library: as large as each other, and r is their number. */
#define ILAW_BUILDING_PLUGIN
#include <ilaw/ilaw.h>

#include <fenv.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>

struct ilaw_instance {
  int unused;
};

static int instances; /* that live; laws are created by many threads at once */

#ifdef VARIANT_ROUNDS_AT_LOAD
__attribute__((constructor)) static void loaded(void) { fesetround(FE_UPWARD); }
#endif

#ifdef VARIANT_ABORTS
/* Describing a law runs none of its code: this one's ends the process. */
__attribute__((constructor)) static void loaded(void) { abort(); }
#endif

/* in throws.cpp */
void throw_number(void);
void throw_error(void);

static ilaw_result ILAW_CALL create(const char* id, const ilaw_setup* setup, ilaw_instance** instance,
                                    char* message, size_t message_size) {
  (void)setup;
  if (strcmp(id, "zero") != 0) return ILAW_NOT_FOUND;
  if (message_size > 0) message[0] = '\0';
#ifdef VARIANT_ROUNDS_IN_CREATE
  fesetround(FE_UPWARD);
#endif
#ifdef VARIANT_ODD_CODE
  *instance = NULL;
  return 57;
#elif defined(VARIANT_ODD_MESSAGE)
  *instance = NULL;
  strncpy(message, "wrong \033[2J\xff", message_size);
  return ILAW_INVALID_PARAMETER;
#elif defined(VARIANT_THROWS_NUMBER) || defined(VARIANT_THROWS_ERROR)
  *instance = NULL;
#ifdef VARIANT_THROWS_NUMBER
  throw_number();
#else
  throw_error();
#endif
  return ILAW_OK;
#else
  *instance = malloc(sizeof **instance);
  if (!*instance) return ILAW_OUT_OF_MEMORY;
  __atomic_add_fetch(&instances, 1, __ATOMIC_RELAXED);
  return ILAW_OK;
#endif
}

static void ILAW_CALL destroy(ilaw_instance* instance) {
  if (instance) __atomic_sub_fetch(&instances, 1, __ATOMIC_RELAXED);
  free(instance);
}

static const void* ILAW_CALL extension(const char* name) {
  return strcmp(name, "tests.instances/1") == 0 ? &instances : NULL;
}

static const ilaw_amount heat = {sizeof heat, 0, "heat", "J", "Of friction."};
static const ilaw_amount* const amounts[] = {&heat};

static ilaw_result ILAW_CALL info(const ilaw_instance* instance, ilaw_instance_info* out) {
  const uint32_t size = out->struct_size;
  (void)instance;
  memset(out, 0, size < sizeof *out ? size : sizeof *out);
  out->struct_size = size;
#ifdef VARIANT_WRONG_STATE_SIZE
  out->state_size = 3;
#endif
#ifdef VARIANT_UNKNOWN_INPUT
  out->inputs = 1u << 20;
#endif
  out->permissions = ILAW_MAY_SKIP_FRESH;
  out->amounts = amounts;
  out->amount_count = 1;
#ifdef VARIANT_REFUSED_INFO
  return ILAW_INVALID_ARGUMENT;
#else
  return ILAW_OK;
#endif
}

#if defined(VARIANT_ODD_NODE)
#define REASON "a node that is none"
#elif defined(VARIANT_WILD_REASON)
#define REASON ((const char*)16)
#elif defined(VARIANT_CONTROL_REASON)
#define REASON "wrong \033[2J"
#endif

#if defined(VARIANT_NUMBER_1)
#define IMPULSE 1.0
#elif defined(VARIANT_NUMBER_2)
#define IMPULSE 2.0
#else
#define IMPULSE 0.0
#endif

static ilaw_result ILAW_CALL nothing(const ilaw_instance* instance, const ilaw_batch* batch,
                                     ilaw_report* report) {
  int64_t i;
  (void)instance;
  (void)report;
  for (i = 0; batch->impulse.values && i < batch->node_count; ++i)
    batch->impulse.values[i * batch->impulse.node_stride] = IMPULSE;
#ifdef VARIANT_ODD_STATUS
  for (i = 0; batch->status && i < batch->node_count; ++i) batch->status[i * batch->status_stride] = 42;
#endif
#ifdef REASON
  if (report) {
    report->bad_count = 1;
    report->first_bad_node = INT64_C(1) << 40;
    report->reason = REASON;
  }
  return ILAW_BAD_NODES;
#endif
  return ILAW_OK;
}

static const char* const axes[] = {"time", "slip_speed"};
static const ilaw_parameter parameter = {.struct_size = sizeof(ilaw_parameter),
                                         .kind = ILAW_KIND_NUMBER,
                                         .name = "strength",
                                         .symbol = "s",
                                         .unit = "1",
                                         .doc = "Nothing.",
                                         .minimum = 0.0,
                                         .maximum = DBL_MAX,
                                         .default_value = 0.5,
                                         .flags = ILAW_FLAG_ALLOWS_PER_NODE | ILAW_FLAG_ALLOWS_INFINITY,
                                         .axes = axes,
                                         .axis_count = 2};
static const ilaw_parameter* const parameters[] = {&parameter};

/* The law as a newer minor version would extend it. */
typedef struct newer_law {
  ilaw_law law;
  double appended;
} newer_law;

#ifdef VARIANT_NEWER_MINOR
#define LAW_SIZE sizeof(newer_law)
#define MINOR 5
#define DIMENSIONS (ILAW_DIMENSION_1 | 1u << 20)
#else
#define LAW_SIZE sizeof(ilaw_law)
#define MINOR 0
#define DIMENSIONS ILAW_DIMENSION_1
#endif
#ifdef VARIANT_NULL_TITLE
#define TITLE NULL
#elif defined(VARIANT_NUMBER_1)
#define TITLE "Number 1"
#elif defined(VARIANT_NUMBER_2)
#define TITLE "Number 2"
#else
#define TITLE "Nothing"
#endif
#ifdef VARIANT_ODD_STATUS
#define OUTPUTS ILAW_OUTPUT_STATUS
#else
#define OUTPUTS 0
#endif

#define LAW(name)                            \
  {                                          \
    {.struct_size = LAW_SIZE,                \
     .dimensions = DIMENSIONS,               \
     .delassus_forms = ILAW_DELASSUS_SCALAR, \
     .frames = ILAW_FRAME_LOCAL,             \
     .numbers = ILAW_NUMBERS_DOUBLE,         \
     .inputs = ILAW_INPUT_GAP,               \
     .outputs = OUTPUTS,                     \
     .permissions = ILAW_MAY_SKIP_FRESH,     \
     .id = name,                             \
     .title = TITLE,                         \
     .doc = "Gives no impulse.",             \
     .parameters = parameters,               \
     .parameter_count = 1,                   \
     .amounts = amounts,                     \
     .amount_count = 1,                      \
     .create = create,                       \
     .destroy = destroy,                     \
     .info = info,                           \
     .initialise = nothing,                  \
     .evaluate = nothing,                    \
     .extension = extension},                \
        1.0                                  \
  }
static const newer_law zero = LAW("zero");
#ifdef VARIANT_TWO_LAWS
static const newer_law one = LAW("one");
static const ilaw_law* const laws[] = {&zero.law, &one.law};
#else
static const ilaw_law* const laws[] = {&zero.law};
#endif

static const ilaw_plugin plugin = {sizeof(ilaw_plugin),
                                   ILAW_ABI_MAJOR,
                                   MINOR,
                                   "variant",
                                   "0.1",
                                   "tests",
                                   "BSD-3-Clause",
                                   laws,
                                   sizeof laws / sizeof *laws,
                                   0,
                                   NULL};

#ifdef VARIANT_OTHER_MAJOR_SYMBOL
ILAW_EXPORT const ilaw_plugin* ILAW_CALL ilaw_plugin_v2(void);
ILAW_EXPORT const ilaw_plugin* ILAW_CALL ilaw_plugin_v2(void) { return &plugin; }
#elif defined(VARIANT_NO_ENTRY)
ILAW_EXPORT const ilaw_plugin* ILAW_CALL some_other_function(void);
ILAW_EXPORT const ilaw_plugin* ILAW_CALL some_other_function(void) { return &plugin; }
#else
ILAW_EXPORT const ilaw_plugin* ILAW_CALL ILAW_ENTRY(void) { return &plugin; }
#endif
