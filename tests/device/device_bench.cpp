// Time per node of laws on a device, all arrays there, beside the device's own triad. Usage:
// device_bench cuda|opencl [NODES [CASE...]]
#include "device_runner.hpp"
#include "driver.hpp"
#include "triad.hpp"

#include <chrono>
#include <cstdio>
#include <cstring>
#include <random>
#include <set>

extern "C" {
#if defined(ILAW_HAS_PTX)
[[gnu::visibility("hidden")]] extern const char ilaw_bench_ptx[], ilaw_bench_ptx_end[];
#endif
#if defined(ILAW_HAS_SPIRV)
[[gnu::visibility("hidden")]] extern const char ilaw_bench_spirv[], ilaw_bench_spirv_end[];
#endif
}

namespace {

constexpr int repeats = 50;
constexpr double s_per_ns = 1e-9;

// Arrays of a device.
class Arrays {
 public:
  Arrays(ilaw::device::Driver& driver, std::int64_t nodes) : driver_(driver), nodes_(nodes) {}
  ~Arrays() {
    for (void* const memory : all_) driver_.free(memory);
  }
  Arrays(const Arrays&) = delete;
  Arrays& operator=(const Arrays&) = delete;

  double* add(const std::vector<double>& values) {
    auto* const there = static_cast<double*>(driver_.allocate(values.size() * sizeof(double)));
    all_.push_back(there);
    driver_.write(driver_.own_queue(), there, values.data(), values.size() * sizeof(double));
    return there;
  }
  double* add_zeros(int components) {
    return add(std::vector<double>(static_cast<std::size_t>(nodes_ * components)));
  }
  std::int64_t nodes() const { return nodes_; }
  const std::vector<void*>& all() const { return all_; }

 private:
  ilaw::device::Driver& driver_;
  std::int64_t nodes_;
  std::vector<void*> all_;
};

// The nodes that ilaw bench draws: half touch, half of these are pressed, and the others have moved freely.
struct Inputs {
  explicit Inputs(Arrays& arrays) {
    const auto n = static_cast<std::size_t>(arrays.nodes());
    std::vector<double> free(3 * n), previous(3 * n), h(n), gaps(n), areas(n);
    std::mt19937_64 random(1);
    const auto draw = [&](double low, double high) {
      return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
    };
    for (std::size_t i = 0; i < n; ++i) {
      const bool touches = draw(0.0, 1.0) < 0.5;
      for (std::size_t c = 0; c < 3; ++c) previous[3 * i + c] = free[3 * i + c] = draw(-1.0, 1.0);
      if (touches) previous[3 * i] = 0.0;
      h[i] = draw(1.0, 3.0);
      gaps[i] = touches ? draw(-1e-4, 0.0) : draw(0.01, 0.1);
      areas[i] = 1.0;
    }
    v_free = arrays.add(free);
    v_previous = arrays.add(previous);
    delassus = arrays.add(h);
    gap = arrays.add(gaps);
    area = arrays.add(areas);
  }
  double *v_free, *v_previous, *delassus, *gap, *area;
};

// The least of several, each of so many launches.
template <class Launch>
double seconds_per_launch(ilaw::device::Driver& driver, const void* any, Launch launch) {
  double best = 1e300, scratch = 0.0;
  for (int trial = 0; trial < 5; ++trial) {
    driver.read(driver.own_queue(), &scratch, any, sizeof scratch);
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; k < repeats; ++k) launch();
    driver.read(driver.own_queue(), &scratch, any, sizeof scratch);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    best = std::min(best, took.count() / repeats);
  }
  return best;
}

double triad_bytes_per_second(ilaw::device::Driver& driver, std::int64_t nodes) {
  Arrays arrays(driver, nodes);
  double* const a = arrays.add_zeros(1);
  ilaw::testing::Triad triad{nodes, a, arrays.add_zeros(1), arrays.add_zeros(1), 0.5};
  ilaw_device_image image{sizeof(ilaw_device_image), driver.image_kind(), nullptr, nullptr};
#if defined(ILAW_HAS_PTX)
  if (image.kind == ILAW_IMAGE_PTX) image.begin = ilaw_bench_ptx, image.end = ilaw_bench_ptx_end;
#endif
#if defined(ILAW_HAS_SPIRV)
  if (image.kind == ILAW_IMAGE_SPIRV) image.begin = ilaw_bench_spirv, image.end = ilaw_bench_spirv_end;
#endif
  if (!image.begin) throw std::runtime_error("the triad was built without a kernel for this driver");
  const auto kernel = driver.load(image, "ilaw_triad");
  const double seconds = seconds_per_launch(
      driver, a, [&] { kernel->launch(driver.own_queue(), nodes, &triad, sizeof triad, arrays.all()); });
  return 24.0 * static_cast<double>(nodes) / seconds;
}

// A node's bytes, its time, and its share of the triad's speed.
void measure(ilaw::device::Driver& driver, const ilaw::testing::LawCase& given, const Inputs& inputs,
             Arrays& arrays, double triad) {
  ilaw::testing::SetupBuilder setup(given.parameters, 3, ILAW_DELASSUS_SCALAR, ILAW_FRAME_LOCAL, false);
  const ilaw::interface law = make_law(given.law, setup);
  const ilaw_instance_info info = law.info();
  const auto* const device = static_cast<const ilaw_device_law*>(law.law().extension(ILAW_DEVICE));
  const char* reason = nullptr;
  const char* const name = device->kernel(law.instance(), &reason);
  if (!name) {
    std::printf("%-24s not served: %s\n", given.name.c_str(), reason);
    return;
  }
  const std::int64_t nodes = arrays.nodes();
  int numbers = 0;
  const auto input = [&](const double* values, int components) {
    numbers += components;
    return ilaw::input(values, components, 1);
  };
  ilaw_batch b{};
  b.struct_size = sizeof b;
  b.node_count = nodes;
  b.velocity_step = b.position_step = 1e-3;
  b.v_free = input(inputs.v_free, 3);
  b.delassus = input(inputs.delassus, 1);
  if (info.inputs & ILAW_INPUT_GAP) b.gap = input(inputs.gap, 1);
  if (info.inputs & ILAW_INPUT_V_PREVIOUS) b.v_previous = input(inputs.v_previous, 3);
  if (info.inputs & ILAW_INPUT_AREA) b.area = input(inputs.area, 1);
  Arrays own(driver, nodes);
  const int states = static_cast<int>(info.state_size);
  if (states > 0) {
    double* const state = own.add_zeros(states);
    b.state_in = ilaw::input(state, states, 1);
    b.state_out = ilaw::output(state, states, 1);
  }
  double* const impulse = own.add_zeros(3);
  b.impulse = ilaw::output(impulse, 3, 1);
  numbers += 3 + 2 * states;
  std::vector<void*> pointers = arrays.all();
  pointers.insert(pointers.end(), own.all().begin(), own.all().end());
  std::vector<unsigned char> argument(device->argument_size);
  ilaw_report report{};
  report.struct_size = sizeof report;
  if (device->argument(law.instance(), &b, nullptr, argument.data(), &report) != ILAW_OK) {
    std::printf("%-24s refused: %s\n", given.name.c_str(), report.reason);
    return;
  }
  for (std::uint32_t k = 0; k < device->image_count; ++k) {
    if (device->images[k]->kind != driver.image_kind()) continue;
    const auto kernel = driver.load(*device->images[k], name);
    const double seconds = seconds_per_launch(driver, impulse, [&] {
      kernel->launch(driver.own_queue(), nodes, argument.data(), argument.size(), pointers);
    });
    const double bytes = 8.0 * numbers, n = static_cast<double>(nodes);
    std::printf("%-24s %3.0f bytes a node  %8.4f ns a node  %5.2f of the triad\n", given.name.c_str(), bytes,
                seconds / n / s_per_ns, bytes * n / seconds / triad);
  }
}

// Both ways, for the arrays of an interface that stay on the host.
void measure_transfer(ilaw::device::Driver& driver, std::int64_t nodes) {
  std::vector<double> here(static_cast<std::size_t>(11 * nodes));
  const std::size_t size = here.size() * sizeof(double);
  void* const there = driver.allocate(size);
  const auto begin = std::chrono::steady_clock::now();
  driver.write(driver.own_queue(), there, here.data(), size);
  driver.read(driver.own_queue(), here.data(), there, size * 3 / 11);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  driver.free(there);
  std::printf("transfer   %3d bytes a node there, 24 back  %8.4f ns a node\n", 88,
              took.count() / static_cast<double>(nodes) / s_per_ns);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: device_bench cuda|opencl [NODES [CASE...]]\n");
    return 2;
  }
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // a law's kernels may take a minute to load
  try {
    const auto driver = std::strcmp(argv[1], "cuda") == 0 ? ilaw::device::open_cuda(0, nullptr)
                                                          : ilaw::device::open_opencl(0, nullptr, nullptr);
    const std::int64_t nodes = argc > 2 ? std::atoll(argv[2]) : 10'000'000;
    const std::set<std::string> chosen(argv + std::min(argc, 3), argv + argc);
    const double triad = triad_bytes_per_second(*driver, nodes);
    std::printf("%s: %lld nodes, triad %.1f GB/s\n", driver->name().c_str(), static_cast<long long>(nodes),
                triad * 1e-9);
    Arrays arrays(*driver, nodes);
    const Inputs inputs(arrays);
    for (const ilaw::testing::LawCase& given : ilaw::testing::served_cases())
      if (chosen.empty() || chosen.contains(given.name)) measure(*driver, given, inputs, arrays, triad);
    measure_transfer(*driver, nodes);
  } catch (const std::exception& error) {
    std::printf("no measurement: %s\n", error.what());
    return 77;
  }
  return 0;
}
