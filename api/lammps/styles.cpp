// Makes the styles known to a running LAMMPS. Called by ilaw.lmp, through LAMMPS' python command.
// SPDX-License-Identifier: BSD-3-Clause
#include "fix_ilaw_pair.hpp"
#include "fix_ilaw_wall.hpp"

#include <lammps.h>
#include <modify.h>

namespace {

template <class Style>
LAMMPS_NS::Fix* create(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg) {
  return new Style(lammps, narg, arg);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void ilaw_lammps_styles(void* lammps) {
  auto& styles = *static_cast<LAMMPS_NS::LAMMPS*>(lammps)->modify->fix_map;
  styles["ilaw/pair"] = create<LAMMPS_NS::FixIlawPair>;
  styles["ilaw/wall"] = create<LAMMPS_NS::FixIlawWall>;
}
