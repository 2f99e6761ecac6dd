// Fields are read back with VTK itself, and hold what the integrator holds.
#include "results/fields.hpp"

#include "field_file.hpp"
#include "host_runner.hpp"

#include <Eigen/Geometry>

#include <omp.h>

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

namespace ilaw::host::testing::fields {
namespace {

void expect_vectors(vtkUnstructuredGrid& grid, const char* name, const Dofs& wanted, int d) {
  const Field field(grid, name, 3);
  for (int i = 0; i < static_cast<int>(wanted.size()); ++i)
    ASSERT_EQ(field.at(i / d, i % d), wanted[i]) << name << " of node " << i / d;
  for (int c = d; c < 3; ++c) EXPECT_EQ(field.at(0, c), 0.0);
}

// Bonds form, hold and break in this scene; the upper nodes belong to no interface.
TEST(Fields, HoldWhatTheIntegratorHolds) {
  omp_set_num_threads(1);
  const auto folder = fresh_folder();
  json source = shipped("postit_3d");
  source["model"]["blocks"][0]["elements"] = {20, 2, 2};
  auto [scene, integrator] = simulation_of(source);
  Interface& interface = *scene.interfaces[0];
  Fields fields(scene, folder);
  int bonded = 0, broken = 0, number = 0;
  while (integrator.steps() < scene.steps) {
    integrator.step();
    if (integrator.steps() % 20 != 0) continue;
    fields.write(integrator);
    char name[32];
    std::snprintf(name, sizeof name, "fields_%06d.vtu", number++);
    const auto grid = grid_of(folder / name);
    ASSERT_EQ(grid->GetNumberOfPoints(), scene.model->node_count());
    ASSERT_EQ(grid->GetNumberOfCells(), 20 * 2 * 2);
    expect_vectors(*grid, "u", integrator.displacement(), 3);
    expect_vectors(*grid, "v", integrator.velocity(), 3);
    expect_vectors(*grid, "r", integrator.interface_impulse(), 3);
    const Field gap(*grid, "gap", 1), status(*grid, "status", 1), adhesion(*grid, "adhesion", 1),
        ruptures(*grid, "ruptures", 1), traction(*grid, "traction", 3);
    std::vector<bool> belongs(static_cast<std::size_t>(scene.model->node_count()));
    for (std::size_t k = 0; k < interface.nodes().size(); ++k) {
      const int node = interface.nodes()[k], node_index = static_cast<int>(k);
      const int contact_index = interface.contact_index_of(node_index, integrator.displacement());
      belongs[static_cast<std::size_t>(node)] = true;
      // The plane is z = 0.
      ASSERT_EQ(gap.at(node), scene.model->position()[3 * node + 2] + integrator.displacement()[3 * node + 2])
          << "k " << k;
      ASSERT_EQ(status.at(node),
                interface.is_active(contact_index) ? interface.status(contact_index) : int{ILAW_FREE})
          << "k " << k;
      ASSERT_EQ(adhesion.at(node), interface.state(contact_index, 0)) << "k " << k;
      ASSERT_EQ(ruptures.at(node), interface.state(contact_index, 1)) << "k " << k;
      for (int c = 0; c < 3; ++c)
        ASSERT_DOUBLE_EQ(traction.at(node, c) * interface.setup().areas[k] * scene.dt,
                         integrator.interface_impulse()[3 * node + c])
            << "k " << k << ", c " << c;
      bonded += status.at(node) == double{ILAW_BONDED};
      broken += ruptures.at(node) > 0.0;
    }
    for (int node = 0; node < scene.model->node_count(); ++node)
      if (!belongs[static_cast<std::size_t>(node)]) {
        ASSERT_TRUE(std::isnan(gap.at(node)));
        ASSERT_TRUE(std::isnan(adhesion.at(node)));
        ASSERT_TRUE(std::isnan(traction.at(node)));
        ASSERT_EQ(status.at(node), -1.0);
      }
  }
  EXPECT_GT(bonded, 100);
  EXPECT_GT(broken, 100);
}

// The first file of a scene.
auto first_grid(Scene& scene) {
  const auto folder = fresh_folder();
  Integrator integrator = integrator_of(scene);
  integrator.start();
  Fields(scene, folder).write(integrator);
  return grid_of(folder / "fields_000000.vtu");
}

// Cells are hexahedra of positive volume that fill the block; nodes stand where the model has them.
TEST(Fields, HaveTheMeshOfTheModel) {
  Scene scene = scene_of(shipped("block_impact").dump());
  const auto grid = first_grid(scene);
  for (int node = 0; node < scene.model->node_count(); ++node) {
    std::array<double, 3> x{};
    grid->GetPoint(node, x.data());
    for (int c = 0; c < 3; ++c)
      ASSERT_EQ(x[static_cast<std::size_t>(c)], scene.model->position()[3 * node + c])
          << "node " << node << ", c " << c;
  }
  double volume = 0.0;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
    ASSERT_EQ(grid->GetCellType(cell), VTK_HEXAHEDRON);
    vtkNew<vtkIdList> nodes;
    grid->GetCellPoints(cell, nodes);
    // VTK's order: 0 1 3 4 are a corner and its neighbours along the three axes.
    const auto corner = [&](int k) { return scene.model->position().segment<3>(3 * nodes->GetId(k)); };
    const Eigen::Vector3d x = corner(1) - corner(0), y = corner(3) - corner(0), z = corner(4) - corner(0);
    EXPECT_LE((corner(6) - corner(0) - x - y - z).norm(), 1e-15);
    EXPECT_LE((corner(2) - corner(0) - x - y).norm(), 1e-15);
    volume += x.cross(y).dot(z);
  }
  EXPECT_NEAR(volume, 1e-3, 1e-15);
}

// Two interfaces: arrays are told apart by name. Bars are lines, points are vertices.
TEST(Fields, NameTheInterfaceWhereThereAreSeveral) {
  Scene scene = scene_of(shipped("block_impact").dump());
  const auto grid = first_grid(scene);
  const int node = scene.model->sets().at("block.x_max").nodes[0];
  // Center (0.215, 0.05, 0.08), radius 0.1, from the corner (0.1, 0, 0.02).
  EXPECT_NEAR(Field(*grid, "ball.gap", 1).at(node),
              std::sqrt(0.115 * 0.115 + 0.05 * 0.05 + 0.06 * 0.06) - 0.1, 1e-15);
  EXPECT_NEAR(Field(*grid, "floor.gap", 1).at(node), 0.02, 1e-15);
  EXPECT_EQ(grid->GetPointData()->GetArray("gap"), nullptr);
}

TEST(Fields, DrawBarsAsLinesAndPointsAsVertices) {
  const auto folder = fresh_folder();
  Scene bars = scene_of(shipped("two_bars").dump()), points = scene_of(shipped("sliding_block").dump());
  Integrator of_bars = integrator_of(bars), of_points = integrator_of(points);
  while (of_bars.steps() < 100) of_bars.step();
  Fields(bars, folder).write(of_bars);
  const auto lines = grid_of(folder / "fields_000000.vtu");
  EXPECT_EQ(lines->GetNumberOfCells(), 300);
  EXPECT_EQ(lines->GetCellType(0), VTK_LINE);
  expect_vectors(*lines, "u", of_bars.displacement(), 1);
  expect_vectors(*lines, "r", of_bars.interface_impulse(), 1);
  EXPECT_GT(of_bars.interface_impulse().cwiseAbs().maxCoeff(), 0.0);
  Fields(points, folder).write(of_points);
  const auto vertices = grid_of(folder / "fields_000000.vtu");
  EXPECT_EQ(vertices->GetNumberOfCells(), points.model->node_count());
  EXPECT_EQ(vertices->GetCellType(0), VTK_VERTEX);
}

// The elastic slip of penalty, in the local frame: a point drawn along by 0.002, below its limit of friction.
TEST(Fields, HoldVectorsOfTheState) {
  const auto folder = fresh_folder();
  Scene scene =
      scene_of(R"({"model": {"type": "points", "dimension": 2, "points": [{"mass": 1, "position": [0, 0]}]},
    "time": {"dt": 0.001, "end": 0.1}, "loads": [{"type": "gravity", "acceleration": [1, -10]}],
    "interfaces": [{"law": "penalty", "parameters": {"stiffness": 1e4, "friction": 0.5, "tangential_stiffness": 1e3, "integration": "implicit"},
      "nodes": "all", "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}}]})");
  Integrator integrator = integrator_of(scene);
  while (integrator.steps() < scene.steps) integrator.step();
  Fields(scene, folder).write(integrator);
  const auto grid = grid_of(folder / "fields_000000.vtu");
  const Field spring(*grid, "spring", 3);
  EXPECT_NE(spring.at(0, 0), 0.0);
  EXPECT_EQ(spring.at(0, 0), scene.interfaces[0]->state(0, 1));  // behind the indentation
  EXPECT_EQ(spring.at(0, 1), 0.0);
  EXPECT_EQ(spring.at(0, 2), 0.0);
}

// `ilaw run` writes the start, then every so many steps; the series names them with their times, as ParaView
// wants it.
TEST(Fields, AreListedInASeries) {
  const auto folder = fresh_folder();
  json source = shipped("block_impact");
  source["output"]["fields"] = 40;
  ASSERT_EQ(run_scene(source, folder).code, 0);
  const json series = json_of(folder / "fields.vtu.series");
  const json summary = json_of(folder / "summary.json");
  EXPECT_EQ(series["file-series-version"], "1.0");
  // The start, every 40th step, and the last.
  ASSERT_EQ(series["files"].size(), 1U + (summary["steps"].get<std::size_t>() + 39U) / 40U);
  for (std::size_t k = 0; k < series["files"].size(); ++k) {
    EXPECT_NEAR(
        series["files"][k]["time"].get<double>(),
        static_cast<double>(std::min<std::size_t>(40 * k, summary["steps"])) * summary["dt"].get<double>(),
        1e-15)
        << "k " << k;
    const auto grid = grid_of(folder / series["files"][k]["name"].get<std::string>());
    EXPECT_EQ(grid->GetNumberOfPoints(), summary["nodes"].get<int>()) << "k " << k;
  }
  source["output"].erase("fields");
  const auto without = fresh_folder();
  ASSERT_EQ(run_scene(source, without).code, 0);
  for (const auto& entry : fs::directory_iterator(without))
    EXPECT_THAT(entry.path().string(), Not(HasSubstr(".vtu"))) << entry.path();
}

// ---- interfaces at the start, obstacles ------------------------------------------------------------------

// Before any step, what the law says of a node at the start.
TEST(Fields, TellTheStatusAtTheStart) {
  const auto status_of = [](const std::string& law, double height, const std::string& more = "") {
    Scene scene = scene_of(
        R"({"model": {"type": "points", "dimension": 3, "points": [{"mass": 1, "position": [0, 0, )" +
        number(height) + R"(]}]}, "time": {"dt": 0.001, "end": 0.1}, "interfaces": [{"nodes": "all", )" +
        more + law + R"(, "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]})");
    return static_cast<int>(Field(*first_grid(scene), "status", 1).at(0));
  };
  const std::string glue = R"("law": "cohesive", "parameters": {"strength": 1, "toughness": 1})";
  EXPECT_EQ(status_of(R"("law": "tie")", 0.0), ILAW_BONDED);
  EXPECT_EQ(status_of(glue, 0.0), ILAW_BONDED);
  EXPECT_EQ(status_of(glue, 0.0, R"("birth": 0.05, )"), ILAW_FREE);
  EXPECT_EQ(status_of(R"("law": "penalty", "parameters": {"stiffness": 10})", -0.1), ILAW_CLOSED);
  EXPECT_EQ(status_of(R"("law": "contact")", 0.1), ILAW_FREE);
  EXPECT_EQ(status_of(R"("law": "postit", "parameters": {"initial_adhesion": 2, "memory": 0.01})", 0.0),
            ILAW_BONDED);
}

// A plane, a sphere and a cylinder that move: every point of theirs is on the surface.
TEST(Fields, ShowObstaclesWhereTheyAre) {
  const auto folder = fresh_folder();
  json source = json::parse(block_of("linear"));
  source["interfaces"] = json::parse(R"([
    {"law": "contact", "nodes": "b.z_min", "obstacle": {"type": "plane", "point": [0, 0, -1], "normal": [0.6, 0, 0.8], "velocity": [0, 0, -10]}},
    {"law": "contact", "nodes": "b.z_min", "obstacle": {"type": "sphere", "center": [1, 2, 3], "radius": 0.5, "path": [[0, 0, 0, 0], [1, 4, 0, 0]]}},
    {"law": "contact", "nodes": "b.z_min", "obstacle": {"type": "cylinder", "point": [3, 0, 0], "axis": [0, 2, 0], "radius": 0.25}}])");
  auto [scene, integrator] = simulation_of(source);
  Fields fields(scene, folder);
  for (int k = 0; k < 3; ++k) {
    fields.write(integrator);
    integrator.step();
  }
  const double time = json_of(folder / "obstacles.vtu.series")["files"][2]["time"];
  const auto grid = grid_of(folder / "obstacles_000002.vtu");
  vtkDataArray& owner = cells_of(*grid, "interface");
  std::array<int, 3> seen{};
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
    ASSERT_EQ(grid->GetCellType(cell), VTK_QUAD);
    const auto which = static_cast<std::size_t>(owner.GetComponent(cell, 0));
    ++seen.at(which);
    vtkNew<vtkIdList> nodes;
    grid->GetCellPoints(cell, nodes);
    for (vtkIdType k = 0; k < 4; ++k) {
      Eigen::Vector3d x;
      grid->GetPoint(nodes->GetId(k), x.data());
      const double off[] = {(x - Eigen::Vector3d(0, 0, -1 - 10 * time)).dot(Eigen::Vector3d(0.6, 0, 0.8)),
                            (x - Eigen::Vector3d(1 + 4 * time, 2, 3)).norm() - 0.5,
                            std::hypot(x[0] - 3, x[2]) - 0.25};
      ASSERT_NEAR(off[which], 0.0, 1e-12) << "interface " << which << ", cell " << cell;
    }
  }
  EXPECT_EQ(seen[0], 1);
  EXPECT_GT(seen[1], 100);
  EXPECT_GT(seen[2], 20);
}

TEST(Fields, ShowObstaclesThatStandStillOnce) {
  const auto folder = fresh_folder();
  Scene scene = scene_of(shipped("block_impact").dump());
  const Integrator integrator = integrator_of(scene);
  Fields fields(scene, folder);
  fields.write(integrator);
  fields.write(integrator);
  EXPECT_EQ(json_of(folder / "obstacles.vtu.series")["files"].size(), 1U);
  EXPECT_EQ(json_of(folder / "fields.vtu.series")["files"].size(), 2U);
}

// A rubber block thrown too hard for its step: the state in which it diverged, with what was turned inside
// out.
TEST(Diverged, StateIsWrittenAndNamed) {
  const auto folder = fresh_folder();
  json source = json::parse(block_of("neo_hookean"));
  source["model"]["blocks"][0]["velocity"] = {0, 0, -120};
  source["time"] = {{"cfl", 0.9}, {"end", 0.1}};
  source["interfaces"] = json::parse(R"([{"law": "contact", "nodes": "b.z_min",
    "obstacle": {"type": "plane", "point": [0, 0, 0.1], "normal": [0, 0, 1]}}])");
  const std::string run = "run " + written(source, folder) + " --out " + folder.string();
  const Outcome outcome = run_program(run);
  ASSERT_EQ(outcome.code, 1) << outcome.output;
  const auto file = folder / "diverged.vtu";
  EXPECT_THAT(outcome.output, HasSubstr("; that state is in " + file.string()));
  const std::size_t named = outcome.output.find("; element ");
  ASSERT_NE(named, std::string::npos) << outcome.output;
  const auto grid = grid_of(file);
  EXPECT_EQ(cells_of(*grid, "inverted").GetComponent(std::stoi(outcome.output.substr(named + 10)), 0), 1.0);
  // The next run does not leave it there.
  source["model"]["blocks"][0]["velocity"] = {0, 0, -1};
  source["time"]["end"] = 0.001;
  std::ofstream(folder / "scene.json") << source.dump();
  ASSERT_EQ(run_program(run).code, 0);
  EXPECT_FALSE(fs::exists(file));
}

}  // namespace
}  // namespace ilaw::host::testing::fields
