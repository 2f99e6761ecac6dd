// contacts.hpp - the contacts of one law as the host gave them: checks, columns of a block, calls of the law,
// results.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blocks.hpp"
#include "bodies.hpp"
#include "kernels.hpp"

#include <ilaw/coupled.h>

#include <cstdint>
#include <vector>

namespace ilaw::coupled {

class Contacts {
 public:
  // Reads the host's structs. Returns why they are refused, or null.
  const char* open(const ilaw_contacts& given, const Bodies& bodies);

  std::int64_t count() const { return theirs_.node_count; }
  const Layout& layout() const { return layout_; }
  Kind kind() const { return kind_; }
  std::uint32_t body_count() const { return body_count_; }
  const char* law_id() const { return given_.law->id; }
  bool has_wall() const { return layout_.wall >= 0; }
  bool asks_energy() const { return theirs_.energy.values != nullptr; }
  bool asks_balance() const { return asks_energy() || theirs_.amounts; }

  // Index of end e of contact k: the first body_count() are of the first side. Bodies::wall() where none is.
  std::int32_t end(std::int64_t k, std::uint32_t e) const {
    return ends_[static_cast<std::size_t>(k) * ends() + e];
  }
  std::uint32_t ends() const { return static_cast<std::uint32_t>(layout_.ends); }
  // Whether weights are integrated over several facets: a contact shares bodies with some 50 others.
  bool is_integrated() const { return body_count_ + counterpart_count_ > 5; }
  // Whether the contact is open, cannot close at its present velocity, and starts without impulse, and the
  // law permits to leave it out.
  bool is_out_of_reach(std::int64_t k, const Bodies& bodies) const;

  // Writes all columns of contact k into a lane; false where an arm is not along the normal.
  bool fill(Block& block, std::size_t lane, std::int64_t k, const Bodies& bodies) const;
  // Whether nothing moves along this axis of the host, so that H has a small number for it.
  bool may_be_held() const {
    return (kind_ == Kind::rigid || kind_ == Kind::points || kind_ == Kind::weighted) && !is_transverse();
  }
  bool is_held(const Block& block, std::size_t lane, std::size_t axis) const;
  // Gaps below what this velocity, or this part of a contact's own, makes in a step become 0, so that
  // contacts that act where they are closed do not open by rounding.
  void close_gaps(Block& block, double known_velocity, double part, const double* speeds) const;
  // The first number of each output.
  void add_outputs(std::vector<const double*>& outputs) const;
  bool is_in_reach(const Block& block, std::size_t lane, const Vector& velocity) const;
  // Whether bonds hold until a solution is judged, and those that broke at one stay broken.
  bool can_adhere() const { return (info_.capabilities & ILAW_CAN_ADHERE) != 0; }
  bool holds_bonds() const {
    return holds_bonds_ && (info_.capabilities & ILAW_CAN_HOLD_BONDS) && theirs_.flags == 0;
  }
  // From now on the law decides, until the next step.
  void release_bonds() { holds_bonds_ = false; }

  // With moments v_free is followed by spins and impulse by moments.
  struct Call {
    const double* v_free;    // columns at distances of max_stride
    const double* delassus;  // columns at distances of delassus_stride
    std::size_t delassus_stride;
    double* impulse;              // columns at distances of max_stride
    double* state_out = nullptr;  // as the block's columns; null: the block's own
    std::uint8_t* status = nullptr;
    double* energy = nullptr;              // ILAW_ENERGY_COUNT columns at distances of max_stride
    const ilaw_output* amounts = nullptr;  // as many as the law has
    bool judges = false;  // the law decides whether a bond holds that has not broken in this step
  };
  std::int32_t evaluate(const Block& block, const Call& call, ilaw_report& report) const;

  // r.(wall_previous + wall_velocity) and the same of the moment: twice the work at the wall.
  double wall_work(const Block& block, std::size_t lane) const;
  // Outputs of contact k that a lane of a block has.
  void write(const Block& block, std::size_t lane) const;
  void write_balance(const Block& block, std::size_t lane, const double* energy, const double* amounts,
                     double* energy_sums) const;
  std::uint32_t amount_count() const { return theirs_.amounts ? info_.amount_count : 0; }

 private:
  std::int32_t evaluate_broken(const Block& block, ilaw_batch& batch, ilaw_report& report) const;
  const char* complaint() const;
  const char* complaint_of_law(const Bodies& bodies);
  const char* complaint_of_bodies(const Bodies& bodies) const;
  const char* complaint_of_contact(std::int64_t k, const Bodies& bodies) const;
  void lay_out(const Bodies& bodies);
  void read_ends(const Bodies& bodies);
  void fill_weights(Block& block, std::size_t lane, std::int64_t k) const;
  void fill_delassus(Block& block, std::size_t lane, const Bodies& bodies) const;
  void fill_spin_delassus(Block& block, std::size_t lane, double j_x, double j_y) const;
  Symmetric diagonal_delassus(const Block& block, std::size_t lane, const Bodies& bodies) const;
  Symmetric coupled_delassus(const Block& block, std::size_t lane, const Bodies& bodies) const;
  bool has_spins() const { return given_.delassus_form == ILAW_DELASSUS_TRANSVERSE_SPIN; }
  bool is_transverse() const { return has_spins() || given_.delassus_form == ILAW_DELASSUS_TRANSVERSE; }
  bool is_weighted() const;
  Vector relative(std::int64_t k, const Bodies& bodies) const;
  Vector start(const ilaw_output& values, std::int64_t k) const;

  ilaw_contacts given_{};
  ilaw_batch theirs_{};
  ilaw_instance_info info_{};
  std::uint32_t dimension_ = 3, body_count_ = 1, counterpart_count_ = 1;
  Kind kind_ = Kind::point;
  Layout layout_;
  std::vector<std::int32_t> ends_;
  bool holds_bonds_ = true;
};

}  // namespace ilaw::coupled
