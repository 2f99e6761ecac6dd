/* Steps of the law. r_N = -v_N/(H_NN + 1/(h c A)) where the gap is closed and closing; friction within its
 * cone takes at most the tangential velocity, and a moment up to a reach times r_N half of the spin. */
#include "sample.h"
#include "sample_node.h"

#include <fenv.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

static ilaw_result refuse(ilaw_report* report, ilaw_result code, const char* reason) {
  if (!report) return code;
  report->bad_count = 0;
  report->first_bad_node = -1;
  report->reason = reason;
  return code;
}

/* The mistake in a batch as a whole; null where there is none. */
static const char* wrong_list(const ilaw_batch* b) {
  int64_t k;
  if (b->index_base != 0 && b->index_base != 1) return "index_base is neither 0 nor 1";
  if (b->index && b->index64) return "index and index64 are both given";
  for (k = 0; k < b->node_count; ++k)
    if ((b->index && b->index[k] < b->index_base) || (b->index64 && b->index64[k] < b->index_base))
      return "a node lies below index_base";
  return NULL;
}

/* Whether an array is missing, or not of the number type of the setup. */
static int lacks(const ilaw_instance* made, const double* values, const float* floats, int required) {
  const int is_float = made->setup.numbers == ILAW_NUMBERS_FLOAT;
  if (!values && !floats) return required;
  if (breaks("array-numbers")) return is_float ? !floats : !values;
  return is_float ? !floats || values : !values || floats;
}

static int needs_previous(const ilaw_batch* b) {
  if (breaks("balance-inputs")) return 1;
  return b->energy.values || b->energy.floats || (b->amounts && !breaks("balance-inputs: amounts"));
}

static int lacks_spins(const ilaw_instance* made, const ilaw_batch* b) {
  const spin_arrays a = spins_of(b);
  if (made->setup.delassus_form != ILAW_DELASSUS_TRANSVERSE_SPIN) return 0;
  return lacks(made, a.free.values, a.free.floats, !breaks("call-refused: spins")) ||
         lacks(made, a.previous.values, a.previous.floats,
               needs_previous(b) && !breaks("balance-inputs: spins")) ||
         lacks(made, a.moment.values, a.moment.floats, 1) ||
         (!breaks("array-numbers: spins") && lacks(made, a.after.values, a.after.floats, 0));
}

static int is_flat(const ilaw_input* a) { return (a->values || a->floats) && a->component_stride == 0; }

static int is_shared(const ilaw_output* a) { return (a->values || a->floats) && a->node_stride == 0; }

static const char* wrong_arrays(const ilaw_instance* made, const ilaw_batch* b) {
  const spin_arrays spins = spins_of(b);
  const int global = made->setup.frame == ILAW_FRAME_GLOBAL,
            tangent = made->setup.has_tangent && made->setup.dimension == 3;
  int k;
  if (lacks(made, b->v_free.values, b->v_free.floats, 1) ||
      lacks(made, b->delassus.values, b->delassus.floats, 1) ||
      lacks(made, b->gap.values, b->gap.floats, 1) || lacks(made, b->area.values, b->area.floats, 1) ||
      lacks(made, b->v_previous.values, b->v_previous.floats, needs_previous(b)) ||
      lacks(made, b->gap_offset.values, b->gap_offset.floats, 0) ||
      lacks(made, b->normal.values, b->normal.floats, global) ||
      (made->rough &&
       lacks(made, b->v_smooth.values, b->v_smooth.floats, breaks("functions-return: v_smooth")) &&
       !breaks("array-numbers: v_smooth")) ||
      lacks(made, b->tangent.values, b->tangent.floats, tangent))
    return "an input is missing or of another number type";
  if (lacks(made, b->impulse.values, b->impulse.floats, 1) ||
      lacks(made, b->velocity.values, b->velocity.floats, 0) ||
      lacks(made, b->energy.values, b->energy.floats, 0))
    return "an output is missing or of another number type";
  if (made->setup.dimension > 1 &&
      (is_flat(&b->v_free) || is_flat(&b->v_previous) || (global && is_flat(&b->normal))))
    return "a vector has one component per node";
  if (lacks_spins(made, b)) return "an array of spins is missing or of another number type";
  for (k = 0; b->amounts && k < AMOUNT_COUNT && !breaks("array-numbers: amount"); ++k)
    if (lacks(made, b->amounts[k].values, b->amounts[k].floats, 0))
      return "an amount is of another number type";
  if (!b->state_in.values || (b->state_in.floats && !breaks("array-numbers: state")) || b->state_out.floats)
    return "a state is missing or of floats";
  if (b->node_count > 1 && (is_shared(&b->impulse) || is_shared(&b->velocity) || is_shared(&b->energy) ||
                            (is_shared(&b->state_out) && !breaks("call-refused: state stride")) ||
                            is_shared(&spins.moment) || is_shared(&spins.after)))
    return "an output has a stride of 0";
  return NULL;
}

static const char* wrong_call(const ilaw_instance* made, const ilaw_batch* b, int evaluates) {
  if (b->node_count < 0) return "node_count is negative";
  if (!isfinite(b->time) && !breaks("call-refused")) return "time is not finite";
  if (wrong_list(b)) return wrong_list(b);
  if (b->node_count == 0) return breaks("empty-batch") ? "there are no nodes" : NULL;
  if (!b->state_out.values) return "state_out is null";
  if (!evaluates) return NULL;
  if (!(b->velocity_step > 0.0) || !isfinite(b->velocity_step)) return "velocity_step is not a number > 0";
  if (!(b->position_step > 0.0) || !isfinite(b->position_step)) return "position_step is not a number > 0";
  if (breaks("step-limits") && b->velocity_step > 100.0) return "velocity_step is too large";
  return wrong_arrays(made, b);
}

static ilaw_result check_call(const ilaw_instance* made, const ilaw_batch* b, ilaw_report* report,
                              int evaluates) {
  const char* wrong;
  if (!made || !b) return ILAW_INVALID_ARGUMENT;
  if (b->struct_size < ILAW_BATCH_SIZE_1_0 && !breaks("sizes-short"))
    return refuse(report, ILAW_INVALID_ARGUMENT, "the batch is too small");
  if (b->flags != 0 && !breaks("batch-flags") && !(breaks("held-bonds") && b->flags < 3))
    return refuse(report, ILAW_UNSUPPORTED, "flags are not known");
  wrong = wrong_call(made, b, evaluates);
  if (wrong && b->impulse.values && breaks("call-refused: writes")) b->impulse.values[0] += 1.0;
  if (wrong && breaks("call-refused: silent")) return refuse(report, ILAW_INVALID_ARGUMENT, NULL);
  return wrong ? refuse(report, ILAW_INVALID_ARGUMENT, wrong) : ILAW_OK;
}

ilaw_result ILAW_CALL sample_initialise(const ilaw_instance* made, const ilaw_batch* b, ilaw_report* report) {
  const ilaw_result code = check_call(made, b, report, 0);
  int64_t k;
  if (code != ILAW_OK) return code;
  disturb("calls-process: initialise");
  for (k = 0; k < b->node_count; ++k) {
    const int64_t node = node_of(b, k);
    double first = 0.0;
    if (breaks("initialise-reads: step") && !(b->velocity_step > 0.0)) first = 1.0;
    if (breaks("initialise-reads")) first = 0.0 * read_array(&b->v_free, 0, 0);
    b->state_out.values[node * b->state_out.node_stride] = first;
  }
  refuse(report, ILAW_OK, NULL);
  if (report) report->stable_velocity_step = INFINITY;
  return ILAW_OK;
}

/* Things that evaluate may not do, each for its rule. */
static void misbehave(const ilaw_batch* b, int rough) {
  static volatile int counter;
  static int* volatile nowhere = (int*)8; /* read at run time, so that the compiler does not see through it */
  static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
  volatile char* volatile room; /* so that what is asked for is not left out */
  jmp_buf here;
  if (breaks("functions-return")) *nowhere = 1;
  if (breaks("hang"))
    for (;;) ++counter;
  if (breaks("pause"))
    for (;;) pause();
  if (breaks("poll"))
    for (;;) usleep(1000);
  if (breaks("naps")) usleep(2000);
  if (breaks("slow"))
    for (clock_t end = clock() + CLOCKS_PER_SEC / 100; clock() < end;) ++counter;
  if (breaks("exit")) exit(3);
  if (breaks("quiet exit")) _exit(0);
  if (breaks("abort")) abort();
  if (breaks("kill")) kill(getpid(), SIGKILL);
  if (breaks("throw")) throw_something();
  if (breaks("memory bomb"))
    for (;;) {
      room = malloc(1 << 20);
      memset((char*)room, 1, 1 << 20);
    }
  if (breaks("purity-globals")) ++counter;
  if (breaks("evaluate-allocates")) {
    room = malloc(64);
    if (room) room[0] = 1;
    free((char*)room);
  }
  if (breaks("evaluate-locks")) {
    pthread_mutex_lock(&lock);
    pthread_mutex_unlock(&lock);
  }
  if (breaks("evaluate-io") && getenv("HOME") == (char*)b) abort();
  if (breaks("evaluate-clock") && time(NULL) == 0) abort();
  if (breaks("evaluate-ends") && setjmp(here) != 0) abort();
  if (breaks("evaluate-system") && getppid() < 0) abort();
  if (breaks("memory-reads") && b->v_free.values)
    (void)*(const volatile double*)(b->v_free.values + b->node_count * 7);
  if (breaks("memory-unneeded: v_smooth") && !rough && b->v_smooth.values)
    (void)*(const volatile double*)b->v_smooth.values;
  if (breaks("memory-unneeded") && b->v_previous.values) (void)*(const volatile double*)b->v_previous.values;
}

/* Twice the step up to which an explicit dashpot is stable. */
static double limit_of_explicit(const ilaw_instance* made, const ilaw_batch* b) {
  return 4.0 / (made->damping.constant * read_array(&b->area, 0, 0) * read_array(&b->delassus, 0, 0));
}

static ilaw_result step_all(const ilaw_instance* made, const ilaw_batch* b, ilaw_report* report) {
  const char* reason = NULL;
  int64_t k, bad = 0, first = -1;
  for (k = 0; k < b->node_count; ++k) {
    const char* wrong = step_node(made, b, k, bad > 0);
    if (!wrong) continue;
    if (bad++ == 0) {
      reason = wrong;
      first = node_of(b, k) + (breaks("bad-input-list") ? b->index_base : 0);
    }
  }
  if (report) {
    report->bad_count = bad > 0 && breaks("bad-input-report: count") ? bad + 1 : bad;
    report->first_bad_node = bad == 0 && breaks("report-clean") ? 0 : first;
    report->reason = breaks("bad-input-report") ? NULL : reason;
    report->stable_velocity_step = breaks("stable-step") ? read_array(&b->area, 0, 0) : INFINITY;
    if (breaks("stable-step: last"))
      report->stable_velocity_step = read_array(&b->area, node_of(b, b->node_count - 1), 0);
    if (breaks("stable-step-bound") && !made->damping.slot && !made->damping.axis_count)
      report->stable_velocity_step = limit_of_explicit(made, b);
    if (breaks("report-clean: step")) report->stable_velocity_step = NAN;
    if (breaks("report-clean: step beside bad") && bad > 0) report->stable_velocity_step = NAN;
    if (breaks("report-clean: negative step")) report->stable_velocity_step = -0.5;
    if (breaks("report-clean: step per node") && made->damping.slot) report->stable_velocity_step = NAN;
    if (breaks("sizes-long: report") && report->struct_size > sizeof *report)
      memset((char*)report + sizeof *report, 0, report->struct_size - sizeof *report);
  }
  return bad > 0 ? ILAW_BAD_NODES : ILAW_OK;
}

/* The environment in which steps are computed; a broken rule leaves part of the host's. */
static void enter(const fenv_t* host, int mode, int traps) {
  (void)host;
  fesetenv(FE_DFL_ENV);
  if (breaks("float-rounding")) fesetround(mode);
  if (breaks("float-traps")) feenableexcept(traps);
}

ilaw_result ILAW_CALL sample_evaluate(const ilaw_instance* made, const ilaw_batch* b, ilaw_report* report) {
  ilaw_result code = check_call(made, b, report, 1);
  fenv_t host;
  const int mode = fegetround(), traps = fegetexcept();
#if defined(__x86_64__)
  const unsigned flushing = _mm_getcsr() & 0x8040;
#endif
  if (code != ILAW_OK || b->node_count == 0) {
    if (code == ILAW_OK) refuse(report, ILAW_OK, NULL);
    return code;
  }
  if (breaks("functions-return: code")) return refuse(report, ILAW_OUT_OF_MEMORY, "there is no room");
  if (breaks("report-null: refused") && !report) return ILAW_INVALID_ARGUMENT;
  if (breaks("report-null")) *(volatile int64_t*)&report->bad_count = 0;
  fegetenv(&host);
  enter(&host, mode, traps);
#if defined(__x86_64__)
  if (breaks("float-flushing")) _mm_setcsr(_mm_getcsr() | flushing);
#endif
  misbehave(b, made->rough);
  remember(made, b);
  code = step_all(made, b, report);
  if (breaks("memory-writes") && b->impulse.values && !b->index && !b->index64 &&
      b->impulse.component_stride == 1)
    ((volatile double*)b->impulse.values)[b->node_count * b->impulse.node_stride] = 1.0;
  if (breaks("memory-beside") && b->impulse.values && b->impulse.component_stride == 2)
    b->impulse.values[node_of(b, 0) * b->impulse.node_stride + 1] = 1.0;
  fesetenv(&host);
  if (breaks("float-flags")) feraiseexcept(FE_INEXACT);
  disturb("calls-process: evaluate");
  return code;
}
