/* device.h - draft extension: a law on a GPU. The library carries kernels with one thread a node, which give
 * the bits of evaluate; the host launches them on its own stream or queue, on arrays of the device.
 * ilaw/device.h is a launcher for hosts without one of their own.
 * A draft may change or go: rule in docs/abi.md. How to use it: docs/hosts/gpu.md.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef ILAW_EXT_DRAFT_DEVICE_H
#define ILAW_EXT_DRAFT_DEVICE_H

#include <ilaw/ilaw.h>

#define ILAW_DEVICE "ilaw.device/1"

/* Kind of an image. */
enum {
  ILAW_IMAGE_PTX = 1,  /* text, for cuModuleLoadData: version 6.3, for sm_70 and later */
  ILAW_IMAGE_SPIRV = 2 /* binary, for clCreateProgramWithIL */
};

/* All kernels of a law's library, compiled. */
typedef struct ilaw_device_image {
  uint32_t struct_size;
  ilaw_kind kind;    /* ILAW_IMAGE_* */
  const char* begin; /* a text ends with a zero, at end */
  const char* end;
} ilaw_device_image;

/* Arrays on the device for what evaluate reports, by position in the batch. Null: not asked for. */
typedef struct ilaw_device_findings {
  uint32_t struct_size;
  uint32_t reserved;    /* 0 */
  uint8_t* reasons;     /* node_count codes: why a node is bad; 0 of good ones */
  double* stable_steps; /* node_count; infinity of nodes that limit no step */
} ilaw_device_findings;

/* The same of a whole batch. */
typedef struct ilaw_device_totals {
  uint32_t struct_size;
  uint32_t reason; /* of the first bad node */
  int64_t bad_count;
  int64_t first_bad_node; /* -1 when none */
  double stable_step;     /* the smallest; infinity where they were not asked for */
} ilaw_device_totals;

typedef struct ilaw_device_law {
  uint32_t struct_size;
  uint32_t image_count;
  const ilaw_device_image* const* images;
  uint64_t argument_size; /* bytes of the one argument of every kernel, a struct by value */

  /* [any-thread] The name of the kernel of an instance; null where it is not served, with the reason. It is
   * launched with at least node_count threads in one dimension; further threads do nothing. */
  const char*(ILAW_CALL* kernel)(const ilaw_instance* instance, const char** reason);

  /* [any-thread] Checks a batch as evaluate does, and writes the argument of its kernel. All arrays of the
   * batch and of the findings (null: none) are pointers of the device, which are not followed here;
   * per_node_parameters and amounts are arrays of the host. A list of nodes is not looked at, so none may lie
   * below index_base. Tables over time are read at the time of the batch. Returns as evaluate. */
  ilaw_result(ILAW_CALL* argument)(const ilaw_instance* instance, const ilaw_batch* batch,
                                   const ilaw_device_findings* findings, void* argument, ilaw_report* report);

  /* [any-thread] The report of evaluate from the totals. Returns ILAW_OK, ILAW_BAD_NODES or
   * ILAW_INVALID_ARGUMENT. */
  ilaw_result(ILAW_CALL* report)(const ilaw_instance* instance, const ilaw_device_totals* totals,
                                 ilaw_report* report);
} ilaw_device_law;

#endif
