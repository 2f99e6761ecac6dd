// The host of api/mujoco in the MuJoCo that is installed: closed forms, runs that go on, the example. One
// body without spins: tests/hosts/protocols.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <ilaw_mujoco.hpp>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace ilaw::mujoco {
namespace {

constexpr double g = 10.0;
constexpr double steps[] = {2e-3, 1.3e-3, 0.7e-3};
const std::string examples = ILAW_SOURCE "/api/mujoco/examples/";

struct Scene {
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model{nullptr, mj_deleteModel};
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data{nullptr, mj_deleteData};
  explicit Scene(const std::string& file) {
    char message[1000] = "";
    model.reset(mj_loadXML(file.c_str(), nullptr, message, sizeof message));
    if (!model) throw std::runtime_error(message);
    data.reset(mj_makeData(model.get()));
    if (model->nkey > 0) mj_resetDataKeyframe(model.get(), data.get(), 0);
  }
};

// A model with gravity 10, and a margin in which contacts are seen before they close.
Scene scene(const std::string& bodies, double step) {
  const std::string file = ::testing::TempDir() + "ilaw_mujoco_test.xml";
  std::ofstream(file) << "<mujoco><option gravity='0 0 -10' timestep='" << step
                      << "'/><default><geom margin='0.05' gap='0.05'/></default><worldbody>" << bodies
                      << "</worldbody></mujoco>";
  return Scene(file);
}

const std::string plane = "<geom type='plane' size='9 9 1'/>";
std::string ball(double height, const std::string& radius = "0.1") {
  return plane + "<body pos='0 0 " + std::to_string(height) +
         "'><freejoint/><geom type='sphere' mass='2' size='" + radius + "'/></body>";
}

stepper with(const Scene& at, const std::string& law,
             const std::vector<std::pair<std::string, double>>& numbers, const options& given = {}) {
  parameters law_parameters;
  for (const auto& [name, value] : numbers) law_parameters.number(name, value);
  return {at.model.get(), ILAW_PLUGIN_FOLDER "/" + law + ".so", law_parameters, given};
}

TEST(Mujoco, MovesAsMjStepWithoutContact) {
  // A chain with motors, damping and a joint limit that is reached.
  const std::string chain =
      "<body pos='0 0 2'><joint axis='0 1 0' damping='0.3' range='-60 60' limited='true'/>"
      "<geom type='capsule' size='0.05' fromto='0 0 0 0.4 0 0'/><body pos='0.5 0 0'>"
      "<joint type='ball' damping='0.1'/><geom type='capsule' size='0.05' fromto='0 0 0 0.4 0 0.2'/></body></body>";
  const Scene ours = scene(chain, 2e-3), theirs = scene(chain, 2e-3);
  stepper host = with(ours, "contact", {});
  for (int n = 0; n < 500; ++n) {
    host.step(ours.data.get());
    mj_step(theirs.model.get(), theirs.data.get());
    for (int i = 0; i < ours.model->nq; ++i)
      ASSERT_NEAR(ours.data->qpos[i], theirs.data->qpos[i], 1e-12) << "step " << n << ", coordinate " << i;
  }
  EXPECT_EQ(ours.data->time, theirs.data->time);
  EXPECT_LT(std::abs(ours.data->qpos[0]), 1.2) << "the limit is not reached";
}

// A fall is a parabola at any step, and a ball at rest is carried for half a step in the starting half kick.
TEST(Mujoco, StartsWithHalfKick) {
  for (const double h : steps) {
    const Scene at = scene(ball(2.0), h), held = scene(ball(0.1), h);
    stepper falls = with(at, "contact", {}), lies = with(held, "contact", {});
    falls.start(at.data.get());
    lies.start(held.data.get());
    EXPECT_NEAR(lies.memory().at(0).impulse[2], 2 * g * h / 2, 1e-12);
    for (int n = 1; n < 100; ++n) falls.step(at.data.get());
    EXPECT_NEAR(at.data->qpos[2], 2.0 - g / 2 * std::pow(at.data->time, 2), 1e-12);
  }
}

// A block, on four points of contact, stops after v^2/(2 mu g).
TEST(Mujoco, BlockStopsAndStays) {
  const std::string block =
      plane + "<body pos='0 0 0.05'><freejoint/><geom type='box' mass='3' size='.2 .1 .05'/></body>";
  for (const double h : steps) {
    const Scene at = scene(block, h);
    stepper host = with(at, "coulomb", {{"friction", 0.3}});
    at.data->qvel[0] = 2.0;
    while (at.data->time < 0.7) host.step(at.data.get());
    const double stopped = at.data->qpos[0];
    EXPECT_NEAR(stopped, 2.0 / (0.3 * g), 2.5 * h);
    while (at.data->time < 1.5) host.step(at.data.get());
    EXPECT_NEAR(at.data->qpos[0], stopped, 1e-12);
  }
}

// A solid ball that slides with u rolls with 5 u/7 in the end.
TEST(Mujoco, SlidingBecomesRolling) {
  for (const double h : steps) {
    const Scene at = scene(ball(0.1), h);
    stepper host = with(at, "coulomb", {{"friction", 0.2}});
    at.data->qvel[0] = 3.0;
    const double rolls = 2 * 3.0 / (7 * 0.2 * g);
    while (at.data->time < rolls - 2 * h) host.step(at.data.get());
    EXPECT_GT(at.data->qvel[0], 3.0 * 5 / 7 + 0.2 * g * h * 0.5);
    while (at.data->time < rolls + 2 * h) host.step(at.data.get());
    EXPECT_NEAR(at.data->qvel[0], 3.0 * 5 / 7, 1e-12);
  }
}

// The friction of the model is that of the law where the options say so.
TEST(Mujoco, TakesFrictionOfModel) {
  const std::string block =
      "<geom type='plane' size='9 9 1' friction='0.25'/>"
      "<body pos='0 0 0.05'><freejoint/><geom type='box' mass='3' size='.2 .1 .05' friction='0.25'/></body>";
  const Scene at = scene(block, 1e-3);
  options given;
  given.has_model_friction = true;
  stepper host = with(at, "coulomb", {}, given);
  at.data->qvel[0] = 2.0;
  for (int n = 0; n < 400; ++n) host.step(at.data.get());
  EXPECT_NEAR(at.data->qvel[0], 2.0 - 0.25 * g * 0.4, 1e-10);
}

// Two rods with hinges, the point at their end meets a wall: r = -(1 + e) v_N/(J M^-1 J^T), with the mass
// matrix of a double pendulum.
TEST(Mujoco, ImpactOfChainHasMassOfChain) {
  const double l = 0.5, m1 = 2.0, m2 = 1.0, i1 = 0.03, i2 = 0.02, q2 = 0.7, e = 0.6;
  std::ostringstream rods;
  rods.precision(17);
  rods << "<body><joint axis='0 0 1'/><inertial pos='" << l << " 0 0' mass='" << m1 << "' diaginertia='" << i1
       << ' ' << i1 << ' ' << i1 << "'/><body pos='" << l << " 0 0'><joint axis='0 0 1'/><inertial pos='" << l
       << " 0 0' mass='" << m2 << "' diaginertia='" << i2 << ' ' << i2 << ' ' << i2
       << "'/><geom type='sphere' size='0.01' pos='" << l
       << " 0 0'/></body></body><geom type='plane' size='9 9 1' pos='" << l + l * std::cos(q2) + 0.01
       << " 0 0' zaxis='-1 0 0'/>";
  const Scene at = scene(rods.str(), 1e-4);
  at.model->opt.gravity[2] = 0.0;
  at.data->qpos[1] = q2;
  at.data->qvel[0] = -0.8;
  at.data->qvel[1] = -1.1;
  const double c = std::cos(q2), before[2] = {at.data->qvel[0], at.data->qvel[1]};
  const double M22 = i2 + m2 * l * l, M12 = M22 + m2 * l * l * c;
  const double M11 = i1 + m1 * l * l + M12 + m2 * l * l * (1 + c);
  const double J[2] = {l * std::sin(q2), l * std::sin(q2)};  // of the distance to the wall
  const double determinant = M11 * M22 - M12 * M12;
  const double W[2] = {(M22 * J[0] - M12 * J[1]) / determinant, (M11 * J[1] - M12 * J[0]) / determinant};
  // Without contact, as MuJoCo has it: centrifugal forces change the velocity within the step.
  const Scene alone = scene(rods.str(), 1e-4);
  alone.model->opt.gravity[2] = 0.0;
  alone.model->opt.disableflags |= mjDSBL_CONTACT;
  alone.data->qpos[1] = q2;
  std::copy_n(before, 2, alone.data->qvel);
  mj_step(alone.model.get(), alone.data.get());
  const double* v_free = alone.data->qvel;

  stepper host = with(at, "contact",
                      {
                          {"restitution", e},
                      });
  const ilaw_coupled_report report = host.step(at.data.get());
  const double v_N = J[0] * v_free[0] + J[1] * v_free[1], v_N_before = J[0] * before[0] + J[1] * before[1];
  ASSERT_LT(v_N_before, 0.0);
  const double r = -(v_N + e * v_N_before) / (J[0] * W[0] + J[1] * W[1]);
  ASSERT_EQ(host.memory().size(), 1U);
  EXPECT_NEAR(-host.memory()[0].impulse[0], r, 1e-9 * r);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(at.data->qvel[i], v_free[i] + W[i] * r, 1e-9);
  const double v_N_after = J[0] * at.data->qvel[0] + J[1] * at.data->qvel[1];
  EXPECT_NEAR(report.work, r * (v_N_before + v_N_after) / 2, 1e-9 * r);
}

// A rod with one hinge meets a wall aslant: its end has one direction to move in, so H has rank 1.
TEST(Mujoco, ServesContactOfRankOne) {
  const std::string rod =
      "<body euler='0 0 30'><joint axis='0 0 1'/><geom type='capsule' size='0.02' fromto='0 0 0 0.5 0 0' contype='0'"
      " conaffinity='0'/><geom type='sphere' size='0.02' pos='0.5 0 0'/></body>"
      "<geom type='plane' size='9 9 1' pos='0.45301270189221935 0 0' zaxis='-1 0 0'/>";
  const Scene at = scene(rod, 1e-4);
  at.model->opt.gravity[2] = 0.0;
  stepper host = with(at, "coulomb", {{"restitution", 0.5}, {"friction", 0.0}});
  at.data->qvel[0] = -2.0;
  host.step(at.data.get());
  EXPECT_NEAR(at.data->qvel[0], 1.0, 1e-9);
}

// A ball hangs from the ceiling until its bond breaks under a pull of 10 t: at R/(10 w) + w/2
// (docs/schemes.md). Half of the way another stepper goes on from what was stored, to the same bits.
TEST(Mujoco, BondKeepsItsStateOverRestart) {
  const std::string hanging =
      "<geom type='plane' size='9 9 1' zaxis='0 0 -1'/>"
      "<body pos='0 0 -0.1'><freejoint/><geom type='sphere' size='0.1' mass='2'/></body>";
  const double h = 1e-3;
  const Scene at = scene(hanging, h);
  at.model->opt.gravity[2] = 0.0;
  const std::vector<std::pair<std::string, double>> bond = {{"strength", 1.0}, {"memory", 0.1}};
  const auto pull = [](const Scene& on) { on.data->xfrc_applied[6 + 2] = -10 * on.data->time; };
  stepper host = with(at, "tie", bond);
  while (at.data->time < 0.5) pull(at), host.step(at.data.get());
  EXPECT_NEAR(at.data->qpos[2], -0.1, 1e-14);

  const Scene other = scene(hanging, h);
  other.model->opt.gravity[2] = 0.0;
  mj_copyData(other.data.get(), other.model.get(), at.data.get());
  stepper goes_on = with(other, "tie", bond);
  goes_on.recall(host.memory());
  double broken = 0.0;
  for (int n = 0; n < 700; ++n) {
    pull(at), host.step(at.data.get());
    pull(other), goes_on.step(other.data.get());
    ASSERT_EQ(at.data->qpos[2], other.data->qpos[2]);
    if (broken == 0.0 && at.data->qvel[2] < -1e-9) broken = at.data->time;
  }
  EXPECT_NEAR(broken, 1.05, 2 * h);
}

TEST(Mujoco, RefusesOtherIntegrator) {
  const Scene at = scene(ball(1.0), 1e-3);
  at.model->opt.integrator = mjINT_RK4;
  EXPECT_THROW(with(at, "contact", {}), error);
}

// The slip that the example prints.
double slip(const std::string& arguments) {
  const std::string command =
      "cd '" + examples + "' && ILAW_PATH='" ILAW_PLUGIN_FOLDER "' '" ILAW_HOLD "' " + arguments;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  double found = -1.0;
  if (!pipe || std::fscanf(pipe.get(), "slip %lf m", &found) != 1) throw std::runtime_error(command);
  return found;
}

TEST(Mujoco, PinchedCapsuleStays) {
  const std::string pinch = "pinch.xml left --seconds 3 ";
  EXPECT_LT(slip(pinch + "--law coulomb"), 1e-13);
  EXPECT_GT(slip(pinch), 1e-4) << "MuJoCo's own contacts hold it, so the case shows nothing";
}

TEST(Mujoco, GripperHoldsItsBox) {
  const std::string gripper = "gripper.xml palm --seconds 3 ";
  EXPECT_LT(slip(gripper + "--law coulomb"), 1e-11);
  EXPECT_GT(slip(gripper), 1e-4);
}

TEST(Mujoco, SwungBoxSlipsByErrorOfStep) {
  const std::string swung = "gripper.xml palm --seconds 2 --swing 0.05 --law coulomb --step ";
  const double coarse = slip(swung + "0.002"), fine = slip(swung + "0.001");
  EXPECT_LT(coarse, 1e-4);
  EXPECT_NEAR(coarse / fine, 2.0, 0.2);
}

}  // namespace
}  // namespace ilaw::mujoco
