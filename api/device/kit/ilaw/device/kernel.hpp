// kernel.hpp - a law's kernels for a device: one thread a node, by the careful loop of the CPU, straight from
// the host's arrays. No allocation, no synchronization.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/device/arguments.hpp>
#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- the arrays of one node, as a view: node 0 of it

template <class Law, class T>
struct node_state {
  T* at = nullptr;
  std::int64_t component = 0;
  int dimension = 3;

  // The place of number k of struct state; null: a component beyond the dimension.
  ILAW_KIT_INLINE T* number(int k) const {
    const int entry =
        dimension == 3 ? k : state_entries<Law>[dimension == 2 ? 2 : 1][static_cast<std::size_t>(k)];
    return entry < 0 ? nullptr : at + entry * component;
  }
};

template <class Law>
struct node_states {
  template <class T>
  using of = node_state<Law, T>;
};
template <class Law, class Number>
using node_view = view<Number, node_states<Law>::template of>;

template <int N, class Law>
ILAW_KIT_INLINE void load_numbers(pack_of_one (&to)[N], const node_state<Law, const double>& a,
                                  std::int64_t) {
#pragma unroll
  for (int k = 0; k < N; ++k) {
    const double* const from = a.number(k);
    to[k] = from ? *from : 0.0;
  }
}
template <int N, class Law>
ILAW_KIT_INLINE void store_numbers(const pack_of_one (&a)[N], const node_state<Law, double>& to,
                                   std::int64_t) {
#pragma unroll
  for (int k = 0; k < N; ++k)
    if (double* const place = to.number(k)) *place = a[k].v;
}

// Null where the array is absent, and without a branch: the compiler then knows that all arrays of an
// argument lie in global memory, whose loads are the fastest.
template <class T>
ILAW_KIT_INLINE T* place_in(const device_array& a, std::int64_t node) {
  return static_cast<T*>(a.at) + (a.at ? node * a.node_stride : 0);
}

ILAW_KIT_INLINE std::int64_t node_of(const device_options& a, std::int64_t k) {
  if (a.index64) return a.index64[k] - a.index_base;
  return a.index ? std::int64_t{a.index[k]} - a.index_base : k;
}

template <class Law, class Number>
ILAW_KIT_INLINE node_view<Law, Number> view_of(const device_arguments<Law>& a, std::int64_t node) {
  node_view<Law, Number> v{};
  static_cast<view_options&>(v) = a;
  v.count = 1;
  const auto place = [&](const device_array& from, auto& to, int count) ILAW_KIT_LAMBDA {
    to = {place_in<std::remove_pointer_t<decltype(to.at)>>(from, node), from.component_stride, count};
  };
  const auto open = [&](const array_card& card, const device_array& from, auto& to)
                        ILAW_KIT_LAMBDA { place(from, to, card.count(a.dimension)); };
  for_inputs(open, a, v);
  for_outputs(open, a, v);
  place(a.delassus, v.delassus, a.delassus_numbers);
  place(a.state_in, v.state_in, a.dimension);
  place(a.state_out, v.state_out, a.dimension);
  place(a.frame_in, v.frame_in, frame_size);
  place(a.frame_out, v.frame_out, frame_size);
  v.status = place_in<std::uint8_t>(a.status, node);
#pragma unroll
  for (int k = 0; k < amount_count<Law>; ++k) v.amounts[k] = place_in<Number>(a.amounts[k], node);
  return v;
}

// ---- the parameters of a node

// As take_parameters; false where they are not good, and the law then stays as it was.
template <class Law, class Number, std::size_t... K>
ILAW_KIT_INLINE bool take_parameters_at(Law& law, const device_arguments<Law>& a, std::int64_t node,
                                        std::index_sequence<K...>) {
  bool good = true;
  Law own = law;
  const auto take = [&](auto place) ILAW_KIT_LAMBDA {
    constexpr int k = decltype(place)::value;
    const device_array& given = a.parameters[k];
    if (!given.at) return;
    const auto value = static_cast<double>(static_cast<const Number*>(given.at)[node * given.node_stride]);
    constexpr parameter_range range = Law::parameters[k].range();
    good = good & range.has(value);
    Law::parameters[k].member.set(own, value);
  };
  (take(std::integral_constant<int, static_cast<int>(K)>{}), ...);
  if constexpr (requires { own.conflict(); }) good = good & !own.conflict();
  if (good) law = own;
  return good;
}

// ---- one node

// Wide: the law on packs, whose solver may leave a node to the scalar fallback.
template <class Law, class Wide, class Prepared>
ILAW_KIT_INLINE void solve_node(const Law& law, const Wide& wide, const step_sizes& step,
                                const typename Wide::problem& p, typename Wide::answer& a,
                                const Prepared& prepared) {
  if (!any(solve_lanes(wide, p, a, prepared))) return;
  typename Law::problem one;
  typename Law::answer answer{};
  static_assert(sizeof one == sizeof p && sizeof answer == sizeof a);
  __builtin_memcpy(static_cast<void*>(&one), &p, sizeof one);
  solve_one(law, step, one, answer);
  __builtin_memcpy(static_cast<void*>(&a), &answer, sizeof a);
}
template <class Solver, class Law, class Wide, class View>
ILAW_KIT_INLINE void solve_and_step_node(const Law& law, const Wide& wide, const View& b,
                                         typename Solver::checks_type c, tally& found,
                                         pack_of_one& stable_step) {
  const auto prepared = kit::prepared(wide, b.step);
  auto p = Solver::load_pack(prepared, b, 0, c);
  Solver::take_state(p.node, b, 0, c);
  const typename Solver::results came = p.node;
  typename Wide::problem open;
  const asked<pack_of_one> asked = wide.ask(p.node, open);
  const mask_of_one is_open = asked.open & !c.bad();
  status_of<pack_of_one> status = asked.status;
  if (any(is_open)) {
    typename Wide::answer answer{};
    solve_node(law, wide, b.step, open, answer, prepared);
    status = Solver::finish(wide, p.node, came, answer, is_open, status);
  }
  Solver::check_result(p.node, b, c);
  Solver::store_pack(wide, p, b, 0, status, !c.bad());
  add_stable_step(stable_step, wide, p.node, !c.bad());
  Solver::add_bad(found, c, 0);
}

// Node k of a batch.
template <class Law, device_variant Variant>
ILAW_KIT_INLINE void run_node(const device_arguments<Law>& a, std::int64_t k) {
  using Number = std::conditional_t<Variant.numbers == device_numbers::of_float, float, double>;
  using variant = device_loop<Law, Variant>;
  using loop = typename variant::template kernel_on<node_view<Law, Number>>;
  if (k >= a.count) return;
  const std::int64_t node = node_of(a, k);
  const auto b = view_of<Law, Number>(a, node);
  typename loop::checks_type c;
  Law law = a.law;
  if (a.varying)
    c.require({take_parameters_at<Law, Number>(
                  law, a, node, std::make_index_sequence<static_cast<std::size_t>(parameter_count<Law>)>{})},
              reason_parameter);
  const auto wide = broadcast<pack_of_one>(law);
  tally found;
  pack_of_one stable_step = infinity;
  if constexpr (variant::solves)
    solve_and_step_node<typename variant::template solver_kernel_on<node_view<Law, Number>>>(
        law, wide, b, c, found, stable_step);
  else
    loop::run_pack(wide, kit::prepared(wide, b.step), b, 0, c, found, stable_step);
  if (a.reasons) a.reasons[k] = static_cast<std::uint8_t>(found.reason);
  if (a.stable_steps) a.stable_steps[k] = stable_step.v;
}

// The kernels of a library: nothing where a law has no such variant.
template <std::size_t Size>
struct alignas(8) device_block {
  std::uint64_t words[(Size + 7) / 8];  // by bytes a compiler would load each alone
};
template <template <class> class... Laws>
using device_block_of = device_block<std::max({sizeof(device_arguments<Laws<double>>)...})>;

template <device_variant Variant, class Law>
ILAW_KIT_INLINE void run_law(const void* block, int place, std::int64_t k) {
  const auto& a = *static_cast<const device_arguments<Law>*>(block);
  if constexpr (device_loop<Law, Variant>::exists)
    if (a.law_place == place) run_node<Law, Variant>(a, k);
}
template <device_variant Variant, template <class> class... Laws>
ILAW_KIT_INLINE void run_laws(const void* block, std::int64_t k) {
  int place = 0;
  (run_law<Variant, Laws<double>>(block, place++, k), ...);
}

}  // namespace ilaw::kit::detail

// The entry of a law library as a device's compiler sees it.
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
