// `ilaw bench`: what a law costs per node, beside what its bytes cost.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "base/files.hpp"
#include "base/running_call.hpp"
#include "bench/bench_law.hpp"
#include "bench/measure.hpp"
#include "cli/guard.hpp"
#include "cli/terminal.hpp"

#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

struct BenchOptions {
  std::vector<std::string> laws, case_files;
  std::string law, parameters = "{}";
  std::filesystem::path folder;
  std::vector<std::int64_t> nodes = {1000, 10000000};
  std::vector<std::vector<std::string>> words{bench_words().size()};  // of bench_words, in their order
  int repetitions = 7;
  bool floats = false, as_json = false;
};

// Libraries of this run, opened once.
class Libraries {
 public:
  const ilaw::library& open(const std::string& name_or_path) {
    const RunningCall running({"", name_or_path.c_str()});
    return opened_.try_emplace(name_or_path, name_or_path).first->second;
  }

 private:
  std::map<std::string, ilaw::library> opened_;
};

json parameters_of(const BenchOptions& options) {
  json parameters = json::parse(options.parameters, nullptr, false);
  if (parameters.is_object()) return parameters;
  throw InputError("--parameters: found '" + options.parameters +
                   R"(', expected an object in JSON, as {"friction": 0.3})");
}

// Runs work; a refusal of a case of a file names its entry.
template <class Work>
auto naming_entry(const BenchCase& bench_case, Work&& work) {
  try {
    return work();
  } catch (const std::runtime_error& refusal) {
    throw InputError(bench_case.where + refusal.what());
  }
}

// A case for each law of the library where it names none.
std::vector<BenchCase> with_laws(BenchCase bench_case, Libraries& libraries) {
  if (!bench_case.law.empty()) return {bench_case};
  std::vector<BenchCase> cases;
  for (const std::string& law : laws_of(libraries.open(bench_case.library))) {
    bench_case.law = law;
    cases.push_back(bench_case);
  }
  return cases;
}

// The options make an entry for each law or library that is named; then come those of files.
std::vector<BenchEntry> entries_of(const BenchOptions& options) {
  std::vector<BenchEntry> entries;
  json given = {{"parameters", parameters_of(options)}, {"float", options.floats}};
  if (!options.law.empty()) given["law"] = options.law;
  for (std::size_t k = 0; k < options.words.size(); ++k)
    if (!options.words[k].empty()) given[bench_words()[k].key] = options.words[k];
  for (const std::string& name : options.laws) {
    given["library"] = name;
    entries.push_back({given, ""});
  }
  for (const std::string& file : options.case_files) {
    const std::vector<BenchEntry> more = read_bench_entries(file);
    entries.insert(entries.end(), more.begin(), more.end());
  }
  return entries;
}

std::vector<BenchCase> cases_of(const BenchOptions& options, Libraries& libraries) {
  std::vector<BenchCase> cases;
  for (const BenchEntry& entry : entries_of(options))
    for (const BenchCase& one : cases_of(entry))
      naming_entry(one, [&] {
        for (const BenchCase& own : with_laws(one, libraries))
          if (const ilaw_law* law = libraries.open(own.library).law(own.law);
              options.law.empty() || own.law == options.law)
            cases.push_back(law ? with_required_parameters(own, *law) : own);
      });
  if (cases.empty()) throw InputError("found nothing to measure, expected a law, a library or --cases");
  return cases;
}

void print_header() {
  std::printf("%9s  %-60s %9s %10s %6s %6s %9s %7s\n", "nodes", "case", "ns/node", "bytes/node", "GB/s",
              "ratio", "isa", "scalar");
}

void print_result(const BenchResult& result) {
  const std::string shown = printable(result.bench_case.law + " " + text_of(result.bench_case));
  std::printf("%9lld  %-60s %9.2f %10.0f %6.1f %6.2f %9s %7s\n", static_cast<long long>(result.nodes),
              shown.c_str(), result.ns_per_node, result.bytes_per_node, result.triad_gb_per_s, result.ratio,
              printable(result.isa.value_or("-")).c_str(),
              result.scalar_share ? text_of("%.4f", *result.scalar_share).c_str() : "-");
  std::fflush(stdout);
}

std::vector<BenchResult> measure_all(const std::vector<BenchCase>& cases, const BenchOptions& options,
                                     Libraries& libraries) {
  std::vector<BenchResult> results;
  if (!options.as_json) print_header();
  for (const std::int64_t nodes : options.nodes)
    for (const BenchCase& one : cases) {
      results.push_back(run_bench(libraries.open(one.library), one, nodes, options.repetitions));
      if (!options.as_json) print_result(results.back());
    }
  return results;
}

int bench(const BenchOptions& options) {
  warn_of_search_path();
  name_crashes();
  Libraries libraries;
  const std::vector<BenchCase> cases = cases_of(options, libraries);
  for (const BenchCase& one : cases)
    for (const std::int64_t nodes : options.nodes)
      naming_entry(one, [&] { check_bench(libraries.open(one.library), one, nodes); });
  std::optional<HeldFolder> held;
  if (!options.folder.empty()) held.emplace(options.folder, "bench.csv");
  const std::vector<BenchResult> results = measure_all(cases, options, libraries);
  if (options.as_json) {
    json array = json::array();
    for (const BenchResult& result : results) array.push_back(json_of(result));
    std::printf("%s\n", array.dump(2, ' ', false, json::error_handler_t::replace).c_str());
  }
  if (!held) return exit_done;
  remove_pictures(options.folder);
  write_bench(results, options.folder);
  return exit_done;
}

void add_words(CLI::App& command, BenchOptions& options) {
  for (std::size_t k = 0; k < bench_words().size(); ++k) {
    const BenchWords& option = bench_words()[k];
    std::string words;
    for (const std::string& word : option.words) words += (words.empty() ? "" : "|") + word;
    command
        .add_option(std::string("--") + option.key, options.words[k],
                    std::string(option.doc) + "; several with commas between them")
        ->delimiter(',')
        ->take_all()
        ->allow_extra_args(false)
        ->type_name(words);
  }
}

}  // namespace

void add_bench(CLI::App& app, int& code) {
  const auto options = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand(
      "bench", "Measure the time of a law per node, beside a triad of arrays in the same run");
  command->add_option("laws", options->laws, "Names of laws, or paths of libraries");
  command->add_option("--law", options->law, "Only this law of the libraries");
  command->add_option("--nodes", options->nodes, "Numbers of nodes of a batch")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 40))
      ->delimiter(',')
      ->capture_default_str();
  add_words(*command, *options);
  command->add_option("--parameters", options->parameters,
                      "In JSON, as in a scene; {\"per_node\": value} gives it per node. Where one is missing "
                      "that the law requires, a plain value of its range is taken");
  command->add_option(
      "--cases", options->case_files,
      "Files of cases: what their section \"benchmarks\" lists, instead of the options above");
  command->add_flag("--float", options->floats, "Arrays of float");
  command->add_option("--repetitions", options->repetitions, "Repetitions, for medians")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--json", options->as_json, "Print an array of objects, one for each case");
  command->add_option("--out", options->folder, "Folder for bench.csv, which `ilaw plot` draws");
  command->footer(
      "ratio: the time over what the bytes cost at the triad's bandwidth. scalar: share of nodes solved one by\n"
      "one. -: the law cannot say. ILAW_ISA=baseline, v3 or v4 caps the instruction set.\n"
      "Exit codes: 0 done; 1 the law refused a node, or failed; 2 bad usage, or a case that it does not "
      "serve.\n"
      "Example: ilaw bench coulomb --parameters '{\"friction\": 0.3}' --delassus scalar,full --nodes 1000");
  command->callback([options, &code] { code = bench(*options); });
}

}  // namespace ilaw::host
