// Rules: what a library and its instances say of themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"
#include "check/sandbox.hpp"
#include "check/units.hpp"
#include "check/watch.hpp"

#include <dlfcn.h>

#include <malloc.h>
#include <algorithm>
#include <cstring>

namespace ilaw::check {
namespace {

void opens(const Subject&) {}  // nobody would come here else

// Default visibility shares statics of inline functions between libraries, since their symbols are unique in
// a process (STB_GNU_UNIQUE), and lets a function of the host replace one of the law.
void exports_entry(const Subject& subject) {
  constexpr std::size_t most_named = 8;
  const std::optional<std::vector<Exported>> all = exported_symbols(subject.library.path());
  if (!all) throw NotJudged{"the library's table of symbols was not found"};
  std::string names;
  std::size_t count = 0;
  for (const Exported& symbol : *all) {
    if (symbol.name == ILAW_ENTRY_NAME || ++count > most_named) continue;
    names += (names.empty() ? "" : ", ") + symbol.name +
             (symbol.is_unique ? " (unique in the process)"
              : symbol.is_weak ? " (weak)"
                               : "");
  }
  if (count > most_named) names += ", ...";
  if (count > 0)
    throw Finding{joined("beside its entry the library exports ", count,
                         (count == 1 ? " symbol: " : " symbols: "), names),
                  ILAW_ENTRY_NAME " alone: compile with -fvisibility=hidden, link with a version script"};
}

std::string all_of(const ilaw_law& law) {
  std::string text = joined(law.id, "|", law.title, "|", law.doc);
  const auto add = [&text](const auto&... parts) { ((text += joined("|", parts)), ...); };
  add(law.dimensions, law.delassus_forms, law.frames, law.numbers, law.inputs, law.outputs, law.capabilities,
      law.permissions, law.reference_count, law.parameter_count, law.state_variable_count, law.amount_count);
  for (const ilaw_parameter* p : all_parameters(law)) {
    add(p->name, p->symbol, p->unit, p->doc, p->minimum, p->maximum, p->default_value, p->kind, p->flags,
        p->choice_count, p->axis_count);
    for (std::uint32_t c = 0; c < p->choice_count; ++c) add(p->choices[c]);
    for (std::uint32_t a = 0; a < p->axis_count; ++a) add(p->axes[a]);
  }
  for (std::uint32_t k = 0; k < law.amount_count; ++k) add(law.amounts[k]->name, law.amounts[k]->unit);
  return text;
}

const ilaw_plugin* entry_of(const Subject& subject) {
  void* handle = dlopen(subject.library.path().c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
  void* symbol = handle ? dlsym(handle, ILAW_ENTRY_NAME) : nullptr;
  if (!symbol) throw NotJudged{"the entry is not found again"};
  ilaw_entry_function entry = nullptr;
  std::memcpy(&entry, &symbol, sizeof entry);
  calling(ILAW_ENTRY_NAME);
  const ilaw_plugin* plugin = entry();
  dlclose(handle);
  return plugin;
}

const ilaw_law& law_of(const ilaw_plugin& plugin, const Subject& subject) {
  for (std::uint32_t k = 0; k < plugin.law_count; ++k)
    if (std::strcmp(plugin.laws[k]->id, subject.law.id) == 0) return *plugin.laws[k];
  throw Finding{joined("the entry describes no law '", subject.law.id, "' any more"), "the same laws"};
}

void description_constant(const Subject& subject) {
  const ilaw_plugin* const first = entry_of(subject);
  const std::string before = all_of(law_of(*first, subject));
  for_trials(subject, [&](const Trial& trial, Draw& draw) {
    run(trial, draw_script(trial, draw));
    return true;
  });
  const ilaw_plugin* const second = entry_of(subject);
  if (first != second) throw Finding{"the entry returned another pointer", "the same pointer"};
  const std::string after = all_of(law_of(*second, subject));
  if (before != after)
    throw Finding{joined("the description was ", before, " and became ", after), "the same description"};
}

[[noreturn]] void fail_unit(const std::string& what, const char* unit) {
  throw Finding{joined(what, " has the unit \"", unit, "\""),
                "factors kg, m, s, N, J, Pa, Hz, W, K, rad, 1, with . and /, powers m^2 or m^p of a "
                "parameter's symbol"};
}

void units(const Subject& subject) {
  const std::vector<std::string> symbols = symbols_of(subject.law);
  for (const ilaw_parameter* p : all_parameters(subject.law))
    if (p->kind != ILAW_KIND_CHOICE && !parse_unit(p->unit, symbols))
      fail_unit(joined("parameter '", p->name, "'"), p->unit);
  for (std::uint32_t k = 0; k < subject.law.amount_count; ++k)
    if (const ilaw_amount& amount = *subject.law.amounts[k]; !parse_unit(amount.unit, symbols))
      fail_unit(joined("amount '", amount.name, "'"), amount.unit);
}

// A description in C that leaves the maximum out has the range [0, 0]. The loader accepts it: a parameter may
// be 0 or infinite.
void ranges(const Subject& subject) {
  for (const ilaw_parameter* p : all_parameters(subject.law))
    if (p->kind != ILAW_KIND_CHOICE && p->minimum == p->maximum && !has(*p, ILAW_FLAG_ALLOWS_INFINITY))
      throw Finding{joined("parameter '", p->name, "' allows the value ", p->minimum, " alone"),
                    "a maximum above the minimum, or ILAW_FLAG_ALLOWS_INFINITY"};
}

bool info_within_description(const Trial& trial, Draw&) {
  const ilaw_law& law = trial.law;
  const ilaw_instance_info& info = trial.info;
  const std::uint32_t inputs = law.inputs | ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT;
  const auto expect_within = [&](const char* what, std::uint32_t more, const char* of, std::uint32_t most) {
    if (more) fail(trial, joined("the instance ", what, " ", more), joined(of, " of the law, ", most));
  };
  expect_within("reads inputs", (info.inputs | info.balance_inputs) & ~(inputs | ILAW_INPUT_V_PREVIOUS),
                "inputs", law.inputs);
  expect_within("reads inputs", info.inputs & ~inputs, "inputs", law.inputs);
  expect_within("has capabilities", info.capabilities & ~law.capabilities, "capabilities", law.capabilities);
  expect_within("lacks permissions", law.permissions & ~info.permissions, "permissions", law.permissions);
  return true;
}

bool info_frame(const Trial& trial, Draw&) {
  const bool normal = trial.reads(ILAW_INPUT_NORMAL), tangent = trial.reads(ILAW_INPUT_TANGENT);
  if (normal != trial.setup.global())
    fail(trial, normal ? "ILAW_INPUT_NORMAL in the local frame" : "no ILAW_INPUT_NORMAL in the global frame",
         "ILAW_INPUT_NORMAL always, and only, in the global frame");
  if (tangent && !trial.setup.has_tangent)
    fail(trial, "ILAW_INPUT_TANGENT without tangents", "create refuses where it needs tangents");
  return true;
}

std::string all_of(const ilaw_instance_info& info) {
  std::string text;
  const auto add = [&text](const auto&... parts) { ((text += joined(parts, " ")), ...); };
  add(info.inputs, info.balance_inputs, info.state_size, info.capabilities, info.permissions,
      info.state_version);
  for (std::uint32_t k = 0; k < info.state_variable_count; ++k)
    add(info.state_variables[k]->name, info.state_variables[k]->count);
  for (std::uint32_t k = 0; k < info.per_node_parameter_count; ++k) add(info.per_node_parameters[k]);
  for (std::uint32_t k = 0; k < info.amount_count; ++k) add(info.amounts[k]->name);
  return text;
}

bool info_same(const Trial& trial, Draw& draw) {
  const std::string first = all_of(trial.info);
  run(trial, draw_script(trial, draw));
  const Trial other(trial.law, trial.setup, trial.values);
  for (const std::string& again : {all_of(trial.instance.info()), all_of(other.info)})
    if (again != first) fail(trial, joined("info says ", again), joined("what it said first, ", first));
  return true;
}

// Variables that this dimension and these parameters leave without doubles may be missing.
bool state_described(const Trial& trial, Draw&) {
  const std::span known(trial.law.state_variables, trial.law.state_variable_count);
  for (const ilaw_state_variable* v : std::span(trial.info.state_variables, trial.info.state_variable_count))
    if (!(trial.setup.global() && v->kind == ILAW_KIND_AXIS) &&
        std::none_of(known.begin(), known.end(), [v](const ilaw_state_variable* one) {
          return std::strcmp(one->name, v->name) == 0 && one->kind == v->kind;
        }))
      fail(trial, joined("the instance has a state variable '", v->name, "' of kind ", v->kind),
           "those of the law's description; axes besides in the global frame");
  return true;
}

bool amounts_described(const Trial& trial, Draw&) {
  const std::span known(trial.law.amounts, trial.law.amount_count);
  for (const ilaw_amount* amount : std::span(trial.info.amounts, trial.info.amount_count))
    if (std::none_of(known.begin(), known.end(), [amount](const ilaw_amount* one) {
          return std::strcmp(one->name, amount->name) == 0 && std::strcmp(one->unit, amount->unit) == 0;
        }))
      fail(trial, joined("the instance has an amount '", amount->name, "' [", amount->unit, "]"),
           "those of the law's description");
  return trial.law.amount_count > 0;
}

void extension_unknown(const Subject& subject) {
  const auto ask = [](ilaw_extension_function extension, const char* of) {
    if (!extension) return;
    calling("extension");
    if (extension("nobody.nothing/1"))
      throw Finding{joined("extension of the ", of, " gave something for \"nobody.nothing/1\""), "null"};
  };
  ask(subject.law.extension, "law");
  ask(subject.library.plugin().extension, "library");
}

void setups_served(const Subject& subject) {
  std::string refused;
  for (const Setup& setup : setups_of(subject.law)) {
    Draw draw(subject.seed);
    if (draw_values(subject.law, setup, draw)) continue;
    // A law may need tangents.
    if (setup.global() && !setup.has_tangent && setup.dimension == 3) continue;
    throw Finding{"create refused 200 sets of parameters within their described ranges",
                  "parameters that are accepted in each dimension, form of H, frame and number type",
                  text_of(setup),
                  {}};
  }
}

void instances_end(const Subject& subject) {
  calling("destroy");
  subject.law.destroy(nullptr);
#if !defined(__SANITIZE_ADDRESS__)
  const Trial trial = any_trial(subject);
  const auto make = [&] { static_cast<void>(create(trial.law, trial.setup, trial.values)); };
  constexpr int count = 100;
  for (int k = 0; k < count; ++k) make();  // what an allocator keeps for later is there by now
  const std::size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
  for (int k = 0; k < count; ++k) make();
  const std::size_t after = mallinfo2().uordblks + mallinfo2().hblkhd;
  if (after >= before + 16 * count)
    fail(trial,
         joined(after - before, " bytes were kept after ", count, " instances were made and destroyed"),
         "none");
#endif
}

}  // namespace

std::vector<Rule> description_rules() {
  return {
      {opens_id, "The loader opens the library: it is a law library with a sound description.",
       "abi.md, The loader", needing(Needs::nothing, opens)},
      {"exports-entry", "A library exports its entry, and nothing else.", "ilaw.h, ILAW_ENTRY",
       needing(Needs::library, exports_entry)},
      {creates_id,
       "Some parameters within the described ranges are accepted in every dimension, form of H, frame and "
       "number type that the law serves.",
       "ilaw.h, ilaw_law, create", needing(Needs::library, setups_served)},
      {"description-constant", "The entry returns the same constant description at every call.",
       "ilaw.h, ilaw_entry_function", needing(Needs::motion, description_constant)},
      {"description-units", "Units of parameters and amounts are SI units, or 1.",
       "ilaw.h, ilaw_parameter.unit", needing(Needs::library, units)},
      {"description-range", "A parameter that is a number allows more than one value.",
       "ilaw.h, ilaw_parameter.maximum", needing(Needs::library, ranges)},
      {"extension-unknown", "An extension that nobody knows is null.", "ilaw.h, ilaw_law.extension",
       needing(Needs::library, extension_unknown)},
      {"info-within",
       "An instance reads and can do no more than its law's description says, and permits no less.",
       "ilaw.h, ilaw_law.inputs", on_instances(info_within_description)},
      {"info-frame", "Normals are read always, and only, in the global frame; tangents where they are given.",
       "ilaw.h, ILAW_INPUT_NORMAL", on_instances(info_frame)},
      {"info-same", "Two instances of the same setup say the same of themselves, at every call.",
       "abi.md, State", on_trials(info_same)},
      {"state-described", "State variables of an instance are those of the law's description.",
       "ilaw.h, ilaw_law.state_variables", on_instances(state_described)},
      {"amounts-described", "Amounts of an instance are those of the law's description.",
       "ilaw.h, ilaw_law.amounts", on_instances(amounts_described, "the law has no amounts")},
      {"instances-end", "destroy takes null, and leaves nothing of an instance behind.",
       "ilaw.h, ilaw_law.destroy", needing(Needs::instance, instances_end)}};
}

}  // namespace ilaw::check
