/* v_smooth as the law reads it, and what rules find if it reads it otherwise. */
#include "sample_node.h"

int has_smooth(const ilaw_instance* made, const ilaw_batch* b) {
  return made->rough && (b->v_smooth.values || b->v_smooth.floats);
}

void read_smooth(const ilaw_instance* made, const ilaw_batch* b, int64_t k, double* velocity) {
  const int is_given = has_smooth(made, b);
  const int64_t i = breaks("index-32: v_smooth") || breaks("index-64: v_smooth") ? k : node_of(b, k);
  ilaw_input from = is_given ? b->v_smooth : b->v_free;
  int c;
  if (breaks("layout-strides: v_smooth")) from.node_stride = b->v_free.node_stride;
  if (breaks("layout-components: v_smooth")) from.component_stride = 1;
  for (c = 0; c < (int)made->setup.dimension; ++c)
    velocity[c] = read_array(&from, is_given ? i : node_of(b, k), c);
}
