// A law that gives no impulse, and breaks one promise: the one that ILAW_BROKEN names. With `bare` it breaks
// none: it stops what comes, and gives wear, but neither status nor energy.
#define ILAW_BUILDING_PLUGIN
#include <ilaw/ilaw.h>

#include <unistd.h>

#include <cfenv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

struct ilaw_instance {};

namespace {

bool breaks(const char* promise) {
  const char* named = std::getenv("ILAW_BROKEN");
  return named && std::strcmp(named, promise) == 0;
}

[[noreturn]] void hang() {
  for (;;) pause();
}

struct AtLoad {
  AtLoad() {
    if (breaks("abort_at_load")) std::abort();
    if (breaks("exit_at_load")) std::exit(0);
  }
} at_load;

int deeper(volatile char* before) {
  volatile char here[4096];
  here[0] = before ? before[0] : '\1';
  return here[0] ? deeper(here) + here[0] : 0;
}

std::int32_t create(const char*, const ilaw_setup*, ilaw_instance** instance, char*, std::size_t) {
  static ilaw_instance only;
  *instance = &only;
  return ILAW_OK;
}

void destroy(ilaw_instance*) {}

constexpr ilaw_amount wear{sizeof wear, 0, "wear", "m", ""};
constexpr const ilaw_amount* amounts[] = {&wear};

std::int32_t info(const ilaw_instance*, ilaw_instance_info* out) {
  const std::uint32_t size = out->struct_size;
  std::memset(out, 0, size);
  out->struct_size = size;
  out->inputs = ILAW_INPUT_GAP;
  out->amounts = amounts;
  out->amount_count = breaks("bare") ? 1 : 0;
  return ILAW_OK;
}

std::int32_t initialise(const ilaw_instance*, const ilaw_batch*, ilaw_report*) { return ILAW_OK; }

// Breaks the answer of the last node.
std::int32_t answer(const ilaw_batch& batch, ilaw_report& report) {
  const std::int64_t last = batch.node_count - 1;
  double* const energy = batch.energy.values + last * batch.energy.node_stride;
  if (breaks("status")) batch.status[last * batch.status_stride] = 200;
  if (breaks("bad_input")) batch.status[last * batch.status_stride] = ILAW_BAD_INPUT;
  if (batch.energy.values && breaks("negative_energy"))
    energy[ILAW_ENERGY_IMPACT * batch.energy.component_stride] = -0.5;
  if (batch.energy.values && breaks("nan_energy"))
    energy[ILAW_ENERGY_STORED * batch.energy.component_stride] = std::nan("");
  if (breaks("nan_impulse")) batch.impulse.values[last * batch.impulse.node_stride] = std::nan("");
  if (breaks("rounding")) std::fesetround(FE_UPWARD);
  if (breaks("traps")) feenableexcept(FE_DIVBYZERO);
  if (breaks("nan_step")) report.stable_velocity_step = std::nan("");
  if (breaks("negative_step")) report.stable_velocity_step = -0.5;
  if (breaks("code")) return 57;
  if (breaks("negative_code")) return ILAW_UNSUPPORTED;
  report.bad_count = 1;
  report.first_bad_node = breaks("bad_node") ? std::int64_t{1} << 40 : last;
  report.reason = breaks("wild_reason")     ? reinterpret_cast<const char*>(16)
                  : breaks("steering_text") ? "a \033[2J title"
                                            : "a reason";
  return breaks("bad_node") || breaks("wild_reason") || breaks("steering_text") ? ILAW_BAD_NODES : ILAW_OK;
}

std::int64_t node_of(const ilaw_batch& batch, std::int64_t i) {
  return batch.index ? batch.index[i] - batch.index_base : i;
}

// A node that comes is stopped, until the third step lets a part of its velocity in.
double stop(const ilaw_batch& batch, std::int64_t node) {
  const double v = batch.v_free.values[node * batch.v_free.node_stride],
               gap = batch.gap.values[node * batch.gap.node_stride],
               inverse_mass = batch.delassus.values[node * batch.delassus.node_stride];
  const double late = breaks("creeps_in") ? 1.0 - 1e-8 : 0.5, part = batch.time < 2.9 ? 1.0 : late;
  return gap <= 0.0 && v < 0.0 ? -part * v / inverse_mass : 0.0;
}

// What an audit must find: another answer when it is asked again, and one that no such law may give.
double false_impulse(const ilaw_batch& batch, std::int64_t node) {
  static double asked_at = 0.0, asked_gap = 0.0;
  if (breaks("push")) return 1.0;  // whatever the motion
  if (breaks("lets_in") || breaks("creeps_in")) return stop(batch, node);
  if (breaks("other_start"))
    return batch.time == 0.0 && !batch.v_smooth.values ? 1.0 : 0.0;  // not to an audit
  if (batch.time < 2.9) return 0.0;
  if (breaks("other_answer")) return std::exchange(asked_at, batch.time) < batch.time ? 1.0 : 0.0;
  if (breaks("other_digits")) return std::exchange(asked_at, batch.time) < batch.time ? 1.0 : 1.0 + 1e-11;
  if (breaks("other_gap")) {  // the same answer to an audit at a gap that is smaller by 2e-12
    const double gap = batch.gap.values[node * batch.gap.node_stride];
    if (std::exchange(asked_at, batch.time) >= batch.time) return gap < asked_gap - 2e-12 ? 1.0 : 0.0;
    asked_gap = gap;
    return 1.0;
  }
  return breaks("pull") ? -1.0 : 0.0;
}

double false_energy(const ilaw_batch& batch) {
  static int calls = 0;
  return breaks("other_energy") && batch.time >= 2.9 && ++calls % 2 == 0 ? 1.0 : 0.0;
}

std::int32_t evaluate_bare(const ilaw_batch& batch) {
  for (std::int64_t i = 0; i < batch.node_count; ++i) {
    const std::int64_t node = node_of(batch, i);
    const double impulse = stop(batch, node);
    batch.impulse.values[node * batch.impulse.node_stride] = impulse;
    if (batch.amounts && batch.amounts[0].values)
      batch.amounts[0].values[node * batch.amounts[0].node_stride] = impulse > 0.0 ? 0.25 : 0.0;
  }
  return ILAW_OK;
}

std::int32_t evaluate(const ilaw_instance*, const ilaw_batch* batch, ilaw_report* report) {
  if (breaks("bare")) return evaluate_bare(*batch);
  for (std::int64_t i = 0; i < batch->node_count; ++i) {
    const std::int64_t node = node_of(*batch, i);
    batch->impulse.values[node * batch->impulse.node_stride] = false_impulse(*batch, node);
    batch->status[node * batch->status_stride] = ILAW_FREE;
    for (std::int64_t k = 0; k < ILAW_ENERGY_COUNT; ++k)
      if (batch->energy.values)
        batch->energy.values[node * batch->energy.node_stride + k * batch->energy.component_stride] = 0.0;
    if (batch->energy.values)
      batch->energy
          .values[node * batch->energy.node_stride + ILAW_ENERGY_IMPACT * batch->energy.component_stride] =
          false_energy(*batch);
  }
  if (batch->time < 2.9) return ILAW_OK;  // the third step
  if (breaks("throw")) throw std::runtime_error("what it threw");
  if (breaks("throw_number")) throw 3;
  if (breaks("abort")) std::abort();
  if (breaks("exit")) std::exit(0);
  // Read at run time, so that the compiler does not see through it.
  static int* volatile nowhere = reinterpret_cast<int*>(8);
  if (breaks("crash")) *nowhere = 1;
  if (breaks("stack")) return deeper(nullptr);
  if (breaks("hang")) hang();
  return answer(*batch, *report);
}

const void* extension(const char*) { return nullptr; }

ilaw_law law() {
  ilaw_law made{};
  made.struct_size = sizeof made;
  made.dimensions = ILAW_DIMENSION_1;
  made.delassus_forms = ILAW_DELASSUS_SCALAR;
  made.frames = ILAW_FRAME_LOCAL | ILAW_FRAME_GLOBAL;
  made.numbers = ILAW_NUMBERS_DOUBLE;
  made.inputs = ILAW_INPUT_GAP;
  made.outputs = breaks("bare") ? 0 : ILAW_OUTPUT_STATUS | ILAW_OUTPUT_ENERGY;
  made.amounts = amounts;
  made.amount_count = breaks("bare") ? 1 : 0;
  made.id = "broken";
  made.title = "Breaks a promise";
  made.doc = "";
  made.create = create;
  made.destroy = destroy;
  made.info = info;
  made.initialise = initialise;
  made.evaluate = evaluate;
  made.extension = extension;
  return made;
}

}  // namespace

extern "C" ILAW_EXPORT const ilaw_plugin* ILAW_ENTRY(void) {
  static const ilaw_law only = law();
  static const ilaw_law* const laws[] = {&only};
  static ilaw_plugin plugin{};
  plugin.struct_size = sizeof plugin;
  plugin.abi_major = ILAW_ABI_MAJOR;
  plugin.name = "broken";
  plugin.version = "0.1";
  plugin.vendor = "tests";
  plugin.licence = "BSD-3-Clause";
  plugin.laws = laws;
  plugin.law_count = 1;
  return &plugin;
}
