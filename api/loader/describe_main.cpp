// ilaw-describe LIBRARY - writes the description of contact.so to contact.json beside it, when it is built.
// SPDX-License-Identifier: BSD-3-Clause
#include "description_file.hpp"
#include "description_text.hpp"
#include "refusal.hpp"

#include <ilaw/loader.hpp>

#include <nlohmann/json.hpp>

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>

namespace {

using namespace ilaw::loading;

// The file of an earlier build says what that library said: the loader would refuse this one.
void remove_description(const std::string& library, const std::string& file) {
  if (read_description(library))
    std::remove(file.c_str());
  else if (std::FILE* other = std::fopen(file.c_str(), "rb")) {
    std::fclose(other);
    throw std::runtime_error(file + ": the file is there and is no description of a library");
  }
}

// Nobody sees a file half written.
void write_whole(const std::string& file, const std::string& text) {
  const std::string half = file + ".tmp";
  std::FILE* out = std::fopen(half.c_str(), "wb");
  const bool written = out && std::fwrite(text.data(), 1, text.size(), out) == text.size();
  if ((out && std::fclose(out) != 0) || !written || std::rename(half.c_str(), file.c_str()) != 0)
    throw std::runtime_error(file + ": cannot be written");
}

void describe(const std::string& path) {
  const std::string library = path.find('/') == std::string::npos ? "./" + path : path;
  const std::string file = description_path(library);
  if (file.empty()) throw std::runtime_error(library + ": expected a file <library>.so");
  remove_description(library, file);
  const ilaw::library opened(library);
  const ilaw_plugin& plugin = opened.plugin();
  if (plugin.abi_minor > ILAW_ABI_MINOR)
    throw std::runtime_error(library + ": ABI 1." + std::to_string(plugin.abi_minor) +
                             ", expected at most 1." + std::to_string(ILAW_ABI_MINOR) +
                             ": use a newer ilaw-describe");
  write_whole(file, nlohmann::ordered_json::parse(description_text(plugin)).dump(1) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr,
                 "usage: ilaw-describe LIBRARY\nWrites the description of contact.so to contact.json.\n");
    return 2;
  }
  try {
    describe(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ilaw-describe: %s\n", error.what());
    return 1;
  }
}
