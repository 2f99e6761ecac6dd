// fix_ilaw.hpp - what fix ilaw/pair and fix ilaw/wall share: the law, rows per atom that move with it, and
// the solve, which the last of all ilaw fixes of a run does for all of them together.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact_set.hpp"

#include <ilaw/coupled.hpp>

#include <fix.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixIlaw : public Fix {
 public:
  FixIlaw(LAMMPS* lammps, int narg, char** arg);
  ~FixIlaw() override;

  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void post_force(int) override;
  double compute_vector(int) override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double*) override;
  int unpack_exchange(int, double*) override;
  int pack_restart(int, double*) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  void write_restart(FILE*) override;
  void restart(char*) override;
  int pack_forward_comm(int, int*, double*, int, int*) override;
  void unpack_forward_comm(int, int, double*) override;
  int pack_reverse_comm(int, int, double*) override;
  void unpack_reverse_comm(int, int*, double*) override;
  double memory_usage() override;

 protected:
  // Words of the fix line that are not the law's: how many belong to the one at `at`, 0 if it is none.
  virtual int read_own(const std::vector<std::string>& words, std::size_t at) = 0;
  // Adds the contacts of this step to contacts_.
  virtual void find() = 0;
  virtual void check() {}

  void read_words();
  [[noreturn]] void refuse(const std::string& why);
  double number(const std::vector<std::string>& words, std::size_t at);
  const ilaw::lammps::Row& row(int index) const { return rows_[static_cast<std::size_t>(index)]; }

  std::unique_ptr<ilaw::lammps::ContactSet> contacts_;
  double moved_time_ = 0.0;  // since the start, for walls that move
  double area_ = 0.0;        // of a contact; 0: that of the grain's section

 private:
  using Kept = std::array<double, 6>;  // force and torque of the last step

  bool leads() const { return all_.back() == this; }
  void check_run();
  void check_integration();
  void evaluate(double velocity_step);
  ilaw_coupled_options options() const;
  void gather_bodies(double velocity_step);
  void solve();
  void add_forces(double velocity_step);
  void store();
  void tally();
  const double* velocity_after(int body) const { return &after_[6 * static_cast<std::size_t>(body)]; }
  void forward(double* values, int width);
  void reverse(double* values, int width);
  int pack(int index, double* buffer) const;
  int unpack(int index, const double* buffer);
  int most_packed() const;

  std::vector<FixIlaw*> all_;  // of this run
  std::string law_;
  std::vector<std::array<std::string, 2>> parameters_;
  std::vector<std::string> words_;
  std::vector<ilaw::lammps::Row> rows_;
  std::vector<Kept> kept_;
  bool evaluated_ = false;                      // these positions, by this fix for all
  double clock_ = 0.0;                          // of the laws
  double most_sweeps_ = 0.0, tolerance_ = 0.0;  // 0: left to the other fixes

  ilaw::coupled solver_;
  std::vector<double> motion_, inverse_mass_, inverse_inertia_, after_, total_;
  std::vector<std::int64_t> ids_;
  double* sent_ = nullptr;
  int width_ = 0;
  ilaw_coupled_report report_{};
  double contacts_closed_ = 0.0, overlap_ = 0.0, approach_ = 0.0, stored_ = 0.0;
  std::array<double, 3> dissipated_{};
};

}  // namespace LAMMPS_NS
