// Rules of inclusion (docs/architecture.md): a lower layer knows nothing of those above it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace {

namespace fs = std::filesystem;

// The folders of host_mock from the ground up: each may include itself and those before it.
const std::vector<std::string> floors = {
    "host/base",    "host/mortar",       "host/model",         "host/contact",      "host/step", "host/scene",
    "host/results", "instruments/audit", "instruments/stress", "instruments/bench", "cli"};

std::string first_folder(const std::string& path) { return path.substr(0, path.find('/')); }

// The floor of a folder, as includes name it: without its room.
auto floor_of(const std::string& folder) {
  return std::find_if(floors.begin(), floors.end(),
                      [&](const std::string& floor) { return fs::path(floor).filename() == folder; });
}

std::string complaint_of_host(const std::string& inside, const std::string& header, bool quoted) {
  if (header.starts_with("ilaw/kit"))
    return "the kit is for authors of laws, hosts need ilaw.h and the loader";
  if (!quoted) return "";
  if (inside.starts_with("minimal/"))
    return header == "minimal.hpp" ? "" : "the minimal host has nothing of the reference host";
  const std::string from = fs::path(inside).parent_path().filename(), to = first_folder(header);
  if (header == "check/units.hpp" && from == "stress") return "";
  if (to == "check") return from == "cli" ? "" : "only a command knows the checker";
  if (floor_of(to) == floors.end()) return "no such floor";
  return floor_of(to) > floor_of(from) ? "runs up from " + from + " to " + to : "";
}

std::string complaint_of_api(const std::string& inside, const std::string& header, bool quoted) {
  if (header.find("host_mock") != std::string::npos ||
      (quoted && floor_of(first_folder(header)) != floors.end()))
    return "the interface knows no host";
  if (quoted && first_folder(header) == "check" && first_folder(inside) != "check")
    return "the interface knows no checker";
  const std::set<std::string> of_search = {"ilaw/ilaw.h", "ilaw/search.h", "ilaw/arrays.hpp",
                                           "ilaw/sized.hpp"};
  if (inside.starts_with("search/") && header.starts_with("ilaw/") && !of_search.contains(header))
    return "the search knows neither laws nor their solver";
  const bool of_laws = inside.starts_with("include/ilaw/kit");
  return !of_laws && header.starts_with("ilaw/kit") ? "the loader knows no kit" : "";
}

std::string complaint_of_law(const std::string& header, bool quoted) {
  const bool is_bond = header.starts_with("../bond/");  // what cohesive and rccm share
  if (quoted) return header.find('/') != std::string::npos && !is_bond ? "a law stays in its folder" : "";
  if (!header.starts_with("ilaw/") || header == "ilaw/ilaw.h" || header == "ilaw/kit.hpp" ||
      header == "ilaw/plain_c.h")
    return "";
  static const std::regex public_kit("ilaw/kit/[^/]+\\.hpp");
  return std::regex_match(header, public_kit) ? "" : "a law includes the kit's public headers alone";
}

// Empty where a file of the tree may include a header.
std::string complaint(const std::string& file, const std::string& header, bool quoted) {
  const auto inside = [&](const std::string& folder) { return file.substr(folder.size()); };
  for (const std::string folder : {"host_mock/", "api/", "plugins/"}) {
    if (!file.starts_with(folder)) continue;
    if (folder == "api/") return complaint_of_api(inside(folder), header, quoted);
    return folder == "plugins/" ? complaint_of_law(header, quoted)
                                : complaint_of_host(inside(folder), header, quoted);
  }
  return "";
}

std::vector<std::string> complaints_of(const fs::path& file, const std::string& name) {
  static const std::regex include("\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  std::vector<std::string> complaints;
  std::ifstream stream(file);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    std::smatch found;
    if (!std::regex_match(line, found, include)) continue;
    const std::string said = complaint(name, found[2], found[1] == "\"");
    if (!said.empty())
      complaints.push_back(name + ":" + std::to_string(number) + ": " + found[2].str() + ": " + said);
  }
  return complaints;
}

TEST(Layers, NoIncludeRunsUp) {
  const fs::path root = ILAW_SOURCE;
  std::string all;
  int files = 0;
  for (const char* folder : {"host_mock", "api", "plugins"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".cpp" && extension != ".hpp" && extension != ".h" && extension != ".c") continue;
      ++files;
      for (const std::string& said : complaints_of(entry.path(), fs::relative(entry.path(), root)))
        all += said + "\n";
    }
  EXPECT_EQ(all, "");
  EXPECT_GT(files, 90);
}

TEST(Layers, EveryFolderOfTheHostIsAFloor) {
  for (const std::string room : {"host", "instruments"})
    for (const auto& entry : fs::directory_iterator(fs::path(ILAW_SOURCE) / "host_mock" / room))
      EXPECT_NE(std::find(floors.begin(), floors.end(), room + "/" + entry.path().filename().string()),
                floors.end())
          << entry.path();
}

// The public headers of the kit, from the ground up; those of a room may include each other, not in a circle.
const std::vector<std::vector<std::string>> kit_rooms = {
    {"pack", "math", "vector", "roots", "table"},
    {"law", "node"},
    {"local_coulomb", "friction", "changing_friction", "tangential_spring", "rolling", "rigid_bond",
     "window"},
    {"plugin"}};

std::size_t room_of(const std::string& header) {
  for (std::size_t room = 0; room < kit_rooms.size(); ++room)
    for (const std::string& name : kit_rooms[room])
      if (header == "ilaw/kit/" + name + ".hpp") return room;
  return kit_rooms.size();
}

std::vector<std::string> kit_includes_of(const fs::path& file) {
  static const std::regex include("#include <(ilaw/kit/[^>]+)>");
  std::vector<std::string> headers;
  std::ifstream stream(file);
  std::smatch found;
  for (std::string line; std::getline(stream, line);)
    if (std::regex_search(line, found, include)) headers.push_back(found[1]);
  return headers;
}

// Numbers know nothing of laws, laws nothing of mechanics; the machinery is included by the entry alone, but
// for packs in memory, where windows stand.
TEST(Layers, RoomsOfTheKitStandOnEachOther) {
  const fs::path include = fs::path(ILAW_SOURCE) / "api/include";
  for (const auto& entry : fs::directory_iterator(include / "ilaw/kit")) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), include).string();
    ASSERT_LT(room_of(name), kit_rooms.size()) << name << " stands in no room";
    for (const std::string& header : kit_includes_of(entry.path())) {
      if (header.starts_with("ilaw/kit/detail/") || header.starts_with("ilaw/kit/device/"))
        EXPECT_TRUE(name.ends_with("/plugin.hpp") || header.ends_with("/load_store.hpp"))
            << name << ": " << header;
      else
        EXPECT_LE(room_of(header), room_of(name)) << name << ": " << header;
    }
  }
}

// `using namespace ilaw::kit` brings in nothing of the machinery.
TEST(Layers, MachineryOfTheKitHasANamespaceOfItsOwn) {
  int namespaces = 0;
  for (const char* room : {"detail", "device"})
    for (const auto& entry : fs::directory_iterator(fs::path(ILAW_SOURCE) / "api/include/ilaw/kit" / room)) {
      std::ifstream stream(entry.path());
      for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with("namespace ")) continue;
        ++namespaces;
        EXPECT_EQ(line, "namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {") << entry.path();
      }
    }
  EXPECT_GT(namespaces, 10);
}

// The page lists the kit's headers by layers.
TEST(Layers, PageNamesEveryHeaderOfTheKit) {
  std::ifstream stream(fs::path(ILAW_SOURCE) / "docs/architecture.md");
  const std::string page(std::istreambuf_iterator<char>(stream), {});
  const std::size_t first = page.find("kit.hpp, plugin"), last = page.find("```", first);
  ASSERT_NE(last, std::string::npos);
  std::set<std::string> named, found;
  static const std::regex name("[a-z_0-9]+");
  const std::string list = page.substr(first, last - first);
  for (std::sregex_iterator k(list.begin(), list.end(), name), end; k != end; ++k) named.insert(k->str());
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(ILAW_SOURCE) / "api/include/ilaw/kit"))
    if (entry.is_regular_file()) {
      found.insert(entry.path().stem());
      EXPECT_TRUE(named.contains(entry.path().stem())) << entry.path() << " is not in docs/architecture.md";
    }
  EXPECT_GT(found.size(), 25U);
}

// The test itself: what it must refuse, and what not.
TEST(Layers, IncludesThatRunUpAreSeen) {
  const std::vector<std::tuple<std::string, std::string, bool, bool>> cases = {
      {"host_mock/host/step/integrator.cpp", "scene/scene.hpp", true, false},
      {"host_mock/host/scene/scene.cpp", "step/energy.hpp", true, true},
      {"host_mock/host/base/files.cpp", "cli/commands.hpp", true, false},
      {"host_mock/cli/run.cpp", "base/files.hpp", true, true},
      {"host_mock/host/model/bars.cpp", "attic/bars.hpp", true, false},
      {"host_mock/host/contact/law.cpp", "ilaw/kit/node.hpp", false, false},
      {"host_mock/host/contact/law.cpp", "ilaw/loader.hpp", false, true},
      {"host_mock/host/results/history.cpp", "stress/stress.hpp", true, false},
      {"host_mock/instruments/stress/stress.cpp", "check/check.hpp", true, false},
      {"host_mock/cli/check.cpp", "check/check.hpp", true, true},
      {"api/check/report.cpp", "check/check.hpp", true, true},
      {"api/check/report.cpp", "base/files.hpp", true, false},
      {"api/loader/library.cpp", "check/check.hpp", true, false},
      {"api/loader/library.cpp", "base/files.hpp", true, false},
      {"api/loader/library.cpp", "ilaw/kit.hpp", false, false},
      {"api/search/search.cpp", "ilaw/search.h", false, true},
      {"api/search/search.cpp", "ilaw/coupled.h", false, false},
      {"api/search/finder.cpp", "base/files.hpp", true, false},
      {"host_mock/host/contact/mesh_surface.cpp", "ilaw/search.h", false, true},
      {"host_mock/host/contact/mortar_surface.cpp", "mortar/facet_overlap.hpp", true, true},
      {"host_mock/host/mortar/polygon.cpp", "model/model.hpp", true, false},
      {"api/include/ilaw/kit/plugin.hpp", "ilaw/kit/detail/instance.hpp", false, true},
      {"plugins/tie/tie.cpp", "ilaw/kit/detail/gather.hpp", false, false},
      {"plugins/tie/tie.cpp", "ilaw/kit/window.hpp", false, true},
      {"plugins/tie/tie.cpp", "../cohesive/root.hpp", true, false},
      {"plugins/tie/tie.cpp", "cmath", false, true}};
  for (const auto& [file, header, quoted, allowed] : cases)
    EXPECT_EQ(complaint(file, header, quoted).empty(), allowed) << file << " includes " << header;
}

}  // namespace
