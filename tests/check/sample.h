/* A law in plain C99 that keeps every rule of `ilaw check`: a one-sided dashpot with friction that wears, and
 * with a moment against spins where the form of H has them. If it is rough, it meets an obstacle that
 * v_smooth or, without, v_free reaches within the step, and half as hard if v_smooth opens. The environment
 * variable ILAW_CHECK_BREAK, read when the library is loaded, names the one rule that it breaks. */
#ifndef ILAW_TESTS_SAMPLE_H
#define ILAW_TESTS_SAMPLE_H

#define ILAW_BUILDING_PLUGIN
#include <ilaw/ilaw.h>

#include <stddef.h>

/* A parameter of an instance: a constant, a table over time and temperature, or the value of each node. */
typedef struct quantity {
  double constant;
  uint32_t axis_count; /* 0: no table */
  int is_time[2];
  uint64_t count[2];
  double *points[2], *values; /* owned */
  int slot;                   /* among the parameters per node, from 1; 0: not per node */
} quantity;

/* Memory of the calls of an instance that breaks a rule. */
typedef struct memory {
  double last_sum, first_time, largest_step;
  int started, saw_nine;
} memory;

struct ilaw_instance {
  ilaw_setup setup;
  quantity damping, friction, temperature;
  double wear, reach;
  int rough;
  const char* mode; /* of an argument that is gone: for a broken rule alone */
  memory* own;
  int per_node_count;
  const char* per_node[2];
  ilaw_state_variable variable;
  const ilaw_state_variable* variables[1];
};

/* The arrays of spins of a batch. */
typedef struct spin_arrays {
  ilaw_input free, previous;
  ilaw_output moment, after;
} spin_arrays;
spin_arrays spins_of(const ilaw_batch* batch);

/* Whether this is the rule to break. */
int breaks(const char* rule);

/* Memory shared by instances that break a rule; not a global of the library. */
typedef struct shared_memory {
  const ilaw_instance *last, *before;
  uint32_t infos, rare_calls;
} shared_memory;
shared_memory* shared(void);
int on_first_thread(void);

/* Changes what a rule on the process forbids; the name goes on with the thing after a colon. */
void disturb(const char* rule);

void throw_something(void);
const ilaw_law* sample_law(void);
const ilaw_parameter* parameter_named(const char* name);
double value_at(const quantity* given, double time, double temperature);

enum { HEAT, WORN, AMOUNT_COUNT };

ilaw_result ILAW_CALL sample_create(const char* id, const ilaw_setup* setup, ilaw_instance** made,
                                    char* message, size_t message_size);
void ILAW_CALL sample_destroy(ilaw_instance* made);
ilaw_result ILAW_CALL sample_info(const ilaw_instance* made, ilaw_instance_info* info);
ilaw_result ILAW_CALL sample_initialise(const ilaw_instance* made, const ilaw_batch* batch,
                                        ilaw_report* report);
ilaw_result ILAW_CALL sample_evaluate(const ilaw_instance* made, const ilaw_batch* batch,
                                      ilaw_report* report);
const void* ILAW_CALL sample_extension(const char* name);

#endif
