// SPDX-License-Identifier: BSD-3-Clause
#include "description.hpp"

#include <ilaw/decimal_text.hpp>

#include <cmath>
#include <memory>
#include <set>
#include <string>

namespace ilaw::loading {
namespace {

constexpr std::uint32_t known_dimensions = ILAW_DIMENSION_1 | ILAW_DIMENSION_2 | ILAW_DIMENSION_3;
constexpr std::uint32_t known_forms = 2 * ILAW_DELASSUS_TRANSVERSE_SPIN - 1;
constexpr std::uint32_t known_frames = ILAW_FRAME_LOCAL | ILAW_FRAME_GLOBAL;
constexpr std::uint32_t known_numbers = ILAW_NUMBERS_DOUBLE | ILAW_NUMBERS_FLOAT;
constexpr std::uint32_t known_inputs = 2 * ILAW_INPUT_V_SMOOTH - 1;
constexpr std::uint32_t known_outputs = 2 * ILAW_OUTPUT_ENERGY - 1;
constexpr std::uint32_t known_capabilities = ILAW_CAN_ADHERE | ILAW_CAN_STORE_ENERGY | ILAW_CAN_HOLD_BONDS;
constexpr std::uint32_t known_permissions = ILAW_MAY_SKIP_FRESH | ILAW_MAY_SKIP_FREE;
constexpr std::uint32_t known_parameter_flags = 2 * ILAW_FLAG_NEEDS_SPINS - 1;

// Doubles of state per node: 8 MB, more than any law needs.
constexpr std::uint64_t most_state = std::uint64_t{1} << 20;

std::string quoted(const char* kind, const char* name) { return std::string(kind) + " '" + name + "'"; }

void check_unique(const checker& check, std::set<std::string>& seen, const char* kind, const char* name) {
  if (!seen.insert(name).second) check.refuse(quoted(kind, name) + " is declared twice");
}

bool has(const ilaw_parameter& p, ilaw_parameter_flags flag) { return (p.flags & flag) != 0; }

bool in_range(const ilaw_parameter& p, double value) {
  if (value == INFINITY) return has(p, ILAW_FLAG_ALLOWS_INFINITY);
  const bool above = has(p, ILAW_FLAG_EXCLUDES_MINIMUM) ? value > p.minimum : value >= p.minimum;
  return above && value <= p.maximum;
}

std::string text_of(double value) { return decimal_text(value).get(); }

void check_choices(const checker& check, ilaw_parameter& p) {
  p.choices = check.array(p.choices, p.choice_count, "choices");
  check.texts(p.choices, p.choice_count, "a choice");
  if (p.kind != ILAW_KIND_CHOICE) return;
  if (p.choice_count == 0) check.refuse("choice_count is 0, expected at least 1");
  const double chosen = p.default_value;
  if (!has(p, ILAW_FLAG_REQUIRED) &&
      !(chosen >= 0.0 && chosen < p.choice_count && chosen == std::floor(chosen)))
    check.refuse("default " + text_of(chosen) + " is no index of its choices");
}

void check_axes(const checker& check, ilaw_parameter& p) {
  p.axes = check.array(p.axes, p.axis_count, "axes");
  std::set<std::string> seen;
  for (std::uint32_t i = 0; i < p.axis_count; ++i) {
    check.name(p.axes[i], "an axis");
    check_unique(check, seen, "axis", p.axes[i]);
  }
}

void check_parameter(const checker& check, ilaw_parameter& p) {
  check.kind(p.kind, ILAW_KIND_CHOICE, "kind");
  check.mask(p.flags, known_parameter_flags, "flags");
  check.zero(p.reserved, "reserved");
  check.text(p.symbol, "symbol");
  check.text(p.unit, "unit");
  check.prose(p.doc, "doc");
  check_choices(check, p);
  if (!(p.minimum <= p.maximum))
    check.refuse("minimum " + text_of(p.minimum) + " is not below maximum " + text_of(p.maximum));
  if (!has(p, ILAW_FLAG_REQUIRED) && !in_range(p, p.default_value))
    check.refuse("default " + text_of(p.default_value) + " lies outside its own range");
  check_axes(check, p);
}

void check_state_variable(const checker& check, ilaw_state_variable& v) {
  check.kind(v.kind, ILAW_KIND_TANGENTIAL, "kind");
  check.mask(v.flags, ILAW_FLAG_INTERNAL, "flags");
  check.zero(v.reserved, "reserved");
  check.text(v.unit, "unit");
  check.prose(v.doc, "doc");
}

void check_amount(const checker& check, ilaw_amount& a) {
  check.zero(a.reserved, "reserved");
  check.text(a.unit, "unit");
  check.prose(a.doc, "doc");
}

// Copies of the elements, each with a name that no other has.
template <class Element>
const Element* const* checked_elements(const checker& check, const Element* const* given, std::uint32_t count,
                                       const char* arrays, const char* kind,
                                       void (*check_one)(const checker&, Element&)) {
  const Element** made = check.array(given, count, arrays);
  std::set<std::string> seen;
  for (std::uint32_t i = 0; i < count; ++i) {
    const checker numbered = check.inside(std::string(kind) + " " + std::to_string(i));
    Element& element = numbered.copy(made[i], kind);
    numbered.name(element.name, "name");
    check_unique(check, seen, kind, element.name);
    check_one(check.inside(quoted(kind, element.name)), element);
    made[i] = &element;
  }
  return made;
}

void check_functions(const checker& check, const ilaw_law& law) {
  const auto given = [&check](bool set, const char* name) {
    if (!set) check.refuse("function '" + std::string(name) + "' is null, expected a function");
  };
  given(law.create, "create");
  given(law.destroy, "destroy");
  given(law.info, "info");
  given(law.initialise, "initialise");
  given(law.evaluate, "evaluate");
}

// Spins are of dimension 3, and nobody could give a parameter that needs them to a law without.
void check_spins(const checker& check, const ilaw_law& law) {
  const bool has_spins = law.delassus_forms & ILAW_DELASSUS_TRANSVERSE_SPIN;
  if (has_spins && !(law.dimensions & ILAW_DIMENSION_3))
    check.refuse("delassus_forms has spins, expected dimension 3 among dimensions");
  for (std::uint32_t i = 0; i < law.parameter_count; ++i)
    if (has(*law.parameters[i], ILAW_FLAG_NEEDS_SPINS) && !has_spins)
      check.refuse(quoted("parameter", law.parameters[i]->name) +
                   " needs spins, expected a form with spins among delassus_forms");
}

void check_law(const checker& check, ilaw_law& law) {
  check.text(law.title, "title");
  check.prose(law.doc, "doc");
  check.choice_of(law.dimensions, known_dimensions, "dimensions");
  check.choice_of(law.delassus_forms, known_forms, "delassus_forms");
  check.choice_of(law.frames, known_frames, "frames");
  check.choice_of(law.numbers, known_numbers, "numbers");
  check.mask(law.inputs, known_inputs, "inputs");
  check.mask(law.outputs, known_outputs, "outputs");
  check.mask(law.capabilities, known_capabilities, "capabilities");
  check.mask(law.permissions, known_permissions, "permissions");
  check.zero(law.reserved, "reserved");
  law.references = check.array(law.references, law.reference_count, "references");
  check.texts(law.references, law.reference_count, "a reference");
  law.parameters = checked_elements(check, law.parameters, law.parameter_count, "parameters", "parameter",
                                    check_parameter);
  law.state_variables = checked_elements(check, law.state_variables, law.state_variable_count,
                                         "state_variables", "state variable", check_state_variable);
  law.amounts = checked_elements(check, law.amounts, law.amount_count, "amounts", "amount", check_amount);
  check_spins(check, law);
  check_functions(check, law);
}

// Count of a variable of a kind whose count the dimension tells; the others have any.
std::uint64_t expected_count(const ilaw_state_variable& v, std::uint32_t dimension) {
  switch (v.kind) {
    case ILAW_KIND_SCALAR:
      return 1;
    case ILAW_KIND_VECTOR:
    case ILAW_KIND_AXIS:
      return dimension;
    case ILAW_KIND_TANGENTIAL:
      return dimension - 1;
    default:
      return v.count;
  }
}

void check_state(const checker& check, const ilaw_instance_info& info, std::uint32_t dimension) {
  std::uint64_t sum = 0;
  for (std::uint32_t i = 0; i < info.state_variable_count; ++i) {
    const ilaw_state_variable& v = *info.state_variables[i];
    const checker variable = check.inside(quoted("state variable", v.name));
    const std::uint64_t expected = expected_count(v, dimension);
    if (v.count != expected)
      variable.refuse("count is " + std::to_string(v.count) + ", expected " + std::to_string(expected));
    if (v.count > most_state)
      variable.refuse("count is " + std::to_string(v.count) + ", expected at most " +
                      std::to_string(most_state));
    sum += v.count;
  }
  if (sum != info.state_size || sum > most_state)
    check.refuse("state_size is " + std::to_string(info.state_size) + ", expected the sum of the counts, " +
                 std::to_string(sum) + ", and at most " + std::to_string(most_state));
}

std::set<std::string> given_per_node(const ilaw_setup& setup) {
  std::set<std::string> names;
  for (std::uint32_t k = 0; setup.arguments && k < setup.argument_count; ++k)
    if (const ilaw_argument* a = setup.arguments[k]; a && a->name && a->kind == ILAW_KIND_VALUE_PER_NODE)
      names.insert(a->name);
  return names;
}

// The batch carries one array for each parameter that the host gave per node, no more: a name too many would
// read beyond the host's list.
void check_per_node(const checker& check, const std::set<std::string>& given, ilaw_instance_info& info) {
  info.per_node_parameters =
      check.array(info.per_node_parameters, info.per_node_parameter_count, "per_node_parameters");
  std::set<std::string> seen;
  for (std::uint32_t i = 0; i < info.per_node_parameter_count; ++i) {
    const char* name = info.per_node_parameters[i];
    check.name(name, "a per-node parameter");
    check_unique(check, seen, "per-node parameter", name);
    if (!given.contains(name)) check.refuse(quoted("per-node parameter", name) + " was not given per node");
  }
  if (seen.size() != given.size())
    check.refuse("per_node_parameter_count is " + std::to_string(seen.size()) + ", expected " +
                 std::to_string(given.size()) + ", the parameters given per node");
}

// An instance gives amounts of its law.
void check_amounts(const checker& check, const ilaw_law& law, const ilaw_instance_info& info) {
  std::set<std::string> known;
  for (std::uint32_t i = 0; i < law.amount_count; ++i) known.insert(law.amounts[i]->name);
  for (std::uint32_t i = 0; i < info.amount_count; ++i)
    if (const char* name = info.amounts[i]->name; !known.contains(name))
      check.refuse(quoted("amount", name) + " is none of the law's");
}

// The law's permissions hold for all parameters.
void check_permissions(const checker& check, const ilaw_law& law, const ilaw_instance_info& info) {
  check.mask(info.permissions, known_permissions, "permissions");
  if (law.permissions & known_permissions & ~info.permissions)
    check.refuse("permissions is " + std::to_string(info.permissions) + ", expected at least the law's, " +
                 std::to_string(law.permissions));
}

// Replaces arrays in the info by checked copies.
void check_instance(const instance_origin& origin, instance_description& made) {
  ilaw_instance_info& info = made.info;
  const checker check = checker(origin.file, origin.minor > ILAW_ABI_MINOR, made.kept)
                            .inside(quoted("law", origin.law.id) + ": instance");
  // These ask for arrays: what the loader does not know, no host can give.
  if (const std::uint32_t asked = info.inputs | info.balance_inputs; (asked & ~known_inputs) != 0)
    throw refusal(ILAW_UNSUPPORTED, origin.file + ": law '" + origin.law.id + "': reads inputs " +
                                        std::to_string(asked) + ", expected only the bits of " +
                                        std::to_string(known_inputs));
  check.mask(info.capabilities, known_capabilities, "capabilities");
  check_permissions(check, origin.law, info);
  check.zero(info.reserved, "reserved");
  info.state_variables = checked_elements(check, info.state_variables, info.state_variable_count,
                                          "state_variables", "state variable", check_state_variable);
  check_state(check, info, made.dimension);
  check_per_node(check, made.per_node, info);
  info.amounts = checked_elements(check, info.amounts, info.amount_count, "amounts", "amount", check_amount);
  check_amounts(check, origin.law, info);
}

}  // namespace

const ilaw_plugin* checked_plugin(const std::string& file, const ilaw_plugin* given, storage& kept) {
  const checker first(file, false, kept);
  ilaw_plugin& plugin = first.copy(given, "the description");
  if (plugin.abi_major != ILAW_ABI_MAJOR)
    first.refuse("ABI version " + std::to_string(plugin.abi_major) + "." + std::to_string(plugin.abi_minor) +
                 ", expected major version " + std::to_string(ILAW_ABI_MAJOR));
  const checker check(file, plugin.abi_minor > ILAW_ABI_MINOR, kept);
  check.text(plugin.name, "name");
  check.text(plugin.version, "version");
  check.text(plugin.vendor, "vendor");
  check.text(plugin.licence, "licence");
  check.zero(plugin.reserved, "reserved");
  if (plugin.law_count == 0) check.refuse("law_count is 0, expected at least 1");
  const ilaw_law** laws = check.array(plugin.laws, plugin.law_count, "laws");
  plugin.laws = laws;
  std::set<std::string> seen;
  for (std::uint32_t i = 0; i < plugin.law_count; ++i) {
    const checker numbered = check.inside("law " + std::to_string(i));
    ilaw_law& law = numbered.copy(laws[i], "law");
    numbered.name(law.id, "id");
    check_unique(check, seen, "law", law.id);
    check_law(check.inside(quoted("law", law.id)), law);
    laws[i] = &law;
  }
  return &plugin;
}

instance_description* instance_descriptions::checked(const instance_origin& origin, const ilaw_setup& setup,
                                                     const ilaw_instance_info& given) {
  constexpr std::size_t most = 8;  // a library whose instances all differ must not fill the memory
  const std::set<std::string> per_node = given_per_node(setup);
  const std::scoped_lock lock(guard_);
  known_.reserve(most);
  for (instance_description* one : known_)
    if (one->law == &origin.law && one->dimension == setup.dimension && one->per_node == per_node &&
        std::memcmp(&one->given, &given, sizeof given) == 0 && one->kept.is_unchanged()) {
      ++one->users;
      return one;
    }
  auto made = std::make_unique<instance_description>(
      instance_description{&origin.law, setup.dimension, per_node, given, given});
  check_instance(origin, *made);
  if (known_.size() == most) {
    if (--known_.front()->users == 0) delete known_.front();
    known_.erase(known_.begin());
  }
  ++made->users;
  known_.push_back(made.get());
  return made.release();
}

void instance_descriptions::give_back(instance_description* one) {
  const std::scoped_lock lock(guard_);
  if (--one->users == 0) delete one;
}

instance_descriptions::~instance_descriptions() {
  for (const instance_description* one : known_) delete one;
}

}  // namespace ilaw::loading
