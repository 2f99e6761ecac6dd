// Contacts that cannot be reached are left out, which changes no bit: the same as when all are active.
#include "host_runner.hpp"

#include "base/parallel.hpp"

#include <omp.h>

#include <cstring>
#include <new>

namespace ilaw::host::testing::proximity_filter {
namespace {

json with_all_active(json scene) {
  for (json& interface : scene["interfaces"]) interface["skip"] = false;
  return scene;
}

// States of all contacts, by node, so that it does not matter when each became active.
std::vector<double> states_of(Scene& scene, const Dofs& u) {
  std::vector<double> states;
  for (const auto& interface : scene.interfaces)
    for (std::size_t node_index = 0; node_index < interface->nodes().size(); ++node_index) {
      const int contact_index = interface->contact_index_of(static_cast<int>(node_index), u);
      for (std::size_t entry = 0; entry < interface->info().state_size; ++entry)
        states.push_back(interface->state(contact_index, static_cast<int>(entry)));
    }
  return states;
}

// Runs a scene in lockstep with itself with all contacts active; returns the tally of the one that skips.
Tally expect_same_bits(const json& source) {
  omp_set_num_threads(1);
  Scene scene = scene_of(source), all = scene_of(with_all_active(source).dump());
  Integrator integrator = integrator_of(scene), complete = integrator_of(all);
  while (integrator.steps() < scene.steps) {
    integrator.step();
    complete.step();
    const bool same = same_bits(integrator.displacement(), complete.displacement()) &&
                      same_bits(integrator.velocity(), complete.velocity()) &&
                      same_bits(integrator.interface_impulse(), complete.interface_impulse());
    if (!same) {
      ADD_FAILURE() << "differs at step " << integrator.steps() << " of " << source.dump();
      break;
    }
  }
  const std::vector<double> states = states_of(scene, integrator.displacement()),
                            wanted = states_of(all, complete.displacement());
  EXPECT_EQ(states.size(), wanted.size());
  EXPECT_TRUE(states.empty() ||
              std::memcmp(states.data(), wanted.data(), states.size() * sizeof(double)) == 0);
  EXPECT_GE(integrator.tally().skipped, complete.tally().skipped);  // those not born yet, or dead
  EXPECT_EQ(integrator.tally().active + integrator.tally().skipped,
            complete.tally().active + complete.tally().skipped);
  EXPECT_EQ(integrator.tally().status_counts, complete.tally().status_counts);
  return integrator.tally();
}

// ---- drawn scenes ---------------------------------------------------------------------------------------

// Torn off in the first steps and free from then on: what rests is not asked again.
TEST(ProximityFilter, LeavesOutBondsThatBroke) {
  const Tally tally = expect_same_bits(json::parse(R"({
    "model": {"type": "points", "dimension": 2, "points": [
      {"mass": 1, "position": [0, 0], "velocity": [0, 10]}, {"mass": 1, "position": [1, 0], "velocity": [0, 10]},
      {"mass": 1, "position": [2, 0], "velocity": [0, 10]}]},
    "time": {"dt": 1e-3, "end": 0.1},
    "interfaces": [{"law": "cohesive", "nodes": "all",
                    "parameters": {"shape": "bilinear", "strength": 1.0, "toughness": 1e-3},
                    "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}}]})"));
  EXPECT_GT(tally.active, 0);
  EXPECT_LT(tally.active, tally.skipped);
}

// The axes of a memory follow the normal far away, too: a point flies past a sphere.
TEST(ProximityFilter, TurnsAxesOutOfReach) {
  expect_same_bits(json::parse(R"({
    "model": {"type": "points", "dimension": 3, "points": [
      {"mass": 1, "position": [0.6, 0, 2.8], "velocity": [-3, 30, -2]}]},
    "time": {"dt": 1e-3, "end": 0.1},
    "interfaces": [{"law": "penalty", "nodes": "all",
                    "parameters": {"stiffness": 1e4, "friction": 0.5, "tangential_stiffness": 1e4},
                    "obstacle": {"type": "sphere", "center": [0, 0, 0], "radius": 1}}]})"));
}

// Two points fly towards each other: they close twice as fast as either flies. From every distance, so that
// some meet just when the horizon ends.
TEST(ProximityFilter, SeesBothBodiesFly) {
  for (int steps = 1; steps < 80; ++steps) {
    const double apart = 2e-3 * (steps - 0.3);
    const json law = law_between({1}, {{"nodes", {0}}, {"normal", {1}}}, "contact", {{"restitution", 1}});
    const json scene =
        until(0.1, 0.001, scene_of_points({point(1, {0}, {1}), point(1, {apart}, {-1})}, {law}));
    expect_same_bits(scene);
    if (HasFailure()) return;
  }
}

// A point flies at 100 towards a wall; a spring that is born around it for one step, late, throws it on at
// 1000. The free motion says nothing of it, but the wall must act within that very step: its law looks ahead.
TEST(ProximityFilter, SeesWhatAnotherInterfaceThrows) {
  json scene = json::parse(R"({
    "model": {"type": "points", "dimension": 1, "points": [{"mass": 1, "position": [0], "velocity": [100]}]},
    "time": {"dt": 0.001, "end": 0.04},
    "interfaces": [
      {"name": "spring", "law": "penalty", "parameters": {"stiffness": 1e5, "integration": "explicit"}, "nodes": [0],
       "obstacle": {"type": "plane", "point": [10], "normal": [1]}},
      {"name": "wall", "law": "contact", "parameters": {"activation": "predictive"}, "nodes": [0],
       "obstacle": {"type": "plane", "point": [3.31], "normal": [-1]}}]})");
  for (int step = 1; step < 33; ++step) {
    scene["interfaces"][0]["birth"] = (step - 0.5) * 1e-3;
    scene["interfaces"][0]["death"] = (step + 0.5) * 1e-3;
    expect_same_bits(scene);
    auto [run, integrator] = run_to_end(scene);
    EXPECT_NEAR(integrator.displacement()[0], 3.31, 1e-12) << step;
  }
}

json soft_block(const char* name, const Triple& corner, const Triple& size,
                const std::array<int, 3>& elements, const Triple& velocity) {
  json soft = elastic(1e3, 0.3, 1);
  soft["type"] = "neo_hookean";
  return block(name, corner, size, elements, soft, velocity);
}

// A plate turns over below a block that is far off and flies away from it: now the block is behind the
// surface, which lets it go no further, however little the two have approached. The known bound of the gap
// holds for as long as the surface is not looked for again, no longer.
TEST(ProximityFilter, SeesASurfaceTurnItsBack) {
  constexpr double rate = 10.0, mass = 0.025;  // of a node
  json source =
      scene_of_blocks({soft_block("plate", {-0.5, -0.5, -0.1}, {1, 1, 0.2}, {1, 1, 1}, {0, 0, 0}),
                       soft_block("far", {-0.05, -0.05, 30}, {0.1, 0.1, 0.1}, {1, 1, 1}, {0, 0, 1})},
                      {law_between("far.z_min", {{"surface", "plate.z_max"}}, "contact")});
  for (int node = 0; node < 8; ++node) {
    const double x = node % 2 - 0.5, z = 0.2 * (node / 4 - 0.5);
    source["loads"].push_back(shock({node}, 0.0005, {mass * rate * z, 0.0, -mass * rate * x}));
  }
  const Tally tally = expect_same_bits(until(0.4, 1e-3, source));
  EXPECT_GT(tally.skipped, 100);
  EXPECT_GT(tally.status_counts[ILAW_CLOSED], 0);
}

// Contacts share nodes, and are solved in an order that must not depend on which are active: a block is
// thrown on another one, with a third far above it, whose nodes come first in the list and would, if active,
// share the same facets.
TEST(ProximityFilter, KeepsTheOrderOfSharedNodes) {
  Random draw(21);
  std::int64_t skipped = 0;
  for (int k = 0; k < 12 && !HasFailure(); ++k) {
    const double x = draw(-0.2, 0.4), y = draw(-0.2, 0.4);
    const Triple thrown{draw(-10.0, 10.0), draw(-10.0, 10.0), draw(-10.0, -1.0)};
    json scene =
        until_at_cfl(0.2, 0.7,
                     scene_of_blocks({soft_block("lower", {0, 0, 0}, {1, 1, 0.3}, {3, 4, 1}, {0, 0, 0}),
                                      soft_block("far", {x, y, 4}, {0.7, 0.8, 0.4}, {4, 3, 2}, {0, 0, -1}),
                                      soft_block("near", {x, y, 0.35}, {0.7, 0.8, 0.4}, {4, 3, 2}, thrown)},
                                     "[]"));
    json nodes = json::array();
    const Scene model = scene_of(scene);
    for (const char* face : {"far.z_min", "near.z_min"})
      for (const int node : model.model->sets().at(face).nodes) nodes.push_back(node);
    const json friction = {{"friction", 0.3}}, floor = plane({0, 0, -0.05}, {draw(-0.3, 0.3), 0, 1});
    scene["interfaces"] = {law_between(nodes, {{"surface", "lower.z_max"}}, "coulomb", friction),
                           law_on("lower.z_min", floor, "coulomb", friction)};
    skipped += expect_same_bits(scene).skipped;
  }
  EXPECT_GT(skipped, 1000);
}

// The last chunk is a worker's.
TEST(Parallel, ThrowsHereWhatAWorkerThrows) {
  omp_set_num_threads(2);
  std::vector<int> done(8, 0);
  EXPECT_THROW(for_each_chunk(8, 1,
                              [&](std::ptrdiff_t c, auto, auto) {
                                if (c == 7) throw std::bad_alloc();
                                done[static_cast<std::size_t>(c)] = 1;
                              }),
               std::bad_alloc);
  omp_set_num_threads(1);
  EXPECT_EQ(std::count(done.begin(), done.end(), 1), 7);
}

}  // namespace
}  // namespace ilaw::host::testing::proximity_filter
