// SPDX-License-Identifier: BSD-3-Clause
#include "fix_ilaw_pair.hpp"

#include <atom.h>
#include <force.h>
#include <neigh_list.h>
#include <pair.h>

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

FixIlawPair::FixIlawPair(LAMMPS* lammps, int narg, char** arg) : FixIlaw(lammps, narg, arg) { read_words(); }

void FixIlawPair::check() {
  if (!force->pair) refuse("needs a pair style for its neighbour list, such as pair_style zero");
  double radius = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) radius = std::max(radius, atom->radius[i]);
  MPI_Allreduce(MPI_IN_PLACE, &radius, 1, MPI_DOUBLE, MPI_MAX, world);
  if (!(force->pair->cutforce > 2.0 * radius))
    refuse("the cutoff of the pair style has to be larger than the largest diameter, " +
           std::to_string(2.0 * radius));
}

void FixIlawPair::find() {
  const NeighList* list = force->pair->list;
  if (!list) refuse("the pair style has no neighbour list");
  const double cutoff = force->pair->cutforce;
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    if (!(atom->mask[i] & groupbit)) continue;
    for (int jj = 0; jj < list->numneigh[i]; ++jj) {
      const int j = list->firstneigh[i][jj] & NEIGHMASK;
      if (!(atom->mask[j] & groupbit)) continue;
      double squared = 0.0;
      for (int c = 0; c < 3; ++c) {
        const double along = atom->x[i][c] - atom->x[j][c];
        squared += along * along;
      }
      if (squared >= cutoff * cutoff) continue;
      // The roles are kept for life: the lower tag is the obstacle.
      if (atom->tag[i] > atom->tag[j])
        add(i, j, std::sqrt(squared));
      else
        add(j, i, std::sqrt(squared));
    }
  }
}

void FixIlawPair::add(int body, int counterpart, double distance) {
  if (atom->tag[body] == atom->tag[counterpart])
    refuse("a grain touches its own image: the box is too small");
  if (counterpart >= atom->nlocal) return;  // found by the rank of the counterpart, too
  ilaw::lammps::ContactSet::Contact contact{};
  contact.body = body;
  contact.counterpart = counterpart;
  contact.partner = atom->tag[body];
  for (int c = 0; c < 3; ++c)
    contact.normal[static_cast<std::size_t>(c)] = (atom->x[body][c] - atom->x[counterpart][c]) / distance;
  contact.arm = atom->radius[body];
  contact.counterpart_arm = atom->radius[counterpart];
  contact.gap = distance - contact.arm - contact.counterpart_arm;
  const double smaller = std::min(contact.arm, contact.counterpart_arm);
  contact.area = area_ > 0.0 ? area_ : M_PI * smaller * smaller;
  contacts_->add(contact, row(counterpart));
}

}  // namespace LAMMPS_NS
