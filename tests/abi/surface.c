/* Functions that take every struct of the header, for abidiff: it compares what debuggers know of them. */
#include <ilaw/ilaw.h>

extern const ilaw_plugin* surface_of_plugin(void);
const ilaw_plugin* surface_of_plugin(void) { return NULL; }

extern int32_t surface_of_create(const ilaw_setup* setup, const ilaw_argument* argument);
int32_t surface_of_create(const ilaw_setup* setup, const ilaw_argument* argument) {
  return (int32_t)(setup->struct_size + argument->struct_size);
}

extern int32_t surface_of_tables(const ilaw_axis* axis, const ilaw_amount* amount);
int32_t surface_of_tables(const ilaw_axis* axis, const ilaw_amount* amount) {
  return (int32_t)(axis->struct_size + amount->struct_size);
}

extern int64_t surface_of_batch(const ilaw_batch* batch, ilaw_report* report, ilaw_instance_info* info);
int64_t surface_of_batch(const ilaw_batch* batch, ilaw_report* report, ilaw_instance_info* info) {
  return batch->node_count + report->bad_count + (int64_t)info->state_size;
}
