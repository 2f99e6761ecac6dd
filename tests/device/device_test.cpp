// Kernels of laws on a device against the libraries on the CPU: every byte that either writes is the same.
#include "device_runner.hpp"

#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <memory>

#include <dlfcn.h>

namespace ilaw::testing {
namespace {

// Those of all laws, and coefficients of friction per node, in time and along two axes.
std::vector<LawCase> cases_to_compare() {
  std::vector<LawCase> cases = served_cases();
  const auto add = [&](const char* name, const Parameters& parameters) {
    cases.push_back({"coulomb", name, parameters, {}});
  };
  add("coulomb_per_node", {.numbers = {}, .texts = {}, .per_node = {"friction"}});
  add("coulomb_in_time", {.numbers = {}, .texts = {}, .tables = {{"friction", {0.0, 0.3, 0.01, 0.6}}}});
  add("coulomb_elliptical", {.numbers = {{"friction", 0.8}, {"friction_2", 0.2}}, .texts = {}});
  return cases;
}

bool serves(const LawCase& given, const Use& use) {
  const ilaw::library library(plugin_file(given.law));
  const ilaw_law& law = *library.law(given.law);
  const bool lacks_tangent = use.dimension == 3 && use.frame == ILAW_FRAME_GLOBAL && !use.tangent &&
                             given.parameters.numbers.contains("friction_2");
  return !lacks_tangent && (law.dimensions & (1U << use.dimension)) && (law.delassus_forms & use.form);
}

// The comparisons and their outcome, for the page.
struct Counts {
  std::int64_t batches = 0, nodes = 0, bad_nodes = 0, differences = 0;
};

// ---- where kernels run

// A copy of the bytes of a block, and steps of its batch.
class Target {
 public:
  virtual ~Target() = default;
  virtual unsigned char* begin() = 0;
  virtual ilaw_result step(const ilaw_batch& moved, ilaw_report& found) = 0;
  virtual std::vector<unsigned char> read() = 0;
};

// On a device, by the launcher.
class Launched : public Target {
 public:
  Launched(Scene& scene) : device_(Device::shared().get()), size_(scene.block().used()) {
    there_ = static_cast<unsigned char*>(ilaw_device_allocate(device_, size_));
    ilaw_device_write(device_, nullptr, there_, scene.block().begin(), size_);
    char message[512] = "";
    const ilaw_result code = ilaw_launcher_create(device_, &scene.law().law(), scene.law().instance(),
                                                  Scene::count, &launcher_, message, sizeof message);
    if (code != ILAW_OK) throw std::runtime_error(message);
  }
  ~Launched() override {
    ilaw_launcher_destroy(launcher_);
    ilaw_device_free(device_, there_);
  }
  unsigned char* begin() override { return there_; }
  ilaw_result step(const ilaw_batch& moved, ilaw_report& found) override {
    const ilaw_result code = ilaw_launcher_evaluate(launcher_, nullptr, &moved, 1, &found);
    return code == ILAW_OK ? ilaw_launcher_report(launcher_, nullptr, &found) : code;
  }
  std::vector<unsigned char> read() override {
    std::vector<unsigned char> bytes(size_);
    ilaw_device_read(device_, nullptr, bytes.data(), there_, size_);
    return bytes;
  }

 private:
  ilaw_device* device_;
  std::size_t size_;
  unsigned char* there_;
  ilaw_launcher* launcher_ = nullptr;
};

#if defined(ILAW_KERNEL_FOLDER)
// The same kernels compiled for this processor (kernels_here.sh), called thread by thread.
class Here : public Target {
 public:
  Here(Scene& scene, const std::string& law)
      : bytes_(scene.block().begin(), scene.block().begin() + scene.block().used()),
        instance_(scene.law().instance()),
        device_(*static_cast<const ilaw_device_law*>(scene.law().law().extension(ILAW_DEVICE))),
        library_(dlopen((ILAW_KERNEL_FOLDER "/" + law + "_kernels.so").c_str(), RTLD_NOW | RTLD_LOCAL)) {
    const char* reason = nullptr;
    const char* const name = device_.kernel(instance_, &reason);
    if (!library_ || !name) throw std::runtime_error(library_ ? reason : dlerror());
    kernel_ = reinterpret_cast<void (*)(void*)>(dlsym(library_, name));
    thread_ = static_cast<std::size_t*>(dlsym(library_, "ilaw_kernel_thread"));
  }
  ~Here() override { dlclose(library_); }
  unsigned char* begin() override { return bytes_.data(); }
  ilaw_result step(const ilaw_batch& moved, ilaw_report& found) override {
    const auto n = static_cast<std::size_t>(moved.node_count);
    std::vector<std::uint8_t> reasons(n);
    std::vector<double> stable_steps(n);
    const ilaw_device_findings findings{sizeof findings, 0, reasons.data(), stable_steps.data()};
    std::vector<unsigned char> argument(device_.argument_size);
    const ilaw_result code = device_.argument(instance_, &moved, &findings, argument.data(), &found);
    if (code != ILAW_OK) return code;
    for (std::size_t k = 0; k < n + 13; ++k) {  // threads beyond the last do nothing
      *thread_ = k;
      kernel_(argument.data());
    }
    ilaw_device_totals totals{sizeof totals, 0, 0, -1, INFINITY};
    for (std::size_t k = 0; k < n; ++k) {
      if (reasons[k] != 0 && totals.bad_count++ == 0) {
        totals.first_bad_node =
            moved.index ? moved.index[k] - moved.index_base : static_cast<std::int64_t>(k);
        totals.reason = reasons[k];
      }
      if (reasons[k] != 0) continue;
      totals.stable_step = std::min(totals.stable_step, stable_steps[k]);
    }
    return device_.report(instance_, &totals, &found);
  }
  std::vector<unsigned char> read() override { return bytes_; }

 private:
  std::vector<unsigned char> bytes_;
  const ilaw_instance* instance_;
  const ilaw_device_law& device_;
  void* library_;
  void (*kernel_)(void*) = nullptr;
  std::size_t* thread_ = nullptr;
};
#endif

// ---- the comparison

// Steps by the library and at the target from the same bytes.
void compare(Scene& scene, Target& target, const Use& use, Counts& counts) {
  for (const double step : {0x1p-10, 0.7e-3, 1.3e-3}) {
    scene.next_step(step);
    ilaw_report expected{}, found{};
    expected.struct_size = found.struct_size = sizeof expected;
    std::vector<ilaw_input> per_node;
    std::vector<ilaw_output> amounts;
    const ilaw_batch moved = scene.batch_in(target.begin(), per_node, amounts);
    const ilaw_result code = scene.law().evaluate(scene.batch(), &expected);
    EXPECT_EQ(target.step(moved, found), code) << (found.reason ? found.reason : "");
    EXPECT_EQ(found.bad_count, expected.bad_count);
    EXPECT_EQ(found.first_bad_node, expected.first_bad_node);
    EXPECT_STREQ(found.reason, expected.reason);
    EXPECT_EQ(found.stable_velocity_step, expected.stable_velocity_step);
    const std::vector<unsigned char> read = target.read();
    ++counts.batches;
    counts.nodes += scene.batch().node_count;
    counts.bad_nodes += expected.bad_count;
    for (std::size_t k = 0; k < read.size(); ++k)
      if (read[k] != scene.block().begin()[k]) {
        ++counts.differences;
        double here = 0.0, there = 0.0;
        if (k / 8 * 8 + 8 <= read.size()) {
          std::memcpy(&here, scene.block().begin() + k / 8 * 8, 8);
          std::memcpy(&there, read.data() + k / 8 * 8, 8);
        }
        ADD_FAILURE() << ::testing::PrintToString(use) << ": byte " << k << " at step " << step << ": "
                      << std::setprecision(17) << there << ", not " << here;
        break;
      }
  }
}

// All forms, dimensions, frames and numbers of a law, with and without bad nodes.
template <class Make>
void compare_all(const LawCase& given, Make make) {
  Counts counts;
  int turn = 0;
  for (const std::uint32_t dimension : {1U, 2U, 3U})
    for (const std::uint32_t form :
         {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_TRANSVERSE, ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL})
      for (const int axes : {0, 1, 2})
        for (const bool is_float : {false, true}) {
          Use use{dimension, form,
                  axes == 0 ? std::uint32_t{ILAW_FRAME_LOCAL} : std::uint32_t{ILAW_FRAME_GLOBAL}, axes == 2,
                  is_float};
          if (!serves(given, use)) continue;
          for (const bool with_bad : {false, true}) {
            use.by_columns = turn % 2 == 1;
            use.listed = turn % 3 == 1;
            use.energy = turn % 5 != 2;
            ++turn;
            Scene scene(given, use, 7 * dimension + form, with_bad);
            (void)scene.law().initialise(scene.batch());
            const auto target = make(scene);
            compare(scene, *target, use, counts);
          }
          if (::testing::Test::HasFailure()) return;
        }
  std::printf("%s: %lld batches, %lld nodes, %lld of them bad, %lld differ\n", given.name.c_str(),
              static_cast<long long>(counts.batches), static_cast<long long>(counts.nodes),
              static_cast<long long>(counts.bad_nodes), static_cast<long long>(counts.differences));
}

class DeviceBits : public ::testing::TestWithParam<LawCase> {};
TEST_P(DeviceBits, AreThoseOfTheLibrary) {
  if (!Device::shared().get()) GTEST_SKIP() << Device::shared().why();
  if (Device::shared().takes_minutes_for(GetParam().law)) GTEST_SKIP() << "pocl takes minutes for this law";
  compare_all(GetParam(), [](Scene& scene) { return std::make_unique<Launched>(scene); });
}
#if defined(ILAW_KERNEL_FOLDER)
TEST_P(DeviceBits, AreThoseOfTheLibraryHere) {
  const std::string law = GetParam().law;
  compare_all(GetParam(), [&](Scene& scene) { return std::make_unique<Here>(scene, law); });
}
#endif
INSTANTIATE_TEST_SUITE_P(Laws, DeviceBits, ::testing::ValuesIn(cases_to_compare()), name_of_case);

// ---- sums

// As totals.hpp has them: value k goes to lane k of many, these to every 256th, which are joined in a tree.
double sum_in_lanes(const std::vector<double>& values) {
  constexpr std::size_t lanes = 65536, last_lanes = 256;
  std::vector<double> first(lanes, 0.0), sums(last_lanes, 0.0);
  for (std::size_t k = 0; k < values.size(); ++k) first[k % lanes] += values[k];
  for (std::size_t k = 0; k < lanes; ++k) sums[k % last_lanes] += first[k];
  for (std::size_t half = last_lanes / 2; half > 0; half /= 2) {
    std::vector<double> joined(half);
    for (std::size_t k = 0; k < half; ++k) joined[k] = sums[2 * k] + sums[2 * k + 1];
    sums = joined;
  }
  return sums[0];
}

TEST(DeviceEnergy, IsSummedInAFixedTree) {
  ilaw_device* const device = Device::shared().get();
  if (!device) GTEST_SKIP() << Device::shared().why();
  const LawCase given{"coulomb", "coulomb", {{{"friction", 0.3}}, {}}, {}};
  for (const bool listed : {false, true}) {
    Scene scene(given, {.listed = listed}, 3, false);
    auto* const there = static_cast<unsigned char*>(ilaw_device_allocate(device, scene.block().used()));
    ASSERT_NE(there, nullptr);
    ilaw_device_write(device, nullptr, there, scene.block().begin(), scene.block().used());
    std::vector<ilaw_input> per_node;
    std::vector<ilaw_output> amounts;
    const ilaw_batch moved = scene.batch_in(there, per_node, amounts);
    char message[512] = "";
    ilaw_launcher* launcher = nullptr;
    ASSERT_EQ(ilaw_launcher_create(device, &scene.law().law(), scene.law().instance(), Scene::count,
                                   &launcher, message, sizeof message),
              ILAW_OK)
        << message;
    double sums[ILAW_ENERGY_COUNT] = {};
    ASSERT_EQ(ilaw_launcher_evaluate(launcher, nullptr, &moved, 0, nullptr), ILAW_OK);
    ASSERT_EQ(ilaw_launcher_energy(launcher, nullptr, sums), ILAW_OK);
    ASSERT_EQ(scene.law().evaluate(scene.batch(), nullptr), ILAW_OK);
    const ilaw_batch& b = scene.batch();
    for (std::int64_t c = 0; c < ILAW_ENERGY_COUNT; ++c) {
      std::vector<double> values;
      for (std::int64_t k = 0; k < b.node_count; ++k) {
        const std::int64_t node = b.index ? b.index[k] - b.index_base : k;
        values.push_back(b.energy.values[node * b.energy.node_stride + c * b.energy.component_stride]);
      }
      EXPECT_EQ(sums[c], sum_in_lanes(values)) << "part " << c << (listed ? " listed" : "");
    }
    EXPECT_GT(sums[ILAW_ENERGY_FRICTION], 0.0);
    ilaw_launcher_destroy(launcher);
    ilaw_device_free(device, there);
  }
}

// ---- what is refused

std::string refusal_of_launcher(const std::string& law, const Parameters& parameters) {
  const SetupBuilder setup(parameters);
  const ilaw::interface made = make_law(law, setup);
  char message[512] = "";
  ilaw_launcher* launcher = nullptr;
  EXPECT_EQ(ilaw_launcher_create(Device::shared().get(), &made.law(), made.instance(), 10, &launcher, message,
                                 sizeof message),
            ILAW_UNSUPPORTED);
  EXPECT_EQ(launcher, nullptr);
  return message;
}

TEST(DeviceRefusals, NameWhatNoDeviceServes) {
  if (!Device::shared().get()) GTEST_SKIP() << Device::shared().why();
  EXPECT_EQ(refusal_of_launcher("template_c", {{{"friction", 0.3}}, {}}),
            "law 'template_c' has no kernels: its library was built without");
  EXPECT_EQ(refusal_of_launcher("tie", {{{"strength", 2.0}, {"memory", 0.01}}, {}}),
            "law 'tie': memory is a window, which no device serves: expected 0");
}
TEST(DeviceRefusals, SayWhyThereIsNoDevice) {
  char message[512] = "";
  ilaw_device* device = nullptr;
  EXPECT_EQ(ilaw_device_open(99, 0, &device, message, sizeof message), ILAW_UNSUPPORTED);
  EXPECT_STREQ(message, "the driver is none of ILAW_DRIVER_*");
  const ilaw_result code = ilaw_device_open(ILAW_DRIVER_CUDA, 1000, &device, message, sizeof message);
  EXPECT_TRUE(code == ILAW_NOT_FOUND || code == ILAW_UNSUPPORTED) << code;
  EXPECT_NE(std::string(message), "");
  EXPECT_EQ(device, nullptr);
}

// ---- a host

#if defined(ILAW_POINTS)
TEST(DeviceHost, SlidesAsFarAsItMust) {
  if (!Device::shared().get() || tested_driver() != ILAW_DRIVER_OPENCL)
    GTEST_SKIP() << Device::shared().why();
  FILE* const program = popen(ILAW_POINTS " " ILAW_PLUGIN_FOLDER "/coulomb.so", "r");
  ASSERT_NE(program, nullptr);
  char line[512] = "";
  ASSERT_NE(std::fgets(line, sizeof line, program), nullptr);
  EXPECT_EQ(pclose(program), 0) << line;
  double error = 1.0, work = 1.0;
  const char* const numbers = std::strstr(line, "largest error");
  ASSERT_NE(numbers, nullptr) << line;
  ASSERT_EQ(std::sscanf(numbers, "largest error %lf m, work of the first step off by %lf", &error, &work), 2);
  // 1024 steps of at most 4 roundings of numbers up to 2, in the speed and in the distance.
  EXPECT_LE(error, 1024 * 8 * 0x1p-53);
  EXPECT_LE(work, 1024 * 0x1p-53);
}
#endif

}  // namespace
}  // namespace ilaw::testing
