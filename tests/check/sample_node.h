/* One node of a batch of the sample law. */
#ifndef ILAW_TESTS_SAMPLE_NODE_H
#define ILAW_TESTS_SAMPLE_NODE_H

#include "sample.h"

double read_array(const ilaw_input* from, int64_t i, int c);
int64_t node_of(const ilaw_batch* b, int64_t k);
/* Keeps what instances that break a rule remember of a call. */
void remember(const ilaw_instance* made, const ilaw_batch* b);
/* v_smooth of the k-th node, and v_free if it is not given or not asked for. */
void read_smooth(const ilaw_instance* made, const ilaw_batch* b, int64_t k, double* velocity);
/* Whether the array is there for an instance that asks for it. */
int has_smooth(const ilaw_instance* made, const ilaw_batch* b);
/* Steps the k-th node of the batch; says what is wrong with it, null where nothing is. */
const char* step_node(const ilaw_instance* made, const ilaw_batch* b, int64_t k, int after_bad);

#endif
