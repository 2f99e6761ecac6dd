// coupled_interface.hpp - the step of an interface whose contacts share nodes with others: what it gives the
// solver of ilaw/coupled.h, and what it takes from it. Calls come in the order below.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/contact_geometry.hpp"
#include "contact/coupled_group.hpp"
#include "contact/interface.hpp"

#include <cstddef>
#include <cstdint>

namespace ilaw::host {

class CoupledInterface {
 public:
  explicit CoupledInterface(Interface& interface);

  CoupledGroup& group() { return group_; }
  const CoupledGroup& group() const { return group_; }
  Interface& interface() { return interface_; }
  const Interface& interface() const { return interface_; }

  // Chooses the active contacts, finds their gaps, normals and partners, and gives the solver those that may
  // act: the others are out of reach of the speeds of the step.
  const ilaw_contacts& open(const StepView& step);
  // Takes the impulses that were found.
  void take() {
    columns().complete_statuses();
    columns().scatter_results();
  }
  // Throws as Interface::solve(), given the first contact with bad input (place in the group; -1: none).
  void check(const ilaw_coupled_report& report, std::int64_t bad_contact, double dt) const;
  // Throws as Interface::solve(), what ended the whole solve.
  void refuse(ilaw_result code, const char* reason) const;
  // Throws: a rigid law must push this contact's node along an axis that is driven.
  [[noreturn]] void refuse_driven(std::size_t place) const;
  // Throws std::runtime_error where a motion drives a node against a law that cannot give way.
  void check_driven(const StepView& step, const Dofs& v) const;
  // Throws where a law returned a status that is none, or an impossible result.
  void check_results(double dt) const;
  // The step is done: its state becomes the state before the next. All that the step before it left is
  // written here alone, so that a step may be opened any number of times.
  void accept(const StepView& step, const Dofs& v);

 private:
  const ContactColumns& columns() const { return group_.columns(); }
  bool is_idle(std::int32_t contact) const;
  Vector v_free_of(std::size_t place, const Dofs& v) const;
  void accept_contact(const StepView& step, const Dofs& v, std::size_t place);

  Interface& interface_;
  CoupledGroup group_;
  ContactGeometry found_;  // kept for the memory of its partners
};

}  // namespace ilaw::host
