// RCCM: adhesion that viscosity delays, with contact and friction. See rccm.md for the equations.
#include "../bond/bond.hpp"

#include <ilaw/kit/law.hpp>
#include <ilaw/kit/plugin.hpp>

namespace {

using namespace bond_law;
using namespace ilaw::kit;

template <class V>
struct rccm : adhesive_bond<rccm, V> {
  V normal_stiffness;
  V tangential_stiffness;
  V adhesion_energy;
  V viscosity;
  V friction;
  V initial_intensity;
  V heat_partition;
  V wear_coefficient;

  static constexpr law_card card{
      .id = "rccm",
      .title = "Adhesion with viscosity, contact and friction (RCCM)",
      .doc =
          "Bond of Raous, Cangemi and Cocou: adhesion weakens with the energy of the opening, at a rate that "
          "viscosity limits; contact and friction take over. Any H.",
      .inputs = reads_gap | reads_v_previous | reads_area,
      .capabilities = can_adhere | can_store_energy,
      .permissions = may_skip_free,
      .gives_rupture = true};

  static constexpr const char* references[] = {
      "M. Raous, L. Cangemi, M. Cocu, 1999, A consistent model coupling adhesion, friction, and unilateral contact",
      "Y. Monerie, M. Raous, 2000, A model coupling adhesion to friction, for a crack and a fibre",
      "P. Larousse, D. Dureisseix, A. Gravouil, J. Georges, 2024, Computational Mechanics"};

  static constexpr parameter<rccm> parameters[] = {
      {.member = &rccm::normal_stiffness,
       .name = "normal_stiffness",
       .symbol = "C_N",
       .unit = "N/m^3",
       .doc = "Stiffness per area of the intact bond against opening.",
       .required = true,
       .minimum_excluded = true},
      {.member = &rccm::tangential_stiffness,
       .name = "tangential_stiffness",
       .symbol = "C_T",
       .unit = "N/m^3",
       .doc = "The same against slip.",
       .required = true,
       .minimum_excluded = true},
      {.member = &rccm::adhesion_energy,
       .name = "adhesion_energy",
       .symbol = "w",
       .unit = "J/m^2",
       .doc = "Dupre's energy: what takes the adhesion off slowly.",
       .required = true},
      {.member = &rccm::viscosity,
       .name = "viscosity",
       .symbol = "b",
       .unit = "N.s/m",
       .doc = "Excess of energy over the rate at which adhesion falls; 0: it falls at once."},
      friction_parameter(&rccm::friction).with_doc("Coefficient without adhesion."),
      {.member = &rccm::initial_intensity,
       .name = "initial_intensity",
       .symbol = "beta_0",
       .doc = "Intensity of adhesion at the start; 0: none.",
       .default_value = 1.0,
       .maximum = 1.0},
      heat_partition_parameter(&rccm::heat_partition),
      wear_coefficient_parameter(&rccm::wear_coefficient)};

  static constexpr double broken = 0.0;
  static constexpr auto state_variables = bond_variables("intensity", "1: intact, 0: no adhesion.");

  template <class Node>
  void initialise(Node& node) const {
    node.state.memory = initial_intensity;
  }

  using common = bond_common<V>;
  common prepare(const step_sizes& step) const { return {step, tangential_stiffness / normal_stiffness}; }

  static V broken_part(V beta, const common&) { return 1.0 - beta; }
  V energy(V beta, V y, const common&) const { return 0.5 * normal_stiffness * (beta * y) * (beta * y); }

  // Adhesion stays where its energy is not above w.
  template <class Step>
  void as_it_was(const Step& step, V beta, const common& all, bond_result<Step>& found) const {
    const V kappa = mean_kappa(step, beta, beta);
    step.move(found.motion, kappa, this->friction_of(beta, all));
    found.holds = step.has_scale(kappa) & (beta * mean_square(step, found.motion) <= adhesion_energy);
  }

  // (beta^- + beta) q/2 - w - b (beta^- - beta)/h = 0, or beta = 0 where that is positive still. One root
  // where the bond is not stiff for the step (rccm.md); else they are counted.
  template <class Step>
  void change(const Step& step, mask_of<V> where, const common& all, bond_result<Step>& found) const {
    const V before = found.memory, rate = viscosity / all.step.velocity_step,
            most = mean_kappa(step, before, before);
    const auto trial = [&](V beta) ILAW_KIT_LAMBDA {
      step.move(found.motion, mean_kappa(step, before, beta), this->mean_friction(before, beta, all));
      found.left = found.left | (where & found.motion.unsolved);
      const V q = mean_square(step, found.motion), size = 0.5 * q + rate, sum = before + beta;
      const V softer = 0.5 * sum * normal_stiffness * step.compliance * normal_stiffness * beta;
      return root_trial<V>{0.5 * sum * q - adhesion_energy - rate * (before - beta), size,
                           size - softer * step.gives_way(found.motion), 1.0, step.is_smooth(found.motion)};
    };
    const mask_of<V> is_unique = step.has_scale(most) & (most * step.trace() <= 0.25);
    if constexpr (std::is_same_v<V, double>) {
      if (!is_unique && changes_sign_again([&](double part) { return trial(before * (1.0 - part)).value; }))
        found.refused = static_cast<double>(refusal::several_solutions);
    } else {
      found.left = where & !is_unique;
      where = where & is_unique;
    }
    found.memory = root_between(V(0.0), before, before, where, trial);
  }

 private:
  // k = C_N ((beta^-)^2 + beta^2)/2, as kappa, and q = C_N <u_N>^2 + C_T |u_T|^2, the mean of both ends.
  template <class Step>
  V mean_kappa(const Step& step, V before, V beta) const {
    return step.compliance * (0.5 * normal_stiffness * (before * before + beta * beta));
  }
  template <class Step>
  V mean_square(const Step& step, const typename Step::motion& m) const {
    return 0.5 * normal_stiffness * (m.size * m.size + step.before * step.before);
  }
};

}  // namespace

ILAW_PLUGIN("rccm", "1.0.0", "ilaw", "BSD-3-Clause", rccm)
