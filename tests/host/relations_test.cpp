// Scenes beside others whose motion follows from theirs: all shipped ones, and carriers with every law.
#include "host_runner.hpp"
#include "support/law_cases.hpp"

#include "stress/related_scenes.hpp"
#include "stress/relations.hpp"

namespace ilaw::host::testing {
namespace {

constexpr std::int64_t shipped_steps = 300;

// How often each relation was found to hold, over some scenes.
class Relations : public ::testing::Test {
 protected:
  void expect_all(const json& source, const fs::path& file) {
    const RelationReport report = check_relations(source, file, shipped_steps);
    for (const std::string& broken : report.broken) ADD_FAILURE() << file << ": " << broken;
    for (const auto& [name, count] : report.held) held_[name] += count;
    vague_ += report.vague;
  }
  // So that none is left out unseen.
  void expect_each(std::int64_t least) const {
    for (const Relation& relation : relations()) EXPECT_GE(held(relation.name), least) << relation.name;
    for (const char* bits : {"with two threads", "beside itself", "resumed", "with contacts one by one",
                             "without skipping", "with parameters in reverse order"})
      EXPECT_GE(held(bits), least) << bits;
  }
  std::int64_t held(const std::string& name) const {
    const auto found = held_.find(name);
    return found == held_.end() ? 0 : found->second;
  }
  std::int64_t all_held() const {
    std::int64_t sum = 0;
    for (const auto& [name, count] : held_) sum += count;
    return sum;
  }

  std::map<std::string, std::int64_t> held_;
  std::int64_t vague_ = 0;
};

TEST_F(Relations, HoldForShippedScenes) {
  for (const fs::path& file : scene_files::all()) expect_all(read_scene_source(file), file);
  expect_each(5);
  EXPECT_GE(all_held(), 500);
  EXPECT_LE(vague_, 30);
}

// Relations that once were said to be broken: a node passed a plane that should be out of reach, and another
// one sticks or not by the rounding of its opening, which one twin did not show. A third breaks by a rounding
// of the shifted scene, which no twin of the scene shows. In the last one two directions are alike, which the
// law cannot see of tables: it asks for a tangent.
TEST_F(Relations, HoldForScenesThatFailed) {
  for (const char* name : {"goes_ten_thousand_lengths", "rough_bond_without_pressure", "tie_without_strength",
                           "directions_alike"}) {
    const fs::path file = fs::path(ILAW_SOURCE) / "tests/host/stress_scenes" / (std::string(name) + ".json");
    expect_all(json_of(file), file);
  }
  EXPECT_GE(held("with a contact out of reach at the same nodes"), 1);
}

// A spun sphere, a driven plane and a wedge of two planes: memory that turns, obstacles that accelerate, and
// contacts that share a node.
TEST_F(Relations, HoldForEveryLaw) {
  const json carriers = json_of(fs::path(ILAW_SOURCE) / "tests/host/carriers.json");
  std::vector<ilaw::testing::LawCase> cases = ilaw::testing::law_cases("properties");
  for (const ilaw::testing::LawCase& stiff : ilaw::testing::law_cases("stiff")) cases.push_back(stiff);
  for (const ilaw::testing::LawCase& one : cases)
    for (const auto& [name, carrier] : carriers.items()) {
      json scene = carrier;
      for (json& interface : scene["interfaces"]) {
        interface["law"] = one.law;
        interface["parameters"] = one.more.value("parameters", json::object());
      }
      try {
        read_scene(scene, name);
      } catch (const SceneError&) {
        continue;  // a law of another dimension
      }
      expect_all(scene, name + " x " + one.name);
    }
  expect_each(60);
  EXPECT_GE(all_held(), 1500);
  EXPECT_LE(vague_, 120);
}

}  // namespace
}  // namespace ilaw::host::testing
