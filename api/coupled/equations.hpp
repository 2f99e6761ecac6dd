// equations.hpp - the linear part of coupled contacts, for methods that solve systems: W = B B', where a row
// of B is a component of a contact's velocity and a column a degree of freedom of a body, times the root of
// its inverse mass.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sweep.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ilaw::coupled {

struct RowEntry {
  std::int32_t row, column;
  double value;
};

class Equations {
 public:
  // Rows: components of velocity, then of spin where there is a moment, over the contacts of awake blocks.
  // Columns 6 * body + component.
  void read(const Blocks& blocks, const Problem& problem);
  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return 6 * roots_.size(); }
  const std::vector<RowEntry>& entries() const { return entries_; }
  // Root of the mean of the diagonal of H, or of J, per three rows; and that of H, which makes velocities of
  // scaled impulses and moments.
  const std::vector<double>& scales() const { return scales_; }
  const std::vector<double>& speeds() const { return speeds_; }

 private:
  struct Root {
    Vector inverse_mass;        // roots of the components
    Symmetric inverse_inertia;  // symmetric root of the tensor
  };
  static Root root_of(const Inertia& inertia);

  std::size_t rows_ = 0;
  std::vector<RowEntry> entries_;
  std::vector<double> scales_, speeds_;
  std::vector<Root> roots_;            // of the bodies in the columns
  std::vector<std::int32_t> numbers_;  // of a body among them; -1: none
};

}  // namespace ilaw::coupled
