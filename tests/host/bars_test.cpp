// Bars against d'Alembert's solutions. At cfl = 1 the scheme is exact at the nodes: a wave passes one element
// per step, so that contact is checked to rounding. A front brings half an element's mass first, whose
// impulse is half that of the steps after it.
#include "host_runner.hpp"

#include "model/bars.hpp"

namespace ilaw::host::testing {
namespace {

int node_of(const Scene& scene, const char* set) { return scene.model->sets().at(set).nodes[0]; }

// Forces of an interface on one node, impulse over dt, per step.
std::vector<double> run_forces(Scene& scene, Integrator& integrator, int node) {
  std::vector<double> forces;
  while (integrator.steps() < scene.steps) {
    integrator.step();
    forces.push_back(integrator.interface_impulse()[node] / scene.dt);
  }
  return forces;
}

// ---- a bar on a wall (Doyen, Ern, Piperno 2011) ---------------------------------------------------------

json doyen_bar(double cfl, int elements) {
  const json wall = law_on("bar.left", ground(1), "contact", {{"activation", "predictive"}});
  return until_at_cfl(1.6, cfl, scene_of_bars({bar("bar", 5, 10, elements, 900, 1, -10)}, {wall}));
}

// c = 30: contact from 5/10 to 5/10 + 2L/c, that is 3 N/2 and 3 N/2 + 2 N steps of h = L/(N c), with the
// force rho c v S = 300. In the step of the release the end is already free to go, and does not get the half
// impulse 300 h/2 that its half mass would need to leave at once with 10: the bar leaves with 10 - 300 h/2
// over its mass 10, and its end with 0 and 20 in turns, of mean 10. Rounding: 3.5 N steps of some operations
// on 300.
TEST(BarOnWall, HasExactContactAtTheCriticalStep) {
  for (const int elements : {4, 50, 100, 400}) {
    GIVEN(elements);
    auto [scene, integrator] = simulation_of(doyen_bar(1.0, elements));
    const double h = 10.0 / 30.0 / elements, rounding = 300.0 * 3.5 * elements * 2.2e-16 * 100.0;
    ASSERT_NEAR(scene.dt, h, 1e-16);
    const std::vector<double> forces = run_forces(scene, integrator, node_of(scene, "bar.left"));
    const int meets = 3 * elements / 2, leaves = meets + 2 * elements;
    for (int step = 1; step <= static_cast<int>(forces.size()); ++step) {
      const double exact = step < meets || step >= leaves ? 0.0 : step == meets ? 150.0 : 300.0;
      ASSERT_NEAR(forces[static_cast<std::size_t>(step) - 1], exact, rounding) << elements << ", " << step;
    }
    EXPECT_NEAR(scene.model->mass().dot(integrator.velocity()), 100.0 - 300.0 * h / 2.0, rounding);
    const int left = node_of(scene, "bar.left");
    const double u = integrator.displacement()[left];
    integrator.step();
    integrator.step();
    EXPECT_NEAR(integrator.displacement()[left] - u, 2.0 * h * 10.0, rounding * h);
  }
}

// ---- two bars -------------------------------------------------------------------------------------------

// Every node of a bar offers its section.
TEST(ElasticBar, OffersItsSectionEverywhere) {
  const Bars bar({{"b", 0.0, 1.0, 4, 1.0, 1.0, 0.3, 0.0}});
  for (const char* set : {"b", "b.left", "b.right", "all"})
    for (const double area : bar.sets().at(set).areas) EXPECT_EQ(area, 0.3) << set;
}

// Whichever bar it belongs to: l sqrt(rho/E) of one element.
TEST(TwoBars, AreLimitedByTheFasterElement) {
  const BarSetup slow{"slow", 0.0, 1.0, 4, 1.0, 1.0, 1.0, 0.0}, fast{"fast", 2.0, 1.0, 8, 4.0, 1.0, 1.0, 0.0};
  EXPECT_EQ(Bars({slow}).critical_step(), 0.25);
  EXPECT_EQ(Bars({slow, fast}).critical_step(), 0.0625);
  EXPECT_EQ(Bars({fast, slow}).critical_step(), 0.0625);
}

// Left: c = 2, Z = 2, L = 1, v = 1; right: c = 1.5, Z = 0.5 sqrt(9 4) = 3, L = 1.2, v = -0.5; both have
// Le/c = 0.01. They meet after 10 steps and go together at (Z_A v_A + Z_B v_B)/(Z_A + Z_B) = 0.1, with the
// force Z_A Z_B/(Z_A + Z_B) (v_A - v_B) = 1.8, until the wave in the left bar is back after 2L/c = 1. Behind
// it the left bar moves at 2 (0.1) - 1 = -0.8; together the ends would then need the force -0.36: they part,
// and the right one goes at 0.1 - 1.8/3 = -0.5 until its own wave is back, 1.6 after they met.
//
// An end of half an element has the mass Z h/2, so that H h/2 = 1/2 + 1/3 = 1/1.2. The step where they meet
// stops 1.5 with the impulse 1.5/H = 0.9 h. In that where they part, an impulse of 0.9 h would let the ends
// go at 0.3 from each other; the law gives no more than together needs, 0.9 h - 0.3/H = 0.72 h.
TEST(TwoBars, OfUnequalImpedancesAndLengthsMeetAndPart) {
  json source = scene_of_bars({bar("a", -1.15, 1, 50, 4, 1, 1), bar("b", 0, 1.2, 80, 9, 4, -0.5)},
                              {law_between("b.left", {{"nodes", "a.right"}, {"normal", {1}}}, "contact",
                                           {{"activation", "predictive"}})});
  source["model"]["bars"][1]["section"] = 0.5;
  auto [scene, integrator] = simulation_of(until_at_cfl(1.65, 1, source));
  ASSERT_NEAR(scene.dt, 0.01, 1e-17);
  const int a = node_of(scene, "a.right"), b = node_of(scene, "b.left");
  double v_a = 0.0, v_b = 0.0;        // of the step before
  constexpr double rounding = 1e-11;  // 165 steps on velocities of 1 and forces of 2
  while (integrator.steps() < scene.steps) {
    integrator.step();
    const auto step = integrator.steps();
    const double force = integrator.interface_impulse()[b] / scene.dt;
    const double exact = step < 10 || step > 110 ? 0.0 : step == 10 ? 0.9 : step == 110 ? 0.72 : 1.8;
    EXPECT_NEAR(force, exact, rounding) << step;
    EXPECT_NEAR(integrator.interface_impulse()[a], -integrator.interface_impulse()[b], 1e-17);
    if (step >= 10 && step <= 109) {
      EXPECT_NEAR(integrator.velocity()[a], 0.1, rounding) << step;
      EXPECT_NEAR(integrator.velocity()[b], 0.1, rounding) << step;
    }
    if (step > 111 && step < 165) {  // half masses leave in turns, see the bar on the wall
      EXPECT_NEAR(0.5 * (v_a + integrator.velocity()[a]), -0.8, rounding) << step;
      EXPECT_NEAR(0.5 * (v_b + integrator.velocity()[b]), -0.5, rounding) << step;
    }
    v_a = integrator.velocity()[a];
    v_b = integrator.velocity()[b];
  }
  EXPECT_LE(integrator.energy().balance_error, 1e-14);
}

// ---- an elastic bar thrown on a wall (arXiv 2606.01355) -------------------------------------------------

struct ContactNode {
  double u_error, v_error, peak_force;
};

// From 1.1 times the release on: mean |u - u_exact| over mean |u_exact|, the same for v at the steps' ends.
ContactNode contact_node(double cfl, int elements) {
  constexpr double length = 0.254, young = 2.1e11, density = 7847.0, gap = 1e-3 * length, speed = 5.0;
  const double c = std::sqrt(young / density), meets = gap / speed, leaves = meets + 2.0 * length / c;
  const double end = leaves + 6.0 * length / c;
  json source = scene_of_bars({bar("bar", gap, length, elements, young, density, -speed)},
                              {law_on("bar.left", ground(1), "contact", {{"activation", "moreau"}})});
  source["model"]["bars"][0]["section"] = 6.45e-4;
  auto [scene, integrator] = simulation_of(until_at_cfl(end, cfl, source));
  double u_error = 0.0, u_sum = 0.0, v_error = 0.0, v_sum = 0.0, peak_force = 0.0;
  while (integrator.steps() < scene.steps) {
    const double v_before = integrator.velocity()[0];
    integrator.step();
    peak_force = std::max(peak_force, integrator.interface_impulse()[0] / scene.dt);
    if (integrator.time() < 1.1 * leaves) continue;
    const double u = speed * (integrator.time() - leaves);  // above the wall
    u_error += std::abs(gap + integrator.displacement()[0] - u);
    u_sum += std::abs(u);
    v_error += std::abs(0.5 * (v_before + integrator.velocity()[0]) - speed);
    v_sum += speed;
  }
  return {u_error / u_sum, v_error / v_sum, peak_force};
}

// The errors published there, of two digits, to half a unit of the second one: 5 % at most. The peak of the
// force S sqrt(rho E) |v0| = 130915 at cfl 0.7 is the overshoot of a dispersed front, whatever the mesh.
TEST(ElasticBar, IsAsNearItsExactReboundAsPublished) {
  struct Published {
    int elements;
    double cfl, u, v;
  };
  for (const Published& published : std::vector<Published>{{10, 0.999, 0.087, 0.10},
                                                           {100, 0.999, 6.4e-3, 1.2e-2},
                                                           {1000, 0.999, 6.7e-4, 2.7e-3},
                                                           {10, 0.7, 0.071, 0.21},
                                                           {100, 0.7, 1.2e-2, 7.1e-2},
                                                           {1000, 0.7, 2.7e-3, 2.5e-2}}) {
    const ContactNode found = contact_node(published.cfl, published.elements);
    EXPECT_NEAR(found.u_error, published.u, 0.05 * published.u) << published.elements << " " << published.cfl;
    EXPECT_NEAR(found.v_error, published.v, 0.05 * published.v) << published.elements << " " << published.cfl;
    if (published.elements == 1000 && published.cfl == 0.7) {
      EXPECT_NEAR(found.peak_force / 130915.0, 1.064, 5e-4);
    }
  }
}

// ---- long runs ------------------------------------------------------------------------------------------

// A bar between two walls, thousands of impacts.
json bar_between_walls(double cfl, int elements, double restitution, double end) {
  const auto wall = [](const char* side, const json& obstacle, double e) {
    return law_on(side, obstacle, "contact", {{"activation", "moreau"}, {"restitution", e}});
  };
  return until_at_cfl(
      end, cfl,
      scene_of_bars({bar("bar", 0.5, 1, elements, 1, 1, -0.1)},
                    {wall("bar.left", ground(1), restitution), wall("bar.right", plane({2}, {-1}), 1)}));
}

TEST(BarBetweenWalls, ClosesItsBalanceOverAMillionSteps) {
  auto [scene, integrator] = run_to_end(bar_between_walls(0.9, 10, 0.9, 0.9 * 1e6 / 10));
  EXPECT_GE(integrator.steps(), 1000000);
  EXPECT_LE(integrator.energy().balance_error, 1e-10);
}

// ---- bars that start deformed ---------------------------------------------------------------------------

// A bar of E = S = L = 1, moved by a at its left and b at its right end, has the strain b - a everywhere: the
// energy (b - a)^2/2 at the start, and forces of b - a on its ends alone, which give half a step's velocity.
TEST(InitialDisplacement, IsLinearAlongTheBar) {
  for (const auto& [a, b] : {std::pair{0.3, -0.1}, std::pair{-0.2, 0.4}, std::pair{0.7, 0.7}}) {
    json source = shipped("held_rod");
    source.erase("exact");
    source["loads"] = json::array();
    source["model"]["bars"][0]["elements"] = 7;
    source["initial"] = {{{"displacement", {a}}, {"gradient", {{b - a}}}}};
    source["interfaces"] = json::array();
    auto [scene, integrator] = simulation_of(source);
    const double half_mass = 0.5 / 7.0, kick = 0.5 * scene.dt * (b - a) / half_mass;
    for (int k = 0; k <= 7; ++k) {
      EXPECT_NEAR(integrator.displacement()[k], a + (b - a) * k / 7.0, 1e-15) << k;
      EXPECT_NEAR(integrator.velocity()[k], k == 0 ? kick : k == 7 ? -kick : 0.0, 1e-13) << k;
    }
    EXPECT_NEAR(integrator.energy().potential, 0.5 * (b - a) * (b - a), 1e-15);
    while (integrator.steps() < scene.steps) integrator.step();
    EXPECT_LE(integrator.energy().balance_error, 1e-13);
  }
}

TEST(InitialDisplacement, IntoAnObstacleIsWarnedOf) {
  json scene = shipped("held_rod");
  scene["initial"] = {{{"displacement", {-0.25}}, {"gradient", {{0.25}}}}};
  scene.erase("exact");
  EXPECT_THAT(scene_of(scene).warnings,
              ElementsAre("/interfaces/0: 1 node(s) start inside the obstacle, node 0 by 0.25"));
}

}  // namespace
}  // namespace ilaw::host::testing
