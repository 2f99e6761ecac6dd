/* What OpenRadioss exports to its user library. SPDX-License-Identifier: BSD-3-Clause */
#include <stdio.h>
#include <stdlib.h>

void set_user_window_nodes_(const int* nodes, const int* count);
void set_user_window_nodes_(const int* nodes, const int* count) {
  if (*count == 1) return;
  fprintf(stderr, "%d nodes from %d on\n", *count, nodes[0]);
  exit(1);
}
