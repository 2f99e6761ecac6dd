// SPDX-License-Identifier: BSD-3-Clause
#include "study/converge.hpp"

#include "base/exit_code.hpp"
#include "base/files.hpp"
#include "base/scene_error.hpp"
#include "results/gnuplot.hpp"
#include "scene/scene.hpp"
#include "study/errors.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <tuple>

namespace ilaw::host {
namespace {

using nlohmann::json;

struct Sweep {
  int levels;
  double factor;
  double first;  // step (and element size) of level 0 over the scene's
  bool with_mesh;
};

Sweep sweep_of(const json& source, const ConvergeOptions& options) {
  const json given = source.value("converge", json::object());
  const std::string refine = options.refine.value_or(given.value("refine", "time"));
  return {options.levels.value_or(given.value("levels", 5)),
          options.factor.value_or(given.value("factor", 2.0)), given.value("first", 1.0), refine == "mesh"};
}

// Multiplies element counts; says whether the model had any.
bool refine_mesh(json& model, double by) {
  const auto scaled = [by](int count) { return static_cast<int>(std::lround(count * by)); };
  bool refined = false;
  for (const char* bodies : {"bars", "blocks"}) {
    if (!model.contains(bodies)) continue;
    for (json& body : model[bodies]) {
      json& elements = body["elements"];
      if (elements.is_number())
        elements = scaled(elements.get<int>());
      else
        for (json& along : elements) along = scaled(along.get<int>());
      refined = true;
    }
  }
  return refined;
}

// Nodes are numbered anew on every mesh, so that the same number is another point.
[[noreturn]] void refuse_number(const std::string& pointer, const json& found) {
  throw SceneError(pointer,
                   "found " + found.dump() +
                       ", expected a set, a box or near: on a refined mesh a number is another node");
}

void refuse_node_numbers(const json& part, const std::string& pointer) {
  if (!part.is_structured()) return;
  for (const auto& [key, value] : part.items()) {
    const std::string inner = pointer + "/" + key;
    if (key == "per_node") refuse_number(inner, value);
    if ((key == "nodes" || key == "watch") && value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i)
        if (value[i].is_number()) refuse_number(inner + "/" + std::to_string(i), value[i]);
    refuse_node_numbers(value, inner);
  }
}

// The scene of a level.
Scene scene_at(const json& source, const Sweep& sweep, int level, const std::filesystem::path& file) {
  json refined = source;
  const double by = std::pow(sweep.factor, level) / sweep.first;
  json& time = refined["time"];
  if (sweep.with_mesh && !refine_mesh(refined["model"], by))
    throw SceneError("/converge/refine", "found \"mesh\", expected \"time\": the model has no mesh");
  // With cfl the time step follows the mesh.
  const bool follows = sweep.with_mesh && time.contains("cfl");
  const char* key = time.contains("dt") ? "dt" : "cfl";
  if (!follows) time[key] = time[key].get<double>() / by;
  Scene scene = read_scene(refined, file);
  if (scene.output.watch.empty())
    throw SceneError("/output/watch", "found no node, expected those to compare");
  return scene;
}

constexpr std::array<const char*, 4> norms{"u_L2", "u_max", "v_L1", "instant"};
double norm_of(const Errors& errors, std::size_t which) {
  return std::array{errors.u_L2, errors.u_max, errors.v_L1, errors.instant}[which];
}

struct ErrorTable {
  std::vector<Trace> runs;
  std::vector<Errors> errors;  // one per run but, without exact solution, the finest
  bool exact = false;

  std::vector<double> steps() const {
    std::vector<double> h;
    for (std::size_t k = 0; k < errors.size(); ++k) h.push_back(runs[k].dt);
    return h;
  }
  double order(std::size_t which) const {
    std::vector<double> values;
    for (const Errors& one : errors) values.push_back(norm_of(one, which));
    // Errors are relative but those of instants.
    const bool is_instant = which + 1 == norms.size();
    return order_of(steps(), values, is_instant ? runs[0].dt * static_cast<double>(runs[0].steps) : 1.0);
  }
};

ErrorTable run_levels(const json& source, const Sweep& sweep, const std::filesystem::path& file) {
  ErrorTable table;
  for (int level = 0; level < sweep.levels; ++level) {
    Scene scene = scene_at(source, sweep, level, file);
    const std::vector<ExactNode> exact = exact_solution(scene);
    table.runs.push_back(trace_of(scene));
    table.exact = !exact.empty();
    if (table.exact) table.errors.push_back(errors_against(exact, table.runs.back()));
    std::fprintf(stderr, "level %d of %d: %lld steps of %g in %.2g s\n", level + 1, sweep.levels,
                 static_cast<long long>(scene.steps), scene.dt, table.runs.back().seconds);
  }
  for (std::size_t k = 0; !table.exact && k + 1 < table.runs.size(); ++k)
    table.errors.push_back(errors_against(table.runs.back(), table.runs[k]));
  return table;
}

void write_table(const ErrorTable& table, const std::filesystem::path& folder) {
  AtomicFile file(folder / "converge.csv");
  file.stream() << "dt,steps,seconds";
  for (const char* norm : norms) file.stream() << ',' << norm;
  file.stream() << '\n';
  file.stream().precision(10);
  for (std::size_t k = 0; k < table.errors.size(); ++k) {
    file.stream() << table.runs[k].dt << ',' << table.runs[k].steps << ',' << table.runs[k].seconds;
    for (std::size_t n = 0; n < norms.size(); ++n) {
      file.stream() << ',';
      if (const double error = norm_of(table.errors[k], n); std::isfinite(error)) file.stream() << error;
    }
    file.stream() << '\n';
  }
  file.commit();
}

void write_orders(const ErrorTable& table, const Sweep& sweep, const std::string& title,
                  const std::filesystem::path& folder) {
  json orders;
  for (std::size_t n = 0; n < norms.size(); ++n) orders[norms[n]] = table.order(n);  // NaN is written as null
  AtomicFile file(folder / "converge.json");
  file.stream() << json{{"title", title},
                        {"reference", table.exact ? "exact solution" : "finest run"},
                        {"refined", sweep.with_mesh ? "mesh and time step" : "time step"},
                        {"levels", sweep.levels},
                        {"orders", orders}}
                       .dump(2)
                << '\n';
  file.commit();
}

// Errors over the time step, and over the run time.
void write_picture(const ErrorTable& table, const std::string& title, const std::filesystem::path& folder,
                   std::ostream& script) {
  for (const auto& [terminal, kind] : {std::pair{"pngcairo", "png"}, std::pair{"svg", "svg"}}) {
    script << "reset\nset datafile separator comma\nset terminal " << terminal
           << " size 1000,460 font 'sans,11' background rgb 'white'\nset output "
           << in_quotes((folder / ("converge." + std::string(kind))).string())
           << "\nset logscale xy\nset format xy '10^{%T}'\nset grid\nset border 3\nset tics nomirror\nset "
              "ylabel 'relative error'\nset multiplot layout 1,2 title "
           << in_quotes(title) << " noenhanced\n";
    // Run times of machines differ: over that of the finest run that is compared.
    const double finest = table.runs[table.errors.size() - 1].seconds;
    for (const auto& [column, unit, label, corner] :
         {std::tuple{1, 1.0, "time step", "right"},
          std::tuple{3, finest, "run time / that of the finest run", "left"}}) {
      script << "set xlabel '" << label << "'\nset key bottom " << corner << " noenhanced\nplot ";
      for (std::size_t n = 0; n < 3; ++n)
        script << (n ? ", " : "") << in_quotes((folder / "converge.csv").string()) << " using ($" << column
               << '/' << unit << "):" << n + 4 << " with linespoints linewidth 1.5 pointtype " << n + 5
               << " title '" << norms[n] << "'";
      if (column == 1) {
        const double h = table.runs[0].dt, top = norm_of(table.errors[0], 0);
        script << ", " << top / h << "*x with lines dashtype 2 linecolor rgb '#808080' title 'order 1'";
      }
      script << "\n";
    }
    script << "unset multiplot\nunset output\n";
  }
}

// A number in ten columns, "-" where there is none.
void print(const char* format, double value) {
  char text[32] = "-";
  if (std::isfinite(value)) std::snprintf(text, sizeof text, format, value);
  std::printf(" %10s", std::string_view(text) == "-0.00" ? "0.00" : text);
}

void print_table(const ErrorTable& table) {
  std::printf("%12s %10s %10s %10s %10s %10s\n", "dt", "seconds", norms[0], norms[1], norms[2], norms[3]);
  for (std::size_t k = 0; k < table.errors.size(); ++k) {
    std::printf("%12.4g %10.2g", table.runs[k].dt, table.runs[k].seconds);
    for (std::size_t n = 0; n < norms.size(); ++n) print("%.2e", norm_of(table.errors[k], n));
    std::printf("\n");
  }
  std::printf("%23s", "order");
  for (std::size_t n = 0; n < norms.size(); ++n) print("%.2f", table.order(n));
  std::printf("\n");
}

}  // namespace

int converge(const ConvergeOptions& options) {
  ErrorTable table;
  std::string title;
  const std::filesystem::path folder = std::filesystem::absolute(options.folder).lexically_normal();
  try {
    const json source = read_scene_source(options.scene);
    const Sweep sweep = sweep_of(source, options);
    title = source.value("title", options.scene.stem().string());
    // Refused, if at all, before anything is written.
    exact_solution(scene_at(source, sweep, 0, options.scene));
    if (sweep.with_mesh) refuse_node_numbers(source, "");
    if (!make_folder(folder)) return exit_bad_input;
    table = run_levels(source, sweep, options.scene);
    write_table(table, folder);
    write_orders(table, sweep, title, folder);
  } catch (const SceneError& error) {
    std::fprintf(stderr, "ilaw: %s: %s\n", options.scene.c_str(), error.what());
    return exit_bad_input;
  }
  print_table(table);
  const std::filesystem::path script = folder / "converge.gnuplot";
  std::ofstream stream(script);
  write_picture(table, title, folder, stream);
  stream.close();
  return run_gnuplot(script) ? exit_done : exit_failed;
}

}  // namespace ilaw::host
