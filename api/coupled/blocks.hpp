// blocks.hpp - contacts in columns: up to 128 contacts of one law that share no movable body, which one call
// of the law evaluates.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "knobs.hpp"
#include "vector.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ilaw::coupled {

using knobs::max_lanes;
// The columns of a block are max_stride doubles apart at most. Not a multiple of the cache's sets: columns at
// distances of 1024 bytes would evict each other.
inline constexpr std::size_t max_stride = max_lanes + 8;

// Columns of all components of a block's contacts, at distances of max_stride.
inline constexpr std::size_t max_width = 6;
using Columns = std::array<double, max_width * max_stride>;

// First column of each quantity of a contact; -1 where a group does not have it.
struct Layout {
  explicit Layout(int components = 3) : width(components) {}

  int width;  // 3, or 6 where contacts have moments: impulse then moment, velocity then spin
  int normal = 0, impulse = 3, direction = 3 + width, change = 3 + 2 * width;
  int asked = 3 + 3 * width;  // v_free of the last evaluation
  int delassus = 3 + 4 * width;
  int length = -1;  // with moments: a spin times it is compared with velocities
  int arm = -1, counterpart_arm = -1, weight = -1, wall = -1;
  int gap = -1, gap_offset = -1, area = -1, v_smooth = -1, v_previous = -1, tangent = -1, parameters = -1;
  int state_in = -1, state_out = -1;
  int columns = 0;
  int delassus_size = 1, weight_size = 1, state_size = 0, ends = 2;
};

struct Block {
  const Layout* layout = nullptr;  // that of its group
  std::int32_t group = 0, colour = 0;
  std::size_t count = 0, stride = 0;  // lanes, and distance of columns: a multiple of 8
  double* values = nullptr;           // columns
  std::int32_t* ends = nullptr;       // bodies: those of the first side, then those of the counterpart's
  std::int32_t* contact = nullptr;    // index in the host's arrays
  std::uint8_t* status = nullptr;
  std::uint8_t* broken = nullptr;  // 1: its bond broke in this step, and stays so
  std::size_t order = 0;           // place of its first contact in the order of the colors
  bool asleep = false;             // out of reach and without impulse: left out of iterations
  double square = 0.0;             // of its contacts in the last iteration: dr.H dr
  bool has_broken = false;         // some lanes are broken
  bool is_refused = false;         // the last evaluation found bad input: those lanes have the status of it
  const char* reason = nullptr;

  double* column(int c) { return values + static_cast<std::size_t>(c) * stride; }
  const double* column(int c) const { return values + static_cast<std::size_t>(c) * stride; }
  // Body at end e of a contact.
  std::int32_t end(int e, std::size_t lane) const {
    return ends[static_cast<std::size_t>(e) * stride + lane];
  }
  Vector at(int c, std::size_t lane) const {
    const double* first = column(c) + lane;
    return {first[0], first[stride], first[2 * stride]};
  }
  void put(int c, std::size_t lane, const Vector& v) {
    double* first = column(c) + lane;
    first[0] = v[0], first[stride] = v[1], first[2 * stride] = v[2];
  }
  // Whether impulse and moment are zero.
  bool is_free(std::size_t lane) const {
    const double* first = column(layout->impulse) + lane;
    for (std::size_t c = 0; c < static_cast<std::size_t>(layout->width); ++c)
      if (first[c * stride] != 0.0) return false;
    return true;
  }
};

// Mean of the diagonal of H. Its root is the scale of a contact's impulse.
inline double mean_delassus(const Block& block, std::size_t q) {
  const double* h = block.column(block.layout->delassus) + q;
  const std::size_t s = block.stride;
  switch (block.layout->delassus_size) {
    case 1:
      return h[0];
    case 2:
    case 5:
      return (h[0] + 2.0 * h[s]) / 3.0;
    case 3:
      return 0.5 * (h[0] + h[s]);
    default:
      return (h[0] + h[s] + h[2 * s]) / 3.0;
  }
}

// Mean of the diagonal of J, the response of the spin to a moment.
inline double mean_spin_delassus(const Block& block, std::size_t q) {
  const double* j = block.column(block.layout->delassus + 3) + q;
  return (j[0] + 2.0 * j[block.stride]) / 3.0;
}

// Appends the scales of a contact's impulse and, where it has one, moment, three components each.
inline void push_scales(const Block& block, std::size_t q, std::vector<double>& scales) {
  scales.push_back(std::sqrt(mean_delassus(block, q)));
  if (block.layout->width > 3) scales.push_back(std::sqrt(mean_spin_delassus(block, q)));
}

// Largest component of a contact's velocity and spin, given in columns at distances of max_stride. A spin is
// compared with velocities by the energies of both, v^2/h and w^2/j: it counts times the root of h/j, which
// is about the radius of a sphere.
inline double size_at(const Block& block, const double* columns, std::size_t q) {
  const double velocity = largest(columns_at<3>(columns + q, max_stride));
  if (block.layout->length < 0) return velocity;
  const double spin = largest(columns_at<3>(columns + 3 * max_stride + q, max_stride));
  return std::fmax(velocity, block.column(block.layout->length)[q] * spin);
}

// Place of a contact.
struct Lane {
  std::int32_t block, lane;
};

// Blocks in the order of an iteration, with their memory.
class Blocks {
 public:
  void clear() { blocks_.clear(); }
  // Adds a block; allocate() gives all of them their columns.
  Block& add(const Layout& layout, std::int32_t group, std::int32_t colour, std::size_t count);
  void allocate();
  // Becomes these lanes of `from`, in their order. Neighbours of one color are joined.
  void select(const Blocks& from, std::span<const Lane> lanes);
  // Copies impulses, states and status back to the lanes they were selected from.
  void give_back(Blocks& to) const;

  // Of all columns.
  std::size_t bytes() const { return sizeof(double) * size_; }
  std::vector<Block>& list() { return blocks_; }
  const std::vector<Block>& list() const { return blocks_; }

 private:
  std::vector<Block> blocks_;
  std::vector<double> values_;  // room for more
  std::size_t size_ = 0;        // of all columns
  std::vector<std::int32_t> integers_;
  std::vector<std::uint8_t> bytes_;
  std::span<const Lane> origins_;
};

}  // namespace ilaw::coupled
