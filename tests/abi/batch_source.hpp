// Random batches of any law that can be loaded: drawn from its description alone, with doubles of every
// class, corrupt states, strides and indices of every sort, all of them within arrays of their own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/loader.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#if defined(__SANITIZE_ADDRESS__)
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
  // Of 53 bits in [0, 1): exact, whatever the compiler is allowed.
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

// Any double: of a class each, or any bits at all.
inline double any_double(Draw& draw) {
  constexpr std::uint64_t classes[] = {
      0x0000000000000000, 0x8000000000000000, 0x0000000000000001, 0x000FFFFFFFFFFFFF, 0x0010000000000000,
      0x7FEFFFFFFFFFFFFF, 0xFFEFFFFFFFFFFFFF, 0x7FF0000000000000, 0xFFF0000000000000, 0x7FF8000000000000,
      0x7FF0000000000001, 0xFFF8DEADBEEF0000, 0x3FF0000000000000, 0x3FF0000000000001, 0x3FEFFFFFFFFFFFFF,
      0xBFF0000000000000, 0x4330000000000000, 0x43E0000000000000, 0x3CB0000000000000, 0x01A56E1FC2F8F359};
  return draw.one_in(3) ? of_bits(draw.bits()) : of_bits(classes[draw.below(std::size(classes))]);
}

// How wild the numbers of a batch are.
struct Temper {
  std::uint64_t odd = 0;  // one number in so many is any double; 0: none
  double number(Draw& draw, double low, double high) const {
    return odd != 0 && draw.one_in(odd) ? any_double(draw) : draw.within(low, high);
  }
};

// Doubles that a batch may touch: each array between others that it may not, which the address sanitizer
// minds.
class Arena {
 public:
  static constexpr std::size_t capacity = std::size_t{1} << 18;
  Arena() : doubles_(capacity, of_bits(0x7FF4000000000000)) {
    ASAN_POISON_MEMORY_REGION(doubles_.data(), capacity * sizeof(double));
  }
  ~Arena() { ASAN_UNPOISON_MEMORY_REGION(doubles_.data(), capacity * sizeof(double)); }
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  void empty() {
    ASAN_POISON_MEMORY_REGION(doubles_.data(), used_ * sizeof(double));
    used_ = 0;
  }
  double* span(std::size_t count) {
    used_ += 2;
    double* first = doubles_.data() + used_;
    used_ += count + 2;
    if (used_ > capacity) throw std::length_error("a batch larger than the arena");
    return first;
  }

 private:
  std::vector<double> doubles_;
  std::size_t used_ = 0;
};

// An array as a batch has it, and where its values stand.
struct Array {
  double* values = nullptr;
  std::int64_t node_stride = 0, component_stride = 0;
  ilaw_input input() const { return {values, node_stride, component_stride}; }
  ilaw_output output() const { return {values, node_stride, component_stride}; }
  double& at(std::int64_t node, std::size_t component) const {
    return values[node * node_stride + static_cast<std::int64_t>(component) * component_stride];
  }
};

// A law of a library with parameters drawn from its description.
class Drawn {
 public:
  // Nothing where the law refuses the draw, as it may.
  static std::optional<Drawn> of(const ilaw::library& library, Draw& draw);

  const ilaw::interface& interface() const { return *interface_; }
  const ilaw_instance_info& info() const { return info_; }
  std::size_t dimension() const { return setup_.dimension; }
  bool global() const { return setup_.frame == ILAW_FRAME_GLOBAL; }
  bool tangent() const { return setup_.tangent_given != 0; }
  std::uint32_t form() const { return setup_.delassus_form; }

 private:
  std::optional<ilaw::interface> interface_;
  ilaw_setup setup_{};
  ilaw_instance_info info_{};
};

// What a run of batches saw.
struct Tally {
  std::uint64_t batches = 0, nodes = 0, bad = 0, refused = 0;
  std::uint64_t digest = 0xCBF29CE484222325;  // of all outputs: FNV-1a (Fowler, Noll, Vo), by words
  std::string wrong;                          // the first promise broken, empty where none

  void add(std::uint64_t word) { digest = (digest ^ word ^ word >> 32) * 0x100000001B3; }
  void add(double value) {
    std::uint64_t word;
    std::memcpy(&word, &value, sizeof word);
    add(word);
  }
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
    call(&ilaw::interface::initialise, tally);
    for (int n = 0; n < steps && tally.wrong.empty(); ++n) {
      fill_step(n);
      call(&ilaw::interface::evaluate, tally);
    }
  }

 private:
  using Call = std::int32_t (ilaw::interface::*)(const ilaw_batch&, ilaw_report*) const;

  void draw_nodes();
  void draw_arrays();
  void describe();
  void fill_step(int n);
  void fill_frames();
  void fill_delassus();
  void fill_state();
  void call(Call function, Tally& tally);
  void check(std::int32_t code, const ilaw_report& report, bool evaluated, Tally& tally);
  std::size_t form_width() const;

  const Drawn& drawn_;
  Draw& draw_;
  Temper temper_;
  Arena& arena_;
  std::vector<std::int64_t> nodes_;  // in use, in the order of the batch
  std::int64_t room_ = 0;
  std::vector<std::int32_t> index_;
  std::vector<std::int64_t> index64_;
  Array v_free_, delassus_, gap_, offset_, previous_, area_, normal_, tangent_, state_in_, state_out_,
      impulse_, velocity_, energy_;
  std::vector<Array> per_node_;
  std::vector<ilaw_input> per_node_inputs_;
  std::array<std::uint8_t, 64> status_{};
  ilaw_batch batch_{};
  bool in_place_ = false;
};

}  // namespace random_batches
