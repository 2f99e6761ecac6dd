// bench_case.hpp - what is measured: a law with its parameters, and how its batches look.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/scene_error.hpp"

#include <ilaw/ilaw.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace ilaw::host {

struct BenchCase {
  std::string library, law;  // library: name or path; law empty: every law of the library
  std::string what;          // in words; empty: the parameters say it
  std::string where;         // of its entry
  // As in a scene; {"per_node": value} gives all nodes that value, one each.
  nlohmann::json parameters = nlohmann::json::object();
  // Words of bench_words below.
  std::string delassus = "scalar", frame = "local", layout = "aos", outputs = "none";
  bool floats = false;  // arrays of float
};

// The words of an option and of a key of a file of cases, the default first.
struct BenchWords {
  const char* key;
  std::string BenchCase::*member;
  std::vector<std::string> words;
  const char* doc;
};
const std::vector<BenchWords>& bench_words();

std::uint32_t form_of(const BenchCase& bench_case);
// The words that distinguish a case from others of its law.
std::string text_of(const BenchCase& bench_case);

// What is to be measured, as a file of cases says it, and what messages about it begin with.
struct BenchEntry {
  nlohmann::json given;
  std::string where;  // empty: on the command line
};
// The section "benchmarks" of a JSON file. An entry with neither "law" nor "library" is of the law that the
// file's folder is named after. Throws InputError.
std::vector<BenchEntry> read_bench_entries(const std::filesystem::path& file);
// One case per combination of words, each of which may be a list. An entry whose "law" is a path, or that has
// a "library" alone, is of all laws of that library. Throws InputError.
std::vector<BenchCase> cases_of(const BenchEntry& entry);

}  // namespace ilaw::host
