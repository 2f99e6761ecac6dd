// `ilaw view`: a run as one HTML file in which it moves, written by the Python module ilaw.view.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "cli/python.hpp"

#include <string>

namespace ilaw::host {
namespace {

struct ViewOptions {
  std::string folder, out;
  double megabytes = 50.0;
};

}  // namespace

void add_view(CLI::App& app, int& /*code*/) {
  const auto options = std::make_shared<ViewOptions>();
  CLI::App* command = app.add_subcommand(
      "view", "Write a run as one HTML file: bodies in motion, fields, forces, curves, events");
  command->add_option("folder", options->folder, "Folder that `ilaw run` wrote")->required();
  command->add_option("-o,--out", options->out, "File to write (default: view.html in the folder)");
  command
      ->add_option("--megabytes", options->megabytes,
                   "About the most that the data take: first frames are left out, then nodes")
      ->check(number_from(0.01, 2000.0))
      ->capture_default_str();
  command->footer(
      "The file opens in any browser and needs no network.\n"
      "Example: ilaw view results -o run.html");
  run_in_python(*command, {"ilaw.view", "numpy, vtkmodules.vtkIOXML", "python3-numpy python3-vtk9"}, options);
}

}  // namespace ilaw::host
