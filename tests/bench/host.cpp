// Time of the host per node and step beside the law alone, in the same run.
//
//   ilaw_bench_host [--law NAME] [--situation NAME] [--points N...] [--threads N...] [--repetitions K]
//                   [--out FILE.csv]
//
// Points under gravity on a plane, or over it: all in flight and far, half of them touching, all
// touching. The law alone evaluates the same contacts, interleaved and without a list: "law" the
// impulse alone, "law+" with status and energies, as the host asks. "step" is a step of the host,
// "interface" what it takes longer than that of a host without interface. Each repetition times all
// of these in turn; medians are printed, of the processor's time with one thread, which others on
// the machine disturb little, else of the clock on the wall. "triad" is what the memory gave to as
// many threads in between (bench/triad.hpp), in arrays as large as a vector of all points.
#include "base/clock.hpp"
#include "base/csv.hpp"
#include "base/large_pages.hpp"
#include "bench/triad.hpp"
#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include "model/points.hpp"

#include <ilaw/arrays.hpp>

#include <CLI/CLI.hpp>

#include <omp.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace ilaw::host;
// Seconds of the wall clock; of this thread's processor time where there is but one.
double now() { return clock_seconds(omp_get_max_threads() == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC); }

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Subject {
  const char* law;
  Arguments arguments;
};

enum class Situation { flight, half, all };
constexpr const char* name_of[] = {"flight", "half", "all"};
constexpr double dt = 1e-3;
const Vector acceleration = (Vector(3) << 1.0, 0.0, -10.0).finished();

bool touches(Situation situation, std::size_t k) {
  return situation == Situation::all || (situation == Situation::half && (k * 2654435761U >> 7) % 2 == 0);
}

Points points_of(Situation situation, std::size_t count) {
  std::vector<PointMass> points(count, {1.0, 1.0, Vector::Zero(3), Vector::Zero(3), Vector()});
  for (std::size_t k = 0; k < count; ++k) {
    points[k].position[0] = static_cast<double>(k);
    points[k].position[2] = touches(situation, k) ? 0.0 : 1e3;
  }
  return {3, points};
}

// The host, with one interface or none.
class HostCase {
 public:
  HostCase(const Subject* subject, Situation situation, std::size_t count)
      : count_(count), model_(points_of(situation, count)) {
    const NodeSet& all = model_.sets().at("all");
    loads_.push_back(std::make_unique<Force>(all.nodes, std::vector<double>(count, 1.0), acceleration,
                                             Table{{0.0}, {Vector::Ones(1)}}));
    if (subject) add_interface(*subject, all);
    integrator_ = std::make_unique<Integrator>(model_, loads_, interfaces_, dt);
  }

  // Nanoseconds per node and step.
  double run(long steps) {
    const double start = now();
    for (long k = 0; k < steps; ++k) integrator_->step();
    return 1e9 * (now() - start) / (static_cast<double>(steps) * static_cast<double>(count_));
  }

 private:
  void add_interface(const Subject& subject, const NodeSet& all) {
    InterfaceSetup setup;
    setup.name = setup.law = setup.library = subject.law;
    setup.arguments = subject.arguments;
    setup.nodes = all.nodes;
    setup.areas = all.areas;
    setup.counterpart = std::make_unique<RigidCounterpart>(
        model_, all.nodes,
        std::make_unique<Plane>(Vector::Zero(3), Vector::Unit(3, 2), Motion(Vector::Zero(3).eval())));
    interfaces_.push_back(std::make_unique<Interface>(std::move(setup), model_));
  }

  std::size_t count_;
  Points model_;
  Loads loads_;
  Interfaces interfaces_;
  std::unique_ptr<Integrator> integrator_;
};

// The law by itself, on the arrays of the nodes that touch.
class LawCase {
 public:
  LawCase(const Subject& subject, Situation situation, std::size_t count)
      : library_(ilaw::library::named(subject.law)),
        law_(create_law(subject.law, subject.arguments, Vector(), library_, 3)),
        all_(count) {
    std::size_t touching = 0;
    for (std::size_t k = 0; k < count; ++k) touching += touches(situation, k) ? 1 : 0;
    const auto size = static_cast<std::int64_t>(law_.info().state_size);
    for (std::vector<double>* vectors : {&v_free_, &v_previous_, &normal_, &impulse_})
      vectors->resize(3 * touching);
    for (std::size_t k = 0; k < touching; ++k) {
      normal_[3 * k + 2] = 1.0;
      for (std::size_t c = 0; c < 3; ++c)
        v_free_[3 * k + c] = dt * acceleration[static_cast<Eigen::Index>(c)];
    }
    gap_.resize(touching);
    delassus_.assign(touching, 1.0);
    energy_.resize(touching * ILAW_ENERGY_COUNT);
    status_.resize(touching);
    state_.resize(touching * law_.info().state_size);
    batch_.struct_size = sizeof batch_;
    batch_.node_count = static_cast<std::int64_t>(touching);
    batch_.velocity_step = batch_.position_step = dt;
    batch_.v_free = ilaw::input(v_free_.data(), 3, 1);
    batch_.v_previous = ilaw::input(v_previous_.data(), 3, 1);
    batch_.normal = ilaw::input(normal_.data(), 3, 1);
    batch_.delassus = ilaw::input(delassus_.data(), 1, 1);
    batch_.gap = ilaw::input(gap_.data(), 1, 1);
    batch_.area = ilaw::input(delassus_.data(), 1, 1);
    batch_.impulse = ilaw::output(impulse_.data(), 3, 1);
    batch_.state_in = ilaw::input(state_.data(), size, 1);
    batch_.state_out = ilaw::output(state_.data(), size, 1);
    batch_.status_stride = 1;
    for (const std::vector<double>* values :
         {&v_free_, &v_previous_, &normal_, &impulse_, &gap_, &delassus_, &energy_, &state_})
      keep_in_large_pages(*values);
    if (law_.initialise(batch_) != ILAW_OK) throw std::runtime_error("initialise refused");
  }

  double run(long steps, bool outputs) {
    batch_.energy = outputs ? ilaw::output(energy_.data(), ILAW_ENERGY_COUNT, 1) : ilaw_output{};
    batch_.status = outputs ? status_.data() : nullptr;
    const double start = now();
    for (long k = 0; k < steps && batch_.node_count > 0; ++k) {
      batch_.time += dt;
      if (law_.evaluate(batch_) != ILAW_OK) throw std::runtime_error("evaluate refused");
    }
    return 1e9 * (now() - start) / (static_cast<double>(steps) * static_cast<double>(all_));
  }

 private:
  ilaw::library library_;
  ilaw::interface law_;
  std::size_t all_;
  std::vector<double> v_free_, v_previous_, normal_, impulse_, gap_, delassus_, energy_, state_;
  std::vector<std::uint8_t> status_;
  ilaw_batch batch_{};
};

// A triad for each thread.
class Memory {
 public:
  Memory(std::size_t count, int threads)
      : triads_(static_cast<std::size_t>(threads), Triad(3 * count / static_cast<std::size_t>(threads) + 1)) {
  }

  // GB/s of all together.
  double run() {
    const double start = now();
#pragma omp parallel for schedule(static)
    for (std::size_t t = 0; t < triads_.size(); ++t) triads_[t].run();
    return 1e-9 * triads_.front().bytes() * static_cast<double>(triads_.size()) / (now() - start);
  }

 private:
  std::vector<Triad> triads_;
};

struct Options {
  std::vector<std::size_t> points{1, 10, 100, 1000, 100000, 1000000};
  std::vector<int> threads{1};
  int repetitions = 7;
  std::string law, situation, out;
};

void measure(const Subject& subject, Situation situation, std::size_t count, int threads,
             const Options& options, std::ostream* csv) {
  omp_set_num_threads(threads);
  HostCase host(&subject, situation, count), alone(nullptr, situation, count);
  LawCase law(subject, situation, count);
  Memory memory(count, threads);
  const long steps = std::max(3L, 200000L / static_cast<long>(count));
  host.run(20);
  alone.run(20);
  law.run(3, true);
  std::vector<double> interface, whole, bare, full, triad;
  for (int k = 0; k < options.repetitions; ++k) {
    whole.push_back(host.run(steps));
    interface.push_back(whole.back() - alone.run(steps));
    bare.push_back(law.run(steps, false));
    full.push_back(law.run(steps, true));
    triad.push_back(memory.run());
  }
  const double law_time = median(full);
  std::printf("%8zu %-8s %-6s %d thread%s  law %7.2f  law+ %7.2f  interface %8.2f  step %8.2f ns", count,
              subject.law, name_of[static_cast<int>(situation)], threads, threads > 1 ? "s" : " ",
              median(bare), law_time, median(interface), median(whole));
  if (law_time > 1e-2) std::printf("  interface/law+ %6.2f", median(interface) / law_time);
  std::printf(count >= 100000 ? "  triad %5.1f GB/s\n" : "\n",
              median(triad));  // of fewer it tells the caches
  std::fflush(stdout);
  if (!csv) return;
  CsvWriter row(*csv, 9);
  row << std::to_string(count) << subject.law << name_of[static_cast<int>(situation)] << threads
      << median(bare) << law_time << median(interface) << median(whole) << median(triad);
  row.end_row();
}

int measure_all(const Options& options) {
  std::unique_ptr<std::ofstream> csv;
  if (!options.out.empty()) csv = std::make_unique<std::ofstream>(options.out);
  if (csv)
    *csv << "points,law,situation,threads,law_ns,law_with_outputs_ns,interface_ns,step_ns,triad_gb_per_s\n";
  const auto with = [](std::map<std::string, double> numbers) {
    Arguments arguments;
    arguments.numbers = std::move(numbers);
    return arguments;
  };
  const std::vector<Subject> subjects{
      {"contact", {}},
      {"coulomb", with({{"friction", 0.3}})},
      {"postit", with({{"friction", 0.3}, {"memory", 0.01}, {"buckets", 4.0}})}};
  for (const std::size_t count : options.points)
    for (const Subject& subject : subjects)
      for (const Situation situation : {Situation::flight, Situation::half, Situation::all})
        for (const int threads : options.threads)
          if ((options.law.empty() || options.law == subject.law) &&
              (options.situation.empty() || options.situation == name_of[static_cast<int>(situation)]))
            measure(subject, situation, count, threads, options, csv.get());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Time per node and step of the host, beside the law alone");
  app.add_option("--law", options.law, "This law alone");
  app.add_option("--situation", options.situation, "This situation alone: flight, half or all");
  app.add_option("--points", options.points, "Points in a scene")->expected(1, 8)->capture_default_str();
  app.add_option("--threads", options.threads, "Threads")->expected(1, 4)->capture_default_str();
  app.add_option("--repetitions", options.repetitions, "Medians are over so many")->capture_default_str();
  app.add_option("--out", options.out, "CSV file to write as well");
  CLI11_PARSE(app, argc, argv);
  place_arrays_one_after_another();
  try {
    return measure_all(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ilaw_bench_host: %s\n", error.what());
    return 2;
  }
}
