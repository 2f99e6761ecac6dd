// SPDX-License-Identifier: BSD-3-Clause
#include "cli/terminal.hpp"

#include "base/exit_code.hpp"
#include "base/words.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace ilaw::host {

void open_standard_streams() {
  for (int lowest = 0; lowest <= STDERR_FILENO;) {  // each open gives the lowest number that is free
    lowest = open("/dev/null", O_RDWR);
    if (lowest > STDERR_FILENO) close(lowest);
    if (lowest < 0) return;
  }
}

std::string printable(std::string_view text) {
  std::string shown;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = static_cast<unsigned char>(text[k]);
    // In UTF-8, U+0080 to U+009F are control characters, too.
    const bool of_two = byte == 0xC2 && k + 1 < text.size() && static_cast<unsigned char>(text[k + 1]) < 0xA0;
    if (byte >= 0x20 && byte != 0x7F && !of_two) {
      shown += text[k];
      continue;
    }
    shown += formatted("\\x%02x", of_two ? static_cast<unsigned char>(text[++k]) : byte);
  }
  return shown;
}

// No line but the first begins at the margin, whoever wrote it: none looks like another complaint.
void complain(std::string_view text) {
  std::string shown = "ilaw: ";
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    shown += printable(text.substr(0, end)) + "\n  ";
    text.remove_prefix(std::min(text.find_first_not_of(' ', end + 1), text.size()));
  }
  std::fprintf(stderr, "%s\n", (shown + printable(text)).c_str());
}

void warn_of_search_path() {
  const char* path = std::getenv("ILAW_PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    struct stat found {};
    if (folder.empty() || stat(folder.c_str(), &found) != 0) continue;
    if (folder.front() != '/')
      complain("ILAW_PATH: " + folder + " is not searched, expected an absolute path");
    else if (found.st_mode & S_IWOTH)
      complain("ILAW_PATH: " + folder + " is not searched, since every user may write there");
  }
}

bool knows_instruction_set() {
  const char* found = std::getenv("ILAW_ISA");
  if (!found) return true;
  for (const char* known : {"baseline", "v3", "v4"})
    if (std::string_view(found) == known) return true;
  complain(std::string("ILAW_ISA: found '") + found +
           "', expected one of baseline, v3, v4, or no such variable");
  return false;
}

int after_output(int code) {
  errno = 0;
  const bool had_failed = std::ferror(stdout) != 0;
  if (std::fflush(stdout) == 0 && !had_failed) return code;
  complain(std::string("standard output: cannot be written") +
           (errno != 0 ? std::string(": ") + std::strerror(errno) : ""));
  return exit_failed;
}

}  // namespace ilaw::host
