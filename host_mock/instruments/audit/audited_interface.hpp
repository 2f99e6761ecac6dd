// audited_interface.hpp - one interface of a scene for the audit of a step (audit.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"

#include <ilaw/loader.hpp>

#include <array>
#include <string>
#include <vector>

namespace ilaw::host {

// A step as it ended. v_smooth: its velocities without the impulses of interfaces.
struct AuditedStep {
  const Dofs &u, &v, &v_before, &v_smooth;
  double since, time, until, dt;  // obstacles move from the first to the third
  double speed;                   // the largest of these velocities
  double farthest;                // coordinate, which gaps are rounded by
  bool is_start;                  // a half step of the velocity, before which obstacles moved as after it
};

class AuditedInterface {
 public:
  // is_coupled: contacts of it share nodes with others, so that they are solved to a residual.
  AuditedInterface(const Interface& interface, const Model& model, bool is_coupled);

  // Whether its law stores nothing and stops a node at once that comes where the gap is closed.
  bool stops() const { return stops_; }
  // Before a step: the memory of its law.
  void open(const Dofs& u);
  // After it. Throws AuditFailure, without the step.
  void close(const AuditedStep& step);
  // Adds the impulses of the last step to those per degree of freedom.
  void add_impulses(Dofs& impulse) const;

 private:
  // What a law is given and returns for a node.
  struct Call {
    Vector normal, v_free, v_smooth, v_previous, impulse, delassus;
    double gap = 0.0, area = 0.0;
    ilaw_batch_flags flags = 0;
    std::vector<double> parameters, state, next_state;
    std::array<double, ILAW_ENERGY_COUNT> energy{};
  };
  bool find_whether_it_stops() const;
  Call call_of(int node_index, const AuditedStep& step) const;
  void find_velocities(Call& call, int node_index, const AuditedStep& step) const;
  void turn(Call& call, const AuditedStep& step) const;
  void evaluate(Call& call, int node_index, const AuditedStep& step) const;
  bool answers(Call call, const Vector& found, int node_index, const AuditedStep& step, double bound);
  void check_node(int node_index, const AuditedStep& step);
  void check_beyond_border(int node_index) const;
  bool is_final_rupture(int node_index) const;
  void check_gap(const Call& call, int node_index, const AuditedStep& step, double relative_bound) const;
  void check_energy(const AuditedStep& step) const;
  [[noreturn]] void fail(int node_index, const std::string& what) const;

  const Interface& interface_;
  const Model& model_;
  const int d_;
  ilaw::interface law_;
  std::vector<std::size_t> axes_;
  const bool is_coupled_;
  bool stops_ = false;
  std::vector<std::vector<double>> states_;  // by node_index, before the step
  std::array<double, ILAW_ENERGY_COUNT> energy_{};
  double work_scale_ = 0.0, work_rounding_ = 0.0;  // of a step
};

}  // namespace ilaw::host
