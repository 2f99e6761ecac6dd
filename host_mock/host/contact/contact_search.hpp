// contact_search.hpp - which contacts of an interface a step works on: those that are near
// (proximity_filter.hpp; mesh_surface.hpp) or remember something.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/parallel.hpp"
#include "contact/contact_arrays.hpp"
#include "contact/law.hpp"
#include "contact/obstacle_motion.hpp"
#include "contact/proximity_filter.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace ilaw::host {

// Nodes of an interface whose contacts a thread takes at a time.
constexpr std::ptrdiff_t contact_chunk = chunk_of(2048);

// Some contacts, by contact_index, and the nodes of the model that they are of.
struct NearContacts {
  const std::int32_t *index, *nodes;
  std::ptrdiff_t count;

  void leave_out(std::ptrdiff_t first) {
    index += first;
    nodes += first;
    count -= first;
  }
};

class ContactSearch {
 public:
  ContactSearch(const InterfaceSetup& setup, const Law& law, const ContactArrays& contacts);

  // Takes the contact_index of a node_index; makes the contact where there is none.
  using MakeContact = std::function<int(int)>;
  void choose(const StepView& step, const ObstacleMotion& obstacle, const MakeContact& make);

  // ---- of the last choice ----
  const ContactList& active() const { return acts_ ? near_ : none_; }
  bool contains(int node_index) const {
    return !active().empty() && is_near_[static_cast<std::size_t>(node_index)] != 0;
  }
  // By chunks of nodes, so that sums do not depend on which of them are near.
  std::ptrdiff_t chunk_count() const { return static_cast<std::ptrdiff_t>(chunk_starts_.size()) - 1; }
  NearContacts chunk(std::ptrdiff_t number) const;
  // How far a gap may close in the coming step.
  double closing() const { return closing_; }

  // Whether the state of a contact that is out of reach changes: axes follow the normal.
  bool axes_turn() const { return axes_turn_; }
  // A contact has come into being at a node.
  void look_again(int node_index);
  // The next choice looks at all nodes.
  void forget();

 private:
  bool may_skip() const;
  bool is_due(const StepView& step, double closing_before, double closing_after);
  bool may_touch(double gap_bound) const;
  void refresh(const StepView& step, const MakeContact& make);
  void look_at(std::size_t chunk, const StepView& step);

  const InterfaceSetup& setup_;
  const Law& law_;
  const ContactArrays& contacts_;
  const bool axes_turn_;
  const bool finds_near_;        // the counterpart does, instead of the filter
  const double largest_offset_;  // of gaps
  ProximityFilter proximity_;
  bool is_forced_ = true;  // the list of the counterpart must be new
  double closing_ = 0.0;
  bool acts_ = false;              // between birth and death
  ContactList near_, near_nodes_;  // contacts, and the nodes that they are of
  const ContactList none_;
  std::vector<std::ptrdiff_t> chunk_starts_;  // in near_, and its end
  std::vector<std::uint8_t> is_near_;         // by node_index, at the last refresh
  std::vector<FarNodes> far_;                 // by chunk of nodes; no bound where some are near
};

}  // namespace ilaw::host
