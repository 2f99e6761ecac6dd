// made_problem.hpp - coupled contacts made from their solution, for any law: velocities and impulses are
// drawn on the law, then walls and free velocities are chosen so that they solve the problem. So a solution
// exists, and what a solver calls solved is judged by the law alone, in the scale of the velocities given to
// it. made_problem.cpp draws and makes them, made_calls.cpp gives them to laws and to the solver,
// made_audit.cpp judges.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stress/draw.hpp"

#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <Eigen/Dense>

#include <cstdint>
#include <vector>

namespace ilaw::host {

struct MadeSetup {
  enum class Normals { any, wedged, redundant, pressed };

  int bodies = 1, contacts = 2;
  double mass_decades = 0.0;  // masses from 1 to 10^this; pressed: 1 and 10^this in turn
  double no_freedom = 0.0;    // probability that a body cannot move along an axis; with the form FULL
  bool rotate = false;        // with the form FULL; spheres always do
  Normals normals = Normals::any;
  int ends = 1;              // bodies on either side at most, with weights: the nodes of facets
  bool has_axes = false;     // weights are matrices, of nodes with axes of their own; with the form FULL
  double gap = 0.0;          // largest, over speed times step
  bool rounds_gaps = false;  // closed gaps are 1e-15 open
  double open = 1.0 / 3.0;
  double speed = 1.0, step = 1e-3;
};

// Largest error of a law, relative to the largest velocity that the problem brings; the same of the
// velocities of bodies for these impulses; and the reported work less that of these impulses, relative to its
// parts.
struct MadeAudit {
  double residual = 0.0, momentum = 0.0, work = 0.0;
};

class MadeProblem {
 public:
  // The laws take turns. They have the global frame, double numbers, three dimensions and this form of H:
  // SCALAR, FULL, TRANSVERSE (spheres), or TRANSVERSE_SPIN (spheres, with moments).
  MadeProblem(const std::vector<const interface*>& laws, ilaw_delassus_form form, const MadeSetup& setup,
              Draw& draw);

  // Appends another problem with the same laws. No body of one touches one of the other.
  void add(const MadeProblem& other);
  // From rest, or from the impulses that the last call left.
  ilaw_coupled_report solve(coupled& solver, const ilaw_coupled_options& options);

  MadeAudit audit(const ilaw_coupled_report& report) const;
  // The same of the solution that the problem was made from.
  MadeAudit audit_of_solution() const;

  int body_count() const { return static_cast<int>(bodies_.size()); }
  int contact_count() const { return static_cast<int>(contacts_.size()); }
  std::vector<double> velocities() const;

 private:
  using Vector = Eigen::Vector3d;
  using Wrench = Eigen::Matrix<double, 6, 1>;  // velocity and spin, or impulse and moment
  using Matrix = Eigen::Matrix<double, 6, 6>;
  struct Body {
    Wrench inverse = Wrench::Zero();  // masses, then moments of inertia
    Wrench solution = inverse, free = inverse, before = inverse, velocity = inverse;
  };
  struct Contact {
    std::size_t law = 0;
    std::vector<std::int32_t> body{0}, counterpart{-1};  // -1: a wall, or no body
    std::vector<double> weight, other_weight;            // as coupled.h has them, none for one body
    Vector normal = Vector::Zero(), arm = normal, other_arm = normal;
    double gap = 0.0, pressure = 0.0;  // velocity by which it is pressed, see draw_contact
    Wrench wall = Wrench::Zero(), wall_before = wall, made = wall, impulse = wall;
    std::vector<double> state;
    bool has_broken = false;  // its bond, at the solution of a round: then the law is told so
  };
  struct Group;

  int width() const { return form_ == ILAW_DELASSUS_TRANSVERSE_SPIN ? 6 : 3; }
  bool rotates() const { return setup_.rotate || form_ >= ILAW_DELASSUS_TRANSVERSE; }

  Wrench random(Draw& draw, int count) const;
  void draw_bodies(Draw& draw);
  void draw_contact(Draw& draw, Contact& contact);
  void draw_facets(Draw& draw, Contact& contact) const;
  Wrench draw_velocity(Draw& draw, Contact& contact);
  void make(const std::vector<Wrench>& v_free);
  bool is_well_posed(const Contact& contact, const Wrench& v) const;
  void sort_by_law();

  // Calls visit with each body of a contact, once for each side, and the matrix from its motion to its part
  // of the contact's.
  template <class Visit>
  void for_bodies(const Contact& contact, Visit visit) const;
  Wrench relative(const Contact& contact, Wrench Body::*motion) const;
  // By body, of all contacts.
  std::vector<Wrench> sums_of(Wrench Contact::*impulse) const;
  Matrix delassus(const Contact& contact) const;
  // Velocity of a contact without the impulse of any.
  Wrench smooth(const Contact& contact) const { return relative(contact, &Body::free) - contact.wall; }
  Wrench before(const Contact& contact) const {
    return relative(contact, &Body::before) - contact.wall_before;
  }

  bool reads_smooth(std::size_t law) const { return (laws_[law]->info().inputs & ILAW_INPUT_V_SMOOTH) != 0; }
  ilaw_batch batch_of(const Contact& contact) const;
  std::vector<double> first_state(const Contact& contact) const;
  Wrench form_of(const Contact& contact) const;
  // Impulse of the law alone at this free velocity.
  Wrench answer(const Contact& contact, const Wrench& v_free) const;
  ilaw_bodies describe_bodies(std::vector<double>& inertia);

  // Largest velocity that the problem brings: free, before the step, of walls, gap over step.
  double scale() const;
  double size_of(const Matrix& h, const Wrench& impulse) const;
  double least_error(const Contact& contact, const Matrix& h, const Wrench& v_free, const Wrench& r) const;
  MadeAudit audit(Wrench Contact::*impulse, Wrench Body::*velocity) const;

  ilaw_delassus_form form_;
  MadeSetup setup_;
  std::vector<const interface*> laws_;
  std::vector<Body> bodies_;
  std::vector<Contact> contacts_;
};

}  // namespace ilaw::host
