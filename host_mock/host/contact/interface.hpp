// interface.hpp - one interface of a scene: the contacts between some nodes and their counterpart,
// and the law that acts there. It brings together the law (law.hpp), what is stored of contacts
// (contact_arrays.hpp), what the nodes touch (counterpart.hpp, obstacle_motion.hpp), which of them are near
// (contact_search.hpp), and the step of contacts that share no nodes (block_step.hpp). Where contacts share
// nodes, coupled_interface.hpp takes its step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/block_step.hpp"
#include "contact/contact_arrays.hpp"
#include "contact/contact_heat.hpp"
#include "contact/contact_search.hpp"
#include "contact/contact_sums.hpp"
#include "contact/interface_setup.hpp"
#include "contact/law.hpp"
#include "contact/obstacle_motion.hpp"

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::host {

class Interface {
 public:
  // Loads the library and creates the law; throws ilaw::error with the loader's or the law's
  // message.
  Interface(InterfaceSetup setup, const Model& model);

  const std::string& name() const { return setup_.name; }
  const InterfaceSetup& setup() const { return setup_; }
  // For another interface in the place of this one, which is of no use then.
  InterfaceSetup take_setup() { return std::move(setup_); }
  const ilaw::library& library() const { return law_.library(); }
  const ilaw_instance_info& info() const { return law_.info(); }
  const std::vector<int>& nodes() const { return setup_.nodes; }

  bool bonds_at_once() const { return law_.bonds_at_once(); }
  bool bonds_at_start() const { return bonds_at_once() && !(setup_.birth > 0.0); }

  // Forgets the amounts that laws gave so far.
  void clear_amounts() { amounts_.assign(amounts_.size(), 0.0); }
  // Of a step, by all of its contacts.
  void add_conducted_heat(double heat);

  // Whether laws are asked for what contacts dissipate and store, which takes them as long again as
  // the impulse, and changes no bit of it. They are, where nobody says that it is not wanted.
  void ask_energies(bool asks) { asks_energies_ = asks; }

  // Velocity that a unit impulse makes, per degree of freedom of the model. To be set before the first step
  // and again when its values change; the array must stay.
  void set_inverse_mass(const double* inverse_mass);
  const double* inverse_mass() const { return inverse_mass_; }

  // Null where its nodes have no temperature.
  ContactHeat* heat() { return heat_ ? &*heat_ : nullptr; }
  const ContactHeat* heat() const { return heat_ ? &*heat_ : nullptr; }

  // ---- a step where no two contacts share a node ----
  // Contact by contact instead of in blocks, with the same bits.
  void step_one_by_one() { one_by_one_ = true; }
  // Chooses the active contacts, finds gaps, normals and delassus, asks the law for impulse, state,
  // energies and status, and takes v from v_free to v_free + H r. Throws ilaw::error on bad nodes.
  void solve(const StepView& step, Dofs& v);

  // ---- the last step ----
  const ContactList& active() const { return search_.active(); }
  const ContactSums& sums() const { return sums_; }
  // Totals of the run, in the order of info().amounts.
  const std::vector<double>& amounts() const { return amounts_; }
  // By contact_index.
  bool is_active(int contact_index) const;
  auto impulse(int contact_index) const { return contacts_.vector(contacts_.impulse, contact_index); }
  int status(int contact_index) const { return contacts_.status[at(contact_index)]; }
  int node_index_of(int contact_index) const { return contacts_.node_index[at(contact_index)]; }
  int node_of(int contact_index) const { return setup_.nodes[at(node_index_of(contact_index))]; }
  double delassus(int contact_index) const { return contacts_.delassus[at(contact_index)]; }
  // H times an impulse.
  Vector velocity_of(int contact_index, const Vector& impulse) const;
  // Without partners where the counterpart is rigid.
  const ContactPoint& point(int contact_index) const;
  double area(int contact_index) const {
    return setup_.area(node_index_of(contact_index), point(contact_index));
  }
  // Accepted state; entry: double of the node's state.
  double state(int contact_index, int entry) const {
    return contacts_.state.at(at(contact_index), at(entry));
  }
  bool may_have_changed(int contact_index) const { return contacts_.may_have_changed(at(contact_index)); }
  // Adds the contact's impulse to those per degree of freedom.
  void add_impulse(int contact_index, Dofs& impulse) const;
  // Relative velocity of a contact in a velocity field, without the obstacle's own.
  Vector relative(int contact_index, const Dofs& v) const;
  const ObstacleMotion& obstacle() const { return obstacle_; }
  // Force per area along the normal and along the surface, and the length of slip in the step.
  struct Rubbing {
    double pressure = 0.0, shear = 0.0, slip = 0.0;
  };
  Rubbing rubbing(int contact_index, const StepView& step) const;
  // Depth that the law took off, from when it is first to be kept.
  void keep_wear() { contacts_.keep_wear(); }
  double wear(int contact_index) const { return contacts_.wear[at(contact_index)]; }
  // Only where contacts share nodes.
  auto normal(int contact_index) const { return contacts_.vector(contacts_.normal, contact_index); }
  double gap(int contact_index) const { return contacts_.gap[at(contact_index)]; }

  // ---- for outputs, by node_index, whether active or not ----
  double gap_at(int node_index, const Dofs& u, double time) const {
    const Counterpart& counterpart = *setup_.counterpart;
    const ContactPoint point = counterpart.contact_point(node_index, u, time);
    return counterpart.known_gap(
        node_index, u, (point.behind > 0.0 ? -point.behind : point.gap) - setup_.gap_offset(node_index));
  }
  // Whether a node has no gap or no normal: so far out lengths overflow, and edges of facets vanish.
  bool has_lost_a_node(const Dofs& u, double time) const;
  int contact_index_of(int node_index, const Dofs& u);  // makes a contact where there is none
  // -1: none yet. Watching makes none: contacts then have the order of their nodes, which blocks need to
  // work on them where they are.
  int contact_at(int node_index) const { return contacts_.index_of(at(node_index)); }
  // Values of the law's parameters per node, as the scene gives them and as the contact last had them.
  std::vector<double> parameters_of(int node_index) const;
  std::vector<double> parameters_at(int contact_index) const;
  // Where axes begin in the state.
  const std::vector<std::size_t>& axes() const { return axes_; }
  bool gives_energies() const {
    return (asks_energies_ || heat_) && (law_.outputs() & ILAW_OUTPUT_ENERGY) != 0;
  }
  // The accepted state, without making a contact.
  std::vector<double> state_at(int node_index, const Dofs& u) const;
  std::size_t bytes_per_contact() const { return contacts_.bytes_per_contact(); }
  std::size_t contact_count() const { return contacts_.count(); }

  // Everything that the next step depends on.
  void save(std::ostream& out) const;
  void load(std::istream& in, const Dofs& u);

 private:
  friend class CoupledInterface;
  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  void find_delassus(std::size_t contact);
  void leave_out();
  void choose_active(const StepView& step);
  void total_amounts();
  std::vector<double> first_state(int node_index, const Dofs& u) const;
  // Throws what a law refused; node: the first, empty where it is none in particular.
  void check(const Refusal& refusal, double dt) const;
  void check(const Refusal& refusal, const std::string& node) const;

  InterfaceSetup setup_;
  const Model& model_;
  int dimension_;
  Law law_;
  std::vector<std::size_t> axes_;  // where they begin in the state
  ContactArrays contacts_;
  ContactSearch search_;
  ObstacleMotion obstacle_;
  std::optional<ContactHeat> heat_;
  std::vector<ChunkOutcome> outcomes_;  // room that is kept from step to step
  ContactSums sums_;
  std::vector<double> amounts_;
  bool asks_energies_ = true, one_by_one_ = false;
  const double* inverse_mass_ = nullptr;
};

using Interfaces = std::vector<std::unique_ptr<Interface>>;

}  // namespace ilaw::host
