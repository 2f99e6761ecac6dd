// Data of fix ilaw per atom, as LAMMPS moves it: with the atom to other ranks, into restart files and
// back.
// SPDX-License-Identifier: BSD-3-Clause
#include "fix_ilaw.hpp"

#include <atom.h>
#include <error.h>

#include <algorithm>

namespace LAMMPS_NS {
namespace {

constexpr std::size_t head = 7;  // length, force, torque
// In a restart file: state version, size of a contact's entry, clocks, whether evaluated, energies.
enum { VERSION, SIZE, CLOCK, MOVED, EVALUATED, DISSIPATED, GLOBALS = DISSIPATED + 3 };

}  // namespace

void FixIlaw::grow_arrays(int most) {
  rows_.resize(static_cast<std::size_t>(most));
  kept_.resize(static_cast<std::size_t>(most));
}

void FixIlaw::copy_arrays(int from, int to, int) {
  rows_[static_cast<std::size_t>(to)] = rows_[static_cast<std::size_t>(from)];
  kept_[static_cast<std::size_t>(to)] = kept_[static_cast<std::size_t>(from)];
}

void FixIlaw::set_arrays(int index) {
  rows_[static_cast<std::size_t>(index)].clear();
  kept_[static_cast<std::size_t>(index)] = {};
}

// Length first, as restart files want it.
int FixIlaw::pack(int index, double* buffer) const {
  const auto& row = rows_[static_cast<std::size_t>(index)];
  const Kept& kept = kept_[static_cast<std::size_t>(index)];
  buffer[0] = static_cast<double>(head + row.size());
  std::copy(kept.begin(), kept.end(), buffer + 1);
  std::copy(row.begin(), row.end(), buffer + head);
  return static_cast<int>(head + row.size());
}

int FixIlaw::unpack(int index, const double* buffer) {
  const auto length = static_cast<std::size_t>(buffer[0]);
  std::copy(buffer + 1, buffer + head, kept_[static_cast<std::size_t>(index)].begin());
  rows_[static_cast<std::size_t>(index)].assign(buffer + head, buffer + length);
  return static_cast<int>(length);
}

int FixIlaw::most_packed() const {
  std::size_t most = 0;
  for (int i = 0; i < atom->nlocal; ++i) most = std::max(most, rows_[static_cast<std::size_t>(i)].size());
  return static_cast<int>(head + most);
}

int FixIlaw::pack_exchange(int index, double* buffer) { return pack(index, buffer); }
int FixIlaw::unpack_exchange(int index, double* buffer) { return unpack(index, buffer); }
int FixIlaw::pack_restart(int index, double* buffer) { return pack(index, buffer); }
int FixIlaw::size_restart(int index) {
  return static_cast<int>(head + rows_[static_cast<std::size_t>(index)].size());
}
int FixIlaw::maxsize_restart() { return most_packed(); }

void FixIlaw::unpack_restart(int index, int nth) {
  const double* extra = atom->extra[index];
  for (int i = 0; i < nth; ++i) extra += static_cast<std::ptrdiff_t>(*extra);
  unpack(index, extra);
}

void FixIlaw::write_restart(FILE* file) {
  double values[GLOBALS] = {static_cast<double>(contacts_->state_version()),
                            static_cast<double>(contacts_->entry_size()), clock_, moved_time_,
                            evaluated_ ? 1.0 : 0.0};
  MPI_Reduce(dissipated_.data(), values + DISSIPATED, 3, MPI_DOUBLE, MPI_SUM, 0, world);
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  if (rank != 0) return;
  const int size = sizeof values;
  fwrite(&size, sizeof size, 1, file);
  fwrite(values, sizeof(double), GLOBALS, file);
}

void FixIlaw::restart(char* buffer) {
  const auto* values = reinterpret_cast<const double*>(buffer);
  if (values[VERSION] != contacts_->state_version() ||
      values[SIZE] != static_cast<double>(contacts_->entry_size()))
    refuse("the restart file has states of another law, version or memory");
  clock_ = values[CLOCK];
  moved_time_ = values[MOVED];
  evaluated_ = values[EVALUATED] != 0.0;
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  if (rank == 0) std::copy_n(values + DISSIPATED, 3, dissipated_.begin());
}

double FixIlaw::memory_usage() {
  double bytes = static_cast<double>(rows_.capacity() * sizeof rows_[0] + kept_.capacity() * sizeof kept_[0]);
  for (const auto& row : rows_) bytes += static_cast<double>(row.capacity() * sizeof(double));
  return bytes;
}

}  // namespace LAMMPS_NS
