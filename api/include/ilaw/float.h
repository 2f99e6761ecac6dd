/* float.h - arrays of float for hosts in single precision: an extension of the laws that the kit makes.
 *
 *   const ilaw_float_functions* floats = law->extension ? law->extension(ILAW_FLOAT) : NULL;
 *   if (floats) code = floats->evaluate(instance, &batch, &report);
 *
 * The arithmetic is that of the law's own evaluate, in double precision: each number that is read becomes a
 * double, which changes nothing, and each number that is written is that of evaluate rounded once to the
 * nearest float. So an impulse, velocity or energy is as accurate as a float can be: half an ulp of it.
 *
 * What differs from evaluate
 *  - State stays in doubles: it is the law's memory, and would lose in every step what a float cannot hold.
 *  - An impulse that overflows a float (2^126 and more) is bad input of its node, as one that overflows a
 * double is there. Velocities and energies that overflow are infinite.
 *
 * Structs grow as those of ilaw.h do; ilaw_float_input and ilaw_float_output never.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef ILAW_FLOAT_H
#define ILAW_FLOAT_H

#include <ilaw/ilaw.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The name to ask extension of a law for; what comes back points to ilaw_float_functions. */
#define ILAW_FLOAT "ilaw.float/1"

/* As ilaw_input and ilaw_output, strides in floats. */
typedef struct ilaw_float_input {
  const float* values;
  int64_t node_stride;
  int64_t component_stride;
} ilaw_float_input;

typedef struct ilaw_float_output {
  float* values;
  int64_t node_stride;
  int64_t component_stride;
} ilaw_float_output;

/* The members of ilaw_batch, of the same meaning and in the same order. */
typedef struct ilaw_float_batch {
  uint32_t struct_size;
  int32_t index_base;
  uint64_t flags; /* 0: none is defined */
  int64_t node_count;
  const int32_t* index;
  const int64_t* index64;
  double time;
  double velocity_step;
  double position_step;
  ilaw_float_input v_free;
  ilaw_float_input delassus;
  ilaw_float_input gap;
  ilaw_float_input gap_offset;
  ilaw_float_input v_previous;
  ilaw_float_input area;
  ilaw_float_input normal;
  ilaw_float_input tangent;
  const ilaw_float_input* per_node_parameters;
  ilaw_input state_in;   /* doubles */
  ilaw_output state_out; /* doubles */
  ilaw_float_output impulse;
  ilaw_float_output velocity;
  ilaw_float_output energy;
  uint8_t* status;
  int64_t status_stride;
} ilaw_float_batch;

/* What a law has under ILAW_FLOAT. The instance is one of the law's create, and serves evaluate as well. */
typedef struct ilaw_float_functions {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */

  /* [any-thread] As those of ilaw_law. */
  int32_t (*initialise)(const ilaw_instance* instance, const ilaw_float_batch* batch, ilaw_report* report);
  int32_t (*evaluate)(const ilaw_instance* instance, const ilaw_float_batch* batch, ilaw_report* report);
} ilaw_float_functions;

/* Size of each struct in its first version, the least that is accepted. */
#define ILAW_FLOAT_BATCH_SIZE_1 ILAW_SIZE_TO(ilaw_float_batch, status_stride)
#define ILAW_FLOAT_FUNCTIONS_SIZE_1 ILAW_SIZE_TO(ilaw_float_functions, evaluate)

#if UINTPTR_MAX == UINT64_MAX
ILAW_PIN(float_batch_size_1, ILAW_FLOAT_BATCH_SIZE_1 == 400);
ILAW_PIN_OFFSET(ilaw_float_batch, index_base, 4);
ILAW_PIN(float_functions_size_1, ILAW_FLOAT_FUNCTIONS_SIZE_1 == 24);
ILAW_PIN_OFFSET(ilaw_float_functions, reserved, 4);
ILAW_PIN(float_input_size, sizeof(ilaw_float_input) == 24);
ILAW_PIN(float_output_size, sizeof(ilaw_float_output) == 24);
#endif

#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* ILAW_FLOAT_H */
