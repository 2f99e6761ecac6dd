// contacts.hpp - the contacts of one law: their impulses, and the law's answers to velocities of bodies.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bodies.hpp"

#include <ilaw/coupled.h>

#include <cstdint>
#include <vector>

namespace ilaw::coupled {

class Contacts {
 public:
  // Reads what the host gave, impulses to begin with among it. Returns why not, or null.
  const char* open(const ilaw_contacts& given, const Bodies& bodies);

  // Adds count of active contacts, impulses and moments to the sums per body.
  void add_to(std::vector<double>& sums, const Bodies& bodies) const;
  // H of each contact with its bodies' masses divided among their active contacts. A contact that is not
  // active counts itself besides.
  void split(const std::vector<double>& sums, const Bodies& bodies);

  // The law's answer to the velocities that the trial impulses make. Returns the law's code.
  std::int32_t evaluate(const std::vector<Motion>& of_trial);
  // How far the velocities of the contacts are from those that the law answered to, and how large
  // velocities are.
  struct Residual {
    double difference, size;
  };
  Residual residual(const std::vector<Motion>& of_answer) const;
  // The next trial: the answer, taken further by so much of its change.
  void extrapolate(double by);

  // Writes impulse, state and status of the last answer, and energies with these velocities.
  std::int32_t write(const std::vector<Motion>& of_answer, const Bodies& bodies, ilaw_coupled_report& report);

  const ilaw_report& report() const { return report_; }

 private:
  struct Contact {
    std::int64_t body, counterpart;  // below 0: a wall
    Vector normal, arm, counterpart_arm, wall, wall_previous;
    Symmetric delassus, counterpart_delassus;  // of masses that are not split
    bool active;                               // had an impulse in this step
  };

  const char* complaint() const;
  const char* complaint_of_bodies(const Bodies& bodies) const;
  const char* complaint_of_law(const Bodies& bodies);
  bool asks_balance() const { return theirs_.energy.values || theirs_.amounts; }
  bool has_arm_aside(std::int64_t k) const;
  void read(const Bodies& bodies);
  void make_room();
  void describe_batch();
  Vector relative(const Contact& contact, const std::vector<Motion>& motions) const;
  Vector split_response(std::size_t k, const Vector& impulse) const;
  Vector previous(const Contact& contact, const Bodies& bodies) const;
  std::int32_t call(const ilaw_batch& batch, const std::vector<Motion>& motions,
                    const std::vector<Vector>& impulses);
  bool is_bad(std::size_t k) const { return status_[k] == ILAW_BAD_INPUT; }

  ilaw_contacts given_{};
  ilaw_batch theirs_{}, ours_{};
  ilaw_report report_{};
  ilaw_instance_info info_{};
  std::uint32_t dimension_ = 0;
  std::size_t form_size_ = 0;
  std::vector<Contact> contacts_;
  std::vector<Vector> answer_, before_, trial_, v_free_, v_previous_;
  std::vector<double> delassus_, state_, spare_state_, energy_;
  std::vector<std::uint8_t> status_;
};

}  // namespace ilaw::coupled
