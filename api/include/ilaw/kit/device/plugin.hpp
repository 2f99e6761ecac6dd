// plugin.hpp - the entry of a law library as a device's compiler sees it: its kernels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/device/kernel.hpp>

#define ILAW_KIT_KERNEL(numbers, frame, form, part)                                                          \
  extern "C"                                                                                                 \
      __attribute__((global)) void ilaw_##numbers##_##frame##_##form##_##part(ilaw_kit_device_block block) { \
    ilaw_kit_device_run<ILAW_KIT_DEVICE_VARIANT(numbers, frame, form, part)>(&block);                        \
  }
#define ILAW_PLUGIN(name, version, vendor, licence, ...)                                          \
  using ilaw_kit_device_block = ilaw::kit::detail::device_block_of<__VA_ARGS__>;                  \
  template <ilaw::kit::detail::device_variant Variant>                                            \
  ILAW_KIT_INLINE void ilaw_kit_device_run(const void* block) {                                   \
    ilaw::kit::detail::run_laws<Variant, __VA_ARGS__>(block, ilaw::kit::detail::thread_number()); \
  }                                                                                               \
  ILAW_KIT_DEVICE_KERNELS(ILAW_KIT_KERNEL)                                                        \
  _Pragma("clang force_cuda_host_device end")
