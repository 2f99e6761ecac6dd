// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_law.hpp"

#include "base/running_call.hpp"
#include "base/words.hpp"
#include "contact/law_arguments.hpp"
#include "scene/arguments.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {
namespace {

using nlohmann::json;

json plain_value(const ilaw_parameter& p) {
  if (p.kind == ILAW_KIND_CHOICE) return p.choices[0];
  if (p.kind == ILAW_KIND_INTEGER) return std::max(1.0, std::ceil(p.minimum));
  const double usual = std::string(p.unit) == "1" ? 0.3 : 1.0;
  if (usual > p.minimum && usual <= p.maximum) return usual;
  return (p.flags & ILAW_FLAG_EXCLUDES_MINIMUM) ? 0.5 * (p.minimum + p.maximum) : p.minimum;
}

// {"per_node": value} is one value here, of which the arrays of all nodes are made.
Arguments arguments_of(const BenchCase& bench_case) {
  json parameters = bench_case.parameters;
  for (auto& [name, value] : parameters.items())
    if (value.is_object() && value.contains("per_node") && !value["per_node"].is_array())
      value["per_node"] = json::array({value["per_node"]});
  return read_arguments(parameters, 1, "parameters");
}

int dimension_of(const ilaw_law& law) {
  for (const int d : {3, 2})
    if (law.dimensions & (1U << d)) return d;
  return 1;
}

void check_form(const ilaw_law& law, const BenchCase& bench_case) {
  if (law.delassus_forms & form_of(bench_case)) return;
  std::vector<std::string> served = bench_words().front().words;
  std::erase_if(served, [&](const std::string& word) {
    BenchCase other;
    other.delassus = word;
    return !(law.delassus_forms & form_of(other));
  });
  throw InputError("law '" + std::string(law.id) + "': found H " + bench_case.delassus +
                   ", which it does not serve; expected one of " + joined(served));
}

}  // namespace

std::vector<std::string> laws_of(const ilaw::library& library) {
  std::vector<std::string> laws;
  for (std::uint32_t k = 0; k < library.plugin().law_count; ++k)
    laws.emplace_back(library.plugin().laws[k]->id);
  return laws;
}

BenchCase with_required_parameters(BenchCase bench_case, const ilaw_law& law) {
  for (std::uint32_t k = 0; k < law.parameter_count; ++k) {
    const ilaw_parameter& p = *law.parameters[k];
    if ((p.flags & ILAW_FLAG_REQUIRED) && !bench_case.parameters.contains(p.name))
      bench_case.parameters[p.name] = plain_value(p);
  }
  return bench_case;
}

BenchLaw::BenchLaw(const ilaw::library& library, const BenchCase& bench_case)
    : name_(bench_case.law), path_(library.path()) {
  const ilaw_law* law = library.law(bench_case.law);
  if (!law)
    throw InputError("found no law '" + bench_case.law + "' in " + path_ + ", expected one of " +
                     joined(laws_of(library)));
  check_form(*law, bench_case);
  if (bench_case.floats && !(law->numbers & ILAW_NUMBERS_FLOAT))
    throw InputError("law '" + name_ + "': --float: it does not serve arrays of float; expected double");
  dimension_ = dimension_of(*law);
  const Arguments arguments = arguments_of(bench_case);
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = static_cast<std::uint32_t>(dimension_);
  setup.delassus_form = form_of(bench_case);
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  setup.frame = bench_case.frame == "global" ? ILAW_FRAME_GLOBAL : ILAW_FRAME_LOCAL;
  const RunningCall running({name_.c_str(), path_.c_str()});
  try {
    interface_.emplace(create_law(name_, arguments, setup, library));
  } catch (const ilaw::error& refusal) {
    // A law that tells its tangents apart wants them from the host.
    if (refusal.code() != ILAW_UNSUPPORTED || setup.frame == ILAW_FRAME_LOCAL || dimension_ < 3) throw;
    setup.has_tangent = 1;
    interface_.emplace(create_law(name_, arguments, setup, library));
  }
  if (bench_case.floats) {
    setup.numbers = ILAW_NUMBERS_FLOAT;
    floats_.emplace(create_law(name_, arguments, setup, library));
  }
  info_ = interface_->info();
  for (std::uint32_t k = 0; k < info_.per_node_parameter_count; ++k)
    per_node_values_.push_back(arguments.per_node.at(info_.per_node_parameters[k]).front());
  const auto extension = interface_->law().extension;
  const auto* profile = extension ? static_cast<const ilaw_profile*>(extension(ILAW_PROFILE)) : nullptr;
  if (profile && profile->struct_size >= sizeof(ilaw_profile)) profile_ = profile;
}

template <class Call>
void BenchLaw::checked(const char* call, Call make) const {
  ilaw_report report{};
  report.struct_size = sizeof report;
  const RunningCall running({name_.c_str(), path_.c_str()});
  const std::int32_t code = make(&report);
  if (code == ILAW_OK) return;
  throw std::runtime_error("law '" + name_ + "': " + call + " refuses " +
                           (code == ILAW_BAD_NODES ? "node " + std::to_string(report.first_bad_node)
                                                   : "the batch with code " + std::to_string(code)) +
                           ": " + (report.reason ? report.reason : "no reason given"));
}

void BenchLaw::initialise(const ilaw_batch& batch) const {
  checked("initialise", [&](ilaw_report* report) { return interface_->initialise(batch, report); });
}

void BenchLaw::evaluate(const ilaw_batch& batch) const {
  const ilaw::interface& law = batch.v_free.floats ? *floats_ : *interface_;
  checked("evaluate", [&](ilaw_report* report) { return law.evaluate(batch, report); });
}

std::optional<std::string> BenchLaw::instruction_set() const {
  if (!profile_) return {};
  return profile_->instruction_set(interface_->instance());
}

std::optional<double> BenchLaw::scalar_share(const ilaw_batch& batch) const {
  if (!profile_) return {};
  std::int64_t one_by_one = 0;
  checked("evaluate", [&](ilaw_report* report) {
    return profile_->evaluate_counting(interface_->instance(), &batch, report, &one_by_one);
  });
  return static_cast<double>(one_by_one) / static_cast<double>(batch.node_count);
}

}  // namespace ilaw::host
