// A mistake in a scene is answered with the JSON pointer, what was found and what is allowed.
#include "host_runner.hpp"

#include <nlohmann/json.hpp>

namespace ilaw::host::testing {
namespace {

using nlohmann::json;

json good_scene() {
  return json::parse(R"({"model": {"type": "points", "dimension": 2,
      "points": [{"mass": 1.0, "position": [0.0, 1.0]}, {"mass": 1.0, "position": [1.0, 1.0]}]},
    "time": {"dt": 1e-3, "end": 0.1},
    "loads": [{"type": "gravity", "acceleration": [0.0, -10.0]}],
    "interfaces": [{"law": "coulomb", "parameters": {"friction": 0.1}, "nodes": "all",
                    "obstacle": {"type": "plane", "point": [0.0, 0.0], "normal": [0.0, 1.0]}}],
    "output": {"every": 1, "watch": [0]}})");
}

std::string refusal_of(const std::string& text) {
  try {
    scene_of(text);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "not refused";
}

struct Mistake {
  const char* pointer;  // where a value is put
  const char* value;
  const char* message;  // how the refusal begins

  friend void PrintTo(const Mistake& mistake, std::ostream* out) {
    *out << mistake.pointer << " = " << mistake.value;
  }
};

class Mistakes : public ::testing::TestWithParam<Mistake> {};

TEST_P(Mistakes, AreNamedWithPointerFoundAndAllowed) {
  json scene = good_scene();
  scene[json::json_pointer(GetParam().pointer)] = json::parse(GetParam().value);
  const std::string refusal = refusal_of(scene.dump());
  EXPECT_EQ(refusal.substr(0, std::string(GetParam().message).size()), GetParam().message) << refusal;
}

INSTANTIATE_TEST_SUITE_P(
    Scene, Mistakes,
    ::testing::Values(
        Mistake{"/interface", "[]",
                "/interface: unknown key, expected one of: converge, doc, exact, interfaces, loads, model, "
                "output, time, "
                "title (did you mean "
                "'interfaces'?)"},
        Mistake{"/model/type", "\"bar\"", "/model/type: found \"bar\", expected one of \"points\""},
        Mistake{"/model/dimension", "4", "/model/dimension: found 4, expected integer >= 1 <= 3"},
        Mistake{"/model/points/1/mass", "0", "/model/points/1/mass: found 0, expected number > 0"},
        Mistake{"/model/points/1/mass", "\"heavy\"",
                "/model/points/1/mass: found \"heavy\", expected number > 0"},
        Mistake{"/model/points/1/position", "[1.0]",
                "/model/points/1/position: found 1 components, expected 2, the dimension of the model"},
        Mistake{"/time/dt", "-1", "/time/dt: found -1, expected number > 0"},
        Mistake{"/time/cfl", "0.5", "/time: found both 'dt' and 'cfl', expected one of 'dt' and 'cfl'"},
        Mistake{"/time/end", "1e300", "/time: end/dt is"},
        Mistake{"/loads/0/type", "\"wind\"",
                "/loads/0/type: found \"wind\", expected one of \"gravity\", \"force\", \"shock\""},
        Mistake{"/loads/0/direction", "[1, 0]",
                "/loads/0/direction: unknown key, expected one of: acceleration, nodes, type"},
        Mistake{"/loads/0/nodes", "[7]", "/loads/0/nodes/0: found node 7, expected 0 to 1"},
        Mistake{"/interfaces/0/nodes", "[0, 2]", "/interfaces/0/nodes/1: found node 2, expected 0 to 1"},
        Mistake{"/interfaces/0/nodes", "[0, 0]",
                "/interfaces/0/nodes/1: found node 0 twice, expected each node once"},
        Mistake{"/interfaces/0/nodes", "\"some\"",
                "/interfaces/0/nodes: found \"some\", expected one of all"},
        Mistake{"/interfaces/0/law", "\"glue\"",
                "/interfaces/0/law: 'glue': no glue.so found, expected it in one of: "},
        Mistake{"/interfaces/0/library", "\"./nowhere.so\"", "/interfaces/0/library: "},
        Mistake{"/interfaces/0/parameters/friction", "-1",
                "/interfaces/0/parameters: law 'coulomb': parameter 'friction' = -1 is not allowed: expected "
                "a number in [0, inf]"},
        Mistake{"/interfaces/0/parameters/fricton", "1",
                "/interfaces/0/parameters: law 'coulomb': unknown parameter 'fricton': expected one of "
                "friction, "},
        Mistake{"/interfaces/0/parameters/friction", "[1]",
                "/interfaces/0/parameters/friction: found [1], expected a number or \"inf\""},
        Mistake{"/interfaces/0/parameters/friction", "{\"per_node\": [0.1]}",
                "/interfaces/0/parameters/friction/per_node: found 1 values, expected 2, one per node of the "
                "interface"},
        Mistake{"/interfaces/0/obstacle/normal", "[0, 0]",
                "/interfaces/0/obstacle/normal: found a vector of length 0, expected a direction"},
        Mistake{"/output/watch", "[2]", "/output/watch/0: found node 2, expected 0 to 1"},
        Mistake{"/output/every", "0", "/output/every: found 0, expected integer >= 1"},
        Mistake{"/output/every", "1.5", "/output/every: found 1.5, expected integer >= 1"}));

TEST(Scene, WithAMissingKeyIsRefused) {
  json scene = good_scene();
  scene["interfaces"][0].erase("nodes");
  EXPECT_EQ(refusal_of(scene.dump()).substr(0, 44), "/interfaces/0: key 'nodes' is missing, found");
}

TEST(Scene, ThatIsNoJsonIsRefused) {
  EXPECT_NE(refusal_of("{").find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusal_of(R"({"time": {"dt": 1e999}})").find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusal_of(R"({"time": {}, "time": {}})").find("key 'time' appears twice"), std::string::npos);
}

TEST(Scene, TakesInfinityTablesAndValuesPerNode) {
  for (const char* friction :
       {"\"inf\"", "{\"table\": [[0, 0.1], [1, 0.5]]}", "{\"per_node\": [0.1, \"inf\"]}"}) {
    json scene = good_scene();
    scene["interfaces"][0]["parameters"]["friction"] = json::parse(friction);
    Scene read = scene_of(scene.dump());
    Integrator integrator = integrator_of(read);
    EXPECT_NO_THROW(while (integrator.steps() < read.steps) integrator.step());
  }
}

}  // namespace
}  // namespace ilaw::host::testing
