// hold - how far a held body slips out of its grip: by a law, or by MuJoCo's own contacts.
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <ilaw_mujoco.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>

namespace {

struct arguments {
  std::string file, law, body = "held", holder;
  double step = 0.0, seconds = 60.0, settle = 1.0, impratio = 0.0, swing = 0.0, every = 0.0, lost = 0.05;
  bool is_pyramidal = false;
  int noslip = 0;
  ilaw::mujoco::options law_options{.has_model_friction = true};
};

using model_owner = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using data_owner = std::unique_ptr<mjData, decltype(&mj_deleteData)>;

model_owner load(const arguments& given) {
  char message[1000] = "";
  model_owner model(mj_loadXML(given.file.c_str(), nullptr, message, sizeof message), mj_deleteModel);
  if (!model) throw std::runtime_error(message);
  if (given.step > 0.0) model->opt.timestep = given.step;
  if (given.impratio > 0.0) model->opt.impratio = given.impratio;
  if (given.is_pyramidal) model->opt.cone = mjCONE_PYRAMIDAL;
  model->opt.noslip_iterations = given.noslip;
  return model;
}

int body_named(const mjModel* model, const std::string& name) {
  const int body = mj_name2id(model, mjOBJ_BODY, name.c_str());
  if (body < 0) throw std::runtime_error("the model has no body '" + name + "'");
  return body;
}

// Place of the held body in the axes of the holder.
struct grip {
  const mjModel* model;
  int body, holder;
  void place(const mjData* data, double out[3]) const {
    double between[3];
    mju_sub3(between, data->xpos + 3 * body, data->xpos + 3 * holder);
    mju_rotVecMatT(out, between, data->xmat + 9 * holder);
  }
};

struct outcome {
  double slip = 0.0, time = 0.0;  // distance in the grip, and the time since `settle`
  double microseconds = 0.0;      // of processor time, a step
};

// Runs until the end, or until the body is lost.
outcome run(const arguments& given, const mjModel* model, mjData* data, const std::function<void()>& step) {
  const grip held{model, body_named(model, given.body), body_named(model, given.holder)};
  const double first_control = model->nu > 0 ? data->ctrl[0] : 0.0, h = model->opt.timestep;
  const auto steps = std::lround(given.seconds / h), settled = std::lround(given.settle / h);
  const auto interval = given.every > 0.0 ? std::max(1L, std::lround(given.every / h)) : steps;
  double start[3] = {}, now[3];
  outcome found;
  std::clock_t began = 0;
  for (long n = 0; n < steps && found.slip < given.lost; ++n) {
    if (given.swing != 0.0)
      data->ctrl[0] = first_control + given.swing * std::sin(2 * std::numbers::pi * data->time);
    if (n == settled) {
      mj_kinematics(model, data);
      held.place(data, start);
      began = std::clock();
    }
    step();
    if (n < settled) continue;
    held.place(data, now);  // before the step
    mju_subFrom3(now, start);
    found.slip = mju_norm3(now);
    found.time = data->time - h * static_cast<double>(settled + 1);
    if (given.every > 0.0 && n % interval == 0) std::printf("%.6g %.6g\n", found.time, found.slip);
  }
  found.microseconds =
      1e6 * static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC / (found.time / h + 1);
  return found;
}

void report(const arguments& given) {
  const model_owner model = load(given);
  const data_owner data(mj_makeData(model.get()), mj_deleteData);
  if (model->nkey > 0) mj_resetDataKeyframe(model.get(), data.get(), 0);
  outcome found;
  if (given.law.empty()) {
    found = run(given, model.get(), data.get(), [&] { mj_step(model.get(), data.get()); });
  } else {
    ilaw::mujoco::stepper stepper(model.get(), given.law, {}, given.law_options);
    found = run(given, model.get(), data.get(), [&] { stepper.step(data.get()); });
  }
  std::printf("slip %.6g m in %.6g s, %.4g us a step\n", found.slip, found.time, found.microseconds);
}

}  // namespace

int main(int count, char** words) {
  arguments given;
  CLI::App app{"How far a held body slips out of its grip: by a law, or by MuJoCo's own contacts."};
  app.add_option("model", given.file, "model, its first keyframe is the start")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("holder", given.holder, "body in whose axes the slip is measured")->required();
  app.add_option("--body", given.body, "held body")->capture_default_str();
  app.add_option("--law", given.law, "law that has a parameter `friction`; without: MuJoCo's own contacts");
  app.add_option("--step", given.step, "time step [s]; default: that of the model");
  app.add_option("--seconds", given.seconds, "end of the run")->capture_default_str();
  app.add_option("--settle", given.settle, "time from which slip and cost count")->capture_default_str();
  app.add_option("--swing", given.swing, "amplitude of the first control, at 1 Hz");
  app.add_option("--lost", given.lost, "slip at which the run ends [m]")->capture_default_str();
  app.add_option("--every", given.every, "print time and slip at this interval");
  app.add_option("--iterations", given.law_options.most_iterations, "largest number of iterations of the law")
      ->capture_default_str();
  app.add_option("--tolerance", given.law_options.tolerance, "of the residual, at which they end")
      ->capture_default_str();
  app.add_flag("--pyramidal", given.is_pyramidal, "pyramidal friction cones of MuJoCo");
  app.add_option("--impratio", given.impratio, "option impratio of MuJoCo; default: that of the model");
  app.add_option("--noslip", given.noslip, "noslip iterations of MuJoCo");
  CLI11_PARSE(app, count, words);
  try {
    report(given);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "hold: %s\n", failure.what());
    return 1;
  }
}
