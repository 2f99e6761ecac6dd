// SPDX-License-Identifier: BSD-3-Clause
#include "search.hpp"

#include "file.hpp"
#include "refusal.hpp"

#include <sys/auxv.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <string_view>

namespace ilaw::loading {
namespace {

// "/a//b/./c/../" as "/a/b", by its letters alone.
std::string normal(const std::string& path) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at < path.size();) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    const std::string part = path.substr(at, end - at);
    if (part == ".." && !parts.empty()) parts.pop_back();
    if (!part.empty() && part != "." && part != "..") parts.push_back(part);
    at = end + 1;
  }
  std::string text;
  for (const std::string& part : parts) text += "/" + part;
  return text.empty() ? "/" : text;
}

// The folder by which every user may put a library of his own into this one: itself, or one above it in which
// he may rename the next. The sticky bit forbids that, as in /tmp.
std::string writable_by_all(const std::string& folder) {
  for (std::size_t end = folder.find('/', 1); end != std::string::npos; end = folder.find('/', end + 1)) {
    std::string above = folder.substr(0, end);
    if (const file_status status = status_of(above); status.anyone_writes && !status.sticky) return above;
  }
  return status_of(folder).anyone_writes ? folder : "";
}

void add_once(search_path& path, const std::string& folder) {
  const std::string text = normal(folder), real = canonical(text);
  std::string weak = writable_by_all(text);
  if (weak.empty() && real != text) weak = writable_by_all(real);
  std::vector<std::string>& list = weak.empty() ? path.folders : path.left_out;
  const std::string entry = weak.empty() || weak == text ? text : text + " (by " + weak + ")";
  if (std::find(list.begin(), list.end(), entry) == list.end()) list.push_back(entry);
}

void add_environment(search_path& path) {
  const char* text = secure_getenv("ILAW_PATH");
  if (!text) return;
  const std::string entries(text);
  for (std::size_t at = 0; at <= entries.size();) {
    const std::size_t end = std::min(entries.find(':', at), entries.size());
    // An empty or relative entry would mean the current folder, which is never searched.
    if (end > at) {
      const std::string entry = entries.substr(at, end - at);
      entry.front() == '/' ? add_once(path, entry) : path.relative.push_back(entry);
    }
    at = end + 1;
  }
}

// Beside the program, and beside the shared object that the loader is or is part of: a plug-in of a foreign
// program, as Python's. Not if set-uid: whoever links to the program from elsewhere chooses what lies there.
void add_beside_files(search_path& path) {
  if (getauxval(AT_SECURE) != 0) return;
  static const std::string &program = *new std::string(
                               mapped_file(reinterpret_cast<const void*>(getauxval(AT_PHDR)))),
                           &own = *new std::string(mapped_file(ILAW_INSTALLED_FOLDER));
  if (!program.empty()) add_once(path, program + "/../../lib/ilaw");
  if (own.empty() || own == program) return;
  for (const char* place : {"/../ilaw", "/../../lib/ilaw"}) add_once(path, own + place);
}

bool ends_in_so(std::string_view name) { return name.size() > 3 && name.substr(name.size() - 3) == ".so"; }

bool is_name(const std::string& text) {
  const auto usual = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '+' || c == '.';
  };
  return !text.empty() && text.front() != '.' && std::all_of(text.begin(), text.end(), usual);
}

// Whether at most `edits` insertions, deletions and changes of letters turn a into b.
bool is_within(std::size_t edits, std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty() && a.front() == b.front()) {
    a.remove_prefix(1);
    b.remove_prefix(1);
  }
  if (a.empty() || b.empty()) return a.size() + b.size() <= edits;
  return edits > 0 && (is_within(edits - 1, a.substr(1), b) || is_within(edits - 1, a, b.substr(1)) ||
                       is_within(edits - 1, a.substr(1), b.substr(1)));
}

// The library on the search path whose file is named nearest to this one.
std::string suggestion(const std::string& file) {
  for (const std::size_t edits : {1, 2})
    for (const std::string& path : library_files()) {
      const std::string known = path.substr(path.rfind('/') + 1);
      if (is_within(edits, file, known))
        return " (did you mean '" + known.substr(0, known.size() - 3) + "'?)";
    }
  return "";
}

}  // namespace

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : ":") + text;
  return all;
}

search_path folders_searched() {
  search_path path;
  add_environment(path);
  add_beside_files(path);
  // The last two serve a host that links the loader of one installation and runs beside laws of a package.
  for (const char* folder : {ILAW_INSTALLED_FOLDER, "/usr/local/lib/ilaw", "/usr/lib/ilaw"})
    add_once(path, folder);
  return path;
}

std::string find_named(const std::string& name) {
  if (!is_name(name))
    throw refusal(ILAW_NOT_FOUND,
                  "'" + name + "' is no name of a library, expected letters, digits, '_', '-', '+' and '.'");
  const std::string file = ends_in_so(name) ? name : name + ".so";
  const search_path path = folders_searched();
  for (const std::string& folder : path.folders)
    if (std::string found = canonical(folder + "/" + file); !found.empty()) return found;
  std::string where = joined(path.folders);
  if (!secure_getenv("ILAW_PATH")) where += "; ILAW_PATH adds folders by their absolute paths";
  if (!path.left_out.empty())
    where += "; not searched, since every user may write there: " + joined(path.left_out);
  if (!path.relative.empty())
    where += "; not searched, since it is no absolute path: " + joined(path.relative);
  if (ends_in_so(name)) where += "; the path of a file has a '/', as ./" + name;
  throw refusal(ILAW_NOT_FOUND, "'" + name + "': no " + file + " found" + suggestion(file) +
                                    ", expected it in one of: " + where);
}

std::string find_library(const std::string& name_or_path) {
  if (name_or_path.find('/') == std::string::npos) return find_named(name_or_path);
  std::string found = canonical(name_or_path);
  if (found.empty()) throw refusal(ILAW_NOT_FOUND, name_or_path + ": no such file, expected a law library");
  return found;
}

std::vector<std::string> library_files() {
  std::vector<std::string> files;
  std::set<std::string> seen;
  for (const std::string& folder : folders_searched().folders)
    for (const std::string& name : names_in(folder))
      if (ends_in_so(name) && seen.insert(name).second) files.push_back(folder + "/" + name);
  return files;
}

}  // namespace ilaw::loading
