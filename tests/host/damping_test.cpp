// Bodies that are damped, and loads over time, against closed forms.
#include "run_result.hpp"

#include <Eigen/Geometry>

#include <complex>

namespace ilaw::host::testing::damping {
namespace {

// A point that is driven along y keeps the damping along x, as a free one beside it.
TEST(Damping, ActsAlongTheFreeAxesOfADrivenNode) {
  for (const double h : coprime_steps) {
    GIVEN(h);
    json source = json::parse(R"({
      "model": {"type": "points", "dimension": 2, "points": [{"mass": 3, "position": [0, 0], "velocity": [2, 0]},
                                                             {"mass": 3, "position": [1, 0], "velocity": [2, 0]}]},
      "loads": [{"type": "damping", "rate": 30},
                {"type": "motion", "nodes": [0], "axes": [1], "path": [[0, 0, 0], [0.2, 0, 0.1]]}],
      "interfaces": []})");
    source["time"] = {{"dt", h}, {"end", 0.5}};
    auto [scene, integrator] = run_to_end(source);
    const double a = 15.0 * h, kept = 2.0 * (1.0 - 0.5 * a) / (1.0 + 0.5 * a) *
                                      std::pow((1.0 - a) / (1.0 + a), static_cast<double>(scene.steps));
    EXPECT_NEAR(integrator.velocity()[2], kept, 1e-14);
    EXPECT_EQ(integrator.velocity()[0], integrator.velocity()[2]);
    EXPECT_EQ(integrator.velocity()[1], 0.0);
    EXPECT_NEAR(integrator.displacement()[1], 0.1, 1e-15);
    EXPECT_LT(integrator.energy().balance_error, 1e-14);
  }
}

// A floor carries the weight, whatever is damped: alone, with friction, and through a stack of light and
// heavy ones.
TEST(Damping, LeavesTheWeightToTheFloor) {
  json source = json::parse(R"({
    "model": {"type": "points", "dimension": 2, "points": [{"mass": 1, "position": [0, 0]}, {"mass": 20, "position": [0, 0]},
                                                           {"mass": 5, "position": [0, 0]}]},
    "loads": [{"type": "gravity", "acceleration": [0, -10]}, {"type": "damping", "nodes": "all"},
              {"type": "force", "nodes": [0], "direction": [1, 0], "history": [[0, 60]]},
              {"type": "damping", "name": "more", "nodes": [1], "rate": 50}],
    "interfaces": [{"name": "floor", "law": "coulomb", "parameters": {"friction": 0.2}, "nodes": [0],
        "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}},
      {"name": "middle", "law": "coulomb", "parameters": {"friction": 0.2}, "nodes": [1], "against": {"nodes": [0], "normal": [0, 1]}},
      {"name": "top", "law": "contact", "nodes": [2], "against": {"nodes": [1], "normal": [0, 1]}}],
    "output": {"forces": ["floor", "middle", "top", "more"]}})");
  for (const double h : coprime_steps)
    for (const double rate : {20.0, 200.0}) {
      GIVEN(h, rate);
      source["time"] = {{"dt", h}, {"end", 3}};
      source["loads"][1]["rate"] = rate;
      const Ran run = ran(source);
      EXPECT_NEAR(run.last("floor.F1"), 260.0, 1e-9);
      EXPECT_NEAR(run.last("floor.F0"), -52.0, 1e-9);
      EXPECT_NEAR(run.last("middle.F1"), 250.0, 1e-9);
      EXPECT_NEAR(run.last("top.F1"), 50.0, 1e-9);
      EXPECT_NEAR(run.last("more.F1"), 0.0, 1e-9);
      EXPECT_LT(run.energy("balance_error"), 1e-13);
      EXPECT_LT(run.energy("reaction_work"), CoupledStep::default_tolerance);
    }
}

// ---- tables in time -------------------------------------------------------------------------------------

// Gravity and damping over time: a point settles on a spring, and is let go.
TEST(History, ScalesGravityAndDamping) {
  json source = json::parse(R"({
    "model": {"type": "points", "dimension": 1, "points": [{"mass": 2, "position": [0], "stiffness": [200]}]},
    "loads": [{"type": "gravity", "acceleration": [-10], "history": [[0, 0], [0.5, 1], [4, 1], [4.001, 0]]},
              {"type": "damping", "rate": 20, "history": {"rows": [[0, 1], [3.9, 1], [4, 0]], "smooth": true}}],
    "interfaces": [], "output": {"watch": [0]}})");
  for (const double h : coprime_steps) {
    GIVEN(h);
    source["time"] = {{"dt", h}, {"end", 6}};
    const Ran run = ran(source);
    double least = 0.0, most = -1.0;
    for (std::size_t k = 0; k < run.rows(); ++k) {
      const double time = run["time"][k], u = run["n0.u0"][k];
      EXPECT_TRUE(time <= 3.0 || time >= 3.99 || std::abs(u + 0.1) < 1e-8) << u << " at " << time;
      if (time < 4.1) continue;
      least = std::min(least, u);
      most = std::max(most, u);
    }
    EXPECT_NEAR(least, -0.1, 2e-3);
    EXPECT_NEAR(most, 0.1, 2e-3);
  }
}

// A floor carries weight and a varying damping alike.
TEST(History, OfDampingReachesTheLaws) {
  for (const double h : coprime_steps) {
    json source = resting_point("contact", {}, h);
    source["loads"].push_back(
        {{"type", "damping"}, {"rate", 300}, {"history", {{0, 0}, {0.1, 1}, {0.15, 0.3}}}});
    EXPECT_THAT(ran(source)["floor.F1"], Each(DoubleNear(10.0, 1e-12))) << "h = " << h;
  }
}

TEST(Table, IsSmoothBetweenItsRowsOrASine) {
  const Table smooth({1.0, 3.0}, {Vector::Constant(1, 2.0), Vector::Constant(1, 6.0)}, true);
  EXPECT_EQ(smooth.at(0.0)[0], 2.0);
  EXPECT_EQ(smooth.at(2.0)[0], 4.0);
  EXPECT_EQ(smooth.at(5.0)[0], 6.0);
  for (const double at : {1.0, 3.0}) EXPECT_NEAR(smooth.at(at + 1e-4)[0], smooth.at(at - 1e-4)[0], 1e-11);
  const Table sine(Sine{Vector::Constant(1, 1.0), Vector::Constant(1, 3.0), 0.5, 0.1});
  EXPECT_NEAR(sine.at(0.3)[0], 1.0 + 3.0 * std::sin(0.3 * M_PI + 0.1), 1e-15);
}

TEST(History, TakesASineAndRefusesOneOfDamping) {
  json source = resting_point("contact", {}, 1e-2);
  source["loads"].push_back(
      json::parse(R"({"type": "force", "name": "shaker", "nodes": [0], "direction": [1, 0],
                                            "history": {"sine": {"amplitude": 3, "frequency": 5}}})"));
  source["output"]["forces"].push_back("shaker");
  const Ran run = ran(source);
  for (std::size_t k = 0; k < run.rows(); ++k)
    EXPECT_NEAR(run["shaker.F0"][k], 3.0 * std::sin(10.0 * M_PI * run["time"][k]), 1e-12);
  source["loads"].back() =
      json::parse(R"({"type": "damping", "rate": 1, "history": {"sine": {"amplitude": 3, "frequency": 5}}})");
  source["output"]["forces"] = {"floor"};
  EXPECT_EQ(refusal_of(source), "/loads/1/history: found a sine, expected rows: a rate is not negative");
}

// ---- bulk viscosity -------------------------------------------------------------------------------------

// The stretch of one element whose volume vibrates alone, from rest, at steps of h: the roots of
//   z^2 - (2 - h c - h^2 w^2) z + (1 - h c) = 0.
double damped_vibration(double start, double w, double c, double h, std::int64_t steps) {
  const std::complex<double> half = 1.0 - 0.5 * h * c - 0.5 * h * h * w * w,
                             part = std::sqrt(half * half - (1.0 - h * c));
  const double after = start * (1.0 - 0.5 * h * h * w * w);  // half a kick, then a step
  const std::complex<double> one = half + part, other = half - part,
                             of_one = (after - other * start) / (one - other);
  return (of_one * std::pow(one, steps) + (start - of_one) * std::pow(other, steps)).real();
}

// A bar of one element, and a cube, which swells as a whole.
struct Swelling {
  json scene;
  double w, c;  // per unit of b1
};
std::vector<Swelling> swelling_bodies() {
  const double young = 9.0, poisson = 0.25, density = 4.0, length = 0.5;
  const double speed = std::sqrt(young / density);
  json of_bar = scene_of_bars({bar("b", 0, length, 1, young, density)}, {});
  of_bar["initial"] = {{{"gradient", {{1e-3}}}}};
  json of_cube = scene_of_blocks(
      {block("b", {0, 0, 0}, {length, length, length}, {1, 1, 1}, elastic(young, poisson, density))}, "[]");
  of_cube["initial"] = {{{"gradient", {{1e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e-3}}}}};
  const double lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
               shear = 0.5 * young / (1.0 + poisson), bulk = lame + 2.0 / 3.0 * shear;
  return {{of_bar, 2.0 * speed / length, 4.0 * speed / length},
          {of_cube, std::sqrt(12.0 * bulk / density) / length,
           12.0 * std::sqrt((lame + 2.0 * shear) / density) / length}};
}

TEST(BulkViscosity, DampsASwellingElement) {
  for (const auto& [swelling, w, c] : swelling_bodies())
    for (const double linear : {0.06, 0.2})
      for (const double cfl : {0.9, 0.41, 0.07}) {
        GIVEN(w, linear, cfl);
        json source = until_at_cfl(20.0, cfl, swelling);
        source["loads"] = {{{"type", "bulk_viscosity"}, {"linear", linear}, {"quadratic", 0}}};
        auto [scene, integrator] = run_to_end(source);
        const Dofs& u = integrator.displacement();
        const double stretch = (u[u.size() - 1] - u[0]) / 0.5;
        EXPECT_NEAR(stretch, damped_vibration(1e-3, w, linear * c, scene.dt, scene.steps), 1e-13);
        EXPECT_LT(integrator.energy().balance_error, 1e-13);
        EXPECT_LT(integrator.energy().damping_work, 0.0);
      }
}

// As a stretched element comes back it is compressed, and the second step feels the rate of the first.
TEST(BulkViscosity, ResistsCompressionQuadratically) {
  for (const double start : {0.1, -0.1}) {
    json source = until_at_cfl(1.0, 0.5, swelling_bodies()[0].scene);
    source["initial"][0]["gradient"][0][0] = start;
    source["loads"] = {{{"type", "bulk_viscosity"}}};
    auto [scene, integrator] = simulation_of(source);
    const double h = scene.dt, length = 0.5, speed = 1.5, k = std::pow(2.0 * speed / length, 2);
    integrator.step();
    const double rate = -0.5 * h * k * start, stretch = start + h * rate;
    const double viscosity = 0.06 * speed * length + std::pow(1.2 * length, 2) * std::max(-rate, 0.0);
    const double expected = rate - h * k * stretch - h * viscosity * 4.0 / (length * length) * rate;
    EXPECT_NEAR((integrator.velocity()[1] - integrator.velocity()[0]) / length, expected, 1e-14);
  }
}

TEST(BulkViscosity, ReducesTheCriticalStep) {
  const double critical = 0.5 / 1.5, viscous = critical * (std::sqrt(1.0 + 0.06 * 0.06) - 0.06);
  json source = until_at_cfl(1.0, 1.0, swelling_bodies()[0].scene);
  source["loads"] = {{{"type", "bulk_viscosity"}}};
  EXPECT_NEAR(scene_of(source).dt, viscous, 1e-15);
  source["time"] = {{"dt", 1.001 * viscous}, {"end", 1}};
  EXPECT_THAT(refusal_of(source), HasSubstr("the model's critical step"));
  source["time"]["dt"] = 0.99 * viscous;
  source["initial"][0]["gradient"][0][0] = 0.3;  // comes back at a rate that takes more of the step
  EXPECT_THAT(run_to_end(source).integrator.warnings(),
              Contains(HasSubstr("where bulk viscosity is stable up to")));
}

// A body that has turned, and turns, keeps its volume.
TEST(BulkViscosity, LetsABodyTurn) {
  json source = until_at_cfl(
      1.0, 0.5,
      scene_of_blocks({block("b", {0, 0, 0}, {1, 1, 1}, {2, 1, 1},
                             {{"type", "neo_hookean"}, {"young", 1}, {"poisson", 0.3}, {"density", 1}})},
                      "[]"));
  source["loads"] = {{{"type", "bulk_viscosity"}}};
  const Scene scene = scene_of(source);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Vector3d spin(0.3, -2, 0.7);
  const Dofs& x = scene.model->position();
  Dofs u(x.size()), v(x.size()), impulse = Dofs::Zero(x.size());
  for (Eigen::Index k = 0; k < x.size(); k += 3) {
    u.segment<3>(k) = turn * x.segment<3>(k) - x.segment<3>(k);
    v.segment<3>(k) = spin.cross(turn * x.segment<3>(k));
  }
  Dofs after = v;
  scene.loads[0]->correct({0.0, 1.0}, {u, v}, after, impulse);
  EXPECT_LT(impulse.cwiseAbs().maxCoeff(), 1e-14);
}

// The audit evaluates the viscosity at the velocity before the start that the run reports.
TEST(BulkViscosity, ReadsTheMotionFromTheStart) {
  json source = shipped("stopper");
  source["model"]["meshes"][0]["file"] = (fs::path(ILAW_SOURCE) / "host_mock/scenes/stopper.vtu").string();
  source["loads"][0]["path"]["rows"][0][0] = 0.0;
  source["time"]["end"] = 1e-4;
  EXPECT_LT(ran(source).energy("balance_error"), 1e-13);
}

TEST(BulkViscosity, ClosesTheBalanceOfImpacts) {
  for (const char* name : {"bar_on_wall", "block_impact"}) {
    json source = shipped(name);
    source["time"]["cfl"] = 0.5;
    source["loads"].push_back({{"type", "bulk_viscosity"}});
    const Ran run = ran(source);
    EXPECT_LT(run.energy("balance_error"), 1e-13) << name;
    EXPECT_LT(run.energy("damping_work"), 0.0) << name;
    EXPECT_EQ(run.summary["warnings"], json::array()) << name;
  }
}

}  // namespace
}  // namespace ilaw::host::testing::damping
