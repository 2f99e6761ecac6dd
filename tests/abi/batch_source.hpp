// Random batches of any law that can be loaded: drawn from its description alone, with doubles of every
// class, corrupt states, strides and indices of every sort, all of them within arrays of their own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/loader.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

// Its macros do nothing without the address sanitizer; compilers differ in how they say that it is on.
#if __has_include(<sanitizer/asan_interface.h>)
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(address, size) ((void)(address), (void)(size))
#define ASAN_UNPOISON_MEMORY_REGION(address, size) ((void)(address), (void)(size))
#endif

namespace random_batches {

// splitmix64: Steele, Lea, Flood (2014), Fast splittable pseudorandom number generators.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15U;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9U;
    z = (z ^ z >> 27) * 0x94D049BB133111EBU;
    return z ^ z >> 31;
  }
  // Without a division, for n below 2^32: Lemire (2019), Fast random integer generation in an interval.
  std::uint64_t below(std::uint64_t n) { return (bits() >> 32) * n >> 32; }
  bool one_in(std::uint64_t n) { return below(n) == 0; }
  // A number of 53 bits in [0, 1): exact, whatever the compiler is allowed.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double within(double low, double high) { return low + (high - low) * unit(); }

 private:
  std::uint64_t state_;
};

inline double of_bits(std::uint64_t bits) {
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}
inline std::uint64_t bits_of(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
inline std::uint32_t bits_of(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

// Any double: of a class each, or any bits at all.
inline double any_double(Draw& draw) {
  constexpr std::uint64_t classes[] = {
      0x0000000000000000, 0x8000000000000000, 0x0000000000000001, 0x000FFFFFFFFFFFFF, 0x0010000000000000,
      0x7FEFFFFFFFFFFFFF, 0xFFEFFFFFFFFFFFFF, 0x7FF0000000000000, 0xFFF0000000000000, 0x7FF8000000000000,
      0x7FF0000000000001, 0xFFF8DEADBEEF0000, 0x3FF0000000000000, 0x3FF0000000000001, 0x3FEFFFFFFFFFFFFF,
      0xBFF0000000000000, 0x4330000000000000, 0x43E0000000000000, 0x3CB0000000000000, 0x01A56E1FC2F8F359};
  return draw.one_in(3) ? of_bits(draw.bits()) : of_bits(classes[draw.below(std::size(classes))]);
}

// The bits of any float, drawn likewise. Never by way of a double, since hosts may trap or flush what that
// would round.
inline std::uint32_t any_float(Draw& draw) {
  constexpr std::uint32_t classes[] = {0x00000000, 0x80000000, 0x00000001, 0x007FFFFF, 0x00800000,
                                       0x7F7FFFFF, 0xFF7FFFFF, 0x7F800000, 0xFF800000, 0x7FC00000,
                                       0x7F800001, 0xFFC0BEEF, 0x3F800000, 0x3F800001, 0x3F7FFFFF,
                                       0xBF800000, 0x4B000000, 0x5F000000, 0x34000000, 0x0D2F3788};
  return draw.one_in(3) ? static_cast<std::uint32_t>(draw.bits()) : classes[draw.below(std::size(classes))];
}

// How wild the numbers of a batch are.
struct Temper {
  std::uint64_t odd = 0;  // one number in so many is any double or float; 0: none
  bool is_odd(Draw& draw) const { return odd != 0 && draw.one_in(odd); }
};

// Numbers that a batch may touch: each array between others that it may not, which the address sanitizer
// minds, of floats by pairs.
template <class Number>
class Region {
 public:
  static constexpr std::size_t capacity = std::size_t{1} << 18;
  explicit Region(Number unused) : numbers_(capacity, unused) {
    ASAN_POISON_MEMORY_REGION(numbers_.data(), capacity * sizeof(Number));
  }
  ~Region() { ASAN_UNPOISON_MEMORY_REGION(numbers_.data(), capacity * sizeof(Number)); }
  Region(const Region&) = delete;
  Region& operator=(const Region&) = delete;

  void empty() {
    ASAN_POISON_MEMORY_REGION(numbers_.data(), used_ * sizeof(Number));
    used_ = 0;
  }
  Number* span(std::size_t count) {
    used_ += between;
    Number* first = numbers_.data() + used_;
    used_ += count + between;
    if (used_ > capacity) throw std::length_error("a batch larger than the arena");
    return first;
  }

 private:
  static constexpr std::size_t between = 2 * sizeof(double) / sizeof(Number);
  std::vector<Number> numbers_;
  std::size_t used_ = 0;
};

struct Arena {
  Region<double> doubles{of_bits(0x7FF4000000000000)};
  Region<float> floats{std::numeric_limits<float>::quiet_NaN()};
  void empty() {
    doubles.empty();
    floats.empty();
  }
};

// An array as a batch has it, of doubles or of floats, and where its values stand.
struct Array {
  double* values = nullptr;
  float* floats = nullptr;
  std::int64_t node_stride = 0, component_stride = 0;
  ilaw_input input() const { return {values, floats, node_stride, component_stride}; }
  ilaw_output output() const { return {values, floats, node_stride, component_stride}; }

  bool is_given() const { return values || floats; }
  double get(std::int64_t node, std::size_t c) const {
    return floats ? double{floats[at(node, c)]} : values[at(node, c)];
  }
  std::uint64_t bits(std::int64_t node, std::size_t c) const {
    return floats ? bits_of(floats[at(node, c)]) : bits_of(values[at(node, c)]);
  }
  // By their bits, since -ffast-math would have no number be infinite or NaN.
  bool is_finite(std::int64_t node, std::size_t c) const {
    return floats ? (bits(node, c) >> 23 & 0xFF) != 0xFF : (bits(node, c) >> 52 & 0x7FF) != 0x7FF;
  }
  bool is_nan(std::int64_t node, std::size_t c) const {
    return (bits(node, c) & ~(std::uint64_t{1} << (floats ? 31 : 63))) >
           (floats ? 0x7F800000 : 0x7FF0000000000000);
  }
  void put(std::int64_t node, std::size_t c, double value) const {
    if (floats)
      floats[at(node, c)] = static_cast<float>(value);
    else
      values[at(node, c)] = value;
  }
  void put_any(std::int64_t node, std::size_t c, Draw& draw) const {
    if (!floats) {
      values[at(node, c)] = any_double(draw);
      return;
    }
    const std::uint32_t drawn = any_float(draw);
    std::memcpy(&floats[at(node, c)], &drawn, sizeof drawn);
  }

  std::int64_t at(std::int64_t node, std::size_t component) const {
    return node * node_stride + static_cast<std::int64_t>(component) * component_stride;
  }
};

// A law of a library with parameters drawn from its description.
class Drawn {
 public:
  // Nothing where the law refuses the draw, as it may.
  static std::optional<Drawn> of(const ilaw::library& library, Draw& draw);
  // Before and after the law is created.
  static inline void (*before)() = nullptr;
  static inline void (*after)() = nullptr;

  const ilaw::interface& interface() const { return *interface_; }
  const ilaw_instance_info& info() const { return info_; }
  std::size_t dimension() const { return setup_.dimension; }
  bool spins() const { return setup_.delassus_form == ILAW_DELASSUS_TRANSVERSE_SPIN; }
  bool global() const { return setup_.frame == ILAW_FRAME_GLOBAL; }
  bool tangent() const { return setup_.has_tangent != 0; }
  std::uint32_t form() const { return setup_.delassus_form; }
  bool floats() const { return setup_.numbers == ILAW_NUMBERS_FLOAT; }

 private:
  std::optional<ilaw::interface> interface_;
  ilaw_setup setup_{};
  ilaw_instance_info info_{};
};

// Counts over a run of batches.
struct Tally {
  std::uint64_t batches = 0, of_floats = 0, nodes = 0, bad = 0, refused = 0;
  std::uint64_t digest = 0xCBF29CE484222325;  // of all outputs: FNV-1a (Fowler, Noll, Vo), by words
  std::string wrong;                          // the first promise broken, empty where none

  void add(std::uint64_t word) { digest = (digest ^ word ^ word >> 32) * 0x100000001B3; }
};

// Runs batches of one instance, one step after another from the state that it wrote, and checks what it
// gives.
class Runner {
 public:
  Runner(const Drawn& drawn, Draw& draw, const Temper& temper, Arena& arena)
      : drawn_(drawn), draw_(draw), temper_(temper), arena_(arena) {}

  // Before and after each call of the law: a host's floating-point settings.
  void (*before)() = nullptr;
  void (*after)() = nullptr;

  void run(int steps, Tally& tally) {
    arena_.empty();
    draw_nodes();
    draw_arrays();
    describe();
    call(false, tally);
    for (int n = 0; n < steps && tally.wrong.empty(); ++n) {
      fill_step(n);
      call(true, tally);
    }
  }

 private:
  void draw_nodes();
  void draw_arrays();
  void describe();
  void fill_step(int n);
  void fill_frames();
  void fill_delassus();
  void fill_state();
  void call(bool evaluates, Tally& tally);
  void check(std::int32_t code, const ilaw_report& report, bool evaluated, Tally& tally);
  std::string wrong_at(std::int64_t node, bool is_bad) const;
  void fill(const Array& a, std::size_t begin, std::size_t end, double low, double high);
  std::size_t form_width() const;

  const Drawn& drawn_;
  Draw& draw_;
  Temper temper_;
  Arena& arena_;
  std::vector<std::int64_t> nodes_;  // in use, in the order of the batch
  std::int64_t room_ = 0;
  std::vector<std::int32_t> index_;
  std::vector<std::int64_t> index64_;
  Array v_free_, delassus_, gap_, offset_, previous_, smooth_, spin_free_, spin_previous_, area_, normal_,
      tangent_, state_in_, state_out_, impulse_, moment_, velocity_, spin_, energy_;
  std::vector<Array> per_node_, amounts_;
  std::vector<ilaw_input> per_node_inputs_;
  std::vector<ilaw_output> amount_outputs_;
  std::vector<std::uint8_t> status_;
  ilaw_batch batch_{};
  bool in_place_ = false;
};

}  // namespace random_batches
