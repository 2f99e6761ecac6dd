// Time per node of each law beside a triad kernel, in the same run.
//
//   ilaw_bench_laws [--nodes N] [--repetitions K] [--out FILE.csv]
//
// Each repetition times the triad a = b + s c (counted at 24 bytes per element, as STREAM does) and then each
// case; medians over the repetitions are reported. "ratio" is the time over what the bytes of the case cost
// at the triad's bandwidth: 1 is as fast as memory allows (out of cache), the unit in which to compare
// machines.
#include <ilaw/loader.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

// Arrays of one case, drawn at random: half of the nodes touch.
class Case {
 public:
  Case(const std::string& law, std::vector<std::pair<const char*, double>> parameters, bool global, bool soa,
       bool outputs, std::int64_t nodes)
      : name_(law),
        global_(global),
        soa_(soa),
        outputs_(outputs),
        nodes_(nodes),
        interface_(create(law, std::move(parameters), global)),
        state_size_(static_cast<std::int64_t>(interface_.info().state_size)) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto fill = [&](std::vector<double>& values, std::int64_t size) {
      values.resize(static_cast<std::size_t>(size));
      for (double& value : values) value = uniform(random);
    };
    fill(v_free_, 3 * nodes);
    fill(gap_, nodes);
    fill(delassus_, nodes);
    for (double& h : delassus_) h = 1.5 + h;
    if (global) fill(normal_, 3 * nodes);
    for (std::int64_t i = 0; global && i < nodes; ++i) {
      double* n[3];
      for (int c = 0; c < 3; ++c) n[c] = &normal_[static_cast<std::size_t>(soa ? i + c * nodes : 3 * i + c)];
      const double length = std::sqrt(*n[0] * *n[0] + *n[1] * *n[1] + *n[2] * *n[2]);
      for (double* component : n) *component /= length;
    }
    impulse_.resize(static_cast<std::size_t>(3 * nodes));
    state_.resize(static_cast<std::size_t>(state_size_ * nodes));
    if (outputs) velocity_.resize(static_cast<std::size_t>(3 * nodes));
    if (outputs) status_.resize(static_cast<std::size_t>(nodes));
    lay_out();
    if (interface_.initialise(batch_) != ILAW_OK) std::abort();
    batch_.state_in = {state_.data(), state_size_, 1};
  }

  void run() {
    batch_.time += 1e-3;
    if (interface_.evaluate(batch_) != ILAW_OK) std::abort();
    benchmark::DoNotOptimize(impulse_.data());
    benchmark::ClobberMemory();
  }

  // What one node must move: inputs and outputs once, the state in and out.
  double bytes() const {
    return 24.0 + 8.0 + 8.0 + 24.0 + (global_ ? 24.0 : 0.0) + (outputs_ ? 25.0 : 0.0) +
           16.0 * static_cast<double>(state_size_);
  }
  std::string label() const {
    return name_ + (global_ ? " global" : " local") + (soa_ ? " SoA" : " AoS") + (outputs_ ? " outputs" : "");
  }
  std::int64_t nodes() const { return nodes_; }

 private:
  static ilaw::interface create(const std::string& law,
                                std::vector<std::pair<const char*, double>> parameters, bool global) {
    std::vector<ilaw_argument> arguments;
    for (const auto& [name, value] : parameters)
      arguments.push_back({sizeof(ilaw_argument), ILAW_VALUE_NUMBER, name, value, nullptr, nullptr, 0});
    std::vector<const ilaw_argument*> pointers;
    for (const ilaw_argument& argument : arguments) pointers.push_back(&argument);
    ilaw_setup setup{};
    setup.struct_size = sizeof setup;
    setup.dimension = 3;
    setup.delassus_form = ILAW_DELASSUS_SCALAR;
    setup.frame = global ? ILAW_FRAME_GLOBAL : ILAW_FRAME_LOCAL;
    setup.velocity_step = 1e-3;
    setup.arguments = pointers.data();
    setup.argument_count = static_cast<std::uint32_t>(pointers.size());
    return {ilaw::library(law), law, setup};
  }

  void lay_out() {
    const std::int64_t node = soa_ ? 1 : 3, component = soa_ ? nodes_ : 1;
    batch_.struct_size = sizeof batch_;
    batch_.node_count = nodes_;
    batch_.velocity_step = batch_.position_step = 1e-3;
    batch_.v_free = {v_free_.data(), node, component};
    batch_.delassus = {delassus_.data(), 1, 1};
    batch_.gap = {gap_.data(), 1, 1};
    if (global_) batch_.normal = {normal_.data(), node, component};
    batch_.impulse = {impulse_.data(), node, component};
    batch_.state_out = {state_.data(), state_size_, 1};
    if (outputs_) batch_.velocity = {velocity_.data(), node, component};
    if (outputs_) batch_.status = status_.data();
    batch_.status_stride = 1;
  }

  std::string name_;
  bool global_, soa_, outputs_;
  std::int64_t nodes_;
  ilaw::interface interface_;
  std::int64_t state_size_;
  std::vector<double> v_free_, gap_, delassus_, normal_, impulse_, velocity_, state_;
  std::vector<std::uint8_t> status_;
  ilaw_batch batch_{};
};

class Triad {
 public:
  explicit Triad(std::int64_t size)
      : a_(static_cast<std::size_t>(size)), b_(a_.size(), 1.0), c_(a_.size(), 2.0) {}
  void run() {
    for (std::size_t i = 0; i < a_.size(); ++i) a_[i] = b_[i] + 1.5 * c_[i];
    benchmark::DoNotOptimize(a_.data());
    benchmark::ClobberMemory();
  }

 private:
  std::vector<double> a_, b_, c_;
};

// Seconds of one call, from as many as fill a few milliseconds.
template <class Work>
double seconds_of(Work&& work) {
  for (long calls = 1;; calls *= 4) {
    const Clock::time_point start = Clock::now();
    for (long k = 0; k < calls; ++k) work();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (seconds > 5e-3) return seconds / static_cast<double>(calls);
  }
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

struct Options {
  std::vector<std::int64_t> sizes{2000, 10000000};
  int repetitions = 7;
  std::string out;
};

// Each case alone in memory, alternated with the triad, so that drifts of the machine hit both.
void measure(const std::function<std::unique_ptr<Case>()>& make, Triad& triad, std::int64_t nodes,
             const Options& options, std::ostream* csv) {
  const std::unique_ptr<Case> one = make();
  one->run();
  std::vector<double> times, ratios, bandwidths;
  for (int k = 0; k < options.repetitions; ++k) {
    const double bandwidth = 24.0 * static_cast<double>(nodes) / seconds_of([&] { triad.run(); });
    const double seconds = seconds_of([&] { one->run(); });
    times.push_back(1e9 * seconds / static_cast<double>(nodes));
    ratios.push_back(seconds * bandwidth / (one->bytes() * static_cast<double>(nodes)));
    bandwidths.push_back(1e-9 * bandwidth);
  }
  std::printf("%9lld  %-32s %8.2f ns/node  triad %7.1f GB/s  ratio %6.2f\n", static_cast<long long>(nodes),
              one->label().c_str(), median(times), median(bandwidths), median(ratios));
  if (csv)
    *csv << nodes << ',' << one->label() << ',' << median(times) << ',' << median(bandwidths) << ','
         << median(ratios) << '\n';
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int k = 1; k + 1 < argc; k += 2) {
    if (std::strcmp(argv[k], "--nodes") == 0) options.sizes = {std::atoll(argv[k + 1])};
    if (std::strcmp(argv[k], "--repetitions") == 0) options.repetitions = std::atoi(argv[k + 1]);
    if (std::strcmp(argv[k], "--out") == 0) options.out = argv[k + 1];
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  std::unique_ptr<std::ofstream> csv;
  if (!options.out.empty()) {
    csv = std::make_unique<std::ofstream>(options.out);
    *csv << "nodes,case,ns_per_node,triad_GB_per_s,ratio\n";
  }
  using Parameters = std::vector<std::pair<const char*, double>>;
  const std::vector<std::pair<std::string, Parameters>> laws = {
      {"contact", {}}, {"coulomb", {{"friction", 0.3}}}, {"postit", {{"friction", 0.3}}}};
  for (const std::int64_t nodes : options.sizes) {
    Triad triad(nodes);
    for (const auto& [law, parameters] : laws)
      for (const bool outputs : {false, true})
        for (const bool global : {false, true})
          for (const bool soa : {false, true})
            measure([&, l = law,
                     p = parameters] { return std::make_unique<Case>(l, p, global, soa, outputs, nodes); },
                    triad, nodes, options, csv.get());
  }
}
