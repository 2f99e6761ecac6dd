// interface.hpp - one interface of a scene: a law between some nodes and their counterpart, driven through
// the ABI.
//
// Contacts have a place (of their node in the interface's list) and, once they were first asked, a slot in
// the arrays that the law works on. What was never near takes no slot.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/counterpart.hpp"
#include "contact/law_arguments.hpp"
#include "contact/proximity_filter.hpp"

#include <ilaw/loader.hpp>

#include <algorithm>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace ilaw::host {

struct InterfaceSetup {
  std::string name, law, library;  // library: name or path
  Arguments arguments;
  std::vector<int> nodes;
  std::vector<double> areas;  // tributary, per node
  std::unique_ptr<Counterpart> counterpart;
  double birth = 0.0, death = std::numeric_limits<double>::infinity();  // acts for birth <= t < death
  Vector tangent;                 // first tangent of all nodes; empty: none given
  double gap_offset = 0.0;        // taken off every gap: thickness, radius
  bool keeps_all_active = false;  // also contacts that cannot be reached: same results, more work
};

// A step from the interface's side. Speeds bound those of all nodes.
struct StepView {
  const Dofs& u;         // at time
  const Dofs& v_before;  // at the half step before time
  double time, dt;
  double speed_before;  // at the half step before time
  double speed_after;   // while impulses are sought: of v_free, and of what other contacts may make of it
};

// How far velocities are from those that the laws were last asked about.
struct Residual {
  double change = 0.0;  // largest change of a contact's free velocity since
  double size = 0.0;    // largest change of velocity that an impulse alone makes at its contact
};

class Interface {
 public:
  // Loads the library and creates the law; throws ilaw::error with the loader's or the law's message.
  Interface(InterfaceSetup setup, const Model& model);

  const std::string& name() const { return setup_.name; }
  const InterfaceSetup& setup() const { return setup_; }
  const ilaw::library& library() const { return library_; }
  const ilaw_law& law() const { return interface_.law(); }
  const ilaw_instance_info& info() const { return info_; }
  const std::vector<int>& nodes() const { return setup_.nodes; }

  // Chooses the contacts to ask in this step and finds their gaps, normals and partners.
  void open_step(const StepView& step);
  // The contacts of the step, by slot; those of one colour share no node, but for the last one where coupled:
  // these contacts cannot act.
  const std::vector<std::int32_t>& active() const { return active_; }
  int colours() const { return static_cast<int>(colours_.size()); }
  // Evaluates one colour against the velocities v, which hold all impulses so far and take the change in.
  // Returns the largest speed of a node that was moved. Throws ilaw::error on bad nodes.
  double solve(int colour, Dofs& v, const StepView& step);
  // Zero where every law has answered to the velocities v.
  Residual residual(const Dofs& v) const;
  // Impulses of contacts that may act, in a fixed order, times the root of their delassus: a norm in energy.
  void append_impulses(std::vector<double>& scaled) const;
  // Adds as many to them, and to the velocities. Returns the largest speed of a node that was moved, and
  // moves scaled to the end of what it took.
  double add_impulses(const double*& scaled, Dofs& v);
  // The step is done: its state becomes the state before the next.
  void accept(double dt);
  // Contacts may share nodes: evaluate is called more than once per step, with state_in and state_out apart.
  void set_coupled();

  // Of the last step, by slot.
  auto impulse(int contact_index) const {
    return Eigen::Map<const Vector>(&impulse_[at(contact_index)], dimension_);
  }
  auto normal(int contact_index) const {
    return Eigen::Map<const Vector>(&normal_[at(contact_index)], dimension_);
  }
  double delassus(int contact_index) const { return delassus_[static_cast<std::size_t>(contact_index)]; }
  double gap(int contact_index) const { return gap_[static_cast<std::size_t>(contact_index)]; }
  int status(int contact_index) const { return status_[static_cast<std::size_t>(contact_index)]; }
  double energy(int contact_index, int part) const {
    return energy_[static_cast<std::size_t>(contact_index) * ILAW_ENERGY_COUNT +
                   static_cast<std::size_t>(part)];
  }
  // Relative velocity of a contact in a velocity field, without the obstacle's own.
  Vector relative(int contact_index, const Dofs& v) const;
  // Adds an impulse per degree of freedom.
  void add_impulse(int contact_index, Dofs& impulse) const;
  const Vector& obstacle_velocity() const { return obstacle_velocity_; }
  const Vector& obstacle_velocity_before() const { return obstacle_velocity_before_; }

  // For outputs, by place, whether it was asked or not.
  double gap_at(int node_index, const Dofs& u, double time) const {
    return setup_.counterpart->meet(node_index, u, time).gap - setup_.gap_offset;
  }
  int node_of(int contact_index) const {
    return setup_.nodes[static_cast<std::size_t>(node_index_of_[static_cast<std::size_t>(contact_index)])];
  }
  int contact_index_of(int node_index, const Dofs& u);  // makes one where there is none
  // Accepted state; entry: double of the node's state.
  double state(int contact_index, int entry) const {
    return state_[state_at(contact_index) + static_cast<std::size_t>(entry)];
  }
  bool is_active(int contact_index) const;

  std::size_t bytes_per_contact() const;
  std::size_t contact_count() const { return node_index_of_.size(); }

  // Everything that the next step depends on.
  void save(std::ostream& out) const;
  void load(std::istream& in, const Dofs& u);

 private:
  std::size_t at(int contact_index) const {
    return static_cast<std::size_t>(contact_index) * static_cast<std::size_t>(dimension_);
  }
  std::size_t state_at(int contact_index) const {
    return static_cast<std::size_t>(contact_index) * info_.state_size;
  }
  bool may_skip() const;
  void look(const StepView& step);
  void locate(int contact_index, const StepView& step);
  bool is_idle(int contact_index) const;
  void colour_contacts();
  std::size_t colour_of(int contact_index);
  void open_contact(int node_index, const Dofs& u);
  void initialise(int contact_index, const Dofs& u);
  void gather(const std::vector<std::int32_t>& contact_indices, const Dofs& v, const StepView& step);
  void evaluate(const std::vector<std::int32_t>& contact_indices, const StepView& step);
  template <class Visit>
  void for_each_batch(std::size_t colour, Visit visit) const;
  double apply(const std::vector<std::int32_t>& contact_indices, Dofs& v);
  ilaw_batch batch(double time, double dt) const;
  std::string node_message(const ilaw_report& report) const;

  InterfaceSetup setup_;
  const Model& model_;
  int dimension_;
  ilaw::library library_;
  ilaw::interface interface_;
  ilaw_instance_info info_;
  bool coupled_ = false;
  ProximityFilter proximity_;
  double ahead_ = 0.0;  // how far a gap may close in the coming step

  std::vector<int> contact_index_of_;        // by place; -1: none yet
  std::vector<int> node_index_of_;           // by slot
  std::vector<std::int32_t> near_, active_;  // slots
  std::vector<std::vector<std::int32_t>> colours_;
  std::vector<std::uint64_t> colours_of_node_;

  // By slot.
  std::vector<ContactPoint> contact_points_;
  std::vector<double> v_free_, v_previous_, normal_, impulse_, previous_impulse_, delassus_, gap_, area_,
      energy_;
  std::vector<double> state_, next_state_;
  std::vector<std::uint8_t> status_, touched_;
  std::vector<std::vector<double>> per_node_;
  std::vector<ilaw_input> per_node_inputs_;
  Vector obstacle_velocity_, obstacle_velocity_before_;
};

}  // namespace ilaw::host
