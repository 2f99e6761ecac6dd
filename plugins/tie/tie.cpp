// Bilateral bond that may break by the impulses of a window, and is then contact. See tie.md.
#include <ilaw/kit.hpp>
#include <ilaw/kit/window.hpp>

namespace {

using namespace ilaw::kit;

// A pull exactly at the limit holds, whatever the rounding of its windowed sum.
constexpr double at_the_limit = 1.0 + window_slack;

struct tie {
  double strength;
  double force;
  double duration;  // of the window
  double buckets;

  static constexpr law_card card{.id = "tie",
                                 .title = "Bilateral bond, breakable (spot weld)",
                                 .doc =
                                     "Keeps the node at rest relative to the obstacle, in all directions and "
                                     "for any H. Where a strength or a force "
                                     "is given, the bond breaks for good when the impulses of the last "
                                     "memory exceed it in pull and shear "
                                     "together; frictionless contact is left.",
                                 .inputs = reads_gap | reads_v_previous | reads_area,
                                 .capabilities = ILAW_CAN_ADHERE | acts_at_distance | can_rest,
                                 .state_version = 2};

  static constexpr const char* references[] = {
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics"};

  static constexpr parameter<tie> parameters[] = {
      {.member = &tie::strength,
       .name = "strength",
       .symbol = "R_Y",
       .unit = "N.s/m^2",
       .doc = "Impulse per area, over the memory, that the bond can carry in pull and shear.",
       .default_value = infinity,
       .infinity_allowed = true},
      {.member = &tie::force,
       .name = "force",
       .symbol = "F_Y",
       .unit = "N",
       .doc = "Mean force over the memory that the bond of one node can carry, whatever its area.",
       .default_value = infinity,
       .infinity_allowed = true},
      memory_parameter(&tie::duration),
      buckets_parameter(&tie::buckets)};

  struct state {
    double broken;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::broken,
                                                               .name = "broken",
                                                               .doc = "1 once the bond has broken, else 0.",
                                                               .minimum = 0.0,
                                                               .maximum = 1.0,
                                                               .whole = true}};
  static constexpr history_card history_variable = window_variable;

  const char* conflict() const {
    if (force == infinity) return nullptr;
    if (strength < infinity) return "parameters 'strength' and 'force' are two limits, expected one of them";
    return duration > 0.0 && duration < infinity
               ? nullptr
               : "parameter 'force' is a mean over 'memory', which must be above 0 and finite";
  }
  static constexpr std::uint32_t always_reads = reads_v_previous;
  std::uint32_t inputs() const {
    if (strength < infinity) return card.inputs;
    return force < infinity ? reads_gap | reads_v_previous : reads_v_previous;
  }
  std::int64_t history_size() const { return window::doubles(duration, buckets); }

  // Without a limit and memory: nothing to sum.
  struct unbreakable;
  using form_of_floats = unbreakable;
  template <class Run>
  void in_form(Run run) const;

  template <class Node>
  void step(Node& node) const {
    const vector trial = stopping_impulse(node);
    const bool overloads = exceeds(node.earlier + trial, limit(node));
    const bool bonded = node.state.broken == 0.0, holds = bonded & !overloads;
    touch(node);
    hold(node, trial, holds);
    node.status = (bonded & overloads) ? status::broken : node.status;
    node.state.broken = holds ? 0.0 : 1.0;
  }

  // Bonded, holding, and without work to take off. One comparison: of two GCC makes branches.
  template <class Node>
  bool try_step(Node& node) const {
    node.impulse = whole_stopping_impulse(node);
    node.status = status::bonded;
    const double work = positive_part(doubled_work(node, node.impulse));
    const bool overloads = exceeds(node.earlier + node.impulse, limit(node));
    return node.state.broken + work + (overloads ? 1.0 : 0.0) == 0.0;
  }

  window_in_step window_in(step_interval step) const { return {duration, buckets, step}; }
  // A broken bond needs no window any more.
  static bool adds_to_window(double s) { return s == status::bonded; }
  static bool clears_window(double s) { return s == status::broken; }

 private:
  // Not a number: inf, and no area is read.
  template <class Node>
  double limit(const Node& node) const {
    return (force < infinity ? force * duration : strength * node.area) * at_the_limit;
  }
  // Pull and shear count alike, a press does not: nothing is torn by it.
  static bool exceeds(vector sum, double limit) {
    const scaled_length<double> load = scaled_length_of(positive_part(-sum.n), sum.t1, sum.t2);
    return load.square > (load.down * limit) * (load.down * limit);
  }

  template <class Node>
  static void touch(Node& node) {
    const contact_condition contact = contact_leaving_at(0.0, node.gap, node.v_free.n, node.v_previous.n);
    node.impulse.n = contact.slack <= 0.0 ? positive_part(-contact.excess / node.delassus.normal()) : 0.0;
    node.status = node.impulse.n > 0.0 ? status::closed : status::free;
  }

  template <class Node>
  static void hold(Node& node, vector trial, bool holds) {
    node.impulse = {holds ? trial.n : node.impulse.n, holds ? trial.t1 : 0.0, holds ? trial.t2 : 0.0};
    node.status = holds ? status::bonded : node.status;
  }
};

struct tie::unbreakable : tie {
  static constexpr bool forgets = true, takes_two_packs = true;
  template <class Node>
  void step(Node& node) const {
    const vector trial = stopping_impulse(node);
    touch(node);  // if the state says broken, by a strength that there was
    hold(node, trial, node.state.broken == 0.0);
  }
  // Bonded, and without work to take off. One comparison: of two GCC makes branches.
  template <class Node>
  bool try_step(Node& node) const {
    node.impulse = whole_stopping_impulse(node);
    node.status = status::bonded;
    return node.state.broken + positive_part(doubled_work(node, node.impulse)) == 0.0;
  }
};

template <class Run>
void tie::in_form(Run run) const {
  if (strength == infinity && duration == 0.0)
    run(unbreakable{*this});
  else
    run(*this);
}

}  // namespace

ILAW_PLUGIN("tie", "1.0.0", "ilaw", "BSD-3-Clause", tie)
