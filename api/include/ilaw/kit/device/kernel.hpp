// kernel.hpp - a law's kernels for a device: one thread a node, on the careful loop of the CPU with V
// = double, straight from the host's arrays. No allocation, no synchronization.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/device/arguments.hpp>
#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- the number type

// V of a law on a device is a pack of one lane. Not a double, with which laws mean the scalar fallback and
// may compute in another way.

struct device_mask {
  bool m;

  ILAW_KIT_INLINE friend device_mask operator&(device_mask a, device_mask b) { return {a.m && b.m}; }
  ILAW_KIT_INLINE friend device_mask operator|(device_mask a, device_mask b) { return {a.m || b.m}; }
  ILAW_KIT_INLINE friend device_mask operator!(device_mask a) { return {!a.m}; }
  ILAW_KIT_INLINE friend device_mask operator&(device_mask a, bool b) { return {a.m && b}; }
  ILAW_KIT_INLINE friend device_mask operator&(bool a, device_mask b) { return {a && b.m}; }
  ILAW_KIT_INLINE friend device_mask operator|(device_mask a, bool b) { return {a.m || b}; }
  ILAW_KIT_INLINE friend device_mask operator|(bool a, device_mask b) { return {a || b.m}; }
  ILAW_KIT_INLINE friend bool any(device_mask a) { return a.m; }
  ILAW_KIT_INLINE friend unsigned mask_bits(device_mask a) { return a.m ? 1U : 0U; }
};

struct device_number {
  static constexpr int size = 1;
  using mask = device_mask;
  double v;

  device_number() = default;
  ILAW_KIT_INLINE device_number(double x) : v(x) {}
  template <class T>
  ILAW_KIT_INLINE explicit operator T() const requires std::is_arithmetic_v<T> {
    return static_cast<T>(v);
  }

#define ILAW_KIT_OPERATION(op) \
  ILAW_KIT_INLINE friend device_number operator op(device_number a, device_number b) { return a.v op b.v; }
  ILAW_KIT_OPERATION(+)
  ILAW_KIT_OPERATION(-)
  ILAW_KIT_OPERATION(*)
  ILAW_KIT_OPERATION(/)
#undef ILAW_KIT_OPERATION
#define ILAW_KIT_COMPARISON(op) \
  ILAW_KIT_INLINE friend mask operator op(device_number a, device_number b) { return {a.v op b.v}; }
  ILAW_KIT_COMPARISON(<)
  ILAW_KIT_COMPARISON(<=)
  ILAW_KIT_COMPARISON(>)
  ILAW_KIT_COMPARISON(>=)
  ILAW_KIT_COMPARISON(==)
  ILAW_KIT_COMPARISON(!=)
#undef ILAW_KIT_COMPARISON
  ILAW_KIT_INLINE friend device_number operator-(device_number a) { return -a.v; }
  ILAW_KIT_INLINE friend device_number& operator+=(device_number& a, device_number b) { return a = a + b; }
  ILAW_KIT_INLINE friend device_number& operator-=(device_number& a, device_number b) { return a = a - b; }
  ILAW_KIT_INLINE friend device_number& operator*=(device_number& a, device_number b) { return a = a * b; }

  ILAW_KIT_INLINE friend device_number select(mask m, device_number a, device_number b) {
    return m.m ? a.v : b.v;
  }
  ILAW_KIT_INLINE friend device_number zero_unless(mask m, device_number a) { return m.m ? a.v : 0.0; }
  ILAW_KIT_INLINE friend device_number larger(device_number a, device_number b) {
    return kit::larger(a.v, b.v);
  }
  ILAW_KIT_INLINE friend device_number smaller(device_number a, device_number b) {
    return kit::smaller(a.v, b.v);
  }
  ILAW_KIT_INLINE friend device_number positive_part(device_number x) { return kit::positive_part(x.v); }
  ILAW_KIT_INLINE friend device_number square_root(device_number x) { return kit::square_root(x.v); }
  ILAW_KIT_INLINE friend device_number absolute(device_number x) { return kit::absolute(x.v); }
  ILAW_KIT_INLINE friend device_number exp(device_number x) { return kit::exp(x.v); }
  ILAW_KIT_INLINE friend device_number log(device_number x) { return kit::log(x.v); }

  ILAW_KIT_INLINE friend mask have_other_bits(device_number a, device_number b) {
    return {detail::have_other_bits(a.v, b.v)};
  }
  ILAW_KIT_INLINE friend double lane_of(device_number x, int /*lane*/) { return x.v; }
  ILAW_KIT_INLINE double operator[](int /*lane*/) const { return v; }
};

template <>
struct bits_of<device_number> {
  using type = std::uint64_t;
  ILAW_KIT_INLINE static type in(device_number x) { return std::bit_cast<type>(x.v); }
  ILAW_KIT_INLINE static type of(std::uint64_t all) { return all; }
  ILAW_KIT_INLINE static device_number number(type bits) { return std::bit_cast<double>(bits); }
};
template <>
ILAW_KIT_INLINE device_mask mask_from<device_number>(unsigned bits) {
  return {bits != 0};
}
ILAW_KIT_INLINE status_of<device_number> select(device_mask m, status_value a, status_value b) {
  return m.m ? a : b;
}

// ---- the arrays of one node, as a view: node 0 of it

template <class Law, class Number>
struct at_node {};

template <class T>
struct node_array {
  T* at = nullptr;
  std::int64_t component = 0;
  int count = 0;
  static constexpr int rows = 0;
};
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

template <class Law, class Number>
struct arrays_of<at_node<Law, Number>> {
  static constexpr bool are_careful = true;
  using value = Number;
  template <class T, int Count>
  using array_type = node_array<T>;
  template <class T>
  using state_type = node_state<Law, T>;
};

template <int N, class Law>
ILAW_KIT_INLINE void load_numbers(device_number (&to)[N], const node_state<Law, const double>& a,
                                  std::int64_t) {
#pragma unroll
  for (int k = 0; k < N; ++k) {
    const double* const from = a.number(k);
    to[k] = from ? *from : 0.0;
  }
}
template <int N, class Law>
ILAW_KIT_INLINE void store_numbers(const device_number (&a)[N], const node_state<Law, double>& to,
                                   std::int64_t) {
#pragma unroll
  for (int k = 0; k < N; ++k)
    if (double* const place = to.number(k)) *place = a[k].v;
}

// With fewer dimensions than three H is filled up as batch_walk does.
template <class T>
ILAW_KIT_INLINE void load_symmetric(full<device_number>& h, const node_array<T>& a, std::int64_t) {
  const auto number = [&](int c) ILAW_KIT_LAMBDA { return static_cast<double>(a.at[c * a.component]); };
  h.nn = number(0);
  h.t11 = a.count > 1 ? number(1) : h.nn;
  h.t22 = a.count == 3 || a.count == 6 ? number(2) : h.t11;
  h.n1 = a.count == 6 ? number(3) : (a.count == full_in_plane ? number(2) : 0.0);
  h.n2 = a.count == 6 ? number(4) : 0.0;
  h.t12 = a.count == 6 ? number(5) : 0.0;
}

// Null where the array is absent, and without a branch: the compiler then knows that all arrays of an
// argument lie in global memory, whose loads are the fastest.
template <class T>
ILAW_KIT_INLINE T* place_in(const device_array& a, std::int64_t node) {
  return static_cast<T*>(a.at) + (a.at ? node * a.node_stride : 0);
}
template <class T>
ILAW_KIT_INLINE node_array<T> array_at(const device_array& a, std::int64_t node, int count) {
  return {place_in<T>(a, node), a.component_stride, count};
}
template <class Law, class T>
ILAW_KIT_INLINE node_state<Law, T> state_at(const device_array& a, std::int64_t node, int dimension) {
  return {place_in<T>(a, node), a.component_stride, dimension};
}

ILAW_KIT_INLINE std::int64_t node_of(const device_options& a, std::int64_t k) {
  if (a.index64) return a.index64[k] - a.index_base;
  return a.index ? std::int64_t{a.index[k]} - a.index_base : k;
}

template <class Law, class Number>
ILAW_KIT_INLINE view<at_node<Law, Number>> view_of(const device_arguments<Law>& a, std::int64_t node) {
  view<at_node<Law, Number>> v{};
  static_cast<view_options&>(v) = a;
  v.count = 1;
  const auto open = [&](const array_card& card, const device_array& from, auto& to) ILAW_KIT_LAMBDA {
    to = {place_in<std::remove_pointer_t<decltype(to.at)>>(from, node), from.component_stride,
          card.count(a.dimension)};
  };
  for_inputs(open, a, v);
  for_outputs(open, a, v);
  v.delassus = array_at<const Number>(a.delassus, node, a.delassus_numbers);
  v.status = array_at<std::uint8_t>(a.status, node, 1).at;
  v.state_in = state_at<Law, const double>(a.state_in, node, a.dimension);
  v.state_out = state_at<Law, double>(a.state_out, node, a.dimension);
  v.frame_in = array_at<const double>(a.frame_in, node, 6);
  v.frame_out = array_at<double>(a.frame_out, node, 6);
#pragma unroll
  for (int k = 0; k < amount_count<Law>; ++k) v.amounts[k] = array_at<Number>(a.amounts[k], node, 1).at;
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

// Laws in closed form, as kernel::run_pack, or with the solver: ask, solve and finish of one node.
template <class Kernel, class Law, class View>
ILAW_KIT_INLINE void step_node(const Law& law, const View& b, typename Kernel::checks_type c, tally& found,
                               typename Kernel::limit& limits) {
  Kernel::run_pack(law, kit::prepared(law, b.step), b, 0, c, found, limits, 0);
}
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
                                         typename Solver::limit& limits) {
  const auto prepared = kit::prepared(wide, b.step);
  auto p = Solver::load_pack(prepared, b, 0, c);
  Solver::take_state(p.node, b, 0, c);
  const typename Solver::results came = p.node;
  typename Wide::problem open;
  const asked<device_number> asked = wide.ask(p.node, open);
  const device_mask is_open = asked.open & !c.bad();
  status_of<device_number> status = asked.status;
  if (any(is_open)) {
    typename Wide::answer answer{};
    solve_node(law, wide, b.step, open, answer, prepared);
    status = Solver::finish(wide, p.node, came, answer, is_open, status);
  }
  Solver::check_result(p.node, b, c);
  Solver::store_pack(wide, p, b, 0, status, !c.bad());
  Solver::steps::add(limits, wide, p.node, b.varying, !c.bad());
  Solver::add_bad(found, c, {true}, 0);
}

// Node k of a batch.
template <class Law, device_variant Variant>
ILAW_KIT_INLINE void run_node(const device_arguments<Law>& a, std::int64_t k) {
  using Number = std::conditional_t<Variant.numbers == device_numbers::of_float, float, double>;
  using variant = device_loop<Law, Variant>;
  using loop = typename variant::template kernel_on<at_node<Law, Number>, device_number>;
  if (k >= a.count) return;
  const std::int64_t node = node_of(a, k);
  const auto b = view_of<Law, Number>(a, node);
  typename loop::checks_type c;
  Law law = a.law;
  if (a.varying)
    c.require({take_parameters_at<Law, Number>(
                  law, a, node, std::make_index_sequence<static_cast<std::size_t>(parameter_count<Law>)>{})},
              reason_parameter);
  const auto wide = broadcast<device_number>(law);
  tally found;
  typename loop::limit limits = loop::steps::start(a.law, b.varying);
  if constexpr (variant::solves)
    solve_and_step_node<typename variant::template solver_kernel_on<at_node<Law, Number>, device_number>>(
        law, wide, b, c, found, limits);
  else
    step_node<loop>(wide, b, c, found, limits);
  if (a.reasons) a.reasons[k] = static_cast<std::uint8_t>(found.reason);
  if (a.limits) {
    a.limits[3 * k] = limits.least.v;
    a.limits[3 * k + 1] = limits.most_normal.v;
    a.limits[3 * k + 2] = limits.most_tangential.v;
  }
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
