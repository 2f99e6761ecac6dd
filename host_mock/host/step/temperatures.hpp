// temperatures.hpp - the temperatures of nodes, at half steps as velocities are:
//   T_free = T_{n+1/2} + C^-1 h (q(t_{n+1}) - K T_{n+1/2}),  T_{n+3/2} = T_free + C^-1 Q,
// Q the heat of the laws and of the exchange in the step. The start has half a step. Laws see T_free as they
// see v_free. Source: explicit conduction with lumped capacities (Bathe 2014, section 9.6).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"
#include "model/load.hpp"
#include "model/thermal_model.hpp"
#include "step/heat_exchange.hpp"

#include <array>
#include <iosfwd>
#include <utility>
#include <vector>

namespace ilaw::host {

// Since time 0.
struct HeatReport {
  double stored = 0.0;     // sum of C (T - T_0)
  double obstacles = 0.0;  // into obstacles
  double friction = 0.0;   // by the laws
  double supplied = 0.0;   // by held temperatures and fluxes
  double balance_error = 0.0;
  double lowest = 0.0, highest = 0.0;  // temperature, now
};

// Its parts as results name them.
inline std::array<std::pair<const char*, double>, 4> named(const HeatReport& heat) {
  return {{{"stored", heat.stored},
           {"obstacles", heat.obstacles},
           {"friction", heat.friction},
           {"supplied", heat.supplied}}};
}

class Temperatures {
 public:
  // Interfaces read the temperatures from here.
  Temperatures(const ThermalModel& model, const Loads& loads, const Interfaces& interfaces);

  // Sets T_free. take() then makes the temperatures at the end of the step; where one is not finite, it
  // keeps those before the step and returns false.
  void conduct(StepTimes step);
  [[nodiscard]] bool take(const Interfaces& interfaces);

  // The temperature of a node that has one, at the half step after time().
  double at(int node) const { return model_.initial_temperature()[node] + rise_[node]; }
  HeatReport report() const;

  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  using Sum = long double;
  struct Sums {
    Sum obstacles = 0, friction = 0, supplied = 0;
    double largest = 0.0;  // of the sums, and of the sum of C |T - T_0|
  };
  struct Held {
    int node;
    const HeatLoad* load;
  };
  // Adds what holding takes to the heat that was supplied.
  void hold(double time);
  void add_friction(const Interface& interface, std::int32_t contact);
  template <class Visit>
  void for_each_conducting(const Interfaces& interfaces, Visit visit) const;
  void exchange(const Interfaces& interfaces);
  Sum stored() const;
  void publish();

  const ThermalModel& model_;
  std::vector<Held> held_;
  std::vector<const HeatLoad*> fluxes_;
  // T - T_0, so that small rises close their balance, too.
  Dofs rise_, free_rise_;
  Dofs temperature_, capacity_;  // T_free, and capacities as laws see them: infinite where T is held
  Dofs softness_;                // 1/capacity_, 0 without a temperature
  HeatExchange exchange_;
  Dofs heat_;                // scratch
  Sums sums_, sums_before_;  // sums_before_: of the last complete step
  double held_at_ = 0.0;     // the time at which temperatures are held: the end of the step
};

}  // namespace ilaw::host
