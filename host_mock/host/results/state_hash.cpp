// SPDX-License-Identifier: BSD-3-Clause
#include "results/state_hash.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

namespace ilaw::host {
namespace {

class Fnv1a {
 public:
  void add(double value) {
    if (value == 0.0) value = 0.0;
    if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int shift = 0; shift < 64; shift += 8) {
      hash_ ^= (bits >> shift) & 0xFF;
      hash_ *= prime;
    }
  }
  void add(const Dofs& values) {
    for (const double value : values) add(value);
  }
  std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash_));
    return digits;
  }

 private:
  static constexpr std::uint64_t offset_basis = 0xCBF29CE484222325, prime = 0x100000001B3;
  std::uint64_t hash_ = offset_basis;
};

void add_temperatures(Fnv1a& hash, const Model& model, const Temperatures& temperatures) {
  for (int node = 0; node < model.node_count(); ++node)
    if (model.thermal()->has_temperature(node)) hash.add(temperatures.at(node));
}

// By node, because contacts have an order that depends on when the search found them.
void add_states(Fnv1a& hash, const Interface& interface) {
  const int state_size = static_cast<int>(interface.info().state_size);
  const int node_count = state_size > 0 ? static_cast<int>(interface.nodes().size()) : 0;
  for (int node_index = 0; node_index < node_count; ++node_index) {
    const int contact = interface.contact_at(node_index);
    if (contact < 0 || !interface.may_have_changed(contact)) continue;
    hash.add(static_cast<double>(node_index));
    for (int entry = 0; entry < state_size; ++entry) hash.add(interface.state(contact, entry));
  }
}

}  // namespace

std::string state_hash(const Scene& scene, const Integrator& integrator) {
  Fnv1a hash;
  hash.add(integrator.displacement());
  hash.add(integrator.velocity());
  if (const Temperatures* temperatures = integrator.temperatures())
    add_temperatures(hash, *scene.model, *temperatures);
  for (const auto& interface : scene.interfaces) add_states(hash, *interface);
  return hash.text();
}

}  // namespace ilaw::host
