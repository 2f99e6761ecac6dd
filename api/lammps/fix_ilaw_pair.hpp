// fix_ilaw_pair.hpp - fix ilaw/pair: a law between grains.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fix_ilaw.hpp"

namespace LAMMPS_NS {

class FixIlawPair : public FixIlaw {
 public:
  FixIlawPair(LAMMPS* lammps, int narg, char** arg);

 private:
  int read_own(const std::vector<std::string>&, std::size_t) override { return 0; }
  void find() override;
  void check() override;
  void warn_of_strangers();
  std::string name(int mask) const;
  void add(int body, int counterpart, double distance);
};

}  // namespace LAMMPS_NS
