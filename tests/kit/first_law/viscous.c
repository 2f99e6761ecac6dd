/* viscous.c - the viscous layer of docs/first_law.md without the kit, in plain C99: everything that the
 * header asks of a law, by hand.
 * SPDX-License-Identifier: BSD-3-Clause */
#define ILAW_BUILDING_PLUGIN
#include <fenv.h>
#include <ilaw/ilaw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct ilaw_instance {
  double viscosity;
  uint32_t dimension, inputs;
};

static const ilaw_parameter viscosity = {.struct_size = sizeof viscosity,
                                         .name = "viscosity",
                                         .symbol = "c",
                                         .unit = "N.s/m^3",
                                         .doc = "Force per area and speed.",
                                         .maximum = 1e300,
                                         .required = 1};
static const ilaw_parameter* const parameters[] = {&viscosity};
static const char* const references[] = {"docs/first_law.md"};
/* It holds back a node that leaves, and leaves alone what is out of reach. */
enum { capabilities = ILAW_CAN_ADHERE | ILAW_CAN_REST };

static int32_t refuse(int32_t code, char* message, size_t size, const char* why) {
  if (size > 0) snprintf(message, size, "viscous: %s", why);
  return code;
}

static int32_t create(const ilaw_setup* setup, ilaw_instance** instance, char* message, size_t size) {
  if (!instance) return refuse(ILAW_INVALID_ARGUMENT, message, size, "instance is null");
  *instance = NULL;
  if (!setup || setup->struct_size < ILAW_SETUP_SIZE_1_0 || (setup->argument_count && !setup->arguments))
    return refuse(ILAW_INVALID_ARGUMENT, message, size, "the setup is null or too small");
  if (setup->flags || setup->dimension < 1 || setup->dimension > 3 || setup->frame > ILAW_FRAME_GLOBAL ||
      setup->delassus_form != ILAW_DELASSUS_SCALAR)
    return refuse(ILAW_UNSUPPORTED, message, size, "dimensions 1 to 3, scalar H and no flags are served");
  if (setup->argument_count != 1 || !setup->arguments[0] ||
      setup->arguments[0]->struct_size < ILAW_ARGUMENT_SIZE_1_0 || !setup->arguments[0]->name ||
      strcmp(setup->arguments[0]->name, "viscosity") != 0)
    return refuse(ILAW_INVALID_PARAMETER, message, size, "viscosity must be given, and nothing else");
  const double value = setup->arguments[0]->number;
  if (setup->arguments[0]->kind != ILAW_VALUE_NUMBER || !(value >= 0.0 && value <= viscosity.maximum))
    return refuse(ILAW_INVALID_PARAMETER, message, size, "viscosity must be a number in [0, 1e300]");
  if (!(*instance = malloc(sizeof **instance))) return ILAW_OUT_OF_MEMORY;
  (*instance)->viscosity = value;
  (*instance)->dimension = setup->dimension;
  (*instance)->inputs =
      ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_AREA | (setup->frame ? ILAW_INPUT_NORMAL : 0);
  return ILAW_OK;
}

static void destroy(ilaw_instance* instance) { free(instance); }

static int32_t info(const ilaw_instance* instance, ilaw_instance_info* out) {
  if (!instance || !out || out->struct_size < ILAW_INSTANCE_INFO_SIZE_1_0) return ILAW_INVALID_ARGUMENT;
  const ilaw_instance_info known = {
      .struct_size = out->struct_size, .inputs = instance->inputs, .capabilities = capabilities};
  /* What a later version appended stays as the host zeroed it. */
  memcpy(out, &known, known.struct_size < sizeof known ? known.struct_size : sizeof known);
  return ILAW_OK;
}

static const double* of(const ilaw_input* a, int64_t i) { return a->values + i * a->node_stride; }
static int64_t node_of(const ilaw_batch* b, int64_t k) {
  return b->index ? (int64_t)b->index[k] - b->index_base : b->index64 ? b->index64[k] - b->index_base : k;
}

static const char* wrong_call(const ilaw_instance* law, const ilaw_batch* b) {
  if (!law || !b || b->struct_size < ILAW_BATCH_SIZE_1_0) return "the batch is null or too small";
  if (b->node_count < 0 || (b->index && b->index64)) return "node_count is negative, or two lists are given";
  if (b->index_base != 0 && b->index_base != 1) return "index_base is neither 0 nor 1";
  if (!isfinite(b->time)) return "time is not finite";
  for (int64_t k = 0; k < b->node_count; ++k)
    if (node_of(b, k) < 0) return "an index is below index_base";
  return NULL;
}

static const char* wrong_arrays(const ilaw_instance* law, const ilaw_batch* b) {
  if (!(b->velocity_step > 0.0 && isfinite(b->velocity_step)) ||
      !(b->position_step > 0.0 && isfinite(b->position_step)))
    return "a step is not finite and > 0";
  if (b->node_count == 0) return NULL;
  if (!b->v_free.values || !b->delassus.values || !b->gap.values || !b->area.values ||
      !b->v_previous.values || !b->impulse.values || (law->inputs & ILAW_INPUT_NORMAL && !b->normal.values))
    return "an array is missing";
  if (b->node_count > 1 &&
      (b->impulse.node_stride == 0 || (b->velocity.values && b->velocity.node_stride == 0) ||
       (b->status && b->status_stride == 0)))
    return "an output has a node stride of 0";
  return NULL;
}

/* The largest part s <= 1 of r = factor v_free that adds no energy: s r.(v^- + v_free + s H r) <= 0. */
static double dissipative_part(const ilaw_batch* b, int64_t i, uint32_t dimension, double h, double factor) {
  const double *v = of(&b->v_free, i), *before = of(&b->v_previous, i);
  double work = 0.0, own = 0.0;
  for (uint32_t c = 0; c < dimension; ++c) {
    const double free = v[c * b->v_free.component_stride], r = factor * free;
    work += r * (before[c * b->v_previous.component_stride] + free);
    own += r * (h * r);
  }
  if (!(work + own > 0.0)) return 1.0;
  const double part = -work / own;
  return part > 0.0 ? part : 0.0;
}

/* r = -h c A/(1 + h c A H) v_free where the gap is closed, or that part; why not, where the input is bad. */
static const char* step(const ilaw_instance* law, const ilaw_batch* b, int64_t i, uint8_t* status) {
  const double *v = of(&b->v_free, i), *before = of(&b->v_previous, i);
  const double h = *of(&b->delassus, i), area = *of(&b->area, i);
  const double gap = *of(&b->gap, i) - (b->gap_offset.values ? *of(&b->gap_offset, i) : 0.0);
  const char* bad = !(h > 0.0 && isfinite(h))          ? "H is not positive"
                    : !(area >= 0.0 && isfinite(area)) ? "area is not >= 0"
                    : !isfinite(gap)                   ? "gap is not finite"
                                                       : NULL;
  double length = 0.0;
  for (uint32_t c = 0; c < law->dimension; ++c) {
    if (!isfinite(v[c * b->v_free.component_stride])) bad = "v_free is not finite";
    if (!isfinite(before[c * b->v_previous.component_stride])) bad = "v_previous is not finite";
    if (b->normal.values && law->inputs & ILAW_INPUT_NORMAL)
      length += of(&b->normal, i)[c * b->normal.component_stride] *
                of(&b->normal, i)[c * b->normal.component_stride];
  }
  if (law->inputs & ILAW_INPUT_NORMAL && !(fabs(length - 1.0) <= 1e-6)) bad = "normal is not a unit vector";
  const double damping = gap <= 0.0 ? b->velocity_step * law->viscosity * area : 0.0;
  const double whole = -damping / (1.0 + damping * h);
  const double factor = bad ? 0.0 : whole * dissipative_part(b, i, law->dimension, h, whole);
  for (uint32_t c = 0; c < law->dimension && !bad; ++c)
    if (!isfinite(factor * v[c * b->v_free.component_stride])) bad = "the impulse overflows";
  for (uint32_t c = 0; c < law->dimension; ++c) {
    const double free = v[c * b->v_free.component_stride], r = bad ? 0.0 : factor * free + 0.0;
    b->impulse.values[i * b->impulse.node_stride + c * b->impulse.component_stride] = r;
    if (b->velocity.values)
      b->velocity.values[i * b->velocity.node_stride + c * b->velocity.component_stride] =
          bad ? free : free + h * r;
  }
  *status = bad ? ILAW_BAD_INPUT : damping > 0.0 ? ILAW_STICK : ILAW_FREE;
  return bad;
}

static int32_t done(ilaw_report* report, int32_t code, int64_t count, int64_t first, const char* reason) {
  if (report && report->struct_size >= ILAW_REPORT_SIZE_1_0) {
    report->bad_count = count;
    report->first_bad_node = first;
    report->reason = reason;
    report->stable_velocity_step = INFINITY; /* solved implicitly: needs no limit */
  }
  return code;
}

/* No state: there is nothing to write. */
static int32_t initialise(const ilaw_instance* law, const ilaw_batch* b, ilaw_report* report) {
  const char* refused = wrong_call(law, b);
  if (refused) return done(report, ILAW_INVALID_ARGUMENT, 0, -1, refused);
  return done(report, b->flags ? ILAW_UNSUPPORTED : ILAW_OK, 0, -1, b->flags ? "flags are not known" : NULL);
}

static int32_t evaluate(const ilaw_instance* law, const ilaw_batch* b, ilaw_report* report) {
  fenv_t host;
  fegetenv(&host); /* whatever rounding, traps and flush-to-zero the host has */
  fesetenv(FE_DFL_ENV);
  int64_t count = 0, first = -1;
  const char *refused = wrong_call(law, b), *reason = NULL;
  if (!refused) refused = wrong_arrays(law, b);
  const int unsupported = !refused && (b->flags || b->energy.values);
  for (int64_t k = 0; !refused && !unsupported && k < b->node_count; ++k) {
    const int64_t i = node_of(b, k);
    uint8_t status;
    const char* bad = step(law, b, i, &status);
    if (b->status) b->status[i * b->status_stride] = status;
    if (bad && count++ == 0) first = i, reason = bad;
  }
  fesetenv(&host);
  if (refused) return done(report, ILAW_INVALID_ARGUMENT, 0, -1, refused);
  if (unsupported) return done(report, ILAW_UNSUPPORTED, 0, -1, "flags or energies are not served");
  return done(report, count ? ILAW_BAD_NODES : ILAW_OK, count, first, reason);
}

static const ilaw_law law = {
    .struct_size = sizeof law,
    .dimensions = ILAW_DIMENSION_1 | ILAW_DIMENSION_2 | ILAW_DIMENSION_3,
    .delassus_forms = ILAW_DELASSUS_SCALAR,
    .inputs = ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_AREA | ILAW_INPUT_NORMAL,
    .outputs = ILAW_OUTPUT_VELOCITY | ILAW_OUTPUT_STATUS,
    .capabilities = capabilities,
    .id = "viscous",
    .title = "Viscous layer",
    .doc = "A force -c A v where the gap is closed, solved implicitly.",
    .references = references,
    .reference_count = 1,
    .parameters = parameters,
    .parameter_count = 1,
    .create = create,
    .destroy = destroy,
    .info = info,
    .initialise = initialise,
    .evaluate = evaluate};
static const ilaw_law* const laws[] = {&law};
static const ilaw_plugin plugin = {.struct_size = sizeof plugin,
                                   .abi_major = ILAW_ABI_MAJOR,
                                   .abi_minor = ILAW_ABI_MINOR,
                                   .name = "viscous",
                                   .version = "1.0.0",
                                   .vendor = "me",
                                   .licence = "BSD-3-Clause",
                                   .laws = laws,
                                   .law_count = 1};

const ilaw_plugin* ilaw_plugin_v1(void) { return &plugin; }
