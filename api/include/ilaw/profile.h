/* profile.h - what a law tells those who measure it: the extension ILAW_PROFILE of a law
 * (ilaw_law.extension). A law need not have it. All laws that are made with the kit do.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef ILAW_PROFILE_H
#define ILAW_PROFILE_H

#include <ilaw/ilaw.h>

#define ILAW_PROFILE "ilaw.profile/1"

typedef struct ilaw_profile {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */

  /* [any-thread] The instruction set that evaluate of this instance uses, as static text: "baseline", "v3" or
   * "v4" (levels of x86-64) where the law is made with the kit. */
  const char* (*instruction_set)(const ilaw_instance* instance);

  /* [any-thread] As ilaw_law.evaluate, with the same bits, and counts the nodes that were solved one by one
   * instead of side by side with others: what packs of nodes left over, and all nodes of a loop that writes a
   * history. What a compiler makes of a loop without either is not known here. */
  int32_t (*evaluate_counting)(const ilaw_instance* instance, const ilaw_batch* batch, ilaw_report* report,
                               int64_t* one_by_one);
} ilaw_profile;

#endif
