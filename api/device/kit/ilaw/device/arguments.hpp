// arguments.hpp - what a kernel of a device is given by value: the batch with its device pointers, the
// instance's options and the law. The host's compiler and the device's lay it out alike.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/solver_kernel.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Which kernel of a law serves an instance. Parameters may decide whether the law needs the solver.
enum class device_numbers { of_double, of_float };
enum class device_frame { local, normal, axes };
enum class device_form { transverse, full };
enum class device_part { plain, solver };
struct device_variant {
  device_numbers numbers;
  device_frame frame;
  device_form form;
  device_part part;
};

// clang-format off
#define ILAW_KIT_DEVICE_PARTS(kernel, numbers, frame, form)                                   \
  kernel(numbers, frame, form, plain) kernel(numbers, frame, form, solver)
#define ILAW_KIT_DEVICE_FORMS(kernel, numbers)                                                \
  ILAW_KIT_DEVICE_PARTS(kernel, numbers, local, transverse)                                   \
  ILAW_KIT_DEVICE_PARTS(kernel, numbers, normal, transverse)                                  \
  ILAW_KIT_DEVICE_PARTS(kernel, numbers, axes, transverse)                                    \
  ILAW_KIT_DEVICE_PARTS(kernel, numbers, local, full)                                         \
  ILAW_KIT_DEVICE_PARTS(kernel, numbers, axes, full)
#define ILAW_KIT_DEVICE_KERNELS(kernel)                                                       \
  ILAW_KIT_DEVICE_FORMS(kernel, double) ILAW_KIT_DEVICE_FORMS(kernel, float)
// clang-format on
#define ILAW_KIT_DEVICE_VARIANT(numbers, frame, form, part)                                  \
  ilaw::kit::detail::device_variant {                                                        \
    ilaw::kit::detail::device_numbers::of_##numbers, ilaw::kit::detail::device_frame::frame, \
        ilaw::kit::detail::device_form::form, ilaw::kit::detail::device_part::part           \
  }

// Component c of a node stands at at[node * node_stride + c * component_stride] of its number type.
struct device_array {
  void* at;
  std::int64_t node_stride, component_stride;
};

struct device_options : view_options {
  std::int32_t law_place;  // in its library
  const std::int32_t* index;
  const std::int64_t* index64;
  std::int32_t index_base, delassus_numbers;
  device_array v_free, v_smooth, v_previous, normal, tangent, delassus, gap, gap_offset, area, spin_free,
      spin_previous;
  device_array impulse, velocity, moment, spin, energy, state_in, state_out, frame_in, frame_out, status;
  std::uint8_t* reasons;  // by position in the batch, as the next; null: not asked for
  double* stable_steps;
};

template <class Law>
struct device_arguments : device_options {
  device_array parameters[parameter_count<Law>], amounts[amount_count<Law> + 1];
  Law law;
};

// ---- which kernels a law has

// Tables that a step reads stay on the host.
template <class Law>
inline constexpr bool serves_devices = [] {
  bool reads_tables = false;
  for (const auto& p : Law::parameters) reads_tables = reads_tables || p.member.is_grid();
  return !reads_tables;
}();

template <device_frame Frame, class V>
using device_frame_t =
    std::conditional_t<Frame == device_frame::local, local_frame<V>,
                       std::conditional_t<Frame == device_frame::normal, normal_frame<V>, axes_frame<V>>>;

template <class Law, device_variant Variant>
struct device_loop {
  template <class V>
  using frame = device_frame_t<Variant.frame, V>;
  template <class V>
  using delassus = std::conditional_t<Variant.form == device_form::full, full<V>, transverse<V>>;

  static constexpr bool solves = Variant.part == device_part::solver;
  static constexpr bool is_full = Variant.form == device_form::full;
  static constexpr bool is_served =
      is_full ? serves_full<Law> && Variant.frame != device_frame::normal
              : serves_transverse<Law> && (Variant.frame != device_frame::normal || needs_no_tangents<Law>);
  template <class View, class V = pack_of_one>
  using kernel_on = kernel<Law, V, View, frame, delassus>;
  template <class View>
  using solver_kernel_on = solver_kernel<Law, pack_of_one, View, frame, delassus>;
  using node_type = typename kernel_on<view<double>, double>::node_type;
  static constexpr bool has_solver = can_ask<Law, node_type> ? solves || can_choose<Law, node_type> : !solves;
  static constexpr bool exists = is_served && serves_devices<Law> && has_solver;
};

}  // namespace ilaw::kit::detail
