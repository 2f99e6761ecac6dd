// SPDX-License-Identifier: BSD-3-Clause
#include "fix_ilaw_pair.hpp"

#include <atom.h>
#include <comm.h>
#include <error.h>
#include <force.h>
#include <group.h>
#include <modify.h>
#include <neigh_list.h>
#include <pair.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>

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
  warn_of_strangers();
}

// Where no pair style acts either, two grains meet only if a fix has both in its group. The last fix says it
// for all.
void FixIlawPair::warn_of_strangers() {
  if (!force->pair_match("zero", 1)) return;
  int of_laws = 0;
  const FixIlawPair* last = nullptr;
  for (int i = 0; i < modify->nfix; ++i)
    if (const auto* other = dynamic_cast<FixIlawPair*>(modify->fix[i])) {
      of_laws |= other->groupbit;
      last = other;
    }
  if (last != this) return;
  std::set<int> here;
  for (int i = 0; i < atom->nlocal; ++i) here.insert(atom->mask[i] & of_laws);
  const std::vector<int> sent(here.begin(), here.end());
  int count = static_cast<int>(sent.size());
  std::vector<int> counts(static_cast<std::size_t>(comm->nprocs)), first(counts.size());
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  std::exclusive_scan(counts.begin(), counts.end(), first.begin(), 0);
  std::vector<int> all(static_cast<std::size_t>(first.back() + counts.back()));
  MPI_Allgatherv(sent.data(), count, MPI_INT, all.data(), counts.data(), first.data(), MPI_INT, world);
  if (comm->me != 0) return;
  const std::set<int> groups(all.begin(), all.end());
  for (auto one = groups.begin(); one != groups.end(); ++one)
    for (auto other = std::next(one); other != groups.end(); ++other)
      if ((*one & *other) == 0)
        error->warning(FLERR, "Fix ilaw/pair: grains of " + name(*one) + " and of " + name(*other) +
                                  " pass through each other, since no fix ilaw/pair has both in its group");
}

std::string FixIlawPair::name(int mask) const {
  std::string names;
  for (int g = 0; g < group->ngroup; ++g)
    if (mask & group->bitmask[g])
      names += (names.empty() ? "group " : " and ") + std::string(group->names[g]);
  return names.empty() ? "no group of one" : names;
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
