// contact_set.hpp - the contacts of one fix at one step as arrays for coupled.h, and what each leaves for the
// next step, kept per atom under the tag of the partner: rows that LAMMPS moves, sorts and writes with atoms.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/coupled.h>
#include <ilaw/loader.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace ilaw::lammps {

using Vector = std::array<double, 3>;

// Contacts of an atom, one after the other: tag of the partner, force (3), moment (3) of laws that serve
// spins, state.
using Row = std::vector<double>;

class ContactSet {
 public:
  // The law by name or path, its parameters as pairs of texts. Throws ilaw::error.
  ContactSet(const std::string& law, const std::vector<std::array<std::string, 2>>& parameters);

  std::size_t entry_size() const { return 1 + response_size_ + state_size_; }
  std::uint32_t state_version() const { return interface_->info().state_version; }

  // Begins a step, in which a force makes an impulse over velocity_step.
  void clear(double velocity_step);
  // n points from the counterpart to the body. partner: name of the other atom, or of the wall, in the row of
  // the atom that keeps the contact. All contacts of a set have a wall, or none has.
  struct Contact {
    int body, counterpart;  // counterpart below 0: a wall
    double partner;
    Vector normal, wall_velocity, wall_previous, wall_spin;
    double gap, arm, counterpart_arm, area;
  };
  // row: of the atom that keeps the contact.
  void add(const Contact& contact, const Row& row);

  // Arrays in, once all contacts are there. The pointers live until the next clear.
  const ilaw_contacts* describe(double time, double position_step);

  std::size_t size() const { return body_.size(); }
  int body(std::size_t k) const { return body_[k]; }
  int counterpart(std::size_t k) const { return counterpart_[k]; }
  double gap(std::size_t k) const { return gap_[k]; }
  const double* normal(std::size_t k) const { return &normal_[3 * k]; }
  const double* wall_velocity(std::size_t k) const { return &wall_[3 * k]; }
  std::uint8_t status(std::size_t k) const { return status_[k]; }
  const double* energy(std::size_t k) const { return &energy_[k * ILAW_ENERGY_COUNT]; }
  // Appends what the contact leaves.
  void keep(std::size_t k, Row& row) const;

 private:
  bool has_spins() const { return delassus_form_ == ILAW_DELASSUS_TRANSVERSE_SPIN; }
  void initialise_new(const ilaw_batch& batch);

  std::unique_ptr<ilaw::interface> interface_;
  std::uint64_t state_size_ = 0;
  std::size_t response_size_ = 3;  // impulse, and moment where the form of H has spins
  std::uint32_t delassus_form_ = ILAW_DELASSUS_FULL;
  double velocity_step_ = 0.0;
  std::vector<std::int32_t> body_, counterpart_, new_;
  std::vector<double> partner_, gap_, area_, normal_, arm_, counterpart_arm_, wall_, wall_previous_,
      wall_spin_;
  std::vector<double> response_, state_, energy_;
  std::vector<std::uint8_t> status_;
  ilaw_batch batch_{};
  ilaw_contacts described_{};
};

}  // namespace ilaw::lammps
