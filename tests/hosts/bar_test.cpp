// The bar in Fortran whose penalty was replaced by three calls gives the figures of the host program to the
// bit, and what it is for: no penetration where the spring let the bar sink in.
// SPDX-License-Identifier: BSD-3-Clause
#include "host/host_runner.hpp"

namespace ilaw::host::testing {
namespace {

using Row = std::array<double, 3>;  // displacement, velocity, impulse

std::vector<Row> rows_of_fortran(double h, int count, const std::string& library) {
  const std::string command =
      std::string(ILAW_BAR) + " " + number(h) + " " + std::to_string(count) + " " + library;
  std::istringstream answer(run_command(command).output);
  std::vector<Row> rows;
  for (Row row; answer >> row[0] >> row[1] >> row[2];) rows.push_back(row);
  return rows;
}

TEST(BarInFortran, GivesTheBitsOfTheHostProgram) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  Scene scene = read_scene(scene_files::named("bar_on_wall.json"));
  Integrator integrator = integrator_of(scene);
  const std::vector<Row> found = rows_of_fortran(scene.dt, 500, ILAW_PLUGIN_FOLDER "/contact.so");
  ASSERT_EQ(found.size(), 500U);
  for (std::size_t n = 0; n < found.size(); ++n) {
    integrator.step();
    EXPECT_EQ(found[n], (Row{integrator.displacement()[0], integrator.velocity()[0],
                             integrator.interface_impulse()[0]}))
        << "step " << n;
    if (HasFailure()) break;
  }
}

TEST(BarInFortran, NeedsNoPenetrationToRebound) {
  const double h = 0.9 * 0.1 / 30.0;
  const auto lowest = [](const std::vector<Row>& rows) {
    double least = 0.0;
    for (const Row& row : rows) least = std::min(least, 5.0 + row[0]);
    return least;
  };
  // The impact lasts with the force rho c v S = 300, on a spring of two element stiffnesses, 18000: it sinks
  // in by their ratio, and by less than twice that where the load is sudden.
  const double sunk = lowest(rows_of_fortran(0.5 * h, 1000, ""));
  EXPECT_LE(sunk, -300.0 / 18000.0);
  EXPECT_GE(sunk, -2.0 * 300.0 / 18000.0);
  EXPECT_GE(lowest(rows_of_fortran(h, 500, ILAW_PLUGIN_FOLDER "/contact.so")), -1e-12);
}

}  // namespace
}  // namespace ilaw::host::testing
