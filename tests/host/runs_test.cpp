// Several runs side by side: sweeps, tables, pictures; and the pictures of many nodes.
#include "host_runner.hpp"
#include "mesh_writer.hpp"

#include "base/csv.hpp"

#include <chrono>
#include <csignal>
#include <thread>

namespace ilaw::host::testing::runs {
namespace {

std::vector<std::vector<std::string>> rows_of(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) rows.push_back(csv_cells(line));
  return rows;
}

std::string cell(const std::vector<std::vector<std::string>>& rows, std::size_t row,
                 const std::string& column) {
  for (std::size_t k = 0; k < rows[0].size(); ++k)
    if (rows[0][k] == column) return k < rows[row].size() ? rows[row][k] : "";
  return "no column " + column;
}

// A block that slides until it stops, at v0^2/(2 mu g).
json sliding() {
  return json::parse(
      R"({"model": {"type": "points", "dimension": 2, "points": [{"mass": 2, "position": [0, 0], "velocity": [2, 0]}]},
    "time": {"dt": 0.001, "end": 4}, "loads": [{"type": "gravity", "acceleration": [0, -10]}],
    "interfaces": [{"name": "floor", "law": "coulomb", "nodes": "all", "parameters": {"friction": 0.5},
      "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}}],
    "output": {"watch": [0], "forces": ["floor"], "every": 10}})");
}

json block_on_plane() {
  return json::parse(R"({
    "model": {"type": "blocks", "blocks": [{"name": "b", "size": [0.1, 0.1, 0.1], "elements": [2, 2, 2],
      "material": {"type": "linear", "young": 1e6, "poisson": 0.3, "density": 1000}}]},
    "time": {"cfl": 0.9, "end": 0.01},
    "interfaces": [{"law": "contact", "nodes": "b.z_min",
      "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]})");
}

// A law without statuses and energies: what it wears off, and how hard it pushes, is told all the same, alone
// and beside an interface that shares the node.
TEST(History, TellsOfContactsOfABareLaw) {
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 1, "points": [
      {"mass": 2, "position": [0], "velocity": [-1], "area": 0.5}]}, "time": {"dt": 0.5, "end": 2},
    "loads": [{"type": "gravity", "acceleration": [-10]}],
    "interfaces": [{"name": "floor", "law": "broken", "nodes": "all",
                    "obstacle": {"type": "plane", "point": [0], "normal": [1]}}],
    "output": {"watch": [0], "contact": true, "events": true}})");
  scene["interfaces"][0]["library"] = ILAW_BROKEN_LAW;
  for (const std::string prefix : {"n0.", "n0.floor."}) {
    const auto folder = fresh_folder();
    ASSERT_EQ(run_scene(scene, folder, "", "ILAW_BROKEN=bare ").code, 0);
    const auto rows = rows_of(text_of(folder / "history.csv"));
    ASSERT_EQ(rows.size(), 5U);
    EXPECT_EQ(cell(rows, 4, prefix + "pressure"), "40");  // m g/A
    EXPECT_EQ(cell(rows, 4, prefix + "status"), "1");
    EXPECT_EQ(cell(rows, 4, prefix + "wear_depth"), "1.25");  // of four steps and the start
    EXPECT_EQ(json_of(folder / "summary.json")["status_counts"]["closed"], 4);
    EXPECT_THAT(text_of(folder / "events.csv"), HasSubstr("0,0,floor,contact,"));
    scene["interfaces"].push_back(scene["interfaces"][0]);
    scene["interfaces"][1]["name"] = "other";
    scene["interfaces"][1]["obstacle"]["point"] = {-1};
  }
}

// Readers of meshes are processes, and so are the runs.
TEST(Sweep, ReadsMeshesInEachOfItsProcesses) {
  const auto folder = fresh_folder();
  std::ofstream(folder / "box.vtu") << box_mesh({1, 1, 1}, {4, 4, 1}, false).vtu();
  const json scene = json::parse(R"({"model": {"type": "solids", "meshes": [{"name": "b", "file": "box.vtu",
      "material": {"type": "linear", "young": 1e6, "poisson": 0.3, "density": 1000}}]},
    "time": {"cfl": 0.9, "end": 0.02}, "interfaces": [{"law": "coulomb", "nodes": "all",
      "parameters": {"friction": 0.3}, "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]})");
  for (int k = 0; k < 5; ++k) {
    const Outcome outcome = run_scene(scene, folder, "--set /time/end=0.02,0.03,0.04,0.05,0.06 --threads 2");
    EXPECT_THAT(outcome, Exits(0, HasSubstr("5 runs, 0 failed; ")));
  }
}

void wait_for(const fs::path& file) {
  for (int k = 0; k < 5000 && !fs::exists(file); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

// Ends the program by a signal once files are there; its messages.
std::string interrupted(const json& scene, const fs::path& folder, const std::vector<std::string>& begun,
                        const std::vector<std::string>& options = {}) {
  std::vector<std::string> arguments = {"run", written(scene, folder), "--out", folder.string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const pid_t child = start_program(arguments, folder / "messages");
  for (const std::string& file : begun) wait_for(folder / file);
  kill(child, SIGTERM);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1) << text_of(folder / "messages");
  return text_of(folder / "messages");
}

// Runs end at their next step, with results, and no other is started.
TEST(Sweep, EndsAtAnInterrupt) {
  const auto folder = fresh_folder();
  json scene = sliding();
  scene["time"]["end"] = 1e6;
  interrupted(scene, folder, {"mass=1/history.csv.partial", "mass=2/history.csv.partial"},
              {"--threads", "2", "--set", "/model/points/0/mass=1,2,3"});
  for (const std::string name : {"mass=1", "mass=2"})
    EXPECT_TRUE(json_of(folder / name / "summary.json")["interrupted"]) << name;
  EXPECT_FALSE(fs::exists(folder / "mass=3"));
  EXPECT_EQ(rows_of(text_of(folder / "sweep.csv")).size(), 3U);
}

// So do its runs if it is killed itself; a run that is killed is named.
TEST(Sweep, IsKilledWithItsRunsAndNamesThoseThatAre) {
  const auto folder = fresh_folder();
  json scene = sliding();
  scene["time"]["end"] = 1e6;
  const pid_t sweep = start_program({"run", written(scene, folder), "--out", (folder / "all").string(),
                                     "--threads", "2", "--set", "/model/points/0/mass=1,2,3"},
                                    folder / "messages");
  for (const char* name : {"mass=1", "mass=2"}) wait_for(folder / "all" / name / "history.csv.partial");
  pid_t run = 0;
  std::istringstream(text_of(folder / "all/mass=1/ilaw.lock").substr(8)) >> run;  // "process 4711 on ..."
  ASSERT_GT(run, 1);
  kill(run, SIGKILL);
  wait_for(folder / "all/mass=3/history.csv.partial");
  EXPECT_THAT(text_of(folder / "messages"), HasSubstr("mass=1: its process ended: Killed"));
  kill(sweep, SIGKILL);
  int status = 0;
  waitpid(sweep, &status, 0);
  for (const char* name : {"mass=2", "mass=3"}) {
    wait_for(folder / "all" / name / "summary.json");
    EXPECT_TRUE(json_of(folder / "all" / name / "summary.json")["interrupted"]) << name;
  }
}

// It ends at its next step, too, without results but a summary that says so.
TEST(Prestress, EndsAtAnInterrupt) {
  const auto folder = fresh_folder();
  json scene = block_on_plane();
  scene["prestress"] = {{"tolerance", 1e-300}, {"steps", 1000000000}};
  scene["loads"] = {gravity({0, 0, -10})};
  EXPECT_THAT(interrupted(scene, folder, {"history.csv.partial"}), HasSubstr("interrupted at step 0 of "));
  EXPECT_TRUE(json_of(folder / "summary.json")["interrupted"]);
}

TEST(Sweep, RunsEachValueAndGathersTheSummaries) {
  const auto folder = fresh_folder();
  const std::string run = "run " + written(sliding(), folder) + " --out " + (folder / "all").string();
  const Outcome outcome = run_program(
      run +
      " --set /interfaces/0/parameters/friction=0.1,0.2,0.4 --set /model/points/0/mass=1,3 --threads 2");
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  const auto rows = rows_of(text_of(folder / "all" / "sweep.csv"));
  ASSERT_EQ(rows.size(), 7U);
  EXPECT_EQ(rows[4][0], "friction=0.2_mass=3");
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const double friction = std::stod(cell(rows, k, "/interfaces/0/parameters/friction")),
                 mass = std::stod(cell(rows, k, "/model/points/0/mass"));
    EXPECT_NEAR(std::stod(cell(rows, k, "energy.dissipated_friction")), 0.5 * mass * 4, 0.02 * mass) << k;
    EXPECT_NEAR(std::stod(cell(rows, k, "forces.floor.impulse.0")), -2 * mass, 1e-9) << k;
    const json summary = json_of(folder / "all" / rows[k][0] / "summary.json");
    EXPECT_EQ(summary["scene"]["source"]["interfaces"][0]["parameters"]["friction"], friction) << "k " << k;
  }
  // A table of some of them, by columns of the summary and of the history.
  const std::string one = (folder / "all" / "friction=0.1_mass=1").string(),
                    other = (folder / "all" / "friction=0.4_mass=1").string();
  const Outcome table =
      run_program("table " + one + " " + other + " --csv --columns steps,n0.u0,n0.v0:max,floor.F1:mean");
  const auto cells = rows_of(table.output);
  ASSERT_EQ(cells.size(), 3U) << table.output;
  EXPECT_EQ(cells[0], (std::vector<std::string>{"run", "/interfaces/0/parameters/friction", "steps", "n0.u0",
                                                "n0.v0:max", "floor.F1:mean"}));
  EXPECT_EQ(cells[1][2], "4000");
  EXPECT_NEAR(std::stod(cells[1][3]), 2.0, 0.01);
  EXPECT_NEAR(std::stod(cells[2][3]), 0.5, 0.01);
  EXPECT_NEAR(std::stod(cells[2][5]), 10.0, 1e-9);  // the weight
  EXPECT_EQ(run_program("table " + one + " --columns nothing").code, 2);
  // Files that lie beside the runs by now are none.
  const Outcome all = run_program("table " + (folder / "all").string() + "/* --csv --columns steps");
  EXPECT_EQ(rows_of(all.output).size(), rows.size()) << all.output;
  EXPECT_THAT(run_program("table " + (folder / "all/sweep.csv").string()).output,
              HasSubstr("found a file, expected a folder that `ilaw run SCENE --out DIR` wrote"));
  std::ofstream(folder / "all/comparison.png") << "a picture";
  EXPECT_THAT(run_program("table " + (folder / "all").string() + "/sweep.csv " + (folder / "all").string() +
                          "/comparison.png")
                  .output,
              HasSubstr("found files alone"));
}

// Commas in brackets and quotes belong to a value; settings whose last keys are alike have their whole names,
// and values that are alike a number.
TEST(Sweep, TellsValuesAndNamesApart) {
  const auto folder = fresh_folder();
  json scene = sliding();
  scene["time"]["end"] = 0.01;
  const std::string run = "run " + written(scene, folder) + " --out " + folder.string();
  for (const auto& [settings, names] : std::map<std::string, std::vector<std::string>>{
           {"--set '/model/points/0/velocity=[2,0],[1,0]'", {"velocity=2_0", "velocity=1_0"}},
           {"--set '/title=\"a, b\",c'", {"title=a_b", "title=c"}},
           {"--set '/title=\"a\\\", b\",\"c\"'", {"title=a_b", "title=c"}},
           {"--set /model/points/0/velocity/0=1 --set /model/points/0/position/0=2,2",
            {"model.points.0.velocity.0=1_model.points.0.position.0=2",
             "model.points.0.velocity.0=1_model.points.0.position.0=2_1"}}}) {
    const Outcome outcome = run_program(run + " " + settings);
    ASSERT_EQ(outcome.code, 0) << settings << outcome.output;
    for (const std::string& name : names)
      EXPECT_TRUE(fs::exists(folder / name / "summary.json")) << settings << ": " << name;
  }
}

TEST(Sweep, CountsTheRunsThatFail) {
  const auto folder = fresh_folder();
  EXPECT_THAT(run_scene(sliding(), folder, " --set /model/points/0/velocity/0=1,1e200"),
              Exits(1, HasSubstr("2 runs, 1 failed; their summaries in ")));
  EXPECT_EQ(rows_of(text_of(folder / "sweep.csv")).size(), 3U);
}

TEST(Table, SaysWhatIsNoRun) {
  const auto folder = fresh_folder(), good = folder / "good", odd = folder / "odd";
  json scene = sliding();
  scene["time"]["end"] = 0.1;
  std::ofstream(folder / "scene.json") << scene.dump();
  ASSERT_EQ(run_program("run " + (folder / "scene.json").string() + " --out " + good.string()).code, 0);
  const auto refused = [&](const std::string& command, const std::string& said) {
    EXPECT_THAT(run_program(command), Exits(2, HasSubstr(said))) << command;
  };
  fs::create_directories(odd);
  std::ofstream(odd / "summary.json") << "[]";
  refused("table " + odd.string(), "found no summary of a run");
  refused("table " + good.string() + " --columns n0.u0:median",
          "n0.u0:median: found 'median', expected one of last, min, max, mean");
  refused("table " + good.string() + " --columns energy.kinetik", "(did you mean 'energy.kinetic'?)");
  refused("table " + good.string() + " --columns n0.u7:max",
          "or a column of history.csv, one of time, n0.u0, ");
  const Outcome table = run_program("table " + good.string() + "/ --csv --columns n0.u0:min,n0.v0:last");
  EXPECT_EQ(rows_of(table.output).size(), 2U) << table.output;
  EXPECT_EQ(run_program("table " + good.string()).code, 0);
}

// A Python without matplotlib: the run is done all the same.
TEST(Plot, SaysWhatToInstall) {
  const auto folder = fresh_folder();
  ASSERT_EQ(run_scene(sliding(), folder).code, 0);
  std::ofstream(folder / "sitecustomize.py") << "import sys; sys.modules['matplotlib'] = None";
  const Outcome outcome = run_program("plot " + folder.string(), "PYTHONPATH=" + folder.string() + " ");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.output,
            "ilaw: found no Python 3 with numpy, matplotlib; install it with `apt-get install python3-numpy "
            "python3-matplotlib`\n");
}

// Pictures that name the program that drew them go, those of others stay.
TEST(Picture, OfAnEarlierRunIsRemoved) {
  const auto folder = fresh_folder();
  for (const auto& [name, maker] : {std::pair{"history.png", "tEXtSoftware ilaw plot"},
                                    {"floor.F0_over_time.svg", "<dc:title>ilaw plot</dc:title>"},
                                    {"my_over_all.png", "mine"}})
    std::ofstream(folder / name) << maker;
  ASSERT_EQ(run_scene(sliding(), folder).code, 0);
  EXPECT_FALSE(fs::exists(folder / "history.png"));
  EXPECT_FALSE(fs::exists(folder / "floor.F0_over_time.svg"));
  EXPECT_TRUE(fs::exists(folder / "my_over_all.png"));
}

}  // namespace
}  // namespace ilaw::host::testing::runs
