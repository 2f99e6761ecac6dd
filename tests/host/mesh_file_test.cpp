// Files of meshes: sets that they name, mistakes that are refused, and files that are damaged in any way.
#include "run_result.hpp"

#include "mesh_writer.hpp"
#include "model/mesh_topology.hpp"
#include "scene/read_meshes.hpp"

namespace ilaw::host::testing::mesh_file {
namespace {

json scene_with(const std::string& file) {
  return {{"model",
           {{"type", "solids"},
            {"meshes",
             {{{"name", "b"},
               {"file", file},
               {"material", {{"type", "linear"}, {"young", 1e6}, {"poisson", 0.3}, {"density", 1000.0}}}}}}}},
          {"time", {{"cfl", 0.9}, {"end", 0.1}}},
          {"interfaces", json::array()}};
}

std::string refusal_of_mesh(const WrittenMesh& mesh) {
  const MeshFile file(mesh);
  return refusal_of(scene_with(file.path()));
}

WrittenMesh two_cells() { return box_mesh({2, 1, 1}, {2, 1, 1}, false); }

void expect_refusal(const std::string& found, const std::string& expected) {
  EXPECT_EQ(found.rfind("/model/meshes/0/file: ", 0), 0U) << found;
  EXPECT_THAT(found, HasSubstr(expected));
}

// ---- what is refused ------------------------------------------------------------------------------------

// Nothing in a file of the legacy format tells whether its end is missing.
TEST(MeshFile, ThatCannotBeReadIsRefused) {
  const auto changed = [](const char* from, const char* to) {
    std::string text = two_cells().vtu();
    return text.replace(text.rfind(from), std::string(from).size(), to);
  };
  expect_refusal(refusal_of(scene_with("nowhere.vtu")), "nowhere.vtu: no such file, expected a mesh");
  expect_refusal(refusal_of(scene_with("/tmp")), "found no file, expected a mesh");
  for (
      const auto& [name, text, expected] : std::vector<std::array<std::string, 3>>{
          {"part.msh", "$MeshFormat\n",
           "found the extension '.msh', expected .vtu; `meshio convert mesh.msh mesh.vtu` writes one (Debian package "
           "python3-meshio)"},
          {"part.vtk", "# vtk DataFile Version 3.0\n", "`meshio convert mesh.vtk mesh.vtu` writes one"},
          {"mesh.vtu", changed("12 12", "12 13"),
           "cell 1: found VTK's cell type 13, expected elements with 4 or 8 nodes (types 10, 12)"},
          {"mesh.vtu", changed("8 16", "7 16"), "cell 0: found 7 nodes, expected 8"}}) {
    const MeshFile file(text, name);
    expect_refusal(refusal_of(scene_with(file.path())), expected);
  }
}

TEST(MeshFile, ThatMakesNoBodyIsRefusedWithThePlace) {
  struct Mistake {
    bool tetrahedra;
    std::function<void(WrittenMesh&)> make;
    const char* expected;
  };
  const auto swap_in = [](std::size_t cell) {
    return [cell](WrittenMesh& mesh) { std::swap(mesh.cells[cell].nodes[0], mesh.cells[cell].nodes[1]); };
  };
  const auto node_is = [](int node) { return [node](WrittenMesh& mesh) { mesh.cells[1].nodes[3] = node; }; };
  for (const auto& [tetrahedra, make, expected] : std::vector<Mistake>{
           {false, swap_in(1), "cell 1: found the scaled Jacobian -"},
           {true, swap_in(4), "cell 4: found the scaled Jacobian -"},
           {true, [](WrittenMesh& mesh) { mesh.nodes[7] = mesh.nodes[3]; },
            "cell 0: found the scaled Jacobian "},
           {false, [](WrittenMesh& mesh) { mesh.nodes.emplace_back(5, 5, 5); },
            "node 12: found in no element, expected every node in one"},
           {false, node_is(12), "cell 1: found node 12, expected 0 to 11"},
           {false, node_is(-1), "cell 1: found node -1, expected 0 to 11"},
           {false, node_is(2147483647), "cell 1: found node 2147483647, expected 0 to 11"},
           {false, [](WrittenMesh& mesh) { mesh.cells.insert(mesh.cells.end(), 2, MeshCell(mesh.cells[1])); },
            "found one face in all of them, expected a face in at most two elements"},
           {false,
            [](WrittenMesh& mesh) {
              mesh.cells.push_back({CellKind::triangle, {0, 1, 11, 0, 0, 0, 0, 0}});
            },
            "cell 2: found a triangle that is a face of no element, expected one"},
           {false,
            [](WrittenMesh& mesh) {
              mesh.cells = {{CellKind::quadrangle, {0, 1, 4, 3, 0, 0, 0, 0}}};
            },
            "found no elements, expected tetrahedra or hexahedra"},
           {false,
            [](WrittenMesh& mesh) {
              mesh.of_cells["boundary"] = {0, 1};
            },
            "array 'boundary': found the name of a set that every mesh has"}}) {
    WrittenMesh mesh = tetrahedra ? box_mesh({1, 1, 1}, {1, 1, 1}, true) : two_cells();
    make(mesh);
    expect_refusal(refusal_of_mesh(mesh), expected);
  }
}

// Without its last byte the mesh is the same: the file ends with a line feed.
TEST(MeshFile, ThatIsCutOffIsRefused) {
  for (const char* name : {"arch.vtu", "bracket.vtu"}) {
    const MeshFile file(text_of(fs::path(ILAW_SOURCE) / "tests/host/analyst_scenes" / name));
    const MeshData whole = read_mesh_file(file.path());
    std::uintmax_t size = fs::file_size(file.path());
    fs::resize_file(file.path(), --size);
    EXPECT_EQ(read_mesh_file(file.path()).nodes, whole.nodes);
    while (size > 0) {
      fs::resize_file(file.path(), --size);
      EXPECT_THROW(read_mesh_file(file.path()), MeshError) << name << " of " << size << " bytes";
    }
    expect_refusal(refusal_of(scene_with(file.path())), "the file is damaged: it does not end with");
  }
}

TEST(MeshFile, WithoutTheSetOfASceneNamesThoseThereAre) {
  const MeshFile file(two_cells());
  json scene = scene_with(file.path());
  scene["loads"] = {{{"type", "pressure"}, {"surface", "b.top"}, {"history", {{0, 1}}}}};
  EXPECT_EQ(
      refusal_of(scene),
      "/loads/0/surface: found \"b.top\", expected one of b.boundary, b.x_max, b.x_min, b.y_max, b.y_min, "
      "b.z_max, b.z_min");
}

// ---- sets -----------------------------------------------------------------------------------------------

TEST(MeshFile, NamesSetsByArraysOfIntegers) {
  WrittenMesh mesh = box_mesh({2, 1, 1}, {2, 1, 1}, true);
  const auto elements = static_cast<int>(mesh.cells.size());
  mesh.cells.push_back({CellKind::triangle, {0, 1, 4, 0, 0, 0, 0, 0}});  // of z = 0, seen from inside
  mesh.cells.push_back({CellKind::vertex, {5, 0, 0, 0, 0, 0, 0, 0}});
  mesh.of_cells["gmsh:physical"].assign(mesh.cells.size(), 3);
  mesh.of_cells["gmsh:physical"][static_cast<std::size_t>(elements)] = 7;
  mesh.of_cells["gmsh:physical"].back() = 0;
  mesh.of_nodes["left"].assign(12, 0);
  for (const int node : {0, 3, 6, 9}) mesh.of_nodes["left"][static_cast<std::size_t>(node)] = 1;
  const MeshFile file(mesh);
  const Scene scene = scene_of(scene_with(file.path()).dump());
  const auto& sets = scene.model->sets();
  const NodeSet& physical = sets.at("b.gmsh_physical_7");
  EXPECT_EQ(physical.nodes, (std::vector<int>{0, 1, 4}));
  ASSERT_EQ(physical.facets.size(), 1U);
  // Counter-clockwise seen from outside, which is from below.
  const auto& facet = physical.facets[0];
  const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(facet[k])]; };
  EXPECT_LT((at(1) - at(0)).cross(at(2) - at(0))[2], 0.0);
  for (const double area : physical.areas) EXPECT_NEAR(area, 0.5 / 3.0, 1e-15);
  EXPECT_EQ(sets.at("b.gmsh_physical_3").nodes.size(), 12U);
  EXPECT_EQ(sets.at("b.gmsh_physical_3").facets.size(), sets.at("b.boundary").facets.size());
  EXPECT_EQ(sets.at("b.left").nodes, (std::vector<int>{0, 3, 6, 9}));
  EXPECT_EQ(sets.at("b.left").facets.size(), 2U);
  EXPECT_EQ(sets.count("b.left_1"), 0U);
}

TEST(MeshFile, WithTwoArraysForOneSetIsRefused) {
  WrittenMesh mesh = two_cells();
  mesh.of_cells["a b"] = {1, 0};
  mesh.of_cells["a_b"] = {0, 1};
  expect_refusal(refusal_of_mesh(mesh), "found two arrays or values for the set 'a_b', expected one");
  mesh.of_cells.erase("a_b");
  mesh.of_nodes["a_b"].assign(12, 1);
  EXPECT_EQ(refusal_of_mesh(mesh), "not refused");  // sets of nodes and of cells may share a name
}

// Numbers of nodes are no names.
TEST(MeshFile, DoesNotNameASetPerNode) {
  WrittenMesh mesh = box_mesh({10, 10, 10}, {1, 1, 1}, false);
  for (int node = 0; node < 1331; ++node) mesh.of_nodes["id"].push_back(node);
  const MeshFile file(mesh);
  EXPECT_TRUE(read_mesh_file(file.path()).groups.empty());
}

// ---- the program ----------------------------------------------------------------------------

TEST(MeshFile, IsRelativeToTheSceneAndTold) {
  const MeshFile file(box_mesh({2, 2, 2}, {1, 1, 1}, true));
  const auto folder = file.path().parent_path();
  std::ofstream(folder / "scene.json") << scene_with("mesh.vtu").dump();
  const Outcome outcome =
      run_command("cd / && " + std::string(ILAW_PROGRAM) + " run " + (folder / "scene.json").string() +
                  " --out " + (folder / "out").string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(outcome.output.rfind("b from mesh.vtu: 27 nodes, 48 tetrahedra; critical step ", 0), 0U)
      << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("; worst element: cell "));
  EXPECT_THAT(outcome.output, HasSubstr("scaled Jacobian 0.5774; sets (facets): boundary (48) x_max (8)"));
  const json summary = json_of(folder / "out" / "summary.json");
  EXPECT_EQ(summary["meshes"][0]["tetrahedra"], 48);
  EXPECT_NEAR(summary["meshes"][0]["sets"]["boundary"]["area"].get<double>(), 6.0, 1e-14);
}

TEST(MeshFile, TellsOfPartsThatShareNoNode) {
  WrittenMesh mesh = two_cells();
  const WrittenMesh other = box_mesh({1, 1, 1}, {1, 1, 1}, false);
  for (const Eigen::Vector3d& node : other.nodes) mesh.nodes.push_back(node + Eigen::Vector3d(2, 0, 0));
  MeshCell cell = other.cells[0];
  for (int& node : cell.nodes) node += 12;
  mesh.cells.push_back(cell);
  const MeshFile file(mesh);
  EXPECT_EQ(scene_of(scene_with(file.path()).dump()).meshes[0]["parts"], 2);
}

TEST(MeshFile, CannotBeRefined) {
  const MeshFile file(two_cells());
  json scene = scene_with(file.path());
  scene["converge"] = {{"refine", "mesh"}};
  scene["exact"] = {{"type", "held_rod"}};
  std::ofstream(file.path().parent_path() / "scene.json") << scene.dump();
  EXPECT_THAT(run_program("converge " + (file.path().parent_path() / "scene.json").string() + " --out " +
                          (file.path().parent_path() / "out").string()),
              Exits(2, HasSubstr("a mesh from a file cannot be refined")));
}

TEST(MeshFile, WarnsOfTetrahedraThatLock) {
  const MeshFile file(box_mesh({1, 1, 1}, {1, 1, 1}, true));
  json scene = scene_with(file.path());
  json& mesh = scene["model"]["meshes"][0];
  mesh["material"]["poisson"] = 0.45;
  ASSERT_EQ(scene_of(scene).warnings.size(), 1U);
  EXPECT_EQ(
      scene_of(scene).warnings[0],
      "/model/meshes/0/material/poisson: found 0.45, at which full tetrahedra can hardly bend; \"element\": "
      "\"mean_dilatation\" can");
  mesh["element"] = "mean_dilatation";
  EXPECT_TRUE(scene_of(scene).warnings.empty());
}

// ---- damage ---------------------------------------------------------------------------------------------

std::string damaged(std::string text, std::mt19937_64& random) {
  for (std::size_t edits = 1 + random() % 4; edits > 0; --edits) {
    const std::size_t at = random() % text.size();
    switch (random() % 4) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text[at] = "0123456789-e."[random() % 13];
        break;
      case 2:
        text.erase(at, 1 + random() % 20);
        break;
      default:
        text.insert(at, std::to_string(random() >> (random() % 64)));
        break;
    }
  }
  return text;
}

// Whatever the bytes are, a mesh is read or refused; address sanitizers see that nothing else happens.
TEST(MeshFile, SurvivesDamage) {
  WrittenMesh mesh = two_cells();
  mesh.of_cells["part"] = {1, 2};
  const std::string text = mesh.vtu();
  constexpr int cases = 1500;
  std::mt19937_64 random(1);
  int refused = 0;
  for (int k = 0; k < cases; ++k) {
    const MeshFile file(damaged(text, random));
    try {
      topology_of(read_mesh_file(file.path()));
    } catch (const MeshError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, cases / 4);
}

}  // namespace
}  // namespace ilaw::host::testing::mesh_file
