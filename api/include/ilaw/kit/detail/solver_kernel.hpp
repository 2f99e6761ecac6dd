// solver_kernel.hpp - the loop for laws whose equations need a solver at some nodes. By blocks: every node is asked for
// its problem, and packs without one are stored at once; the problems are packed and solved side by side; then packs
// with answers are loaded again and finished. So a node without a problem costs what it costs in any other law, and no
// lane waits for a node that has nothing to solve.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/kernel.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- some lanes of a register, packed, and back ---------------------------------------------------------------------------

#if defined(__AVX512F__)
ILAW_KIT_INLINE void put_packed(one v, unsigned lanes, double* to) {
  _mm512_storeu_pd(to, _mm512_maskz_compress_pd(static_cast<__mmask8>(lanes), (__m512d)v));
}
ILAW_KIT_INLINE one get_packed(const double* from, unsigned lanes) {
  return (one)_mm512_maskz_expand_pd(static_cast<__mmask8>(lanes), _mm512_loadu_pd(from));
}
#elif defined(__AVX2__)
// For each set of lanes, where the lanes come from.
struct lane_moves {
  alignas(32) int packed[16][8], spread[16][8];
  constexpr lane_moves() : packed{}, spread{} {
    for (int bits = 0; bits < 16; ++bits)
      for (int k = 0, at = 0; k < 4; ++k)
        if (bits >> k & 1) {
          for (int h = 0; h < 2; ++h) {
            packed[bits][2 * at + h] = 2 * k + h;
            spread[bits][2 * k + h] = 2 * at + h;
          }
          ++at;
        }
  }
};
inline constexpr lane_moves moves;
ILAW_KIT_INLINE one moved(one v, const int* from) {
  return (one)_mm256_permutevar8x32_ps((__m256)v, _mm256_load_si256((const __m256i*)from));
}
ILAW_KIT_INLINE void put_packed(one v, unsigned lanes, double* to) { put_one(moved(v, moves.packed[lanes]), to); }
ILAW_KIT_INLINE one get_packed(const double* from, unsigned lanes) {
  one v;
  __builtin_memcpy(&v, from, sizeof v);
  return zeroed(mask_of_bits(lanes), moved(v, moves.spread[lanes]));
}
#else
ILAW_KIT_INLINE void put_packed(one v, unsigned lanes, double* to) {
  for (int k = 0; k < register_lanes; ++k)
    if (lanes >> k & 1) *to++ = v[k];
}
ILAW_KIT_INLINE one get_packed(const double* from, unsigned lanes) {
  one v{};
  for (int k = 0; k < register_lanes; ++k)
    if (lanes >> k & 1) v[k] = *from++;
  return v;
}
#endif
template <int Registers>
ILAW_KIT_INLINE void put_packed(const pack_of<Registers>& v, unsigned lanes, double* to) {
  constexpr unsigned all = (1U << register_lanes) - 1;
  for (int r = 0; r < Registers; ++r) {
    const unsigned own = lanes >> (register_lanes * r) & all;
    put_packed(v.v[r], own, to);
    to += __builtin_popcount(own);
  }
}
template <int Registers>
ILAW_KIT_INLINE void get_packed(pack_of<Registers>& v, unsigned lanes, const double* from) {
  constexpr unsigned all = (1U << register_lanes) - 1;
  for (int r = 0; r < Registers; ++r) {
    const unsigned own = lanes >> (register_lanes * r) & all;
    v.v[r] = get_packed(from, own);
    from += __builtin_popcount(own);
  }
}
ILAW_KIT_INLINE void put_packed(double v, unsigned /*lanes*/, double* to) { *to = v; }
ILAW_KIT_INLINE void get_packed(double& v, unsigned lanes, const double* from) { v = lanes ? *from : 0.0; }

// ---- the problems of a block ------------------------------------------------------------------------------------------------

inline constexpr int problem_block = 128;  // nodes

using solver_pack = pack_of<2>;

template <class Struct, class V>
inline constexpr int numbers_in_struct = static_cast<int>(sizeof(Struct) / sizeof(V));

// Number by number: of all at once compilers make a loop over bytes.
template <class V, class Struct>
ILAW_KIT_INLINE char* place_in(Struct& s, int k) {
  return reinterpret_cast<char*>(&s) + static_cast<std::size_t>(k) * sizeof(V);
}

template <class Law>
struct open_problems {
  using solver = law_on_t<Law, solver_pack>;
  static constexpr int room = problem_block + solver_pack::size,
                       problems = numbers_in_struct<typename solver::problem, solver_pack>,
                       answers = numbers_in_struct<typename solver::answer, solver_pack>;
  static_assert(problems == numbers_in_struct<typename law_on_t<Law, double>::problem, double> &&
                    answers == numbers_in_struct<typename law_on_t<Law, double>::answer, double>,
                "the members of problem and answer must all be of type V");

  alignas(64) double problem[problems][room], answer[answers][room];
  alignas(64) double parameter[parameter_count<Law>][room];  // those that vary from node to node
  std::uint64_t varying = 0;                                 // which: a bit each
  unsigned open[problem_block];   // by pack: lanes with a problem
  bool stored[problem_block];     // by pack: nothing is left to do
  bool careful[problem_block];    // by pack: has a bad node
  int count = 0;

  // In full packs; the last is filled up with its first problem. Returns how many the scalar fallback took.
  [[gnu::noinline, gnu::flatten]] int solve(const Law& given, const step_sizes& step) {
    int by_fallback = 0;
    solver law = broadcast<solver_pack>(given);
    auto prepared = kit::prepared(law, step);
    for (int first = 0; first < count; first += solver_pack::size) {
      const int filled = count - first < solver_pack::size ? count - first : solver_pack::size;
      if (varying) {
        take_parameters(law, first, filled);
        const auto own = kit::prepared(law, step);
        __builtin_memcpy(static_cast<void*>(&prepared), &own, sizeof own);
      }
      typename solver::problem p;
      typename solver::answer a;
      for (int c = 0; c < problems; ++c) {
        for (int k = filled; k < solver_pack::size; ++k) problem[c][first + k] = problem[c][first];
        __builtin_memcpy(place_in<solver_pack>(p, c), problem[c] + first, sizeof(solver_pack));
      }
      for (int c = 0; c < answers; ++c) __builtin_memset(place_in<solver_pack>(a, c), 0, sizeof(solver_pack));
      const mask_of<solver_pack> left = solve_one(law, p, a, prepared);
      for (int c = 0; c < answers; ++c)
        __builtin_memcpy(answer[c] + first, place_in<solver_pack>(a, c), sizeof(solver_pack));
      if (const unsigned lanes = mask_bits(left)) [[unlikely]]
        for (int k = 0; k < filled; ++k)
          if (lanes >> k & 1) {
            solve_scalar(given, step, first + k);
            ++by_fallback;
          }
    }
    return by_fallback;
  }

 private:
  template <class Prepared>
  static mask_of<solver_pack> solve_one(const solver& law, const typename solver::problem& p,
                                        typename solver::answer& a, const Prepared& prepared) {
    if constexpr (requires { law.solve(p, a, prepared); })
      return law.solve(p, a, prepared);
    else
      return law.solve(p, a);
  }
  void take_parameters(solver& law, int first, int filled) {
    for (int c = 0; c < parameter_count<Law>; ++c)
      if (varying >> c & 1) {
        for (int k = filled; k < solver_pack::size; ++k) parameter[c][first + k] = parameter[c][first];
        __builtin_memcpy(&solver::parameters[c].member.varying_in(law), parameter[c] + first, sizeof(solver_pack));
      }
  }
  [[gnu::noinline]] void solve_scalar(const Law& given, const step_sizes& step, int k) {
    using scalar = law_on_t<Law, double>;
    scalar law = given;
    for (int c = 0; c < parameter_count<Law>; ++c)
      if (varying >> c & 1) scalar::parameters[c].member.set(law, parameter[c][k]);
    typename scalar::problem p;
    typename scalar::answer a{};
    for (int c = 0; c < problems; ++c) __builtin_memcpy(place_in<double>(p, c), problem[c] + k, sizeof(double));
    const auto prepared = kit::prepared(law, step);
    if constexpr (requires { law.solve_scalar(p, a, prepared); })
      law.solve_scalar(p, a, prepared);
    else
      law.solve_scalar(p, a);
    for (int c = 0; c < answers; ++c) __builtin_memcpy(answer[c] + k, place_in<double>(a, c), sizeof(double));
  }
};

// Where it is asked rarely: once per form of H, whatever the host's numbers and frame.
template <class Wide, class Node>
[[gnu::noinline]] auto ask_apart(const Wide& law, Node& node, typename Wide::problem& open) {
  return law.ask(node, open);
}

// ---- the loop -----------------------------------------------------------------------------------------------------------------

template <class Law, class V, class Number, template <class> class Frame, template <class> class Delassus>
struct solver_kernel : kernel<Law, V, Number, Frame, Delassus> {
  using base = kernel<Law, V, Number, Frame, Delassus>;
  using typename base::limit;
  using typename base::loaded;
  using typename base::mask;
  using typename base::node_type;
  using typename base::view_type;
  using typename base::Wide;
  using base::width;
  using problem = typename Wide::problem;
  using answer = typename Wide::answer;
  using problems_type = open_problems<Law>;

  ILAW_KIT_INLINE static void keep(const Wide& law, const problem& p, unsigned open, problems_type& all) {
    if (!open) return;
    if (all.varying) [[unlikely]]
      for (int c = 0; c < parameter_count<Law>; ++c)
        if (all.varying >> c & 1)
          put_packed(Wide::parameters[c].member.varying_in(law), open, all.parameter[c] + all.count);
#pragma GCC unroll 64
    for (int c = 0; c < problems_type::problems; ++c)
      put_packed(reinterpret_cast<const V*>(&p)[c], open, all.problem[c] + all.count);
    all.count += __builtin_popcount(open);
  }

  // Asks one pack. False: it has a bad node.
  template <class Lanes>
  ILAW_KIT_INLINE static bool ask_pack(const Wide& law, const prepared_t<Wide>& prepared, const view_type& b,
                                       std::int64_t i, Lanes l, mask good_parameters, problems_type& all, int k,
                                       limit& limits) {
    constexpr bool careful = !Lanes::are_all;
    checks<V, careful> c;
    if constexpr (careful) c.require(good_parameters, reason_parameter);
    loaded p = base::load(prepared, b, i, l, c);
    base::take_state(p.node, b, i, l, c);
    const mask bad = c.bad();
    if constexpr (!careful)
      if (any(bad)) [[unlikely]]
        return false;
    problem open_problem;
    asked<V> found{mask_from<V>(0U), status::free};
    if constexpr (careful)
      found = ask_apart(law, p.node, open_problem);
    else
      found = law.ask(p.node, open_problem);
    const unsigned open = l.own(mask_bits(found.open & !bad));
    all.open[k] = open;
    all.stored[k] = false;
    all.careful[k] = careful;
    if constexpr (!careful)
      if (!open) {
        base::check_result(p.node, b, c);
        all.careful[k] = any(c.bad());
        if (!all.careful[k]) {
          base::store(law, p, b, i, l, found.status, !bad);
          base::add_limit(limits, law, p.node, b, !bad);
          all.stored[k] = true;
        }
        return true;
      }
    keep(law, open_problem, open, all);
    return true;
  }

  // A pack with answers, or one that is done with care.
  template <class Lanes>
  ILAW_KIT_INLINE static bool finish_pack(const Wide& law, const prepared_t<Wide>& prepared, const view_type& b,
                                          std::int64_t i, Lanes l, mask good_parameters, const problems_type& all,
                                          unsigned open, int first, tally& found, limit& limits) {
    constexpr bool careful = !Lanes::are_all;
    answer a;
#pragma GCC unroll 64
    for (int c = 0; c < problems_type::answers; ++c)
      get_packed(reinterpret_cast<V*>(&a)[c], open, all.answer[c] + first);
    checks<V, careful> c;
    if constexpr (careful) c.require(good_parameters, reason_parameter);
    loaded p = base::load(prepared, b, i, l, c);
    base::take_state(p.node, b, i, l, c);
    if constexpr (!careful) c = {};  // its input was checked when it was asked
    const status_of<V> status = finish_lanes(law, p.node, a, open);
    base::check_result(p.node, b, c);
    const mask bad = c.bad();
    if constexpr (!careful)
      if (any(bad)) [[unlikely]]
        return false;
    base::store(law, p, b, i, l, status, !bad);
    if constexpr (careful)
      base::add_limit(limits, law, p.node, b, mask_from<V>(l.own(~0U)) & !bad);
    else
      base::add_limit(limits, law, p.node, b, !bad);
    if constexpr (careful) base::add_bad(found, c, i, l);
    return true;
  }
  ILAW_KIT_INLINE static status_of<V> finish_lanes(const Wide& law, node_type& n, const answer& a, unsigned open) {
    constexpr unsigned every = (1U << width) - 1;
    if (open == every) return law.finish(n, a);
    node_type closed = n;
    problem unused;
    const asked<V> before = ask_apart(law, closed, unused);
    const status_of<V> finished = law.finish(n, a);
    const mask is_open = mask_from<V>(open);
    choose(n, closed, is_open);
    return select(is_open, finished, before.status);
  }
  ILAW_KIT_INLINE static void choose(node_type& a, const node_type& b, mask first) {
    a.impulse = select(first, a.impulse, b.impulse);
    for (int k = 0; k < base::states; ++k) {
      V& x = number_in<V>(a.state, k);
      x = select(first, x, number_in<V>(b.state, k));
    }
    a.stored = select(first, a.stored, b.stored);
    a.normal_gain = select(first, a.normal_gain, b.normal_gain);
    a.tangential_gain = select(first, a.tangential_gain, b.tangential_gain);
    a.rupture = select(first, a.rupture, b.rupture);
    for (int k = 0; k < amount_count<Law>; ++k) a.amounts[k] = select(first, a.amounts[k], b.amounts[k]);
    a.refused = select(first, a.refused, b.refused);
  }

  static some_lanes<V> left_at(const view_type& b, std::int64_t i) {
    return {static_cast<int>(b.count - i < width ? b.count - i : width)};
  }
  [[gnu::noinline, gnu::cold]] static void ask_carefully(const Law& given, const view_type& b, std::int64_t i,
                                                         problems_type& all, int k, limit& limits) {
    Wide law = broadcast<V>(given);
    mask good = V(0.0) == V(0.0);
    if (b.varying) good = take_parameters(law, given, b, i, left_at(b, i));
    const auto prepared = kit::prepared(law, b.step);
    ask_pack(law, prepared, b, i, left_at(b, i), good, all, k, limits);
  }
  [[gnu::noinline, gnu::cold]] static void finish_carefully(const Law& given, const view_type& b, std::int64_t i,
                                                            const problems_type& all, unsigned open, int first,
                                                            tally& found, limit& limits) {
    Wide law = broadcast<V>(given);
    mask good = V(0.0) == V(0.0);
    if (b.varying) good = take_parameters(law, given, b, i, left_at(b, i));
    const auto prepared = kit::prepared(law, b.step);
    finish_pack(law, prepared, b, i, left_at(b, i), good, all, open, first, found, limits);
  }

  [[gnu::noinline, gnu::flatten]] static void run(const void* opaque, const view_type& whole, tally& found) {
    const Law& given = *static_cast<const Law*>(opaque);
    const view_type b = whole;
    Wide law = broadcast<V>(given);
    auto prepared = kit::prepared(law, b.step);
    limit limits;
    problems_type all;
    for (int c = 0; c < parameter_count<Law>; ++c)
      if (b.parameters[c]) all.varying |= std::uint64_t{1} << c;
    mask good = V(0.0) == V(0.0);
    const auto take = [&](std::int64_t i) ILAW_KIT_LAMBDA {
      if (b.varying) [[unlikely]] {
        good = take_parameters(law, given, b, i, all_lanes<V>());
        if constexpr (requires { law.prepare(b.step); }) base::refresh(prepared, kit::prepared(law, b.step));
        return !any(!good);
      }
      return true;
    };
    for (std::int64_t start = 0; start < b.count; start += problem_block) {
      const std::int64_t end = b.count - start < problem_block ? b.count : start + problem_block;
      all.count = 0;
      int k = 0;
      for (std::int64_t i = start; i < end; i += width, ++k) {
        if (b.in_memory) prefetch(b, i + prefetch_distance, width);
        if (i + width > end || !take(i) ||
            !ask_pack(law, prepared, b, i, all_lanes<V>(), good, all, k, limits)) [[unlikely]]
          ask_carefully(given, b, i, all, k, limits);
      }
      if (all.count > 0) found.by_scalar_fallback += all.solve(given, b.step);
      int first = 0;
      k = 0;
      for (std::int64_t i = start; i < end; i += width, ++k) {
        const unsigned open = all.open[k];
        if (!all.stored[k] &&
            (all.careful[k] || !take(i) ||
             !finish_pack(law, prepared, b, i, all_lanes<V>(), good, all, open, first, found, limits)))
          finish_carefully(given, b, i, all, open, first, found, limits);
        first += __builtin_popcount(open);
      }
    }
    base::give_limit(limits, given, found);
  }
};

}  // namespace ilaw::kit::detail
