// interface.hpp - one interface of a scene: the contacts between some nodes and their counterpart,
// and the law that acts there. It brings together the law (law.hpp), its arrays
// (contact_arrays.hpp), what the nodes touch (counterpart.hpp), and which of them are near
// (proximity_filter.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/contact_arrays.hpp"
#include "contact/counterpart.hpp"
#include "contact/law.hpp"
#include "contact/proximity_filter.hpp"

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
  double birth = 0.0, death = std::numeric_limits<double>::infinity();  // while birth <= t < death
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
  double speed_after;   // of v_free, and of what other contacts may make of it
};

using ContactList = std::vector<std::int32_t>;  // by contact_index

class Interface {
 public:
  // Loads the library and creates the law; throws ilaw::error with the loader's or the law's
  // message.
  Interface(InterfaceSetup setup, const Model& model);

  const std::string& name() const { return setup_.name; }
  const InterfaceSetup& setup() const { return setup_; }
  const ilaw::library& library() const { return law_.library(); }
  const ilaw_instance_info& info() const { return law_.info(); }
  const std::vector<int>& nodes() const { return setup_.nodes; }

  // ---- a step, in the order of the calls ----
  // Chooses the active contacts, by contact_index, and finds their gaps, normals, partners and
  // delassus.
  void open_step(const StepView& step);
  const ContactList& active() const { return active_; }
  // What the listed contacts see of the velocities v, without their own impulses: v_free.
  void gather(const ContactList& contacts, const Dofs& v, const StepView& step);
  // The law: impulse, state, energies and status. Throws ilaw::error on bad nodes.
  void evaluate(const ContactList& contacts, const StepView& step);
  // Adds to v what the impulses have changed by since gather. Returns the largest speed of a node
  // it moved.
  double apply(const ContactList& contacts, Dofs& v);
  // The step is done: its state becomes the state before the next.
  void accept(double dt);

  // The largest step at which the law was stable at all contacts evaluated so far; infinity: it needs none.
  double stable_step() const { return stable_step_; }

  // Where contacts may share nodes, they are evaluated more than once per step.
  void evaluate_repeatedly() { contacts_.keep_state_in(); }
  // Whether a contact cannot act in this step, like those that are not active
  // (proximity_filter.hpp).
  bool is_idle(int contact_index) const;
  // Adds to the impulse of a contact, for apply to pass on; change has a component per dimension.
  void change_impulse(int contact_index, const Vector& change);

  // ---- the last step, by contact_index ----
  const ContactPoint& point(int contact_index) const { return contacts_.point[at(contact_index)]; }
  auto impulse(int contact_index) const { return contacts_.vector(contacts_.impulse, contact_index); }
  auto normal(int contact_index) const { return contacts_.vector(contacts_.normal, contact_index); }
  auto v_free(int contact_index) const { return contacts_.vector(contacts_.v_free, contact_index); }
  double delassus(int contact_index) const { return contacts_.delassus[at(contact_index)]; }
  double gap(int contact_index) const { return contacts_.gap[at(contact_index)]; }
  int status(int contact_index) const { return contacts_.status[at(contact_index)]; }
  double energy(int contact_index, int part) const {
    return contacts_.energy[at(contact_index) * ILAW_ENERGY_COUNT + at(part)];
  }
  // Accepted state; entry: double of the node's state.
  double state(int contact_index, int entry) const {
    return contacts_.state[contacts_.first_state(contact_index) + at(entry)];
  }
  int node_of(int contact_index) const { return setup_.nodes[at(contacts_.node_index[at(contact_index)])]; }
  bool is_active(int contact_index) const;
  // Relative velocity of a contact in a velocity field, without the obstacle's own.
  Vector relative(int contact_index, const Dofs& v) const;
  // Adds the contact's impulse to those per degree of freedom.
  void add_impulse(int contact_index, Dofs& impulse) const;
  const Vector& obstacle_velocity() const { return obstacle_velocity_; }
  const Vector& obstacle_velocity_before() const { return obstacle_velocity_before_; }

  // ---- for outputs, by node_index, whether active or not ----
  double gap_at(int node_index, const Dofs& u, double time) const {
    return setup_.counterpart->contact_point(node_index, u, time).gap - setup_.gap_offset;
  }
  int contact_index_of(int node_index, const Dofs& u);  // makes a contact where there is none
  std::size_t bytes_per_contact() const { return contacts_.bytes_per_contact(); }
  std::size_t contact_count() const { return contacts_.count(); }

  // Everything that the next step depends on.
  void save(std::ostream& out) const { contacts_.save(out); }
  void load(std::istream& in, const Dofs& u);

 private:
  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  bool may_skip() const;
  void refresh_near(const StepView& step);
  void locate(int contact_index, const StepView& step);
  void initialise(int contact_index, const Dofs& u);
  ilaw_batch timed(ilaw_batch batch, double time, double dt) const;
  void check(const Answer& answer) const;
  void check_status(const ContactList& contacts) const;

  InterfaceSetup setup_;
  const Model& model_;
  int dimension_;
  Law law_;
  ContactArrays contacts_;
  ProximityFilter proximity_;
  double stable_step_ = std::numeric_limits<double>::infinity();
  double closing_ = 0.0;  // how far a gap may close in the coming step
  ContactList near_, active_;
  Vector obstacle_velocity_, obstacle_velocity_before_;
};

using Interfaces = std::vector<std::unique_ptr<Interface>>;

}  // namespace ilaw::host
