// coupled_group.hpp - the contacts of an interface that may act in a step, as ilaw/coupled.h takes them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/contact_columns.hpp"
#include "contact/watched_law.hpp"

#include <ilaw/coupled.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ilaw::host {

// Inputs of one contact beside what ContactArrays stores.
struct CoupledContact {
  std::int32_t contact;
  int node;
  const ContactPoint& point;       // its gap less the gap offset
  Vector surface, surface_before;  // velocities of the obstacle
};

class CoupledGroup {
 public:
  // has_partners: bodies are on the other side, else an obstacle.
  CoupledGroup(const Law& law, int dimension, ilaw_delassus_form form, bool has_partners);

  // ---- before a solve ----
  void open();
  void add(const CoupledContact& contact);
  // Gathers the contacts that were added.
  const ilaw_contacts& close(ContactArrays& arrays, const Vector& tangent, const StepView& step);
  // Calls visit with each entry of the bodies: a node, which visit may replace by its place among the bodies
  // of the solve.
  template <class Visit>
  void for_each_body(Visit visit) {
    for (std::int32_t& node : body_) visit(node);
    for (std::int32_t& node : counterpart_)
      if (node >= 0) visit(node);
  }

  // ---- after it, by place in the group ----
  std::size_t count() const { return contacts_.size(); }
  std::int32_t contact(std::size_t i) const { return contacts_[i]; }
  // A copy of the accepted state, and after the solve the next one.
  const ContactColumns& columns() const { return columns_; }
  auto impulse(std::size_t i) const {
    return Eigen::Map<const Vector>(columns_.impulse() + i * static_cast<std::size_t>(dimension_),
                                    dimension_);
  }
  // Velocities of the obstacle's surface there.
  auto surface(std::size_t i) const {
    return Eigen::Map<const Vector>(&surface_[i * static_cast<std::size_t>(dimension_)], dimension_);
  }
  auto surface_before(std::size_t i) const {
    return Eigen::Map<const Vector>(&surface_before_[i * static_cast<std::size_t>(dimension_)], dimension_);
  }

  // ---- between steps: the forces with which the iterations of the next step begin ----
  void keep_forces(double velocity_step);
  void forget_forces();
  // For a checkpoint: contacts that have a force, and the forces.
  const ContactList& kept() const { return kept_; }
  const std::vector<double>& kept_forces() const { return kept_forces_; }
  void keep(ContactList contacts, std::vector<double> forces);

 private:
  void lay_out_partners();
  void start_from_kept();

  int dimension_;
  ilaw_delassus_form form_;
  bool has_partners_;
  const Law& law_;
  WatchedLaw watched_;
  ContactColumns columns_;
  ContactList contacts_, kept_;
  std::vector<double> kept_forces_;         // d for each of kept_
  std::vector<double> start_;               // the same for each contact of the interface; zero if not kept
  std::vector<std::size_t> first_partner_;  // of each contact, and the end
  std::vector<Partner> partners_;           // contact after contact
  std::vector<std::int32_t> body_, counterpart_;
  std::vector<double> own_weights_, weights_, surface_, surface_before_, gap_, normal_;
  ilaw_batch batch_{};
  ilaw_contacts given_{};
};

}  // namespace ilaw::host
