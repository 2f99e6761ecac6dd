// prelude.hpp - what a device's compiler reads before a law's source (ilaw_add_plugin): the standard
// headers as the host has them, from there on functions of host and device alike, and the number of a thread.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#undef __SSE2__  // packs have no use there
#define __host__ __attribute__((host))
#define __device__ __attribute__((device))

#include <stdlib.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#pragma clang force_cuda_host_device begin

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// The number of this thread.
#if defined(__NVPTX__)
inline std::int64_t thread_number() {
  return std::int64_t{__nvvm_read_ptx_sreg_ctaid_x()} * __nvvm_read_ptx_sreg_ntid_x() +
         __nvvm_read_ptx_sreg_tid_x();
}
#else
extern "C" __attribute__((device)) std::size_t _Z13get_global_idj(unsigned dimension);  // of OpenCL
inline std::int64_t thread_number() { return static_cast<std::int64_t>(_Z13get_global_idj(0)); }
#endif

}  // namespace ilaw::kit::detail
