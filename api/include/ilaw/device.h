/* device.h - launches a law's kernels on a GPU, for hosts that have no launcher of their own. Links against
 * neither CUDA nor OpenCL: the drivers are opened when a device is. How to use it: docs/hosts/gpu.md.
 *
 * A draft, as ilaw/ext/draft/device.h is, which it stands on. Pointers in a batch are those of the device;
 * lists of nodes, too. No call but those that say so waits for the device. One launcher serves one thread and
 * one queue at a time; different launchers are independent.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef ILAW_DEVICE_H
#define ILAW_DEVICE_H

#include <ilaw/ext/draft/device.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(ILAW_BUILDING_SHARED_DEVICE)
#pragma GCC visibility push(default)
#endif

/* Interface to the device's driver. */
enum {
  ILAW_DRIVER_CUDA = 1,  /* libcuda.so.1; kernels from PTX. Contexts, streams: CUcontext, CUstream */
  ILAW_DRIVER_OPENCL = 2 /* libOpenCL.so.1, with shared virtual memory; kernels from SPIR-V. Contexts, queues:
                            cl_context, cl_command_queue. Where a device takes SPIR alone, as Debian's pocl
                            does, the environment variable ILAW_SPIRV_TRANSLATOR names a program llvm-spirv */
};

typedef struct ilaw_device ilaw_device;
typedef struct ilaw_launcher ilaw_launcher;

/* Device number `number` of the driver, in a context of its own; of CUDA in the primary one, which hosts of
 * the runtime API share. message: why not. */
ilaw_result ILAW_CALL ilaw_device_open(ilaw_kind driver, int32_t number, ilaw_device** device, char* message,
                                       size_t message_size);

/* The same in a context of the host. device_id: a cl_device_id of it; null for CUDA. */
ilaw_result ILAW_CALL ilaw_device_open_in(ilaw_kind driver, void* context, void* device_id,
                                          ilaw_device** device, char* message, size_t message_size);

/* After all its launchers. */
void ILAW_CALL ilaw_device_close(ilaw_device* device);

const char* ILAW_CALL ilaw_device_name(const ilaw_device* device);

/* A queue that was made with the device; null stands for it in all calls. */
void* ILAW_CALL ilaw_device_queue(const ilaw_device* device);

/* Memory of the device, for hosts that allocate none: null where there is not enough. write and read wait. */
void* ILAW_CALL ilaw_device_allocate(ilaw_device* device, size_t size);
void ILAW_CALL ilaw_device_free(ilaw_device* device, void* memory);
ilaw_result ILAW_CALL ilaw_device_write(ilaw_device* device, void* queue, void* to, const void* from,
                                        size_t size);
ilaw_result ILAW_CALL ilaw_device_read(ilaw_device* device, void* queue, void* to, const void* from,
                                       size_t size);

/* Loads the kernel of an instance. The instance must outlive the launcher. most_nodes: of any batch; the
 * memory for reports and sums is allocated here. message: why not. */
ilaw_result ILAW_CALL ilaw_launcher_create(ilaw_device* device, const ilaw_law* law,
                                           const ilaw_instance* instance, int64_t most_nodes,
                                           ilaw_launcher** launcher, char* message, size_t message_size);
void ILAW_CALL ilaw_launcher_destroy(ilaw_launcher* launcher);

/* Puts one evaluate into the queue. report: null, or why the call was refused. wants_report: keeps what
 * ilaw_launcher_report needs; batch and per_node_parameters may change after the call, arrays of the device
 * when the queue is through. */
ilaw_result ILAW_CALL ilaw_launcher_evaluate(ilaw_launcher* launcher, void* queue, const ilaw_batch* batch,
                                             int32_t wants_report, ilaw_report* report);

/* Waits for the last evaluate that wanted a report, and gives it as evaluate does. */
ilaw_result ILAW_CALL ilaw_launcher_report(ilaw_launcher* launcher, void* queue, ilaw_report* report);

/* Waits, and sums the energy that the last evaluate wrote, in a tree that depends on the number of nodes
 * alone. */
ilaw_result ILAW_CALL ilaw_launcher_energy(ilaw_launcher* launcher, void* queue,
                                           double sums[ILAW_ENERGY_COUNT]);

#if defined(ILAW_BUILDING_SHARED_DEVICE)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* ILAW_DEVICE_H */
