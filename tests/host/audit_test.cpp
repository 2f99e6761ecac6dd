// `ilaw run --audit`: each planted fault is found by step, node and quantity. All scenes of the other tests
// pass it (host_runner.hpp).
#include "host_runner.hpp"

namespace ilaw::host::testing {
namespace {

json resting(const char* law) {
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 1, "points": [
      {"mass": 2, "position": [1]}, {"mass": 2, "position": [0], "velocity": [-0.1]}]},
      "time": {"dt": 1, "end": 5}, "loads": [{"type": "gravity", "acceleration": [-0.001]}],
      "interfaces": [{"name": "floor", "nodes": [1],
                      "obstacle": {"type": "plane", "point": [0], "normal": [1]}}]})");
  scene["interfaces"][0]["law"] = law;
  if (law == std::string("broken")) scene["interfaces"][0]["library"] = ILAW_BROKEN_LAW;
  return scene;
}

struct Planted {
  const char *broken, *found;
};
std::ostream& operator<<(std::ostream& out, const Planted& one) { return out << one.broken; }

class AuditFinds : public ::testing::TestWithParam<Planted> {};

TEST_P(AuditFinds, WhatALawDoesWrong) {
  const std::string setting = std::string("ILAW_BROKEN=") + GetParam().broken + " ";
  EXPECT_THAT(run_scene(resting("broken"), fresh_folder(), "--audit", setting),
              Exits(1, AllOf(HasSubstr("audit: step "), HasSubstr(GetParam().found))));
}
INSTANTIATE_TEST_SUITE_P(
    Host, AuditFinds,
    ::testing::Values(
        Planted{"other_start", "0, time 0: node 1, interface 'floor' (law 'broken'): impulse: found "},
        Planted{"other_answer", "3, time 3: node 1, interface 'floor' (law 'broken'): impulse: found "},
        Planted{"other_digits", "3, time 3: node 1, interface 'floor' (law 'broken'): impulse: found "},
        Planted{"other_gap", "3, time 3: node 1, interface 'floor' (law 'broken'): impulse: found "},
        Planted{"pull", "3, time 3: node 1, interface 'floor' (law 'broken'): cone: the impulse -1 pulls"},
        Planted{"lets_in", "4, time 4: node 1, interface 'floor' (law 'broken'): gap: it is "},
        Planted{"creeps_in", "4, time 4: node 1, interface 'floor' (law 'broken'): gap: it is "},
        Planted{"other_energy", "3, time 3: interface 'floor' (law 'broken'): energy: part "}),
    [](const auto& drawn) { return std::string(drawn.param.broken); });

// The start of a run as if its scene were another.
std::string audit_of(const json& run, const json& as) {
  Scene scene = scene_of(run), other = scene_of(as);
  host::Integrator integrator = unaudited(scene);
  Audit audit(other, integrator);
  try {
    audit.open();
    integrator.start();
    audit.close();
  } catch (const AuditFailure& failure) {
    return failure.what();
  }
  return "";
}

// A run that has the loads, or leaves out the interfaces, of another scene.
TEST(AuditFinds, AForceThatIsNotThere) {
  json more = resting("contact");
  more["loads"][0]["acceleration"] = {-0.0010001};
  EXPECT_THAT(audit_of(resting("contact"), more),
              StartsWith("audit: step 0, time 0: node 0: momentum along axis 0"));
  json none = resting("contact");
  none["interfaces"] = json::array();
  EXPECT_THAT(audit_of(resting("contact"), none),
              StartsWith("audit: step 0, time 0: node 1: momentum along axis 0"));
}

TEST(AuditFinds, AnEquilibriumOfOtherLoads) {
  json pressed = until_at_cfl(
      1.0, 0.9,
      scene_of_bars({bar("b", 0, 1, 4, 100, 1)},
                    {named("floor", law_on("b.left", plane({0}, {1}), "contact"))}, {gravity({-10})}));
  pressed["prestress"] = json::object();
  json heavier = pressed;
  heavier["loads"][0]["acceleration"] = {-10.01};
  Scene scene = scene_of(pressed), other = scene_of(heavier);
  host::Integrator integrator(*scene.model, other.loads, scene.interfaces, scene.dt, scene.prestress);
  Audit audit(scene, integrator);
  integrator.find_equilibrium();
  try {
    audit.open();
    FAIL();
  } catch (const AuditFailure& failure) {
    EXPECT_THAT(failure.what(), StartsWith("audit: prestress: forces: of "));
  }
}

}  // namespace
}  // namespace ilaw::host::testing
