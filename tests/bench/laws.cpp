// Time per node of each law beside a triad kernel, in the same run.
//
//   ilaw_bench_laws [--law NAME] [--nodes N] [--repetitions K] [--out FILE.csv]
//
// What is timed is the section "benchmarks" of tests/laws/<law>/cases.json: "parameters", "what" (these in
// words), "form" of H (scalar), "per_node" (a parameter that comes per node), "in_all_layouts" (and frames,
// with and without optional outputs).
//
// Each repetition times the triad a = b + s c (counted at 24 bytes per element, as STREAM does) and then each
// case; medians over the repetitions are reported. "ratio" is the time over what the bytes of the case cost
// at the triad's bandwidth: 1 is as fast as memory allows (out of cache), the unit in which to compare
// machines.
#include "support/law_cases.hpp"

#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>

#include "base/csv.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

using ilaw::testing::LawCase;
using ilaw::testing::SetupBuilder;

// A law with parameters, and how its inputs come.
struct Subject {
  explicit Subject(const LawCase& given)
      : law(given.law),
        what(given.more.value("what", "")),
        form(ilaw::testing::form_of(given)),
        per_node(given.more.value("per_node", "")),
        parameters(given.parameters) {
    if (per_node.empty()) return;
    value = parameters.numbers.extract(per_node).mapped();
    parameters.per_node = {per_node};
  }

  std::string law, what;
  std::uint32_t form;
  std::string per_node;
  double value = 0.0;  // of the parameter that is given per node
  ilaw::testing::Parameters parameters;
};

struct Way {
  bool global = false, soa = false, outputs = false;
};

// Arrays of one case, drawn at random: half of the nodes touch.
class Case {
 public:
  Case(const Subject& subject, Way way, std::int64_t nodes)
      : subject_(subject),
        way_(way),
        nodes_(nodes),
        components_(subject.form == ILAW_DELASSUS_SCALAR ? 1
                                                         : (subject.form == ILAW_DELASSUS_DIAGONAL ? 3 : 6)),
        interface_(create(subject, way.global)),
        state_size_(static_cast<std::int64_t>(interface_.info().state_size)) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto fill = [&](std::vector<double>& values, std::int64_t size) {
      values.resize(static_cast<std::size_t>(size));
      for (double& value : values) value = uniform(random);
    };
    fill(v_free_, 3 * nodes);
    fill(gap_, nodes);
    fill(delassus_, components_ * nodes);
    for (std::size_t k = 0; k < delassus_.size(); ++k)  // positive definite: |H_ij| < 0.3, H_ii > 1
      delassus_[k] = k % static_cast<std::size_t>(components_) < 3 ? 2.0 + delassus_[k] : 0.3 * delassus_[k];
    if (way.global) draw_normals([&] { return uniform(random); });
    impulse_.resize(static_cast<std::size_t>(3 * nodes));
    state_.resize(static_cast<std::size_t>(state_size_ * nodes));
    if (way.outputs) velocity_.resize(static_cast<std::size_t>(3 * nodes));
    if (way.outputs) status_.resize(static_cast<std::size_t>(nodes));
    if (!subject.per_node.empty()) per_node_.assign(static_cast<std::size_t>(nodes), subject.value);
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
    return 24.0 + 8.0 * static_cast<double>(components_) + 8.0 + 24.0 + (way_.global ? 24.0 : 0.0) +
           (way_.outputs ? 25.0 : 0.0) + (interface_.info().inputs & ILAW_INPUT_V_PREVIOUS ? 24.0 : 0.0) +
           (per_node_.empty() ? 0.0 : 8.0) + 16.0 * static_cast<double>(state_size_);
  }
  std::string label() const {
    return subject_.law + (subject_.what.empty() ? "" : " " + subject_.what) +
           (subject_.form == ILAW_DELASSUS_SCALAR
                ? ""
                : std::string(" ") + ilaw::testing::name_of_form(subject_.form) + " H") +
           (way_.global ? " global" : " local") + (way_.soa ? " SoA" : " AoS") +
           (way_.outputs ? " outputs" : "");
  }
  std::int64_t nodes() const { return nodes_; }

 private:
  static ilaw::interface create(const Subject& subject, bool global) {
    const SetupBuilder builder(subject.parameters, 3, subject.form,
                               global ? ILAW_FRAME_GLOBAL : ILAW_FRAME_LOCAL);
    return {ilaw::library(subject.law), subject.law, builder.setup};
  }

  template <class Next>
  void draw_normals(Next next) {
    normal_.resize(static_cast<std::size_t>(3 * nodes_));
    for (double& component : normal_) component = next();
    for (std::int64_t i = 0; i < nodes_; ++i) {
      double* n[3];
      for (int c = 0; c < 3; ++c)
        n[c] = &normal_[static_cast<std::size_t>(way_.soa ? i + c * nodes_ : 3 * i + c)];
      const double length = std::sqrt(*n[0] * *n[0] + *n[1] * *n[1] + *n[2] * *n[2]);
      for (double* component : n) *component /= length;
    }
  }

  void lay_out() {
    const std::int64_t node = way_.soa ? 1 : 3, component = way_.soa ? nodes_ : 1;
    batch_.struct_size = sizeof batch_;
    batch_.node_count = nodes_;
    batch_.velocity_step = batch_.position_step = 1e-3;
    batch_.v_free = {v_free_.data(), node, component};
    batch_.delassus = {delassus_.data(), components_, 1};
    batch_.gap = {gap_.data(), 1, 1};
    if (way_.global) batch_.normal = {normal_.data(), node, component};
    batch_.impulse = {impulse_.data(), node, component};
    batch_.state_out = {state_.data(), state_size_, 1};
    if (way_.outputs) batch_.velocity = {velocity_.data(), node, component};
    if (way_.outputs) batch_.status = status_.data();
    batch_.status_stride = 1;
    batch_.v_previous = batch_.v_free;
    batch_.area = {&area_, 0, 1};
    if (!per_node_.empty()) parameter_ = {per_node_.data(), 1, 1};
    batch_.per_node_parameters = &parameter_;
  }

  Subject subject_;
  Way way_;
  std::int64_t nodes_, components_;
  double area_ = 1.0;
  ilaw_input parameter_{};
  ilaw::interface interface_;
  std::int64_t state_size_;
  std::vector<double> v_free_, gap_, delassus_, normal_, impulse_, velocity_, state_, per_node_;
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
  std::string law, out;
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
  std::printf("%9lld  %-52s %8.2f ns/node  triad %7.1f GB/s  ratio %6.2f\n", static_cast<long long>(nodes),
              one->label().c_str(), median(times), median(bandwidths), median(ratios));
  if (!csv) return;
  ilaw::host::CsvWriter row(*csv, 6);
  row << nodes << one->label() << median(times) << median(bandwidths) << median(ratios);
  row.end_row();
}

void measure_all(const std::vector<LawCase>& cases, std::int64_t nodes, const Options& options,
                 std::ostream* csv) {
  const auto triad = std::make_unique<Triad>(nodes);
  for (const LawCase& one : cases) {
    const auto add = [&](Way way) {
      measure([&] { return std::make_unique<Case>(Subject(one), way, nodes); }, *triad, nodes, options, csv);
    };
    if (one.more.value("in_all_layouts", false))
      for (const bool outputs : {false, true})
        for (const bool global : {false, true})
          for (const bool soa : {false, true}) add({global, soa, outputs});
    else
      add({});
  }
}

void write_header(std::ostream* csv) {
  if (csv) *csv << "nodes,case,ns_per_node,triad_GB_per_s,ratio\n";
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Time per node of each law beside a triad kernel");
  app.add_option("--law", options.law, "This law alone");
  app.add_option("--nodes", options.sizes, "Nodes in a batch")->expected(1, 8)->capture_default_str();
  app.add_option("--repetitions", options.repetitions, "Medians are over so many")->capture_default_str();
  app.add_option("--out", options.out, "CSV file to write as well");
  CLI11_PARSE(app, argc, argv);
  std::unique_ptr<std::ofstream> csv;
  if (!options.out.empty()) csv = std::make_unique<std::ofstream>(options.out);
  write_header(csv.get());
  std::vector<LawCase> cases = ilaw::testing::law_cases("benchmarks");
  std::erase_if(cases, [&](const LawCase& one) { return !options.law.empty() && one.law != options.law; });
  for (const std::int64_t nodes : options.sizes) measure_all(cases, nodes, options, csv.get());
}
