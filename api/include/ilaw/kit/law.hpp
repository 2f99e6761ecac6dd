// law.hpp - how a law describes itself, and every name that it may define.
//
// A law is one struct template on its number type V (pack.hpp). Its members are its parameters, each with an
// entry of parameters[]: V may vary from node to node and in time, double is the same at all nodes and fixed
// at create, grid is a table that the step reads itself (table.hpp).
//
// clang-format off
//   is    card, references, parameters       what it is called, serves and reads
//         state, state_variables             named memory (below)
//         history                            what its window is called in the state
//         amounts                            scalars that it gives per node and step; heat and wear are below
//   does  step(node)                         its equations in closed form; returns the status
//         problem, answer                    where a solver is needed, structs whose members are V, for the step
//                                            in parts:
//         ask(node, problem)                 what a node leaves to the solver, and its status as if nothing were
//         solve(problem, answer, prepared)   in full packs; returns the lanes left to solve_scalar
//         solve_scalar(problem, answer, prepared)   the same for a double
//         finish(node, answer)               the status with the answer
//         asks(), asks(bool is_transverse)   whether these parameters need the solver, where step and ask both
//                                            serve a node
//         prepare(step_sizes)                numbers that all nodes of a batch share; node.prepared
//         initialise(node)                   first state (default: zeros)
//         conflict()                         why parameters do not go together, or null
//         inputs(), capabilities(), permissions()   with these parameters (default: the card's)
//         tells_tangents_apart()             whether these parameters need a tangent per node in the host's axes
//         stable_velocity_step(node)         the largest stable step, 2/w of a spring of frequency w
//         window(), adds_to_window(status), clears_window(status)   of a history (window.hpp)
//         extension(name)                    see ilaw_law
// clang-format on
//
// step, ask and finish are const templates on the node (node.hpp); solve and solve_scalar may be static and
// go without prepared; all others are called with V = double. A law gives no other option: what can be
// switched stands in its card.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>
#include <ilaw/kit/pack.hpp>
#include <ilaw/kit/table.hpp>
#include <ilaw/kit/vector.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <iterator>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

inline constexpr std::uint32_t reads_gap = ILAW_INPUT_GAP, reads_v_previous = ILAW_INPUT_V_PREVIOUS,
                               reads_area = ILAW_INPUT_AREA, reads_v_smooth = ILAW_INPUT_V_SMOOTH;
inline constexpr std::uint32_t can_adhere = ILAW_CAN_ADHERE, can_store_energy = ILAW_CAN_STORE_ENERGY,
                               can_hold_bonds = ILAW_CAN_HOLD_BONDS;
inline constexpr std::uint32_t may_skip_fresh = ILAW_MAY_SKIP_FRESH, may_skip_free = ILAW_MAY_SKIP_FREE;
inline constexpr std::uint32_t all_dimensions = ILAW_DIMENSION_1 | ILAW_DIMENSION_2 | ILAW_DIMENSION_3;
inline constexpr std::uint32_t all_delassus_forms =
    ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_DIAGONAL | ILAW_DELASSUS_FULL | ILAW_DELASSUS_TRANSVERSE;
inline constexpr std::uint32_t with_spins = ILAW_DELASSUS_TRANSVERSE_SPIN;

struct law_card {
  const char* id;
  const char* title;
  const char* doc;
  std::uint32_t dimensions = all_dimensions;
  std::uint32_t delassus_forms = all_delassus_forms;
  std::uint32_t inputs = reads_gap;
  std::uint32_t capabilities = 0;
  std::uint32_t permissions = 0;    // promises to a host, see ilaw.h
  std::uint32_t state_version = 1;  // raised with every change of what a state means
  // No step or ask without tells_tangents_apart() names t1 or t2, and no vector is remembered: then nodes in
  // the host's axes need no tangent.
  bool is_isotropic = false;
  // It gives all that rupture dissipates as node.rupture: what else a step that breaks dissipates is friction
  // and impact.
  bool gives_rupture = false;
};

// A list of texts of static storage.
struct texts {
  const char* const* values = nullptr;
  std::uint32_t count = 0;

  constexpr texts() = default;
  template <std::size_t N>
  constexpr texts(const char* const (&list)[N]) : values(list), count(N) {}
  constexpr const char* const* begin() const { return values; }
  constexpr const char* const* end() const { return values + count; }
};
inline constexpr const char* over_time[] = {"time"};

// The number type of a law that is a template on it.
template <class Law>
struct number_of_law;
template <template <class> class Law, class V>
struct number_of_law<Law<V>> {
  using type = V;
};

// The member that holds a parameter.
template <class Law>
class parameter_member {
  using number = typename number_of_law<Law>::type;
  struct none {};

 public:
  constexpr parameter_member() = default;
  constexpr parameter_member(number Law::*member) : varying_(member) {}
  constexpr parameter_member(std::conditional_t<std::is_same_v<number, double>, none, double Law::*> member)
      : fixed_(member) {}
  constexpr parameter_member(grid Law::*member) : grid_(member) {}

  constexpr bool is_given() const { return varying_ || fixed_ || grid_; }
  constexpr bool is_grid() const { return grid_; }
  constexpr bool may_vary() const { return varying_; }  // not known where V is double
  constexpr bool operator==(const parameter_member&) const = default;
  template <class Either>  // Law, or const Law
  ILAW_KIT_INLINE auto& varying_in(Either& law) const {
    return law.*varying_;
  }
  ILAW_KIT_INLINE void set(Law& law, double value) const {
    if (varying_)
      law.*varying_ = value;
    else if (fixed_)
      law.*fixed_ = value;
  }
  void set(Law& law, double value, table& own) const {
    set(law, value);
    own.constant = value;
    if (grid_) law.*grid_ = grid(own);
  }
  template <class From>
  ILAW_KIT_INLINE void copy(Law& law, const parameter_member<From>& member, const From& from) const {
    if (grid_)
      law.*grid_ = from.*member.grid_;
    else
      set(law, member.get(from));
  }
  ILAW_KIT_INLINE double get(const Law& law) const requires std::is_same_v<number, double> {
    return grid_ ? not_a_number : law.*varying_;
  }

 private:
  template <class>
  friend class parameter_member;
  number Law::*varying_ = nullptr;
  double Law::*fixed_ = nullptr;
  grid Law::*grid_ = nullptr;
};

namespace detail {

// The values that a parameter may have, for numbers and packs.
struct parameter_range {
  double minimum, excluded, maximum, beyond;

  constexpr parameter_range(double least, bool excludes, double most, bool allows_infinity)
      : minimum(least),
        excluded(excludes ? least : not_a_number),
        maximum(smaller(most, std::numeric_limits<double>::max())),
        beyond(allows_infinity ? infinity : not_a_number) {}
  template <class V>
  ILAW_KIT_INLINE auto has(V value) const {
    return (value >= minimum) & (value != excluded) & ((value <= maximum) | (value == beyond));
  }
};

}  // namespace detail

template <class Law>
struct parameter {
  parameter_member<Law> member;
  const char* name;
  const char* symbol = "";
  const char* unit = "1";
  const char* doc = "";
  double default_value = 0.0;
  double minimum = 0.0;
  double maximum = std::numeric_limits<double>::max();
  bool required = false;
  bool minimum_excluded = false;
  bool infinity_allowed = false;
  bool whole = false;
  bool is_field = false;     // of the host's model, such as a temperature
  bool needs_spins = false;  // refused for forms of H without
  texts choices = {};        // a choice: the member is double and holds the index
  texts axes = over_time;    // over which a V or a grid may be a table

  constexpr detail::parameter_range range() const {
    return {minimum, minimum_excluded, maximum, infinity_allowed};
  }
  // Copies that differ in one thing.
  constexpr parameter with_doc(const char* text) const {
    parameter copy = *this;
    copy.doc = text;
    return copy;
  }
  constexpr parameter with_default(double value) const {
    parameter copy = *this;
    copy.default_value = value;
    return copy;
  }
  constexpr parameter as_required() const {
    parameter copy = *this;
    copy.required = true;
    return copy;
  }
};

// A scalar of a node and step; see ilaw_amount.
struct amount_card {
  const char* name;
  const char* unit = "1";
  const char* doc = "";
};

// The steps of a batch, the same at all its nodes.
struct step_sizes {
  double time, velocity_step, position_step, per_position_step;
};

// Who decides whether bonds hold in a step: the law, or a host that solves contacts together.
enum class bonds { decided_by_law, hold, break_all };

// ---- questions about a law, L<V>

template <class Law>
concept has_state = requires {
  typename Law::state;
};
template <class Law>
concept has_window = requires(const Law& law) {
  Law::history;
  { law.window().duration } -> std::convertible_to<double>;
  { Law::adds_to_window(ilaw_status{}) } -> std::same_as<bool>;
  { Law::clears_window(ilaw_status{}) } -> std::same_as<bool>;
};
template <class Law>
concept has_amounts = requires {
  Law::amounts;
};

struct stateless {};
namespace detail {
template <class Law>
struct state_of {
  using type = stateless;
};
template <has_state Law>
struct state_of<Law> {
  using type = typename Law::state;
};
}  // namespace detail
template <class Law>
using state_t = typename detail::state_of<Law>::type;

// Numbers in struct state; a vector has three, a tangential one two.
template <class Law>
inline constexpr int state_numbers =
    has_state<Law> ? static_cast<int>(sizeof(state_t<Law>) / sizeof(typename number_of_law<Law>::type)) : 0;
// See below.
template <class Law>
concept gives_heat = requires(const Law& law) {
  law.heat_partition;
  law.wear_coefficient;
};
inline constexpr int heat_amount_count = 3;
// Amounts that the law's step writes, and all of them.
template <class Law>
inline constexpr int own_amount_count = [] {
  if constexpr (has_amounts<Law>) return static_cast<int>(std::size(Law::amounts));
  return 0;
}();
template <class Law>
inline constexpr int amount_count = own_amount_count<Law> + (gives_heat<Law> ? heat_amount_count : 0);
template <class Law>
inline constexpr int parameter_count = static_cast<int>(std::size(Law::parameters));

struct unprepared {};
template <class Law>
ILAW_KIT_INLINE auto prepared(const Law& law, const step_sizes& step) {
  if constexpr (requires { law.prepare(step); })
    return law.prepare(step);
  else
    return unprepared{};
}
template <class Law>
using prepared_t = decltype(prepared(std::declval<const Law&>(), std::declval<const step_sizes&>()));

template <class Law>
inline constexpr bool reads(std::uint32_t input) {
  return (Law::card.inputs & input) != 0;
}

// ---- heat and wear of what slides

// A law whose parameters have the members heat_partition and wear_coefficient gives three amounts after its
// own, which the kit computes where a host asks for them.

template <class Law>
constexpr parameter<Law> heat_partition_parameter(typename number_of_law<Law>::type Law::*member) {
  return {.member = member,
          .name = "heat_partition",
          .symbol = "eta",
          .doc = "Part of the frictional heat that flows into the body; the rest flows into its counterpart.",
          .default_value = 0.5,
          .maximum = 1.0};
}
template <class Law>
constexpr parameter<Law> wear_coefficient_parameter(typename number_of_law<Law>::type Law::*member) {
  return {.member = member,
          .name = "wear_coefficient",
          .symbol = "k_w",
          .unit = "m^2/N",
          .doc = "Depth taken off per pressure and slip (Archard 1953)."};
}

namespace detail {

inline constexpr amount_card heat_amounts[] = {
    {.name = "heat", .unit = "J", .doc = "Frictional heat of the step into the body."},
    {.name = "counterpart_heat", .unit = "J", .doc = "The same into the counterpart."},
    {.name = "wear", .unit = "m", .doc = "Depth taken off in the step: k_w p |v_T| h."}};

}  // namespace detail

// ---- what a node remembers

// One entry per member of struct state, which says where the number stands and, by the member's type, what it
// is. Order and size cannot differ.
//   struct state { V damage; vector<V> opening; tangential_vector<V> slip; };
//   static constexpr state_variable<state> state_variables[] = {
//       {.member = &state::damage, .name = "damage", .maximum = 1.0, ...}, ...};
// A host finds the variables in the order of their entries, whatever that of the struct is.

// The member of a struct state that a variable describes: all of it, or one component of a vector, which then
// has entries for all three.
template <class State>
class state_member {
 public:
  constexpr state_member() = default;
  constexpr state_member(double State::*member) : scalar_(member) {}
  constexpr state_member(vector<double> State::*member) : vector_(member), kind_(ILAW_KIND_VECTOR) {}
  constexpr state_member(vector<double> State::*member, double vector<double>::*component)
      : vector_(member),
        component_(component),
        kind_(component == &vector<double>::n ? ILAW_KIND_SCALAR : ILAW_KIND_HISTORY) {}
  constexpr state_member(tangential_vector<double> State::*member)
      : tangential_(member), kind_(ILAW_KIND_TANGENTIAL) {}

  constexpr bool is_given() const { return scalar_ || vector_ || tangential_; }
  constexpr std::uint32_t kind() const { return kind_; }
  constexpr int numbers() const {  // in struct state
    return kind_ == ILAW_KIND_VECTOR ? 3 : (kind_ == ILAW_KIND_TANGENTIAL ? 2 : 1);
  }
  constexpr int components(int dimension) const {  // in the host's state
    if (kind_ == ILAW_KIND_TANGENTIAL) return dimension - 1;
    return kind_ == ILAW_KIND_VECTOR ? dimension : 1;
  }

  // Which number of struct state is its first one: the one that changes with it.
  constexpr int place() const {
    const auto before = marked(1.0), after = marked(2.0);
    int k = 0;
    while (before[static_cast<std::size_t>(k)] == after[static_cast<std::size_t>(k)]) ++k;
    return k;
  }

 private:
  constexpr auto marked(double value) const {
    State s{};
    if (scalar_) s.*scalar_ = value;
    if (vector_) (s.*vector_).*(component_ ? component_ : &vector<double>::n) = value;
    if (tangential_) (s.*tangential_).t1 = value;
    return std::bit_cast<std::array<double, sizeof(State) / sizeof(double)>>(s);
  }

  double State::*scalar_ = nullptr;
  vector<double> State::*vector_ = nullptr;
  double vector<double>::*component_ = nullptr;
  tangential_vector<double> State::*tangential_ = nullptr;
  std::uint32_t kind_ = ILAW_KIND_SCALAR;
};

template <class State>
struct state_variable {
  state_member<State> member;
  const char* name;
  const char* unit = "1";
  const char* doc = "";
  bool internal = false;  // bookkeeping, not for pictures
  // Allowed values of a scalar; a host's state with anything else is bad input. All are finite.
  double minimum = -std::numeric_limits<double>::max();
  double maximum = std::numeric_limits<double>::max();
  bool whole = false;

  constexpr bool has_range() const {
    return whole || minimum > -std::numeric_limits<double>::max() ||
           maximum < std::numeric_limits<double>::max();
  }
  // Expects finite values.
  template <class V>
  ILAW_KIT_INLINE mask_of<V> may_be(V value) const {
    if (whole && minimum == 0.0 && maximum == 1.0) return value * value == value;
    if (!whole && maximum == std::numeric_limits<double>::max()) return value >= minimum;
    const auto inside = (value >= minimum) & (value <= maximum);
    return whole ? inside & is_whole(value) : inside;
  }
};

// What a law's window is called in the host's state.
struct history_card {
  const char* name;
  const char* unit = "1";
  const char* doc = "";
  bool internal = false;
};

// Whether a law remembers directions, which turn with the frame.
template <class Law>
constexpr bool has_vector_state() {
  if constexpr (has_state<Law>)
    for (const auto& v : Law::state_variables)
      if (v.member.kind() != ILAW_KIND_SCALAR) return true;
  return false;
}

namespace detail {

// Where the variables of L<double> stand in struct state.
template <class Law>
inline constexpr auto state_places = [] {
  if constexpr (has_state<Law>) {
    std::array<int, std::size(Law::state_variables)> places{};
    for (std::size_t v = 0; v < places.size(); ++v) places[v] = Law::state_variables[v].member.place();
    return places;
  } else {
    return std::array<int, 1>{};
  }
}();

// Entry of the host's state that holds number k of struct state; -1: a component beyond the dimension.
template <class Law>
constexpr int state_entry(int k, int dimension) {
  int entry = 0;
  if constexpr (has_state<Law>)
    for (std::size_t v = 0; v < std::size(Law::state_variables); ++v) {
      const auto& member = Law::state_variables[v].member;
      const int component = k - state_places<Law>[v];
      if (component >= 0 && component < member.numbers())
        return component < member.components(dimension) ? entry + component : -1;
      entry += member.components(dimension);
    }
  return -1;
}

// The entries of the host's state in which the numbers of a state stand, of each dimension; see batch_walk.
// In the order of the entries in space.
template <class Law>
inline constexpr auto state_entries = [] {
  std::array<std::array<int, static_cast<std::size_t>(state_numbers<Law>) + 1>, 4> all{};
  for (int d = 1; d <= 3; ++d)
    for (int k = 0; k < state_numbers<Law>; ++k)
      all[static_cast<std::size_t>(d)][static_cast<std::size_t>(state_entry<Law>(k, 3))] =
          state_entry<Law>(k, d);
  return all;
}();

// ---- the state of a node as an array of numbers, in the order of the struct or of the host

template <class V, class State>
ILAW_KIT_INLINE V& number_in(State& state, int k) {
  return reinterpret_cast<V*>(&state)[k];
}
template <class V, class State>
ILAW_KIT_INLINE const V& number_in(const State& state, int k) {
  return reinterpret_cast<const V*>(&state)[k];
}

// Between the struct and the host's entries in space; the walk brings states of fewer dimensions to the same
// order, with zeros.
template <class Law, class State, class V, int Count, std::size_t... K>
ILAW_KIT_INLINE void to_struct(State& state, const V (&entries)[Count], std::index_sequence<K...>) {
  ((number_in<V>(state, static_cast<int>(K)) = entries[state_entry<Law>(static_cast<int>(K), 3)]), ...);
}
template <class Law, class State, class V, int Count, std::size_t... K>
ILAW_KIT_INLINE void from_struct(V (&entries)[Count], const State& state, std::index_sequence<K...>) {
  ((entries[state_entry<Law>(static_cast<int>(K), 3)] = number_in<V>(state, static_cast<int>(K))), ...);
}

}  // namespace detail

}  // namespace ilaw::kit
