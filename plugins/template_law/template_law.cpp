// A law to copy: a dashpot that pushes and never pulls. See template_law.md for the equations and for what to
// replace.
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

template <class V>
struct template_law {
  V damping;

  static constexpr law_card card{.id = "template_law",
                                 .title = "One-sided dashpot",
                                 .doc =
                                     "Where the gap is closed, a pressure proportional to the speed of "
                                     "approach; nothing where the bodies separate, or turn back no faster "
                                     "than they were separating.",
                                 .inputs = reads_gap | reads_v_previous | reads_area,
                                 .permissions = may_skip_fresh,
                                 .is_isotropic = true};

  static constexpr const char* references[] = {"The linear dashpot, made one-sided by this project"};

  static constexpr parameter<template_law> parameters[] = {{.member = &template_law::damping,
                                                            .name = "damping",
                                                            .symbol = "c",
                                                            .unit = "N.s/m^3",
                                                            .doc = "Pressure over the speed of approach.",
                                                            .required = true}};

  // r_N = h c A <-(v_N + <v_N^->)>, v_N = v_free + H_NN r_N, solved for r_N: the dashpot is one more inverse
  // mass beside H_NN. The work r_N (v_N^- + v_N)/2 is never positive (friction.hpp says why).
  template <class Node>
  status_of<V> step(Node& node) const {
    const V compliance = 1.0 / (node.velocity_step * damping * node.area);
    const contact_condition<V> contact =
        contact_leaving_at<V>(0.0, node.gap, node.v_free.n, node.v_previous.n);
    const V impulse = positive_part(-contact.excess / (node.delassus.normal() + compliance));
    node.impulse.n = zero_unless(contact.slack <= 0.0, impulse);
    return select(node.impulse.n > 0.0, status::closed, status::free);
  }
};

}  // namespace

ILAW_PLUGIN("template_law", "1.0.0", "ilaw", "BSD-3-Clause", template_law)
