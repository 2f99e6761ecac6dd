// program_runner.hpp - the `ilaw` program in a process of its own, and folders for it.
#pragma once

#include "support/program.hpp"

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace ilaw::host::testing {

namespace fs = std::filesystem;
using namespace ilaw::testing::programs;
using nlohmann::json;

// before: for the shell, as "ulimit -f 100; ".
inline Outcome run_program(const std::string& arguments, const std::string& before = "") {
  return run_command(before + ILAW_PROGRAM + " " + arguments);
}

inline json json_of(const fs::path& file) { return json::parse(text_of(file)); }

// An empty folder, removed when the program ends.
inline fs::path fresh_folder() {
  struct Folders : std::vector<fs::path> {
    ~Folders() {
      std::error_code ignored;
      for (const fs::path& folder : *this) fs::remove_all(folder, ignored);
    }
  };
  static Folders folders;
  const std::string name = "ilaw_test_" + std::to_string(getpid()) + "_" + std::to_string(folders.size());
  folders.push_back(fs::temp_directory_path() / name);
  fs::remove_all(folders.back());  // of a process with this number that was killed
  fs::create_directories(folders.back());
  return folders.back();
}

// The scene in a file of the folder.
inline std::string written(const json& scene, const fs::path& folder) {
  std::ofstream(folder / "scene.json") << scene.dump();
  return folder / "scene.json";
}

// `ilaw run` on a scene: the scene and its results in a folder.
inline Outcome run_scene(const json& scene, const fs::path& folder = fresh_folder(),
                         const std::string& options = "", const std::string& before = "") {
  return run_program("run " + written(scene, folder) + " --out " + folder.string() + " " + options, before);
}

// Starts the program, its messages in a file; waitpid tells how it ended.
inline pid_t start_program(std::vector<std::string> arguments, const fs::path& messages) {
  const pid_t child = fork();
  if (child != 0) return child;
  arguments.insert(arguments.begin(), ILAW_PROGRAM);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  if (!freopen(messages.c_str(), "w", stderr) || !freopen("/dev/null", "w", stdout)) _exit(127);
  execv(ILAW_PROGRAM, pointers.data());
  _exit(127);
}

}  // namespace ilaw::host::testing
