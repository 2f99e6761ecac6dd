// `ilaw study`: the largest stable step, what an error costs, and the program on scenes with known answers.
#include "run_result.hpp"
#include "study/stable_step.hpp"
#include "study/study_laws.hpp"
#include "study/work_precision.hpp"

namespace ilaw::host::testing::study {
namespace {

json plane(const std::vector<double>& normal) {
  return {{"type", "plane"}, {"point", std::vector<double>(normal.size(), 0.0)}, {"normal", normal}};
}

// A mass that a force presses on the floor, little by little: its spring stays closed.
Scene pressed_mass(double mass, double stiffness, double dt) {
  return scene_of(json{
      {"model", {{"type", "points"}, {"dimension", 1}, {"points", {{{"mass", mass}, {"position", {0.0}}}}}}},
      {"time", {{"dt", dt}, {"end", 3.0}}},
      {"loads",
       {{{"type", "force"}, {"nodes", {0}}, {"direction", {-1.0}}, {"history", {{0.0, 0.0}, {0.2, 10.0}}}}}},
      {"interfaces",
       {{{"law", "penalty"},
         {"parameters", {{"stiffness", stiffness}}},
         {"nodes", {0}},
         {"obstacle", plane({1.0})}}}}}
                      .dump());
}

// A mass on a spring that stays closed is stable up to h = 2/omega, omega^2 = k/m.
TEST(StableStep, OfAMassOnAnExplicitSpringIsThatOfTheOscillator) {
  struct {
    double mass, stiffness, tried;
  } cases[] = {{1.0, 1e4, 0.05}, {2.7, 3.1e4, 0.31}, {0.13, 777.0, 0.0271}};
  for (const auto& one : cases) {
    const double found = largest_stable_step(
        [&](double part) { return pressed_mass(one.mass, one.stiffness, part * one.tried); });
    EXPECT_NEAR(found * one.tried / (2.0 / std::sqrt(one.stiffness / one.mass)), 1.0, 0.02)
        << "m " << one.mass << ", k " << one.stiffness;
  }
}

TEST(StableStep, IsAllThatIsTriedWhereThatIsStable) {
  EXPECT_EQ(largest_stable_step([](double part) { return pressed_mass(1.0, 1e4, part * 0.019); }), 1.0);
}

// Runs with an error of c h^p: below an error from (c/error)^(1/p) steps on.
std::vector<MeasuredRun> runs_of_order(double order, int count) {
  std::vector<MeasuredRun> runs;
  for (int k = 0; k < count; ++k) {
    MeasuredRun run;
    run.steps = 10 << k;
    run.dt = 1.0 / static_cast<double>(run.steps);
    run.seconds = 1e-6 * static_cast<double>(run.steps);
    run.errors.u_L2 = 3.0 * std::pow(run.dt, order);
    run.errors.instant = run.errors.u_L2;
    runs.push_back(run);
  }
  return runs;
}

TEST(Cost, LiesOnTheLineBetweenRuns) {
  for (const double order : {0.5, 1.0, 2.0}) {
    const std::vector<MeasuredRun> runs = runs_of_order(order, 16);
    for (const double steps : {13.0, 177.0, 9999.0}) {
      const Cost cost = cost_of(runs, norm_u_L2, 3.0 * std::pow(steps, -order));
      EXPECT_NEAR(cost.steps / steps, 1.0, 1e-12) << order << ", " << steps;
      EXPECT_NEAR(cost.seconds, 1e-6 * cost.steps, 1e-12 * cost.steps)
          << "order " << order << ", steps " << steps;
    }
  }
}

TEST(Cost, IsThatOfTheFirstRunWhereItIsGoodEnoughAndNoneWhereNoneIs) {
  const std::vector<MeasuredRun> runs = runs_of_order(1.0, 6);
  EXPECT_EQ(cost_of(runs, norm_u_L2, 0.31).steps, 10.0);
  EXPECT_TRUE(std::isnan(cost_of(runs, norm_u_L2, 1e-3).steps));
  EXPECT_TRUE(std::isnan(cost_of(runs, norm_u_L2, 1e-3).seconds));
}

// An error that is small by chance, or that is there again with smaller steps, does not count.
TEST(Cost, CountsFromTheRunAfterWhichErrorsStayBelow) {
  std::vector<MeasuredRun> runs = runs_of_order(1.0, 8);
  runs[1].errors.u_L2 = 1e-9;
  EXPECT_NEAR(cost_of(runs, norm_u_L2, 0.02).steps, 150.0, 1e-9);
  runs[6].errors.u_L2 = ContactInstants::none;  // a run that failed
  EXPECT_EQ(cost_of(runs, norm_u_L2, 0.02).steps, 1280.0);
  runs[7].errors.u_L2 = 0.5;
  EXPECT_TRUE(std::isnan(cost_of(runs, norm_u_L2, 0.02).steps));
}

json ball() {
  return read_scene_source(fs::path(ILAW_SOURCE) / "docs/results/scenes/bouncing_ball_e08.json");
}

TEST(StudyLaws, ScaledParametersAreInUnitsOfTheNodeAndTheStep) {
  json scene = ball();
  scene["model"]["points"][0]["mass"] = 2.0;
  const json entry{
      {"law", "penalty"},
      {"scaled", true},
      {"parameters",
       {{"stiffness", 3.0}, {"tangential_stiffness", 5.0}, {"damping", 7.0}, {"friction", 0.25}}}};
  const json found = with_law(scene, entry, 0.01, "scene.json")["interfaces"][0]["parameters"];
  EXPECT_DOUBLE_EQ(found["stiffness"], 3.0 * 2.0 / 1e-4);
  EXPECT_DOUBLE_EQ(found["tangential_stiffness"], 5.0 * 2.0 / 1e-4);
  EXPECT_DOUBLE_EQ(found["damping"], 7.0 * 2.0 / 1e-2);
  EXPECT_EQ(found["friction"], 0.25);
  // The end node of a bar: half an element, m/h^2 = (rho S l/2) (c/l)^2 = E S/(2 l), on every mesh.
  json bar = shipped("bar_on_wall");
  for (const int elements : {10, 35}) {
    bar["model"]["bars"][0]["elements"] = elements;
    const json of_bar = with_law(bar, entry, 0.01, "scene.json")["interfaces"][0]["parameters"];
    EXPECT_NEAR(of_bar["stiffness"].get<double>(), 3.0 * 900.0 * elements / (2.0 * 10.0), 1e-6)
        << "elements " << elements;
  }
}

TEST(StudyLaws, WithoutANameChangeTheScenesOwn) {
  const json scene = ball();
  const json own = with_law(scene, {{"parameters", {{"activation", "predictive"}}}}, 0.01, "scene.json");
  EXPECT_EQ(own["interfaces"][0]["law"], "contact");
  EXPECT_EQ(own["interfaces"][0]["parameters"], (json{{"restitution", 0.8}, {"activation", "predictive"}}));
  const json other =
      with_law(scene, {{"law", "penalty"}, {"parameters", {{"stiffness", 1.0}}}}, 0.01, "scene.json");
  EXPECT_EQ(other["interfaces"][0]["parameters"], json({{"stiffness", 1.0}}));
}

struct Result {
  Outcome outcome;
  fs::path folder;
};

Result study_of(const json& scene, const std::string& options) {
  const auto folder = fresh_folder(), results = folder / "results";
  return {run_program("study " + written(scene, folder) + " --out " + results.string() + " --repetitions 1 " +
                      options),
          results};
}

// Positions of contact are of first order, whatever the activation: a tenth of an error costs ten times
// the steps, within what the phase of impacts scatters. An explicit spring has an error of its own.
TEST(Study, OfTheBallTellsOrderAndCost) {
  json scene = ball();
  scene["study"] = {{"first", 3.0}, {"factor", 1.7}, {"levels", 10}};
  const Result study =
      study_of(scene,
               "--law '{\"name\": \"contact\"}' "
               "--law 'contact:{\"restitution\": 0.8, \"activation\": \"predictive\"}' "
               "--law '{\"name\": \"spring\", \"law\": \"penalty\", \"parameters\": {\"stiffness\": 1e4}}'");
  ASSERT_EQ(study.outcome.code, 0) << study.outcome.output;
  std::map<std::string, std::vector<double>> steps, errors;
  for (auto& row : rows_of(study.folder / "study.csv")) {
    steps[row["law"]].push_back(std::stod(row["dt"]));
    errors[row["law"]].push_back(std::stod(row["u_L2"]));
    for (const char* norm : norm_names) EXPECT_FALSE(row[norm].empty()) << norm << " of " << row["law"];
    EXPECT_FALSE(row["seconds"].empty()) << row["law"] << ", " << row["steps"] << " steps";
    EXPECT_NEAR(std::stod(row["dt"]) * std::stod(row["steps"]), 5.0, std::stod(row["dt"]));
  }
  ASSERT_EQ(steps.size(), 3U);
  for (const char* law : {"contact", "contact activation predictive restitution 0.8"}) {
    EXPECT_NEAR(order(steps[law], errors[law]), 1.0, 0.25) << law;
    EXPECT_NEAR(steps[law].front(), 0.0309, 1e-9) << law;
  }
  // Stable below 2/omega = 0.02 at most, and run at 0.9 of that at most.
  EXPECT_LE(steps["spring"].front(), 0.018);
  // Elastic, where the ball loses: never right.
  EXPECT_GT(errors["spring"].back(), 0.1);

  std::map<std::string, double> cost;
  std::set<std::string> columns;
  for (auto& row : rows_of(study.folder / "study_needed.csv")) {
    for (const auto& [column, ignored] : row) columns.insert(column);
    if (row["norm"] != "u_L2") continue;
    if (row["law"] == "contact" && !row["steps"].empty()) cost[row["error"]] = std::stod(row["steps"]);
    if (row["law"] == "contact" && row["error"] == "0.01") {
      EXPECT_EQ(row["steps / first law's"], "1");
      EXPECT_EQ(row["seconds / first law's"], "1");
    }
    if (row["law"] == "spring") {
      EXPECT_EQ(row["steps"], "") << row["error"];
    }
  }
  EXPECT_EQ(columns, (std::set<std::string>{"law", "norm", "error", "steps", "seconds", "steps / first law's",
                                            "seconds / first law's"}));
  EXPECT_GT(cost["0.001"] / cost["0.01"], 4.0);
  EXPECT_LT(cost["0.001"] / cost["0.01"], 25.0);

  const json laws = json_of(study.folder / "study.json");
  EXPECT_EQ(laws["reference"], "exact solution");
  EXPECT_EQ(laws["laws"][0]["largest_stable_step"], laws["laws"][0]["largest_step_tried"]);
  EXPECT_LE(laws["laws"][2]["largest_stable_step"].get<double>(), 0.02 * 1.01);
}

// Without exact solution and without a list: the usual laws, against the first one's finest run.
TEST(Study, TakesTheUsualLawsWhereTheSceneListsNone) {
  json scene = ball();
  scene.erase("study");
  scene.erase("exact");
  const Result study = study_of(scene, "--levels 3");
  ASSERT_EQ(study.outcome.code, 0) << study.outcome.output;
  const json found = json_of(study.folder / "study.json");
  EXPECT_EQ(found["reference"], "finest run of the first law");
  ASSERT_EQ(found["laws"].size(), 7U);
  EXPECT_EQ(found["laws"][0]["name"], "contact predictive");
  EXPECT_EQ(found["laws"][2]["name"], "explicit k=0.1");
  EXPECT_THAT(study.outcome.output, HasSubstr("implicit k=100.0"));
}

// The same run has other errors beside a reference that is finer by 1.5 and by 8.
TEST(Study, ComparesWithARunAsFineAsAsked) {
  std::vector<double> errors;
  for (const double finer : {1.5, 8.0}) {
    json scene = ball();
    scene.erase("exact");
    scene["study"] = {{"reference", finer}};
    const Result study = study_of(scene, "--law contact --levels 2");
    ASSERT_EQ(study.outcome.code, 0) << study.outcome.output;
    errors.push_back(std::stod(rows_of(study.folder / "study.csv").back()["u_L2"]));
  }
  EXPECT_NE(errors[0], errors[1]);
}

// A scene with friction is compared with several laws; a scene with another law only with itself.
TEST(Study, TakesLawsThatSuitTheScene) {
  json rubs = shipped("oblique_impact");
  rubs["time"]["end"] = 0.35;  // past the first impact
  json holds = shipped("postit_test2");
  for (json* scene : {&rubs, &holds}) scene->erase("study");
  const Result sliding = study_of(rubs, "--levels 2"), held = study_of(holds, "--levels 2");
  ASSERT_EQ(sliding.outcome.code, 0) << sliding.outcome.output;
  ASSERT_EQ(held.outcome.code, 0) << held.outcome.output;
  const json usual = json_of(sliding.folder / "study.json")["laws"];
  EXPECT_EQ(usual.size(), 7U) << usual;
  const json own = json_of(held.folder / "study.json")["laws"];
  ASSERT_EQ(own.size(), 1U) << own;
  EXPECT_EQ(own[0]["name"], "as in the scene");
}

TEST(Study, OfSeveralScenesHasAFolderForEach) {
  const auto folder = fresh_folder();
  const std::string scenes = (fs::path(ILAW_SOURCE) / "docs/results/scenes/bouncing_ball_e1.json").string() +
                             " " + scene_files::named("postit_test2.json").string();
  const Outcome outcome = run_program(
      "study " + scenes + " --law '{\"name\": \"own\"}' --levels 2 --repetitions 1 --out " + folder.string());
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  for (const char* name : {"bouncing_ball_e1", "postit_test2"})
    EXPECT_TRUE(fs::exists(folder / name / "study.csv")) << name;
}

TEST(Study, EndsWithTheSceneThatFails) {
  const auto folder = fresh_folder();
  std::ofstream(folder / "second.json") << R"({"title": "no scene"})";
  std::ofstream(folder / "third.json") << ball().dump();
  EXPECT_THAT(run_program("study " + scene_files::named("postit_test2.json").string() + " " +
                          (folder / "second.json").string() + " " + (folder / "third.json").string() +
                          " --law '{\"name\": \"own\"}' --levels 2 --repetitions 1 --out " +
                          (folder / "out").string()),
              Exits(2, HasSubstr("second.json: ")));
  EXPECT_TRUE(fs::exists(folder / "out/postit_test2/study.csv"));
  EXPECT_FALSE(fs::exists(folder / "out/third"));
}

}  // namespace
}  // namespace ilaw::host::testing::study
