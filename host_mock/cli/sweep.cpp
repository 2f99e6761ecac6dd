// `ilaw run --set`: a scene with several values of its keys.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/run.hpp"

#include "base/child_process.hpp"
#include "base/exit_code.hpp"
#include "base/files.hpp"
#include "base/scene_error.hpp"
#include "base/stop_request.hpp"
#include "base/words.hpp"
#include "cli/commands.hpp"
#include "cli/guard.hpp"
#include "cli/run_table.hpp"
#include "cli/terminal.hpp"
#include "scene/validation.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <set>

namespace ilaw::host {
namespace {

using nlohmann::json;

struct Setting {
  json::json_pointer pointer;
  std::string name;  // for folders
  std::vector<json> values;
};

// Between commas: the shortest text that is JSON, or a word.
std::vector<json> values_of(const std::string& text) {
  const auto end_from = [&](std::size_t from) { return std::min(text.find(',', from), text.size()); };
  std::vector<json> values;
  for (std::size_t begin = 0, end = 0; begin <= text.size(); begin = end + 1) {
    json value = json::parse(text.substr(begin, (end = end_from(begin)) - begin), nullptr, false);
    for (std::size_t to = end; value.is_discarded() && to < text.size();) {
      to = end_from(to + 1);
      value = json::parse(text.substr(begin, to - begin), nullptr, false);
      if (!value.is_discarded()) end = to;
    }
    values.push_back(value.is_discarded() ? json(text.substr(begin, end - begin)) : std::move(value));
  }
  return values;
}

Setting parse_setting(const std::string& text) {
  const std::size_t sign = text.find('=');
  if (text.empty() || text.front() != '/' || sign == std::string::npos || sign + 1 == text.size())
    throw SceneError("--set " + text, "expected /pointer=value,value,...");
  try {
    Setting setting{json::json_pointer(text.substr(0, sign)), "", {}};
    setting.name = setting.pointer.back();
    setting.values = values_of(text.substr(sign + 1));
    return setting;
  } catch (const json::exception&) {
    throw SceneError("--set " + text, "expected a JSON pointer before '='");
  }
}

// Folders are named by the last key, or by the whole pointer where that is not unique.
std::vector<Setting> parse_settings(const std::vector<std::string>& texts) {
  std::vector<Setting> settings;
  settings.reserve(texts.size());
  for (const std::string& text : texts) settings.push_back(parse_setting(text));
  std::multiset<std::string> names;
  for (const Setting& setting : settings) names.insert(setting.name);
  for (Setting& setting : settings)
    if (names.count(setting.name) > 1) {
      setting.name = setting.pointer.to_string().substr(1);
      std::replace(setting.name.begin(), setting.name.end(), '/', '.');
    }
  return settings;
}

// The owner of the last key may itself be left out in the scene, if it is an object.
void set(json& source, const json::json_pointer& pointer, const json& value) {
  json::json_pointer owner = pointer.parent_pointer();
  while (!source.contains(owner)) owner = owner.parent_pointer();
  if (!source.contains(pointer) && !source[owner].is_object())
    throw SceneError(pointer.to_string(), "found no such key to set");
  source[pointer] = value;
}

// One of the runs.
struct Variant {
  std::string name;
  std::vector<std::size_t> choice;  // by setting
  int exit_code = exit_failed;      // until it has run
};

std::string folder_name(const std::string& text) {
  std::string name;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) || std::string("=.+-_").find(c) != std::string::npos)
      name += c;
    else if (!name.ends_with('_') &&
             !name.ends_with('='))  // one for all brackets, quotes and commas in a row
      name += '_';
  while (name.ends_with('_')) name.pop_back();
  return name.substr(0, 100);
}

std::vector<Variant> variants_of(const std::vector<Setting>& settings) {
  std::vector<Variant> variants(1);
  for (const Setting& setting : settings) {
    std::vector<Variant> more;
    for (const Variant& one : variants)
      for (std::size_t k = 0; k < setting.values.size(); ++k) {
        Variant next = one;
        const json& value = setting.values[k];
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        next.name += (one.name.empty() ? "" : "_") + folder_name(setting.name + "=" + text);
        next.choice.push_back(k);
        more.push_back(next);
      }
    variants = std::move(more);
  }
  std::set<std::string> seen;
  for (std::size_t k = 0; k < variants.size(); ++k)
    if (!seen.insert(variants[k].name).second) variants[k].name += "_" + std::to_string(k);
  return variants;
}

Scene scene_of(const Variant& variant, const std::vector<Setting>& settings, json source,
               const std::filesystem::path& file) {
  for (std::size_t k = 0; k < settings.size(); ++k)
    set(source, settings[k].pointer, settings[k].values[variant.choice[k]]);
  validate_scene(source);
  return read_scene(std::move(source), file);
}

void write_table(const std::vector<Variant>& variants, const std::filesystem::path& folder) {
  std::vector<RunFolder> runs;
  for (const Variant& variant : variants)
    if (std::filesystem::exists(folder / variant.name / "summary.json"))
      runs.push_back(open_run(folder / variant.name));
  AtomicFile file(folder / "sweep.csv");
  write_csv(file.stream(), table_of(runs, {}));
  file.commit();
}

// Runs one in this process.
int run_variant(const Variant& variant, const std::vector<Setting>& settings, const json& source,
                const RunOptions& options) {
  RunOptions own = options;
  own.folder = options.folder / variant.name;
  own.tells_of_start = false;  // bars of several runs would overwrite each other
  try {
    Scene scene = scene_of(variant, settings, source, options.scene);
    return run_scene(scene, own);
  } catch (const std::exception& error) {
    complain(variant.name + ": " + message_of(error));
  }
  return exit_failed;
}

// A process each, options.threads at a time: a law that crashes takes no other run with it. At an interrupt
// those that run end at their next step, and no other is started.
void run_all(std::vector<Variant>& variants, const std::vector<Setting>& settings, const json& source,
             const RunOptions& options) {
  Processes running;
  std::size_t next = 0;
  while (running.count() > 0 || (next < variants.size() && !stop_requested())) {
    if (next < variants.size() && !stop_requested() &&
        running.count() < static_cast<std::size_t>(options.threads)) {
      const Variant& variant = variants[next];
      running.start(next++, [&] { return run_variant(variant, settings, source, options); });
      continue;
    }
    const Processes::Ended ended = running.wait();
    Variant& variant = variants[ended.number];
    variant.exit_code = ended.code;
    if (!ended.crash.empty()) complain(variant.name + ": its process " + ended.crash);
  }
}

}  // namespace

int sweep(const RunOptions& options, const std::vector<std::string>& texts) {
  std::vector<Setting> settings;
  std::vector<Variant> variants;
  json source;
  std::string name;
  std::int64_t steps = 0;
  name_crashes();
  set_threads(1);  // one in each process; none here, which starts processes
  warn_of_search_path();
  try {
    settings = parse_settings(texts);
    variants = variants_of(settings);
    source = read_scene_source(options.scene);
    source.erase("expect");  // its values belong to the scene as it is
    for (const Variant& variant : variants) {
      name = variant.name;
      steps += scene_of(variant, settings, source, options.scene).steps;
    }
  } catch (const std::exception& error) {
    throw InputError(options.scene.string() + ": " + (name.empty() ? name : name + ": ") + error.what() +
                     "; nothing was run");
  }
  catch_interrupts();
  const HeldFolder held(options.folder, "sweep.csv");
  remove_pictures(options.folder);  // of an earlier sweep
  {
    check::Progress progress("runs", "steps", static_cast<double>(steps), options.progress);
    RunOptions shared = options;
    shared.progress = check::ProgressForm::none;
    shared.shared = &progress;
    run_all(variants, settings, source, shared);
  }
  write_table(variants, options.folder);
  const auto failed =
      std::count_if(variants.begin(), variants.end(), [](const Variant& one) { return one.exit_code != 0; });
  std::printf("%zu runs, %td failed%s; their summaries in %s\n", variants.size(), failed,
              stop_requested() ? " or interrupted" : "", (options.folder / "sweep.csv").c_str());
  return failed == 0 ? exit_done : exit_failed;
}

}  // namespace ilaw::host
