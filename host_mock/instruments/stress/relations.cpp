// SPDX-License-Identifier: BSD-3-Clause
#include "stress/relations.hpp"

#include "base/scene_error.hpp"
#include "base/words.hpp"
#include "step/integrator.hpp"
#include "stress/related_scenes.hpp"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

constexpr double tolerance = 1e-13;       // of coupled contacts, so that a motion is known well
constexpr double least_bound = 1e-9;      // of differences, in the scale of the motion
constexpr double growth_of_nudges = 1e5;  // a difference may be so much larger than one rounding makes it
constexpr double vague_bound = 0.1;       // beyond, a relation says nothing
constexpr int sample_count = 8;
constexpr int most_twins = 12;  // a jump that half of them show is missed by all once in 4000 times
constexpr std::uint64_t first_twin = 5;

struct RelatedRun {
  RelatedRun(const json& source, const std::filesystem::path& file, double begin = 0.0)
      : RelatedRun(read_scene(source, file), begin) {}
  explicit RelatedRun(Scene read, double begin = 0.0)
      : scene(std::move(read)),
        integrator(*scene.model, scene.loads, scene.interfaces, scene.dt, scene.prestress, begin) {
    integrator.set_tolerance(tolerance);
  }
  void advance(std::int64_t steps) {
    integrator.start();
    while (integrator.steps() < steps) integrator.step();
  }
  std::string state() const {
    std::ostringstream out;
    integrator.save(out);
    return out.str();
  }
  Scene scene;
  Integrator integrator;
};

// A motion at some instants, and the largest displacement and velocity that it has on the way. Impulses that
// cancel are rounded, too.
struct Motion {
  std::vector<Dofs> u, v;
  double displacement = 0.0, velocity = 0.0, farthest = 0.0;
  bool is_solved = true;  // all steps, as the solver of coupled contacts says

  void note(const RelatedRun& run) {
    const Integrator& integrator = run.integrator;
    const Dofs& mass = run.scene.model->mass();
    const Dofs change = integrator.interface_impulse().cwiseQuotient(mass);
    velocity = std::max({velocity, integrator.velocity().cwiseAbs().maxCoeff(), change.cwiseAbs().maxCoeff(),
                         (integrator.velocity() - change).cwiseAbs().maxCoeff()});
    displacement =
        std::max({displacement, integrator.displacement().cwiseAbs().maxCoeff(), velocity * run.scene.dt});
  }
};

Motion motion_of(RelatedRun& run, std::int64_t steps) {
  Motion motion;
  motion.farthest = run.scene.model->position().cwiseAbs().maxCoeff();
  run.integrator.start();
  motion.note(run);
  for (int sample = 1; sample <= sample_count; ++sample) {
    while (run.integrator.steps() < steps * sample / sample_count) {
      run.integrator.step();
      motion.note(run);
    }
    motion.u.push_back(run.integrator.displacement());
    motion.v.push_back(run.integrator.velocity());
  }
  motion.is_solved = run.integrator.tally().unconverged == 0;
  return motion;
}

// The largest difference of two motions, in the scale of the first, and where it is.
struct Difference {
  double size = 0.0;
  std::string where;
};

class Comparison {
 public:
  Comparison(const Motion& motion, const Scene& scene, const RelatedScene& related)
      : motion_(motion), d_(scene.model->dimension()), related_(related) {
    // Gaps are differences of coordinates; a law that closes one moves by their rounding.
    const double rounded =
        64.0 * std::numeric_limits<double>::epsilon() * (motion.farthest + related.farthest) / least_bound;
    displacement_ = std::max(motion.displacement, rounded);
    velocity_ = std::max(motion.velocity, rounded / scene.dt);
  }

  Difference with(const Motion& other) const {
    Difference largest;
    const auto compare = [&](const std::vector<Dofs>& ours, const std::vector<Dofs>& theirs, double scale,
                             double unit, const char* name) {
      for (std::size_t sample = 0; sample < ours.size(); ++sample)
        for (Eigen::Index i = 0; i < ours[sample].size(); ++i)
          for (const std::vector<int>& image : related_.nodes) {
            const double off = std::abs(ours[sample][i] - seen(theirs[sample], i, image) / unit) / scale;
            if (off <= largest.size) continue;
            largest = {off, formatted("%s%d of node %d, sample %zu of %d", name, static_cast<int>(i % d_),
                                      static_cast<int>(i / d_), sample + 1, sample_count)};
          }
    };
    if (displacement_ > 0.0) compare(motion_.u, other.u, displacement_, related_.length, "u");
    if (velocity_ > 0.0) compare(motion_.v, other.v, velocity_, related_.length / related_.time, "v");
    return largest;
  }

 private:
  double seen(const Dofs& theirs, Eigen::Index dof, const std::vector<int>& image) const {
    const auto c = static_cast<std::size_t>(dof % d_);
    const Eigen::Index node = dof / d_, there = image.empty() ? node : image[static_cast<std::size_t>(node)];
    return related_.sign[c] * theirs[there * d_ + related_.axis[c]];
  }

  const Motion& motion_;
  const Eigen::Index d_;
  const RelatedScene& related_;
  double displacement_, velocity_;
};

class Check {
 public:
  Check(const json& source, const std::filesystem::path& file, std::int64_t steps)
      : source_(source), file_(file), run_(source, file) {
    omp_set_num_threads(1);
    steps_ = std::min(steps, run_.scene.steps);
    try {
      motion_ = motion_of(run_, steps_);
      state_ = run_.state();
    } catch (const std::runtime_error&) {  // contacts may have no solution to this tolerance
      motion_ = {};
    }
  }

  RelationReport report() {
    if (motion_.u.empty()) {
      report_.vague = static_cast<std::int64_t>(relations().size());
      return report_;
    }
    for_bits();
    moved_.farthest = motion_.farthest;
    add_twin(rounded_);
    add_twin(moved_);
    for (const Relation& relation : relations()) compare(relation);
    return report_;
  }

 private:
  void fail(const std::string& name, const std::string& how) { report_.broken.push_back(name + ": " + how); }

  // What a run of the same scene in another way must give to the bit.
  void same_bits(const char* name, std::string (Check::*other)() const, const std::string& expected) {
    try {
      if ((this->*other)() != expected) return fail(name, "the bits are others");
    } catch (const std::exception& stop) {
      return fail(name, std::string("stops: ") + stop.what());
    }
    ++report_.held[name];
  }

  std::string state_of_a_run(const std::function<void(Scene&)>& change = {}) const {
    Scene scene = read_scene(source_, file_);
    if (change) change(scene);
    RelatedRun run(std::move(scene));
    run.advance(steps_);
    return run.state();
  }

  void for_bits() {
    const std::string bits = bits_of(run_);
    same_bits("with two threads", &Check::on_two_threads, state_);
    same_bits("beside itself", &Check::beside_itself, state_ + state_);
    same_bits("resumed", &Check::resumed, bits + sums_of(run_));
    same_bits("with contacts one by one", &Check::one_by_one, state_);
    same_bits("without skipping", &Check::without_skip, bits);  // sums of energies run over other contacts
    if (!source_.contains("fields")) same_bits("with parameters in reverse order", &Check::permuted, state_);
  }

  static std::string bits_of(const RelatedRun& run) {
    std::string bits;
    for (const Dofs* dofs : {&run.integrator.displacement(), &run.integrator.velocity()})
      bits.append(reinterpret_cast<const char*>(dofs->data()),
                  sizeof(double) * static_cast<std::size_t>(dofs->size()));
    const Temperatures* const temperatures = run.integrator.temperatures();
    for (int node = 0; temperatures && node < run.scene.model->node_count(); ++node) {
      const double temperature = temperatures->at(node);
      bits.append(reinterpret_cast<const char*>(&temperature), sizeof temperature);
    }
    return bits;
  }

  // What a summary tells of energies and heat.
  static std::string sums_of(const RelatedRun& run) {
    std::string bits;
    const auto add = [&bits](const auto& parts) {
      for (const auto& part : parts)
        bits.append(reinterpret_cast<const char*>(&part.second), sizeof part.second);
    };
    add(named(run.integrator.energy()));
    if (const Temperatures* const temperatures = run.integrator.temperatures())
      add(named(temperatures->report()));
    return bits;
  }

  std::string on_two_threads() const {
    struct Two {
      Two() { omp_set_num_threads(2); }
      ~Two() { omp_set_num_threads(1); }
    } two;
    return state_of_a_run();
  }

  std::string one_by_one() const {
    return state_of_a_run([](Scene& scene) {
      for (const auto& interface : scene.interfaces) interface->step_one_by_one();
    });
  }

  std::string resumed() const {
    RelatedRun first(source_, file_), second(source_, file_);
    first.advance(steps_ / 2);
    std::stringstream checkpoint;
    first.integrator.save(checkpoint);
    second.integrator.load(checkpoint);
    second.advance(steps_);
    return bits_of(second) + sums_of(second);
  }

  // Several scenes at once in one process. Readers of meshes start processes, which threads must not do.
  std::string beside_itself() const {
    std::array<std::optional<RelatedRun>, 2> runs;
    for (auto& run : runs) run.emplace(source_, file_);
    std::array<std::exception_ptr, 2> stops;
    std::array<std::thread, 2> threads;
    for (std::size_t k = 0; k < runs.size(); ++k)
      threads[k] = std::thread([&, k] {
        omp_set_num_threads(1);
        try {
          runs[k]->advance(steps_);
        } catch (...) {
          stops[k] = std::current_exception();
        }
      });
    for (std::thread& thread : threads) thread.join();
    for (const std::exception_ptr& stop : stops)
      if (stop) std::rethrow_exception(stop);
    return runs[0]->state() + runs[1]->state();
  }

  std::string without_skip() const {
    json all = source_;
    for (json& interface : all["interfaces"]) interface["skip"] = false;
    RelatedRun run(all, file_);
    run.advance(steps_);
    return bits_of(run);
  }

  std::string permuted() const {
    return state_of_a_run([](Scene& scene) {
      for (auto& interface : scene.interfaces) {
        InterfaceSetup setup = interface->take_setup();
        setup.arguments.is_reversed = true;
        interface = std::make_unique<Interface>(std::move(setup), *scene.model);
      }
    });
  }

  // Even seeds round all places, also those at 0.
  double farthest_of(std::uint64_t seed, double farthest) const {
    return seed % 2 == 0 ? std::max(farthest, motion_.farthest + motion_.displacement) : farthest;
  }
  // The largest effect of roundings of the scene, over as many twins as a bound needs.
  struct Twins {
    double farthest;
    int count = 0;
    double effect = 0.0;
  };
  void add_twin(Twins& twins) const {
    try {
      const std::uint64_t seed = first_twin + static_cast<std::uint64_t>(twins.count++);
      RelatedRun twin(nudged(source_, farthest_of(seed, twins.farthest), seed), file_);
      const RelatedScene same;
      twins.effect =
          std::max(twins.effect, Comparison(motion_, run_.scene, same).with(motion_of(twin, steps_)).size);
    } catch (const std::exception&) {
      twins.effect = std::numeric_limits<double>::infinity();
    }
  }
  bool is_undetermined(const Relation& relation) const { return !(bound_of(relation) < vague_bound); }
  double bound_of(const Relation& relation) const {
    const double effect = std::max(rounded_.effect, relation.rounds_places ? moved_.effect : 0.0);
    return std::max(least_bound, growth_of_nudges * effect);
  }
  // One twin may take the side of a jump that the scene took: a node that opens or closes by a rounding. A
  // difference is a finding only if no twin jumps.
  void doubt(const Relation& relation) {
    while (rounded_.count < most_twins && !is_undetermined(relation)) add_twin(rounded_);
    while (relation.rounds_places && moved_.count < most_twins && !is_undetermined(relation))
      add_twin(moved_);
  }

  // The related scene may have the jump instead, where its own roundings take a side that those of the scene
  // do not. A mistake of a law or of the host is in all twins of it.
  bool holds_for_a_twin_of(const RelatedScene& related, const Relation& relation) const {
    const double farthest = relation.rounds_places ? moved_.farthest : 0.0;
    for (std::uint64_t seed = first_twin; seed < first_twin + most_twins; ++seed) try {
        RelatedRun twin(nudged(related.source, farthest_of(seed, farthest), seed), file_, related.begin);
        const Motion motion = motion_of(twin, steps_);
        if (Comparison(motion_, run_.scene, related).with(motion).size <= bound_of(relation)) return true;
      } catch (const std::exception&) {  // it stops: as bad as a difference
      }
    return false;
  }

  void compare(const Relation& relation) {
    const std::optional<RelatedScene> related = relation.make(source_, run_.scene);
    if (!related) return;
    bool is_vague = !motion_.is_solved || is_undetermined(relation);
    double size = std::numeric_limits<double>::infinity();
    std::string how;
    if (!is_vague) try {
        RelatedRun other(related->source, file_, related->begin);
        const Motion motion = motion_of(other, steps_);
        const Difference difference = Comparison(motion_, run_.scene, *related).with(motion);
        is_vague = !motion.is_solved;
        size = difference.size;
        how = formatted("%s differs by %.2g", difference.where.c_str(), size);
      } catch (const SceneError& refusal) {
        if (related->is_excused(refusal.what())) return;
        return fail(relation.name, std::string("is refused: ") + refusal.what());
      } catch (const std::exception& stop) {
        how = std::string("stops: ") + stop.what();
        is_vague = how.find("have no common solution") != std::string::npos;  // as where a step is not solved
      }
    if (!is_vague && !(size <= bound_of(relation))) {
      doubt(relation);
      is_vague = is_undetermined(relation) || holds_for_a_twin_of(*related, relation);
    }
    if (is_vague) {
      ++report_.vague;
      return;
    }
    const double bound = bound_of(relation);
    if (!(size <= bound)) return fail(relation.name, how + formatted(", expected at most %.2g", bound));
    report_.worst = std::max(report_.worst, size / bound);
    ++report_.held[relation.name];
  }

  const json& source_;
  const std::filesystem::path& file_;
  RelatedRun run_;
  std::int64_t steps_ = 0;
  Motion motion_;
  Twins rounded_{0.0}, moved_{0.0};
  std::string state_;
  RelationReport report_;
};

}  // namespace

RelationReport check_relations(const json& source, const std::filesystem::path& file, std::int64_t steps) {
  return Check(source, file, steps).report();
}

}  // namespace ilaw::host
