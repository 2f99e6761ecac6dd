/* A law in plain C99 that keeps every rule of `ilaw check`: a one-sided dashpot with friction that wears. The
 * environment variable ILAW_CHECK_BREAK, read when the library is loaded, names the one rule that it breaks.
 */
#ifndef ILAW_TESTS_SAMPLE_H
#define ILAW_TESTS_SAMPLE_H

#define ILAW_BUILDING_PLUGIN
#include <ilaw/ilaw.h>

#include <stddef.h>

/* A parameter of an instance: a constant, a table or the value of each node. */
typedef struct quantity {
  double constant;
  double* table; /* owned */
  uint64_t count;
  int per_node;
} quantity;

/* What an instance that breaks a rule remembers of its calls. */
typedef struct memory {
  double last_sum, first_time, largest_step;
  int started, saw_nine;
} memory;

struct ilaw_instance {
  ilaw_setup setup;
  quantity damping, friction;
  double wear;
  int rough;
  const char* mode; /* of an argument that is gone: for a broken rule alone */
  memory* own;
  const char* per_node[1];
  ilaw_state_variable variable;
  const ilaw_state_variable* variables[1];
};

/* Whether this is the rule to break. */
int breaks(const char* rule);

/* What instances share that breaks a rule; not a global of the library. */
typedef struct shared_memory {
  const ilaw_instance *last, *before;
  uint32_t infos;
} shared_memory;
shared_memory* shared(void);
int on_first_thread(void);

void throw_something(void);
const ilaw_parameter* parameter_named(const char* name);
double value_at(const quantity* given, double time);

int32_t sample_create(const ilaw_setup* setup, ilaw_instance** made, char* message, size_t message_size);
void sample_destroy(ilaw_instance* made);
int32_t sample_info(const ilaw_instance* made, ilaw_instance_info* info);
int32_t sample_initialise(const ilaw_instance* made, const ilaw_batch* batch, ilaw_report* report);
int32_t sample_evaluate(const ilaw_instance* made, const ilaw_batch* batch, ilaw_report* report);
const void* sample_extension(const char* name);

#endif
