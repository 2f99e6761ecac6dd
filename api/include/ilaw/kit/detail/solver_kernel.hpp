// solver_kernel.hpp - the loop for laws whose equations need a solver at some nodes. By blocks: every node is
// asked for its problem, and packs without one are stored at once; the problems are packed and solved side by
// side; then packs with answers are loaded again and finished. So a node without a problem costs what it
// costs in any other law, and no lane waits for a node that has nothing to solve.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/kernel.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- some lanes of a register, packed, and back

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
ILAW_KIT_INLINE void put_packed(one v, unsigned lanes, double* to) {
  put_one(moved(v, moves.packed[lanes]), to);
}
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
ILAW_KIT_INLINE void put_packed(pack_of_one v, unsigned /*lanes*/, double* to) { *to = v.v; }
ILAW_KIT_INLINE void get_packed(pack_of_one& v, unsigned lanes, const double* from) {
  v = lanes ? *from : 0.0;
}

// ---- the problems of a block

inline constexpr int problem_block = 128;  // nodes

// Two registers hide the latency of a solver: with one it takes 1.1 to 1.4 times as long.
using solver_pack = std::conditional_t<ILAW_KIT_IS_SPARE, pack_of_one, pack_of<2>>;

template <class Struct, class V>
inline constexpr int numbers_in_struct = static_cast<int>(sizeof(Struct) / sizeof(V));

// Number by number: of all at once compilers make a loop over bytes.
template <class V, class Struct>
ILAW_KIT_INLINE char* place_in(Struct& s, int k) {
  return reinterpret_cast<char*>(&s) + static_cast<std::size_t>(k) * sizeof(V);
}

// Work left on a pack: the answers to its problems, all of it by the careful kernel, or nothing.
enum class pack_state : char { open, careful, stored };

// Where a loop is: in which of its two passes, at which pack of the block, at which of the problems, and the
// pack's first node.
struct pass {
  bool finishing = false;
  int k = 0, first = 0;
  std::int64_t node = 0;
};

// The law's solvers, which may take what prepare gave as well: lanes side by side, and one node.
template <class Law, class Prepared>
ILAW_KIT_INLINE auto solve_lanes(const Law& law, const typename Law::problem& p, typename Law::answer& a,
                                 const Prepared& prepared) {
  if constexpr (requires { law.solve(p, a, prepared); })
    return law.solve(p, a, prepared);
  else
    return law.solve(p, a);
}
template <class Law>
ILAW_KIT_INLINE void solve_one(const Law& law, const step_sizes& step, const typename Law::problem& p,
                               typename Law::answer& a) {
  const auto prepared = kit::prepared(law, step);
  if constexpr (requires { law.solve_scalar(p, a, prepared); })
    law.solve_scalar(p, a, prepared);
  else
    law.solve_scalar(p, a);
}

template <class Law>
struct open_problems {
  using solver = law_on_t<Law, solver_pack>;
  static constexpr int room = problem_block + 16,  // more lanes than any level has: it is laid out alike
      problems = numbers_in_struct<typename solver::problem, solver_pack>,
                       answers = numbers_in_struct<typename solver::answer, solver_pack>;
  static_assert(problems == numbers_in_struct<typename law_on_t<Law, double>::problem, double> &&
                    answers == numbers_in_struct<typename law_on_t<Law, double>::answer, double>,
                "the members of problem and answer must all be of type V");

  alignas(64) double problem[problems][room], answer[answers][room];
  alignas(64) double parameter[parameter_count<Law>][room];  // those that vary from node to node
  std::uint64_t varying = 0;                                 // which: a bit each
  unsigned open[problem_block];                              // by pack: lanes with a problem
  pack_state state[problem_block];
  int count = 0;
  pass at;

  // In full packs; the last is filled up with its first problem. Returns how many the scalar fallback took.
  [[gnu::noinline, gnu::flatten]] int solve(const Law& given, const step_sizes& step,
                                            scalar_function scalar) {
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
      const mask_of<solver_pack> left = solve_lanes(law, p, a, prepared);
      for (int c = 0; c < answers; ++c)
        __builtin_memcpy(answer[c] + first, place_in<solver_pack>(a, c), sizeof(solver_pack));
      if (const unsigned lanes = mask_bits(left)) [[unlikely]]
        for (int k = 0; k < filled; ++k)
          if (lanes >> k & 1) {
            scalar(&given, &step, this, first + k);
            ++by_fallback;
          }
    }
    return by_fallback;
  }
  // A scalar_function.
  [[gnu::noinline]] static void solve_scalar(const void* opaque, const void* step, void* block, int k) {
    using scalar = law_on_t<Law, double>;
    auto& own = *static_cast<open_problems*>(block);
    scalar law = *static_cast<const Law*>(opaque);
    for (int c = 0; c < parameter_count<Law>; ++c)
      if (own.varying >> c & 1) scalar::parameters[c].member.set(law, own.parameter[c][k]);
    typename scalar::problem p;
    typename scalar::answer a{};
    for (int c = 0; c < problems; ++c)
      __builtin_memcpy(place_in<double>(p, c), own.problem[c] + k, sizeof(double));
    solve_one(law, *static_cast<const step_sizes*>(step), p, a);
    for (int c = 0; c < answers; ++c)
      __builtin_memcpy(own.answer[c] + k, place_in<double>(a, c), sizeof(double));
  }

 private:
  void take_parameters(solver& law, int first, int filled) {
    for (int c = 0; c < parameter_count<Law>; ++c)
      if (varying >> c & 1) {
        for (int k = filled; k < solver_pack::size; ++k) parameter[c][first + k] = parameter[c][first];
        __builtin_memcpy(static_cast<void*>(&solver::parameters[c].member.varying_in(law)),
                         parameter[c] + first, sizeof(solver_pack));
      }
  }
};

// ---- the loop

template <class Law, class V, class View, template <class> class Frame, template <class> class Delassus>
struct solver_kernel : kernel<Law, V, View, Frame, Delassus> {
  using base = kernel<Law, V, View, Frame, Delassus>;
  using base::careful;
  using base::width;
  using typename base::checks_type;
  using typename base::loaded;
  using typename base::mask;
  using typename base::node_type;
  using typename base::view_type;
  using typename base::Wide;
  using results = typename node_type::results;
  using careful_kernel =
      std::conditional_t<base::is_projected, solver_kernel<Law, pack_of_one, View, normal_frame, Delassus>,
                         solver_kernel<Law, pack_of_one, View, either_frame, Delassus>>;
  using problem = typename Wide::problem;
  using answer = typename Wide::answer;
  using problems_type = open_problems<Law>;
  static constexpr unsigned all_of_pack = (1U << width) - 1;

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

  // One pack, asked for its problems or, where finishing, with the answers to them. False: it has a bad node.
  ILAW_KIT_INLINE static bool run_pack(const Wide& law, const prepared_t<Wide>& prepared, const view_type& b,
                                       std::int64_t i, checks_type c, tally& found, V& stable_step,
                                       problems_type& all, const pass& at) {
    loaded p = base::load_pack(prepared, b, i, c, at.finishing && !careful);
    base::take_state(p.node, b, i, c);
    const mask bad_input = c.bad();
    if constexpr (!careful)
      if (any(bad_input)) [[unlikely]]
        return false;
    const results came = p.node;
    const int lane = careful ? static_cast<int>(i - at.node) : 0;
    unsigned open = all.open[at.k] >> lane & all_of_pack;
    problem own;
    kit::asked<V> asked{none<V>(), status::free};
    if (!at.finishing || open != all_of_pack) asked = law.ask(p.node, own);
    status_of<V> status = asked.status;
    if (at.finishing) {
      const int first = at.first + __builtin_popcount(all.open[at.k] & ((1U << lane) - 1));
      answer a;
#pragma GCC unroll 64
      for (int k = 0; k < problems_type::answers; ++k)
        get_packed(reinterpret_cast<V*>(&a)[k], open, all.answer[k] + first);
      status = finish(law, p.node, came, a, mask_from<V>(open), status);
    } else {
      open = mask_bits(asked.open & !bad_input);
      all.open[at.k] |= open << lane;
      all.state[at.k] = careful ? pack_state::careful : pack_state::open;
      if (careful || open) {
        keep(law, own, open, all);
        return true;
      }
    }
    base::check_result(p.node, b, c);
    const mask bad = c.bad();
    if constexpr (!careful) {
      if (any(bad)) [[unlikely]] {
        all.state[at.k] = pack_state::careful;
        return !at.finishing;
      }
      all.state[at.k] = pack_state::stored;
    }
    base::store_pack(law, p, b, i, status, !bad);
    add_stable_step(stable_step, law, p.node, !bad);
    if constexpr (careful) base::add_bad(found, c, i);
    return true;
  }
  // Finishes the lanes with an answer from the results that they came with; the others stay as ask left them.
  ILAW_KIT_INLINE static status_of<V> finish(const Wide& law, node_type& n, const results& came,
                                             const answer& a, mask is_open, status_of<V> closed_status) {
    const results closed = n;
    static_cast<results&>(n) = came;
    const status_of<V> finished = law.finish(n, a);
    choose(n, closed, is_open);
    return select(is_open, finished, closed_status);
  }
  ILAW_KIT_INLINE static void choose(results& a, const results& b, mask first) {
    a.impulse = select(first, a.impulse, b.impulse);
    if constexpr (base::spins) a.moment = select(first, a.moment, b.moment);
#pragma GCC unroll 32
    for (int k = 0; k < base::states; ++k) {
      V& x = number_in<V>(a.state, k);
      x = select(first, x, number_in<V>(b.state, k));
    }
    a.stored = select(first, a.stored, b.stored);
    a.normal_gain = select(first, a.normal_gain, b.normal_gain);
    a.tangential_gain = select(first, a.tangential_gain, b.tangential_gain);
    a.rupture = select(first, a.rupture, b.rupture);
    a.rubbing = select(first, a.rubbing, b.rubbing);
    for (int k = 0; k < own_amount_count<Law>; ++k) a.amounts[k] = select(first, a.amounts[k], b.amounts[k]);
    a.refused = select(first, a.refused, b.refused);
  }

  // A careful_function.
  [[gnu::noinline, gnu::cold, gnu::flatten]] static void run_nodes(const void* opaque, const void* view,
                                                                   std::int64_t first, std::int64_t count,
                                                                   void* found, void* problems) {
    auto& all = *static_cast<problems_type*>(problems);
    base::template run_each<solver_kernel>(opaque, view, first, count, found, all, all.at);
  }

  // An ilaw_kit_loop.
  [[gnu::noinline, gnu::flatten]] static void run(const void* opaque, const void* view, void* findings) {
    const Law& given = *static_cast<const Law*>(opaque);
    const view_type b = *static_cast<const view_type*>(view);
    auto& found = *static_cast<tally*>(findings);
    [[maybe_unused]] Wide law = broadcast<V>(given);
    [[maybe_unused]] auto prepared = kit::prepared(law, b.step);
    V stable_step = infinity;
    problems_type all;
    for (int c = 0; c < parameter_count<Law>; ++c)
      if (b.varies(c)) all.varying |= std::uint64_t{1} << c;
    for (std::int64_t start = 0; start < b.count; start += problem_block) {
      const std::int64_t end = b.count - start < problem_block ? b.count : start + problem_block;
      all.count = 0;
      for (pass at{};; at = {.finishing = true}) {
        for (std::int64_t i = start; i < end; i += width, ++at.k) {
          if (at.finishing && all.state[at.k] == pack_state::stored) continue;
          if (!at.finishing) all.open[at.k] = 0;
          bool is_done = false;
          if constexpr (!ILAW_KIT_IS_SPARE) {
            bool is_usual = i + width <= end && !(at.finishing && all.state[at.k] == pack_state::careful);
            if (is_usual && b.varying + b.in_memory) [[unlikely]]
              is_usual = base::get_ready(law, prepared, given, b, i);
            is_done = is_usual && run_pack(law, prepared, b, i, checks_type(), found, stable_step, all, at);
          }
          if (!is_done) [[unlikely]] {
            all.at = at;
            all.at.node = i;
            b.careful(opaque, view, i, end - i < width ? end - i : width, &found, &all);
          }
          if (at.finishing) at.first += __builtin_popcount(all.open[at.k]);
        }
        if (at.finishing) break;
        if (all.count > 0) found.by_scalar_fallback += all.solve(given, b.step, b.scalar);
      }
    }
    collect_stable_step(stable_step, found);
  }
};

}  // namespace ilaw::kit::detail
