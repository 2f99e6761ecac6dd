/* profile.h - draft extension: how a law computes, for those who measure it. Laws made with the kit have it.
 * A draft may change or go: rule in docs/abi.md.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef ILAW_EXT_DRAFT_PROFILE_H
#define ILAW_EXT_DRAFT_PROFILE_H

#include <ilaw/ilaw.h>

#define ILAW_PROFILE "ilaw.profile/1"

typedef struct ilaw_profile {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */

  /* [any-thread] The instruction set that evaluate of this instance uses, as static text: "baseline", "v3" or
   * "v4" (levels of x86-64) where the law is made with the kit. */
  const char*(ILAW_CALL* instruction_set)(const ilaw_instance* instance);

  /* [any-thread] As ilaw_law.evaluate, with the same bits, and counts the nodes that were not computed in a
   * pack with others. */
  ilaw_result(ILAW_CALL* evaluate_counting)(const ilaw_instance* instance, const ilaw_batch* batch,
                                            ilaw_report* report, int64_t* one_by_one);
} ilaw_profile;

#endif
