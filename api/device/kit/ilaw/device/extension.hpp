// extension.hpp - the extension ilaw.device/1 of a law whose library carries kernels for devices.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ext/draft/device.h>
#include <ilaw/device/arguments.hpp>
#include <ilaw/kit/detail/evaluate.hpp>

// The images that ilaw_add_plugin links into the library.
extern "C" {
#define ILAW_KIT_IMAGE(name) [[gnu::visibility("hidden")]] extern const char name[], name##_end[]
#if defined(ILAW_HAS_PTX)
ILAW_KIT_IMAGE(ilaw_kit_ptx);
#endif
#if defined(ILAW_HAS_SPIRV)
ILAW_KIT_IMAGE(ilaw_kit_spirv);
#endif
}

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

#if defined(ILAW_HAS_PTX)
inline constexpr ilaw_device_image ptx_image{sizeof(ilaw_device_image), ILAW_IMAGE_PTX, ilaw_kit_ptx,
                                             ilaw_kit_ptx_end};
#endif
#if defined(ILAW_HAS_SPIRV)
inline constexpr ilaw_device_image spirv_image{sizeof(ilaw_device_image), ILAW_IMAGE_SPIRV, ilaw_kit_spirv,
                                               ilaw_kit_spirv_end};
#endif
inline constexpr const ilaw_device_image* device_images[] = {
#if defined(ILAW_HAS_PTX)
    &ptx_image,
#endif
#if defined(ILAW_HAS_SPIRV)
    &spirv_image,
#endif
};

struct device_name {
  const char* name;
  device_variant variant;
};
#define ILAW_KIT_NAME(numbers, frame, form, part) \
  {"ilaw_" #numbers "_" #frame "_" #form "_" #part, ILAW_KIT_DEVICE_VARIANT(numbers, frame, form, part)},
inline constexpr device_name device_names[] = {ILAW_KIT_DEVICE_KERNELS(ILAW_KIT_NAME)};
#undef ILAW_KIT_NAME

// Whether a law has each of them.
template <class Law, std::size_t... K>
constexpr auto device_kernels_of(std::index_sequence<K...>) {
  return std::array<bool, sizeof...(K)>{device_loop<Law, device_names[K].variant>::exists...};
}
template <class Law>
inline constexpr auto has_device_kernel =
    device_kernels_of<Law>(std::make_index_sequence<std::size(device_names)>{});

template <class Law>
device_frame device_frame_of(const instance<Law>& made) {
  if (made.frame == ILAW_FRAME_LOCAL) return device_frame::local;
  const bool is_normal =
      needs_no_tangents<Law> && made.is_transverse() && made.dimension == 3 && !made.has_tangent;
  return is_normal ? device_frame::normal : device_frame::axes;
}

template <class Law>
const char* not_served(const instance<Law>& made) {
  if (made.window.duration > 0.0) return "memory is a window, which no device serves: expected 0";
  if (made.has_spins()) return "H has spins, which no device serves: expected another form";
  if (made.node_tables) return "a table is over a value per node, which no device serves";
  return nullptr;
}

template <class Law>
const char* ILAW_CALL device_kernel_name(const ilaw_instance* opaque, const char** reason) {
  const instance<Law>& made = of<Law>(opaque);
  const char* wrong = not_served(made);
  if (reason) *reason = wrong;
  if (wrong) return nullptr;
  for (const bool solves : {made.asks, !made.asks})  // the other where these nodes leave no choice
    for (std::size_t k = 0; k < std::size(device_names); ++k) {
      const device_variant& v = device_names[k].variant;
      const device_part part = solves ? device_part::solver : device_part::plain;
      if (has_device_kernel<Law>[k] &&
          (v.numbers == device_numbers::of_float) == (made.numbers == ILAW_NUMBERS_FLOAT) &&
          (v.form == device_form::transverse) == made.is_transverse() && v.frame == device_frame_of(made) &&
          v.part == part)
        return device_names[k].name;
    }
  return nullptr;
}

// A batch as the argument of a kernel.
template <class Law>
class device_writer {
 public:
  device_writer(const instance<Law>& made, const ilaw_batch& batch, std::int32_t place)
      : made_(made), b_(batch), to_{} {
    to_.law_place = place;
  }

  const device_arguments<Law>& write(const ilaw_device_findings& findings) {
    to_.law = made_.at(b_.time);
    to_.reasons = findings.reasons;
    to_.stable_steps = findings.stable_steps;
    write_options();
    write_inputs();
    write_outputs();
    write_state();
    return to_;
  }

 private:
  template <class Array>
  device_array numbers(const Array& a) const {
    void* const at = made_.numbers == ILAW_NUMBERS_FLOAT ? const_cast<float*>(a.floats)
                                                         : static_cast<void*>(const_cast<double*>(a.values));
    return {at, a.node_stride, a.component_stride};
  }
  template <class Array>
  static device_array doubles(const Array& a, std::int64_t first = 0) {
    return {const_cast<double*>(a.values) + first * a.component_stride, a.node_stride, a.component_stride};
  }

  void write_options() {
    static_cast<view_options&>(to_) = options_of(made_, b_, b_.node_count);
    to_.index = b_.index;
    to_.index64 = b_.index64;
    to_.index_base = b_.index_base;
    to_.delassus_numbers = made_.delassus_numbers();
  }
  void write_inputs() {
    const std::uint32_t read = inputs_read(made_, b_);
    const auto write = [&](const array_card& card, const ilaw_input& a, device_array& to) {
      if (card.is_in(read)) to = numbers(a);
    };
    for_inputs(write, b_, to_);
    to_.delassus = numbers(b_.delassus);
    for (std::uint32_t k = 0; k < made_.per_node_count; ++k)
      to_.parameters[made_.per_node_parameters[k]] = numbers(b_.per_node_parameters[k]);
  }
  void write_outputs() {
    for_outputs([&](const array_card&, const ilaw_output& a, device_array& to) { to = numbers(a); }, b_, to_);
    to_.status = {b_.status, b_.status_stride, 0};
    for (std::uint32_t k = 0; b_.amounts && k < made_.amount_count; ++k) {
      to_.amounts[k] = numbers(b_.amounts[k]);
      to_.has_amounts = to_.has_amounts || to_.amounts[k].at;
    }
    to_.moves = to_.velocity.at || to_.energy.at || to_.status.at || to_.has_amounts;
    to_.has_balance = to_.energy.at || to_.has_amounts;
  }
  void write_state() {
    if (made_.state_size == 0) return;
    to_.state_in = doubles(b_.state_in);
    to_.state_out = doubles(b_.state_out);
    if (!made_.carries_frame) return;
    to_.frame_in = doubles(b_.state_in, made_.frame_offset);
    to_.frame_out = doubles(b_.state_out, made_.frame_offset);
  }

  const instance<Law>& made_;
  const ilaw_batch& b_;
  device_arguments<Law> to_;
};

template <std::size_t Place, class Law>
struct device_functions {
  static ilaw_result ILAW_CALL argument(const ilaw_instance* opaque, const ilaw_batch* given,
                                        const ilaw_device_findings* findings, void* argument,
                                        ilaw_report* report) {
    const batch_call<Law> call(opaque, given, report);
    if (!call.batch) return call.code;
    const instance<Law>& made = *call.made;
    if (!argument) return refuse(report, "argument is null");
    if (const char* wrong = not_served(made)) return refuse(report, wrong, ILAW_UNSUPPORTED);
    if (const char* wrong = wrong_batch(made, *call.batch, false)) return refuse(report, wrong);
    const ilaw_device_findings none{};
    device_writer<Law> writer(made, *call.batch, static_cast<std::int32_t>(Place));
    std::memcpy(argument, &writer.write(findings ? *findings : none), sizeof(device_arguments<Law>));
    return ILAW_OK;
  }

  static ilaw_result ILAW_CALL report(const ilaw_instance* opaque, const ilaw_device_totals* totals,
                                      ilaw_report* report) {
    if (!opaque || !totals || !sized::is_complete(report)) return ILAW_INVALID_ARGUMENT;
    const float_environment own;
    const tally found{.bad_count = totals->bad_count,
                      .first_bad_node = totals->first_bad_node,
                      .stable_velocity_step = totals->stable_step};
    return give_report(report, found, reason_text<Law>(static_cast<int>(totals->reason)));
  }

  static constexpr ilaw_device_law law{.struct_size = sizeof(ilaw_device_law),
                                       .image_count = std::size(device_images),
                                       .images = device_images,
                                       .argument_size = sizeof(device_arguments<Law>),
                                       .kernel = device_kernel_name<Law>,
                                       .argument = argument,
                                       .report = report};
};

}  // namespace ilaw::kit::detail
