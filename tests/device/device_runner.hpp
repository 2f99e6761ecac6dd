// device_runner.hpp - the same batch by the library on the CPU and by its kernels on a device, to compare all
// bytes that either wrote.
#pragma once

#include "support/law_cases.hpp"

#include <ilaw/device.h>

#include <cstring>
#include <random>
#include <set>

namespace ilaw::testing {

// Whether this build gave the law kernels (ILAW_KERNELS).
inline bool has_kernels(const std::string& name) {
  const ilaw::library library(plugin_file(name));
  const ilaw_law& law = *library.law(name);
  return law.extension && law.extension(ILAW_DEVICE);
}

// Windows and tables that a step reads are not served.
inline std::vector<LawCase> served_cases() {
  std::vector<LawCase> cases;
  for (LawCase& given : law_cases("contract")) {
    if (given.law == "table_friction" || !has_kernels(given.law)) continue;
    if (given.parameters.numbers.contains("memory")) given.parameters.numbers["memory"] = 0.0;
    cases.push_back(std::move(given));
  }
  return cases;
}

// The driver under test: OpenCL, or what ILAW_TEST_DRIVER names.
inline ilaw_kind tested_driver() {
  const char* const name = std::getenv("ILAW_TEST_DRIVER");
  return name && std::strcmp(name, "cuda") == 0 ? ILAW_DRIVER_CUDA : ILAW_DRIVER_OPENCL;
}

// Null where this machine has none; why: what the library says.
class Device {
 public:
  Device() {
    setenv("ILAW_SPIRV_TRANSLATOR", ILAW_TRANSLATOR, 0);
    setenv("POCL_CACHE_DIR", ILAW_POCL_CACHE, 0);
    ilaw_device_open(tested_driver(), 0, &device_, why_, sizeof why_);
  }
  ~Device() { ilaw_device_close(device_); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  ilaw_device* get() const { return device_; }
  const char* why() const { return why_; }

  // pocl takes minutes to compile the kernels of a law with a large solver. ILAW_TEST_WHOLE: all the same.
  bool takes_minutes_for(const std::string& law) const {
    static const std::set<std::string> quick{"conductance", "contact", "coulomb", "template_law", "tie"};
    const bool is_pocl = std::string(ilaw_device_name(device_)).starts_with("pthread-");
    return is_pocl && !quick.contains(law) && !std::getenv("ILAW_TEST_WHOLE");
  }

  // One for all tests: its images stay loaded.
  static Device& shared() {
    static Device device;
    return device;
  }

 private:
  ilaw_device* device_ = nullptr;
  char why_[512] = "";
};

// All arrays of a batch side by side in one block of bytes, here and on the device.
class Block {
 public:
  // Room for an array, filled by value(k).
  template <class T, class Value>
  T* add(std::size_t count, Value value) {
    const std::size_t first = (used_ + 63) / 64 * 64;
    used_ = first + count * sizeof(T);
    if (used_ > bytes_.size()) throw std::runtime_error("the block is too small");
    T* const array = reinterpret_cast<T*>(bytes_.data() + first);
    for (std::size_t k = 0; k < count; ++k) array[k] = static_cast<T>(value(k));
    return array;
  }

  explicit Block(std::size_t size) : bytes_(size, 0xAB) {}
  unsigned char* begin() { return bytes_.data(); }
  std::size_t used() const { return used_; }

 private:
  std::vector<unsigned char> bytes_;
  std::size_t used_ = 0;
};

// A pointer into one block as the same of another.
template <class T>
void move_pointer(T*& pointer, const unsigned char* from, unsigned char* to) {
  if (!pointer) return;
  const auto* const at = reinterpret_cast<const unsigned char*>(pointer);
  pointer = reinterpret_cast<T*>(to + (at - from));
}

struct Use {
  std::uint32_t dimension = 3, form = ILAW_DELASSUS_SCALAR, frame = ILAW_FRAME_LOCAL;
  bool tangent = false, is_float = false;
  bool by_columns = false, listed = false, energy = true;

  friend void PrintTo(const Use& use, std::ostream* out) {
    *out << use.dimension << "D " << name_of_form(use.form)
         << (use.frame == ILAW_FRAME_LOCAL ? " local" : " global") << (use.tangent ? " with tangents" : "")
         << (use.is_float ? " float" : " double") << (use.by_columns ? " columns" : " rows")
         << (use.listed ? " listed" : "") << (use.energy ? " energy" : "");
  }
};

inline int delassus_numbers(const Use& use) {
  const int d = static_cast<int>(use.dimension);
  if (use.form == ILAW_DELASSUS_SCALAR) return 1;
  if (use.form == ILAW_DELASSUS_TRANSVERSE) return 2;
  return use.form == ILAW_DELASSUS_DIAGONAL ? d : d * (d + 1) / 2;
}

// Random nodes of a law in a block: every seventh is open, and with bad nodes one in 23 is spoilt.
class Scene {
 public:
  static constexpr std::int64_t count = 301, columns_stride = count + 3;

  Scene(const LawCase& given, const Use& use, unsigned seed, bool with_bad)
      : use_(use),
        builder_(given.parameters, use.dimension, use.form, use.frame, use.tangent),
        interface_(made(given.law, builder_, use.is_float)),
        info_(interface_.info()),
        block_(count * 8 * (64 + 2 * info_.state_size + 2 * info_.per_node_parameter_count) + 65536),
        random_(seed) {
    fill(with_bad);
  }

  const ilaw::interface& law() const { return interface_; }
  Block& block() { return block_; }
  const ilaw_batch& batch() const { return batch_; }

  // The batch with all pointers in another block; storage for the arrays of arrays.
  ilaw_batch batch_in(unsigned char* to, std::vector<ilaw_input>& per_node,
                      std::vector<ilaw_output>& amounts) {
    ilaw_batch b = batch_;
    const auto move = [&](auto& a) {
      move_pointer(a.values, block_.begin(), to);
      move_pointer(a.floats, block_.begin(), to);
    };
    for (ilaw_input* a : {&b.v_free, &b.delassus, &b.gap, &b.gap_offset, &b.v_previous, &b.area, &b.normal,
                          &b.tangent, &b.state_in})
      move(*a);
    for (ilaw_output* a : {&b.state_out, &b.impulse, &b.velocity, &b.energy}) move(*a);
    move_pointer(b.status, block_.begin(), to);
    move_pointer(b.index, block_.begin(), to);
    per_node = per_node_;
    amounts = amounts_;
    for (ilaw_input& a : per_node) move(a);
    for (ilaw_output& a : amounts) move(a);
    b.per_node_parameters = per_node.data();
    b.amounts = amounts.data();
    return b;
  }

  void next_step(double step) {
    batch_.time += step;
    batch_.velocity_step = batch_.position_step = step;
  }

 private:
  static ilaw::interface made(const std::string& law, SetupBuilder& builder, bool is_float) {
    builder.setup.numbers = is_float ? ILAW_NUMBERS_FLOAT : ILAW_NUMBERS_DOUBLE;
    return make_law(law, builder);
  }
  double uniform(double low = -1.0, double high = 1.0) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }

  // Component c of node i is value(i, c).
  template <class Array, class Value>
  Array array(int components, Value value) {
    const auto n = static_cast<std::size_t>(count), width = static_cast<std::size_t>(components);
    const std::size_t stride = use_.by_columns ? static_cast<std::size_t>(columns_stride) : width;
    const std::size_t size = use_.by_columns ? stride * width : n * width;
    const auto at = [&](std::size_t k) {
      const std::size_t node = use_.by_columns ? k % stride : k / width,
                        c = use_.by_columns ? k / stride : k % width;
      return node < n ? value(node, static_cast<int>(c)) : -77.0;
    };
    Array a{};
    if (use_.is_float && !is_state_)
      a.floats = block_.add<float>(size, at);
    else
      a.values = block_.add<double>(size, at);
    a.node_stride = use_.by_columns ? 1 : components;
    a.component_stride = use_.by_columns ? columns_stride : 1;
    return a;
  }
  template <class Value>
  ilaw_input input(int components, Value value) {
    return array<ilaw_input>(components, value);
  }
  ilaw_output output(int components) {
    return array<ilaw_output>(components, [](std::size_t, int) { return -99.0; });
  }

  void fill(bool with_bad) {
    const int d = static_cast<int>(use_.dimension);
    draw_axes();
    const auto bad = [&](std::size_t i, std::size_t kind) {
      return with_bad && i % 23 == 5 && i / 23 % 6 == kind;
    };
    batch_.struct_size = sizeof batch_;
    batch_.node_count = count;
    batch_.velocity_step = batch_.position_step = 0x1p-10;
    batch_.v_free = input(d, [&](std::size_t i, int c) {
      return bad(i, 0) && c == d - 1 ? NAN : uniform() - (c == 0 ? 0.2 : 0.0);
    });
    batch_.v_previous = input(d, [&](std::size_t i, int) { return bad(i, 1) ? INFINITY : uniform(); });
    const int numbers = delassus_numbers(use_);
    const int diagonal = use_.form == ILAW_DELASSUS_FULL ? d : numbers;
    batch_.delassus = input(numbers, [&](std::size_t i, int c) {
      if (bad(i, 2)) return -1.0;
      return c < diagonal ? uniform(0.5, 2.0) : (i % 3 == 0 ? 0.0 : 0.2 * uniform());
    });
    batch_.gap = input(1, [&](std::size_t i, int) {
      return bad(i, 3) ? NAN : (i % 7 == 3 ? 0.5 : 1e-3 * (uniform() - 0.5));
    });
    batch_.gap_offset = input(1, [&](std::size_t, int) { return 1e-4 * uniform(); });
    batch_.area = input(1, [&](std::size_t i, int) { return bad(i, 4) ? -1.0 : uniform(0.5, 2.0); });
    if (use_.frame == ILAW_FRAME_GLOBAL) {
      batch_.normal = input(d, [&](std::size_t i, int c) {
        return bad(i, 5) ? 2.0 : axes_[i][0][static_cast<std::size_t>(c)];
      });
      if (use_.tangent)
        batch_.tangent =
            input(d, [&](std::size_t i, int c) { return axes_[i][1][static_cast<std::size_t>(c)]; });
    }
    fill_outputs();
  }
  void fill_outputs() {
    const int d = static_cast<int>(use_.dimension);
    for (std::uint32_t k = 0; k < info_.per_node_parameter_count; ++k)
      per_node_.push_back(input(1, [&](std::size_t, int) { return uniform(0.1, 0.6); }));
    batch_.impulse = output(d);
    batch_.velocity = output(d);
    batch_.status = block_.add<std::uint8_t>(static_cast<std::size_t>(count), [](std::size_t) { return 99; });
    batch_.status_stride = 1;
    if (use_.energy) {
      batch_.energy = output(ILAW_ENERGY_COUNT);
      for (std::uint32_t k = 0; k < info_.amount_count; ++k) amounts_.push_back(output(1));
    } else {
      amounts_.resize(info_.amount_count);
    }
    if (info_.state_size > 0) {
      is_state_ = true;
      batch_.state_out = output(static_cast<int>(info_.state_size));
      is_state_ = false;
      batch_.state_in = {batch_.state_out.values, nullptr, batch_.state_out.node_stride,
                         batch_.state_out.component_stride};
    }
    if (use_.listed) {  // every node but each fifth, from the last on
      std::vector<std::int32_t> nodes;
      for (std::int32_t i = count; i-- > 0;)
        if (i % 5 != 2) nodes.push_back(i + 1);
      batch_.index = block_.add<std::int32_t>(nodes.size(), [&](std::size_t k) { return nodes[k]; });
      batch_.index_base = 1;
      batch_.node_count = static_cast<std::int64_t>(nodes.size());
    }
    batch_.per_node_parameters = per_node_.data();
    batch_.amounts = amounts_.data();
  }
  void draw_axes() {
    for (std::int64_t i = 0; i < count; ++i) {
      Vector n{uniform(), use_.dimension > 1 ? uniform() : 0.0, use_.dimension > 2 ? uniform() : 0.0};
      n = scaled(n, 1.0 / std::sqrt(dot(n, n)));
      Vector t{-n[1], n[0], 0.0};
      if (use_.dimension == 3) {
        t = {uniform(), uniform(), uniform()};
        for (int pass = 0; pass < 2; ++pass) {
          const double along = dot(t, n);
          for (std::size_t c = 0; c < 3; ++c) t[c] -= along * n[c];
          t = scaled(t, 1.0 / std::sqrt(dot(t, t)));
        }
      }
      axes_.push_back({n, t});
    }
  }
  static Vector scaled(Vector a, double s) { return {s * a[0], s * a[1], s * a[2]}; }

  Use use_;
  SetupBuilder builder_;
  ilaw::interface interface_;
  ilaw_instance_info info_;
  Block block_;
  std::mt19937_64 random_;
  ilaw_batch batch_{};
  std::vector<ilaw_input> per_node_;
  std::vector<ilaw_output> amounts_;
  std::vector<std::array<Vector, 2>> axes_;
  bool is_state_ = false;
};

}  // namespace ilaw::testing
