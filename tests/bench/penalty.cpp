// Penalty beside contact in the same scenes: largest stable step, penetration, energy that the interface
// creates or takes, error against run time. docs/results tells the cases and what was measured.
// SPDX-License-Identifier: BSD-3-Clause
#include "base/csv.hpp"
#include "scene/scene.hpp"
#include "study/errors.hpp"

#include <CLI/CLI.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace ilaw::host;
using nlohmann::json;

struct Law {
  json law, parameters;
  double stiffness = NAN;  // of penalty, relative to the case's

  bool is_penalty() const { return law == "penalty"; }
  bool is_explicit() const { return is_penalty() && parameters["integration"] == "explicit"; }
  std::string name() const {
    if (!is_penalty()) return law.get<std::string>();
    std::ostringstream text;
    text << parameters["integration"].get<std::string>() << ' ' << stiffness;
    return text.str();
  }
};

struct Case {
  std::string name;
  std::filesystem::path file;
  json source;
  double stiffness;  // that of an element, or of the body's spring
  double largest_h;  // over the critical step, that a user would take for the accuracy of the body
  double length;     // of the body, to measure penetration by
  int levels;        // of the sweep for error against run time
  bool refines_mesh;
};

std::vector<Law> laws_of(const Case& one, const std::vector<double>& stiffnesses) {
  const json& own = one.source["interfaces"][0];
  std::vector<Law> laws{{own["law"], own["parameters"]}};
  for (const double k : stiffnesses)
    laws.push_back({"penalty", {{"stiffness", k * one.stiffness}, {"integration", "explicit"}}, k});
  // With the restitution of the case's own law; none is for a body that gives the rebound itself.
  const double restitution = own["parameters"].value("restitution", 0.0);
  for (const double k : stiffnesses)
    laws.push_back(
        {"penalty",
         {{"stiffness", k * one.stiffness}, {"integration", "implicit"}, {"restitution", restitution}},
         k});
  return laws;
}

// The case with another law, time step (over the critical one) and mesh.
Scene scene_with(const Case& one, const Law& law, double h, int mesh = 0) {
  json source = one.source;
  source["interfaces"][0]["law"] = law.law;
  source["interfaces"][0]["parameters"] = law.parameters;
  if (mesh > 0) {
    json& bar = source["model"]["bars"][0];
    // The stiffness of an element grows as the mesh is refined, and the penalty's with it.
    if (law.is_penalty()) {
      json& stiffness = source["interfaces"][0]["parameters"]["stiffness"];
      stiffness = stiffness.get<double>() * mesh / bar["elements"].get<int>();
    }
    bar["elements"] = mesh;
  }
  source["time"] = {{"cfl", h}, {"end", source["time"]["end"]}};
  return read_scene(source, one.file);
}

// What an interface did to the energy, relative to the energy at the start.
struct Run {
  double energy_max = 0.0, energy_end = 0.0, penetration = 0.0;
};

Run run(Scene scene, double stop_at = INFINITY) {
  Run result;
  Integrator integrator(*scene.model, scene.loads, scene.interfaces, scene.dt);
  const EnergyReport start = integrator.energy();
  const double initial = start.kinetic + start.potential;
  try {
    while (integrator.steps() < scene.steps && !(result.energy_max > stop_at)) {
      integrator.step();
      const EnergyReport now = integrator.energy();
      result.energy_end = (now.interface_work + now.by_law[ILAW_ENERGY_STORED]) / initial;
      result.energy_max = std::max(result.energy_max, result.energy_end);
    }
  } catch (const std::runtime_error&) {
    result.energy_max = INFINITY;  // diverged
  }
  result.penetration = integrator.tally().penetration_max;
  return result;
}

// Steps are called stable when the interface never adds more than this part of the initial energy.
constexpr double most_added = 0.1;

bool is_stable(const Case& one, const Law& law, double h) {
  return run(scene_with(one, law, h), most_added).energy_max <= most_added;
}

// Largest stable step over the critical one, by bisection of its logarithm.
double largest_stable_step(const Case& one, const Law& law) {
  double high = 1.0, low = 1e-4;
  if (is_stable(one, law, high)) return high;
  for (int k = 0; k < 14; ++k)
    (is_stable(one, law, std::sqrt(low * high)) ? low : high) = std::sqrt(low * high);
  return low;
}

// 2/omega_max of the body with a linear spring at the interface's node, along the first axis, over the
// critical step.
double linear_limit(const Case& one, const Law& law) {
  const Scene scene = scene_with(one, law, 1.0);
  const Model& model = *scene.model;
  const Eigen::Index n = model.mass().size();
  constexpr double nudge = 1e-6;
  Eigen::MatrixXd stiffness(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    Dofs forward = Dofs::Zero(n), back = Dofs::Zero(n);
    model.add_internal_forces(nudge * Dofs::Unit(n, k), forward);
    model.add_internal_forces(-nudge * Dofs::Unit(n, k), back);
    stiffness.col(k) = (back - forward) / (2.0 * nudge);
  }
  const int dof = scene.interfaces[0]->nodes()[0] * model.dimension();
  stiffness(dof, dof) += law.stiffness * one.stiffness;
  const Dofs scale = model.mass().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * stiffness * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(scaled, Eigen::EigenvaluesOnly);
  return 2.0 / std::sqrt(modes.eigenvalues().maxCoeff()) / scene.dt;
}

// Error of the watched node's positions, and the median of the run times.
struct Accuracy {
  double error, seconds;
};

Accuracy accuracy_of(const Case& one, const Law& law, double h, int mesh, const Trace* reference) {
  std::vector<double> seconds;
  double error = NAN;
  for (int repetition = 0; repetition < 5; ++repetition) {
    Scene scene = scene_with(one, law, h, mesh);
    const Trace trace = trace_of(scene);
    seconds.push_back(trace.seconds);
    error =
        (reference ? errors_against(*reference, trace) : errors_against(exact_solution(scene), trace)).u_L2;
  }
  std::nth_element(seconds.begin(), seconds.begin() + 2, seconds.end());
  return {error, seconds[2]};
}

// Without exact solution: contact with steps far below those compared.
Trace reference_of(const Case& one, const std::vector<Law>& laws) {
  Scene scene = scene_with(one, laws[0], one.largest_h / 1024.0);
  return trace_of(scene);
}

// Runs of a sweep: meshes at the same part of their critical steps, or steps that the law can take.
struct Level {
  double h;
  int mesh;
};

std::vector<Level> sweep_of(const Case& one, double h, double limit) {
  std::vector<Level> levels;
  for (int k = 0; k < one.levels; ++k) {
    const double halved = one.largest_h * std::pow(2.0, -k);
    if (one.refines_mesh)
      levels.push_back({h, 25 << k});
    else if (halved <= limit)
      levels.push_back({halved, 0});
  }
  return levels;
}

// What is measured of one law.
struct Row {
  Law law;
  double limit, linear = 1.0, h = 0.0;
  Run run{};
  Accuracy accuracy{};
  double contact_seconds = 0.0;  // measured beside it, as machines drift
  std::vector<Level> levels{};
  std::vector<Accuracy> sweep{};
};

Row measured(const Case& one, const Law& law, const Row* contact, const Trace* reference) {
  Row row{law, largest_stable_step(one, law)};
  row.linear = law.is_explicit() ? linear_limit(one, law) : 1.0;
  row.h = std::min(0.9 * row.limit, one.largest_h);
  row.run = run(scene_with(one, law, row.h));
  row.accuracy = accuracy_of(one, law, row.h, 0, reference);
  row.contact_seconds =
      contact ? accuracy_of(one, contact->law, contact->h, 0, reference).seconds : row.accuracy.seconds;
  row.levels = sweep_of(one, row.h, 0.9 * row.limit);
  for (const Level& level : row.levels)
    row.sweep.push_back(accuracy_of(one, law, level.h, level.mesh, reference));
  std::fprintf(stderr, "%s, %s\n", one.name.c_str(), law.name().c_str());
  return row;
}

// Run times are ratios to those of contact, which comes first.
void measure(const Case& one, const std::vector<double>& stiffnesses, CsvWriter& table, CsvWriter& sweep) {
  const std::vector<Law> laws = laws_of(one, stiffnesses);
  const bool exact = one.source.contains("exact");
  const Trace finest = exact ? Trace{} : reference_of(one, laws);
  std::vector<Row> rows;
  for (const Law& law : laws)
    rows.push_back(measured(one, law, rows.empty() ? nullptr : &rows.front(), exact ? nullptr : &finest));
  const double contact_finest = rows.front().sweep.back().seconds;
  for (const Row& row : rows) {
    table << one.name << row.law.name() << row.limit << row.linear << row.h
          << row.run.penetration / one.length << row.run.energy_max << row.run.energy_end
          << row.accuracy.error << row.accuracy.seconds / row.contact_seconds;
    table.end_row();
    for (std::size_t k = 0; k < row.levels.size(); ++k) {
      sweep << one.name << row.law.name() << row.levels[k].h << row.levels[k].mesh << row.sweep[k].error
            << row.sweep[k].seconds / contact_finest;
      sweep.end_row();
    }
  }
}

Case read_case(const std::string& name, const std::filesystem::path& file) {
  return {name, file, read_scene_source(file), 1.0, 0.9, 1.0, 0, false};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Penalty beside contact: writes penalty.csv and penalty_sweep.csv"};
  std::filesystem::path bar_file, spring_file, folder;
  app.add_option("--bar", bar_file, "Scene of a bar that flies against a wall")->required();
  app.add_option("--spring", spring_file, "Scene of a rotating spring that meets a stop")->required();
  app.add_option("--out", folder, "Folder for the tables")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    std::filesystem::create_directories(folder);
    std::ofstream table_file(folder / "penalty.csv"), sweep_file(folder / "penalty_sweep.csv");
    CsvWriter table(table_file, 6), sweep(sweep_file, 6);
    for (const char* column : {"body", "law (k / k_0)", "largest stable h / h_cd", "2/omega_max / h_cd",
                               "h used / h_cd", "penetration / L", "largest energy gain / E_0",
                               "energy from interface at end / E_0", "u_L2", "run time / contact's"})
      table << column;
    table.end_row();
    for (const char* column : {"body", "law", "h / h_cd", "elements", "u_L2", "run time / contact's finest"})
      sweep << column;
    sweep.end_row();
    Case bar = read_case("bar", bar_file);
    const json& body = bar.source["model"]["bars"][0];
    bar.stiffness = body["young"].get<double>() * body["elements"].get<int>() / body["length"].get<double>();
    bar.length = body["length"];
    bar.levels = 6;
    bar.refines_mesh = true;
    measure(bar, {1.0, 10.0, 100.0}, table, sweep);
    Case spring = read_case("spring", spring_file);
    spring.stiffness = spring.source["model"]["stiffness"];
    spring.source["time"]["end"] = 5.0;
    spring.length = spring.source["model"]["length"];
    spring.largest_h = 0.02;
    spring.levels = 8;
    measure(spring, {1e2, 1e4, 1e6}, table, sweep);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ilaw_bench_penalty: %s\n", error.what());
    return 1;
  }
}
