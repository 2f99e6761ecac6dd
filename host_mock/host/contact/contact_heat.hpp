// contact_heat.hpp - temperatures that contacts hand to their law, and the heat that they take from it. The
// host owns both: a law's fields `temperature`, `heat_capacity` and those of the counterpart, and its amounts
// `heat`, `counterpart_heat` and `heat_per_kelvin` (docs/abi.md). The host finds the conducted heat itself
// (step/heat_exchange.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/contact_arrays.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace ilaw::host {

class ContactHeat {
 public:
  // The fields, in the order of inputs_.
  static constexpr std::array field_names{"temperature", "counterpart_temperature", "heat_capacity",
                                          "counterpart_heat_capacity"};

  ContactHeat(const ilaw_instance_info& info, std::optional<Table> obstacle_temperature);

  // Per node of the model; the arrays must stay.
  void read(const double* temperature, const double* capacity) {
    temperature_ = temperature;
    capacity_ = capacity;
  }
  // Whether the law reads a field.
  bool reads(std::string_view field) const {
    for (std::size_t k = 0; k < inputs_.size(); ++k)
      if (field == field_names[k]) return inputs_[k] >= 0;
    return false;
  }
  bool is_conducted_heat(std::size_t amount) const { return static_cast<int>(amount) == conducted_heat_; }
  double obstacle_temperature() const { return obstacle_temperature_; }
  // Before the contacts of a step.
  void open(double time, std::size_t contact_count, const std::vector<std::int32_t>& active);
  // Before a law is evaluated.
  void give(std::size_t contact, int node, const ContactPoint& point, ContactArrays& contacts) const;
  // Afterwards. amount(k): the k-th of the instance.
  template <class Amount>
  void take(std::size_t contact, Amount amount) {
    const auto given = [&](std::size_t k) {
      return amounts_[k] < 0 ? 0.0 : amount(std::size_t(amounts_[k]));
    };
    flows_[contact] = {given(0), given(1), given(2)};
  }

  // Frictional heat of the last step into the sides of a contact, and what it conducts per kelvin.
  struct Flow {
    double body = 0.0, counterpart = 0.0, per_kelvin = 0.0;
  };
  const Flow& flow(std::size_t contact) const { return flows_[contact]; }

 private:
  std::array<int, 4> inputs_{};   // places in the law's parameters per node; -1: it does not read the field
  std::array<int, 3> amounts_{};  // heat, counterpart_heat, heat_per_kelvin; -1: it does not give the amount
  int conducted_heat_ = -1;       // the same
  std::optional<Table> obstacle_;
  double obstacle_temperature_ = 0.0;  // in this step
  const double *temperature_ = nullptr, *capacity_ = nullptr;
  std::vector<Flow> flows_;  // by contact_index
};

}  // namespace ilaw::host
