// SPDX-License-Identifier: BSD-3-Clause
#include "plot/gnuplot.hpp"

#include "base/files.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <fstream>
#include <regex>
#include <string>
#include <utility>
#include <vector>

extern char** environ;

namespace ilaw::host {
namespace {

constexpr const char* first_line = "if (!exists('suffix')) suffix = ''";
constexpr const char* drawn = ".drawn";  // what a picture's name ends in until it is complete

// -1 when it cannot be started.
int exit_status_of_gnuplot(std::string file) {
  std::string program = "gnuplot", option = "-e", suffix = std::string("suffix = '") + drawn + "'";
  char* arguments[] = {program.data(), option.data(), suffix.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int started = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (started != 0 || waitpid(child, &status, 0) != child) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// gnuplot does not notice a disk that is full: the end of a picture tells.
void complete(const std::filesystem::path& picture) {
  const std::filesystem::path found = picture.string() + drawn;
  const std::string bytes = read_whole(found);
  std::filesystem::remove(found);
  const std::string_view end = picture.extension() == ".png" ? "IEND\xAE\x42\x60\x82" : "</svg>\n";
  if (bytes.size() < end.size() || bytes.find(end, bytes.size() - end.size() - 8) == std::string::npos)
    throw WriteError(picture.string() + ": gnuplot could not write it whole; is the disk full?");
  write_file(picture, bytes);
}

bool run(const std::filesystem::path& script) {
  std::vector<std::filesystem::path> pictures(2, script);
  pictures[0].replace_extension(".png");
  pictures[1].replace_extension(".svg");
  for (const auto& picture : pictures) std::filesystem::remove(picture.string() + drawn);
  const int status = exit_status_of_gnuplot(script.string());
  if (status == 0) {
    for (const auto& picture : pictures) complete(picture);
    return true;
  }
  for (const auto& picture : pictures) std::filesystem::remove(picture.string() + drawn);
  if (status < 0 || status == 127)
    std::fprintf(stderr, "ilaw: gnuplot cannot be started; it is in the package gnuplot-nox\n");
  else
    std::fprintf(stderr, "ilaw: gnuplot failed; run it on %s to see why\n", script.c_str());
  return false;
}

}  // namespace

std::string in_quotes(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += '\'';
    out += std::iscntrl(static_cast<unsigned char>(c)) ? ' ' : c;
  }
  return out + "'";
}

std::string in_lines(const std::string& words, std::size_t most, double& line_count) {
  std::string text, rest = words;
  for (line_count = 1.0; rest.size() > most; line_count += 1.0) {
    std::size_t cut = rest.rfind(' ', most);
    if (cut == std::string::npos || cut == 0) cut = most;
    while (cut > 1 && (static_cast<unsigned char>(rest[cut]) & 0xC0U) == 0x80U) --cut;  // within a letter
    text += in_quotes(rest.substr(0, cut)) + ".\"\\n\".";
    rest.erase(0, rest[cut] == ' ' ? cut + 1 : cut);
  }
  return text + in_quotes(rest);
}

bool draw_sheet(const Sheet& sheet, const std::function<void(std::ostream&)>& panels) {
  const std::filesystem::path script = sheet.picture.string() + ".gnuplot";
  AtomicFile file(script);
  file.stream() << first_line << '\n' << sheet.data;
  for (const auto& [terminal, kind] : {std::pair{"pngcairo", ".png"}, std::pair{"svg", ".svg"}}) {
    file.stream() << "reset\nset datafile separator comma\nset terminal " << terminal << " size "
                  << sheet.width << ',' << sheet.height << " font 'sans,11' " << sheet.terminal
                  << " background rgb 'white'\nset output " << in_quotes(sheet.picture.string() + kind)
                  << ".suffix\nset multiplot " << sheet.multiplot << '\n';
    panels(file.stream());
    file.stream() << "unset multiplot\nunset output\n";
  }
  file.commit();
  return run(script);
}

void place_panel(std::ostream& script, const Sheet& sheet, const PanelPlace& place,
                 const std::string& label) {
  const double top = place.top / sheet.height, bottom = place.bottom / sheet.height;
  script << "set tmargin at screen " << top << "\nset bmargin at screen " << bottom << "\nset key at screen "
         << 1.0 - (place.right - 10.0) / sheet.width << "," << top
         << " left top vertical maxcols 1 noenhanced samplen 2 Left reverse\nset label 1 " << label
         << " noenhanced at screen " << place.label_x / sheet.width << "," << 0.5 * (top + bottom)
         << " center rotate by 90\n";
}

void remove_pictures(const std::filesystem::path& folder, const std::string& names) {
  const std::regex own(names);
  std::vector<std::filesystem::path> scripts;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".gnuplot" || !entry.is_regular_file() ||
        !std::regex_match(entry.path().stem().string(), own))
      continue;
    std::ifstream stream(entry.path());
    std::string line;
    if (std::getline(stream, line) && line == first_line) scripts.push_back(entry.path());
  }
  for (std::filesystem::path file : scripts)
    for (const char* ending : {".png", ".svg", ".gnuplot"})
      std::filesystem::remove(file.replace_extension(ending));
}

}  // namespace ilaw::host
