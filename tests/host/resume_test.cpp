// A run that goes on from a checkpoint may have another end, another title and another output.
#include "host_runner.hpp"

#include "base/csv.hpp"

namespace ilaw::host::testing::resume {
namespace {

json short_memory() { return shipped("postit_test3"); }

std::string in_one_go(const json& scene) {
  const auto folder = fresh_folder();
  const Outcome run = run_scene(scene, folder);
  EXPECT_EQ(run.code, 0) << run.output;
  return text_of(folder / "history.csv");
}

// A run that has ended goes on to a later end, under another title: the bytes of the run that was that long
// from the start.
TEST(Resume, GoesOnToALaterEnd) {
  json scene = short_memory();
  scene["time"]["end"] = 1.7;
  const std::string whole = in_one_go(scene);
  const auto folder = fresh_folder();
  const std::string out = " --out " + folder.string() + " --checkpoint-every 600 --resume";
  for (const double end : {0.6, 1.1, 1.7}) {
    scene["time"]["end"] = end;
    scene["title"] = "until " + std::to_string(end);
    const std::string file = written(scene, folder);
    const Outcome run = run_program("run " + file + (end == 0.6 ? out.substr(0, out.rfind(' ')) : out));
    ASSERT_EQ(run.code, 0) << run.output;
    const std::string rows = text_of(folder / "history.csv");
    ASSERT_EQ(rows, whole.substr(0, rows.size())) << end;
  }
  EXPECT_EQ(text_of(folder / "history.csv"), whole);
  EXPECT_EQ(json_of(folder / "summary.json")["execution"]["resumed_at_step"], 1100);
  scene["time"]["end"] = 1.6;
  EXPECT_THAT(
      run_program("run " + written(scene, folder) + out),
      Exits(2, HasSubstr("is at time 1.7 already, expected an 'end' of 'time' that is not before it")));
}

// With other columns: the rows so far stay beside the new ones, which are those of a run that had the columns
// from the start; and the run can be resumed again.
TEST(Resume, GoesOnWithOtherColumns) {
  json scene = short_memory(), wide = scene;
  const json wanted = {{"every", 5}, {"watch", {0}}, {"balance", true}, {"events", true}};
  wide["output"] = wanted;
  const std::string narrow_rows = in_one_go(scene), wide_rows = in_one_go(wide);
  const auto folder = fresh_folder();
  const std::string out = " --out " + folder.string() + " --checkpoint-every 1000";
  const json end = scene["time"]["end"];
  scene["time"]["end"] = 0.5;
  ASSERT_EQ(run_program("run " + written(scene, folder) + out).code, 0);
  scene["output"] = wanted;
  for (const json& next : {json(1.0), end}) {
    scene["time"]["end"] = next;
    const Outcome run = run_program("run " + written(scene, folder) + out + " --resume");
    ASSERT_EQ(run.code, 0) << run.output;
  }
  const std::string before = text_of(folder / "history.until_step_500.csv");
  EXPECT_EQ(before, narrow_rows.substr(0, before.size()));
  EXPECT_EQ(before.substr(before.rfind('\n', before.size() - 2) + 1, 4), "0.5,");
  const std::string rows = text_of(folder / "history.csv"), header = rows.substr(0, rows.find('\n') + 1);
  EXPECT_EQ(header, wide_rows.substr(0, header.size()));
  const std::string tail = rows.substr(header.size());
  EXPECT_EQ(tail.substr(0, 6), "0.505,");
  EXPECT_EQ(tail, wide_rows.substr(wide_rows.size() - tail.size()));
  EXPECT_THAT(text_of(folder / "events.csv"), HasSubstr("rupture"));
  ASSERT_EQ(run_program("run " + written(scene, folder) + out).code, 0);
  EXPECT_FALSE(fs::exists(folder / "history.until_step_500.csv"));
}

TEST(Resume, RefusesOtherPointsInATable) {
  json scene =
      json::parse(R"({"model": {"type": "points", "dimension": 1, "points": "points.csv"}, "interfaces": [],
      "time": {"dt": 0.1, "end": 2}})");
  const auto folder = fresh_folder();
  std::ofstream(folder / "points.csv") << "mass,area,x0,v0\n1,1,0,1\n";
  ASSERT_EQ(run_scene(scene, folder, "--checkpoint-every 10").code, 0);
  ASSERT_EQ(run_scene(scene, folder, "--resume").code, 0);
  std::ofstream(folder / "points.csv", std::ios::app) << "1,1,1,0\n";
  EXPECT_THAT(run_scene(scene, folder, "--resume"), Exits(2, HasSubstr("is of other meshes or points")));
}

// Sums go on when columns change, but not those that nobody asked for before, of which a warning tells in
// this run and in those that go on from it.
TEST(Resume, KeepsSumsWithOtherColumns) {
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 2, "points": [
      {"mass": 2, "position": [0, 0], "velocity": [2, 0], "area": 0.01},
      {"mass": 1, "position": [1, 0], "velocity": [1, 0], "area": 0.01}]},
    "time": {"dt": 1e-3, "end": 0.25}, "loads": [{"type": "gravity", "acceleration": [0, -10]}],
    "interfaces": [{"name": "floor", "law": "coulomb", "nodes": "all",
      "parameters": {"friction": 0.4, "wear_coefficient": 1e-6},
      "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}}]})");
  const json narrow = {
      {"every", 100}, {"watch", {0}}, {"contact", true}, {"forces", {{{"of", "floor"}, {"about", {0, 0}}}}}};
  json wide = narrow;
  wide["watch"] = {0, 1};
  wide["balance"] = true;
  scene["output"] = wide;
  scene["time"]["end"] = 0.6;
  const std::string all_rows = in_one_go(scene);
  scene["output"] = narrow;
  scene["time"]["end"] = 0.25;
  const auto folder = fresh_folder();
  const std::string out = " --out " + folder.string() + " --checkpoint-every 1000";
  ASSERT_EQ(run_program("run " + written(scene, folder) + out).code, 0);
  scene["output"] = wide;
  for (const double end : {0.4, 0.6}) {
    scene["time"]["end"] = end;
    EXPECT_THAT(run_program("run " + written(scene, folder) + out + " --resume"),
                Exits(0, HasSubstr("n1.slip_length, n1.wear_depth: summed from step 250 only")));
  }
  const auto last = [](const std::string& rows) {
    const std::size_t begin = rows.rfind('\n', rows.size() - 2) + 1;
    return csv_cells(rows.substr(begin, rows.size() - 1 - begin));
  };
  const std::vector<std::string> found = last(text_of(folder / "history.csv")), whole = last(all_rows);
  const std::string rows = text_of(folder / "history.csv");
  const std::vector<std::string> names = csv_cells(rows.substr(0, rows.find('\n')));
  ASSERT_EQ(found.size(), names.size());
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == "n1.slip_length" || names[k] == "n1.wear_depth")
      EXPECT_NE(found[k], whole[k]) << names[k];
    else
      EXPECT_EQ(found[k], whole[k]) << names[k];
  // 24 N.s up and, to the left, what both lost of their velocity.
  const json impulse = json_of(folder / "summary.json")["forces"]["floor"]["impulse"];
  EXPECT_NEAR(impulse[0], -5.0, 1e-9);
  EXPECT_NEAR(impulse[1], 18.0 + 0.015, 1e-9);
}

}  // namespace
}  // namespace ilaw::host::testing::resume
