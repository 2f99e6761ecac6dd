// SPDX-License-Identifier: BSD-3-Clause
#include "plot.hpp"

#include "run.hpp"

#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

extern char** environ;

namespace ilaw::host {
namespace {

// A panel of the picture: curves over time that share an axis.
struct Panel {
  std::string label;
  std::vector<std::size_t> columns;  // of history.csv, from 1 as gnuplot counts
};

std::vector<std::string> read_header(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  std::vector<std::string> names;
  std::istringstream cells(line);
  for (std::string name; std::getline(cells, name, ',');) names.push_back(name);
  return names;
}

// n0.gap -> gap, n0.u1 -> u, n0.floor.adhesion -> adhesion.
std::string quantity_of(const std::string& column) {
  std::string name = column.substr(column.rfind('.') + 1);
  if (name.size() == 2 && std::string("uvr").find(name[0]) != std::string::npos) name.resize(1);
  return name;
}

std::vector<Panel> panels_of(const std::vector<std::string>& header) {
  const std::map<std::string, std::string> labels = {
      {"u", "displacement"}, {"v", "velocity"}, {"r", "impulse"}};
  std::vector<Panel> panels;
  for (std::size_t i = 1; i < header.size(); ++i) {
    const std::string quantity = quantity_of(header[i]);
    const std::string label = labels.count(quantity) ? labels.at(quantity) : quantity;
    auto panel = panels.begin();
    while (panel != panels.end() && panel->label != label) ++panel;
    if (panel == panels.end()) panel = panels.insert(panels.end(), {label, {}});
    panel->columns.push_back(i + 1);
  }
  return panels;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string title_of(const std::filesystem::path& folder) {
  std::ifstream stream(folder / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(stream, nullptr, false);
  if (summary.is_discarded()) return folder.filename().string();
  return summary.at("scene").at("title").get<std::string>();
}

// Colours that colour-blind readers tell apart (Okabe and Ito 2008).
constexpr const char* palette[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                   "#E69F00", "#56B4E9", "#000000"};

void draw_panel(std::ostream& script, const Panel& panel, const std::vector<std::string>& header, bool last) {
  const bool is_status = panel.label == "status";
  script << "set ylabel " << quoted(panel.label) << "\n";
  script << (last ? "set xlabel \"time\"\nset format x\n" : "unset xlabel\nset format x \"\"\n");
  if (is_status)
    script << "set yrange [-0.5:6.5]\nset ytics (\"free\" 0, \"closed\" 1, \"stick\" 2, \"slip\" 3, "
              "\"bonded\" 4, "
              "\"broken\" 5, \"healed\" 6)\n";
  else
    script << "set yrange [*:*]\nset ytics autofreq\nset format y \"%.4g\"\n";
  script << "plot";
  for (std::size_t k = 0; k < panel.columns.size(); ++k) {
    const std::size_t column = panel.columns[k];
    script << (k ? ", " : " ") << "history using 1:" << column << " with "
           << (is_status || panel.label == "velocity" ? "steps"
               : panel.label == "impulse"             ? "steps"
                                                      : "lines")
           << " linewidth 1.4 linecolor rgb " << quoted(palette[k % std::size(palette)]) << " title "
           << quoted(header[column - 1]);
  }
  script << "\n";
}

void draw(std::ostream& script, const std::filesystem::path& folder, const char* kind,
          const std::vector<std::string>& header, const std::vector<Panel>& panels) {
  const std::size_t height = 100 + 170 * panels.size();
  script << "set terminal " << (std::string(kind) == "png" ? "pngcairo" : "svg") << " size 1000," << height
         << " font \"sans,11\" enhanced\n"
         << "set output " << quoted((folder / ("history." + std::string(kind))).string()) << "\n"
         << "set multiplot layout " << panels.size() << ",1 title " << quoted(title_of(folder))
         << " font \",14\" noenhanced margins 0.11,0.80," << 60.0 / static_cast<double>(height) << ","
         << 1.0 - 40.0 / static_cast<double>(height) << " spacing 0," << 16.0 / static_cast<double>(height)
         << "\n"
         << "set key outside right top noenhanced\nset grid linecolor rgb \"#dddddd\"\nset border 3\nset "
            "tics nomirror\n";
  for (std::size_t i = 0; i < panels.size(); ++i)
    draw_panel(script, panels[i], header, i + 1 == panels.size());
  script << "unset multiplot\nunset output\n";
}

// Runs gnuplot on a script file, without a shell and without its warnings (an axis of a constant, say).
// Returns its exit status, -1 when it cannot be started.
int run_gnuplot(const std::string& script) {
  std::string program = "gnuplot", file = script;
  char* arguments[] = {program.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int started = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (started != 0 || waitpid(child, &status, 0) != child) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

int plot(const std::filesystem::path& folder) {
  const std::filesystem::path history = folder / "history.csv";
  const std::vector<std::string> header = read_header(history);
  if (header.size() < 2) {
    std::fprintf(stderr,
                 "ilaw: %s: found no column besides time, expected the history of a run with watched nodes\n",
                 history.c_str());
    return exit_bad_input;
  }
  const std::filesystem::path script = folder / "history.gnuplot";
  {
    std::ofstream stream(script);
    stream << "set datafile separator comma\nhistory = " << quoted(history.string()) << "\n";
    const std::vector<Panel> panels = panels_of(header);
    for (const char* kind : {"png", "svg"}) draw(stream, folder, kind, header, panels);
  }
  const int status = run_gnuplot(script.string());
  if (status == 0) {
    std::printf("%s\n%s\n", (folder / "history.png").c_str(), (folder / "history.svg").c_str());
    return exit_done;
  }
  if (status < 0 || status == 127)
    std::fprintf(stderr, "ilaw: gnuplot cannot be started; it is in the package gnuplot-nox\n");
  else
    std::fprintf(stderr, "ilaw: gnuplot failed; run it on %s to see why\n", script.c_str());
  return exit_failed;
}

}  // namespace ilaw::host
