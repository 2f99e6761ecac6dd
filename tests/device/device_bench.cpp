// Time per node of laws on a device, all arrays there, beside the device's own triad. Usage:
// device_bench cuda|opencl FOLDER [NODES]; FOLDER holds the laws.
#include "driver.hpp"
#include "triad.hpp"

#include <ilaw/arrays.hpp>
#include <ilaw/loader.hpp>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <random>

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

// Arrays of a device, filled with random numbers.
class Arrays {
 public:
  Arrays(ilaw::device::Driver& driver, std::int64_t nodes) : driver_(driver), nodes_(nodes) {}
  ~Arrays() {
    for (void* const memory : all_) driver_.free(memory);
  }
  Arrays(const Arrays&) = delete;
  Arrays& operator=(const Arrays&) = delete;

  double* add(int components, double low, double high) {
    std::vector<double> values(static_cast<std::size_t>(nodes_ * components));
    std::uniform_real_distribution<double> uniform(low, high);
    for (double& value : values) value = uniform(random_);
    auto* const there = static_cast<double*>(driver_.allocate(values.size() * sizeof(double)));
    all_.push_back(there);
    driver_.write(driver_.own_queue(), there, values.data(), values.size() * sizeof(double));
    return there;
  }
  const std::vector<void*>& all() const { return all_; }

 private:
  ilaw::device::Driver& driver_;
  std::int64_t nodes_;
  std::mt19937_64 random_{1};
  std::vector<void*> all_;
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
  double* const a = arrays.add(1, 0.0, 1.0);
  ilaw::testing::Triad triad{nodes, a, arrays.add(1, 0.0, 1.0), arrays.add(1, 0.0, 1.0), 0.5};
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

struct Measured {
  const char* law;
  std::vector<std::pair<const char*, double>> parameters;
};

void measure(ilaw::device::Driver& driver, const std::string& folder, const Measured& given,
             std::int64_t nodes, double triad) {
  ilaw::parameters arguments;
  for (const auto& [name, value] : given.parameters) arguments.number(name, value);
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_LOCAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  arguments.give(setup);
  const ilaw::interface law(ilaw::library(folder + "/" + given.law + ".so"), given.law, setup);
  const ilaw_instance_info info = law.info();
  const auto* const device = static_cast<const ilaw_device_law*>(law.law().extension(ILAW_DEVICE));
  const char* reason = nullptr;
  const char* const name = device ? device->kernel(law.instance(), &reason) : nullptr;
  if (!name) {
    std::printf("%-10s not served: %s\n", given.law, reason ? reason : "no kernels");
    return;
  }
  Arrays arrays(driver, nodes);
  int numbers = 0;
  const auto input = [&](int components, double low, double high) {
    numbers += components;
    return ilaw::input(arrays.add(components, low, high), components, 1);
  };
  ilaw_batch b{};
  b.struct_size = sizeof b;
  b.node_count = nodes;
  b.velocity_step = b.position_step = 1e-3;
  b.v_free = input(3, -1.0, 1.0);
  b.delassus = input(1, 0.5, 2.0);
  if (info.inputs & ILAW_INPUT_GAP) b.gap = input(1, -1e-3, 1e-4);
  if (info.inputs & ILAW_INPUT_V_PREVIOUS) b.v_previous = input(3, -1.0, 1.0);
  if (info.inputs & ILAW_INPUT_AREA) b.area = input(1, 0.5, 2.0);
  const int states = static_cast<int>(info.state_size);
  if (states > 0) {
    double* const state = arrays.add(states, 0.0, 0.0);
    b.state_in = ilaw::input(state, states, 1);
    b.state_out = ilaw::output(state, states, 1);
  }
  double* const impulse = arrays.add(3, 0.0, 0.0);
  b.impulse = ilaw::output(impulse, 3, 1);
  numbers += 3 + 2 * states;
  std::vector<unsigned char> argument(device->argument_size);
  ilaw_report report{};
  report.struct_size = sizeof report;
  if (device->argument(law.instance(), &b, nullptr, argument.data(), &report) != ILAW_OK) {
    std::printf("%-10s refused: %s\n", given.law, report.reason);
    return;
  }
  for (std::uint32_t k = 0; k < device->image_count; ++k) {
    if (device->images[k]->kind != driver.image_kind()) continue;
    const auto kernel = driver.load(*device->images[k], name);
    const double seconds = seconds_per_launch(driver, impulse, [&] {
      kernel->launch(driver.own_queue(), nodes, argument.data(), argument.size(), arrays.all());
    });
    const double bytes = 8.0 * numbers, n = static_cast<double>(nodes);
    std::printf("%-10s %3.0f bytes a node  %8.4f ns a node  %5.2f of the triad\n", given.law, bytes,
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
  if (argc < 3) {
    std::fprintf(stderr, "usage: device_bench cuda|opencl FOLDER [NODES]\n");
    return 2;
  }
  try {
    const auto driver = std::strcmp(argv[1], "cuda") == 0 ? ilaw::device::open_cuda(0, nullptr)
                                                          : ilaw::device::open_opencl(0, nullptr, nullptr);
    const std::int64_t nodes = argc > 3 ? std::atoll(argv[3]) : 10'000'000;
    const double triad = triad_bytes_per_second(*driver, nodes);
    std::printf("%s: %lld nodes, triad %.1f GB/s\n", driver->name().c_str(), static_cast<long long>(nodes),
                triad * 1e-9);
    const Measured all[] = {{"contact", {}},
                            {"coulomb", {{"friction", 0.3}}},
                            {"postit", {{"friction", 0.2}, {"memory", 0.0}}},
                            {"tie", {}}};
    for (const Measured& given : all) measure(*driver, argv[2], given, nodes, triad);
    measure_transfer(*driver, nodes);
  } catch (const std::exception& error) {
    std::printf("no measurement: %s\n", error.what());
    return 77;
  }
  return 0;
}
