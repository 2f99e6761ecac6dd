// energy.hpp - the discrete energy balance of central difference, which closes to rounding for any
// law.
//   E_n = 1/2 V_{n+1/2}^T M V_{n+1/2} + I_n,   E_{n+1} - E_n = (W_ext + W_int) of the step,
// with the work of an impulse p over a step p . (V_{n+1/2} + V_{n+3/2})/2. For f_int = K u the
// internal part is I_n = 1/2 U_n^T K U_{n+1}, worked out from the state at the end: the balance is
// then an identity that only a correct scheme fulfils. For other models I_n is the sum of -h
// f_int . (V_{n+1/2} + V_{n+3/2})/2; how far it is from the potential of U_n tells the scheme's own
// energy error.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vector.hpp"
#include "model/model.hpp"

#include <ilaw/ilaw.h>

#include <array>
#include <iosfwd>
#include <utility>

namespace ilaw::host {

struct EnergyReport {
  double kinetic, internal, potential, external_work, damping_work, interface_work, balance_error;
  std::array<double, ILAW_ENERGY_COUNT> by_law;  // friction, impact, rupture dissipated; stored now
  double least_dissipation;                      // smallest dissipation of one node in one step, >= 0
  double reaction_work;                          // interface_work + dissipated + stored: see docs/scenes.md
  double scale;                                  // largest energy or work so far
};

// Its parts as results name them.
inline std::array<std::pair<const char*, double>, 10> named(const EnergyReport& energy) {
  const auto& by_law = energy.by_law;
  return {{{"kinetic", energy.kinetic},
           {"internal", energy.internal},
           {"potential", energy.potential},
           {"external_work", energy.external_work},
           {"damping_work", energy.damping_work},
           {"interface_work", energy.interface_work},
           {"dissipated_friction", by_law[ILAW_ENERGY_FRICTION]},
           {"dissipated_impact", by_law[ILAW_ENERGY_IMPACT]},
           {"dissipated_rupture", by_law[ILAW_ENERGY_RUPTURE]},
           {"stored", by_law[ILAW_ENERGY_STORED]}}};
}

class EnergyBalance {
 public:
  // The state (U_0, V_{1/2}) and U_1 that follows from it.
  void start(const Model& model, const Dofs& u, const Dofs& u_next, const Dofs& v);

  // Work on the way to that state, which is booked apart.
  void take_from_initial(double work) { sums_.initial -= work; }
  void add_external(long double work);
  // Impulses of a step, per degree of freedom, with the velocities at its ends.
  void add_damping(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after);
  void add_internal(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after);
  // Work of an interface on the bodies: in all, and relative to moving obstacles, to compare with
  // what the laws dissipated.
  void add_interface(double work, double relative_work);
  // The energy that the laws of an interface dissipated in a step, and the least of a node.
  void add_dissipation(const std::array<double, ILAW_ENERGY_COUNT>& energy, double least);
  double largest() const { return sums_.largest; }  // of energies and works so far
  // An upper bound of the energy that was put in: what there was at the start, what loads and moving
  // obstacles added, and the most that interfaces have stored.
  double put_in() const { return sums_.put_in + sums_.most_stored; }
  void set_stored(double energy);
  void begin_with_stored(double energy) { sums_.stored_before = sums_.most_stored = energy; }

  EnergyReport report(const Model& model, const Dofs& u, const Dofs& u_next, const Dofs& v) const;

  // So far; without what a report costs beside it.
  double interface_work() const { return static_cast<double>(sums_.interface_work); }

  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  // Extended precision: the sums run over millions of steps and must close to 1e-12.
  using Sum = long double;
  struct Sums {
    Sum initial = 0, external_work = 0, damping_work = 0, internal_work = 0, interface_work = 0,
        relative_work = 0;
    double least_dissipation = 0.0;
    double largest = 0.0;  // of the energies and works so far
    double put_in = 0.0, most_stored = 0.0;
    double stored_before = 0.0;  // by interfaces, in a prestress
  };
  static constexpr std::array all_sums{&Sums::initial,       &Sums::external_work,  &Sums::damping_work,
                                       &Sums::internal_work, &Sums::interface_work, &Sums::relative_work};
  static constexpr std::array all_extremes{&Sums::least_dissipation, &Sums::largest, &Sums::put_in,
                                           &Sums::most_stored, &Sums::stored_before};
  void note_size(Sum energy);

  Sums sums_;
  std::array<Sum, ILAW_ENERGY_COUNT> by_law_{};
};

// The work of an impulse over a step, and the largest speed at its end: one pass over the velocities.
struct WorkAndSpeed {
  long double work;
  double speed;
};
WorkAndSpeed work_and_speed(const Dofs& impulse, const Dofs& v_before, const Dofs& v_after,
                            Eigen::Index dimension);

double kinetic_energy(const Model& model, const Dofs& v);
// About the origin: one component in 2D, three in 3D, none in 1D.
Vector angular_momentum(const Model& model, const Dofs& u, const Dofs& v);

}  // namespace ilaw::host
