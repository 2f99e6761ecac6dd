// A run that goes on from a checkpoint may have another end, another title and another output.
#include "host_runner.hpp"

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

}  // namespace
}  // namespace ilaw::host::testing::resume
