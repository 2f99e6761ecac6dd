// SPDX-License-Identifier: BSD-3-Clause
#include "results/summary.hpp"

#include "base/files.hpp"
#include "results/state_hash.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ilaw::host {
namespace {

using nlohmann::json;

constexpr const char* status_names[ILAW_STATUS_COUNT] = {"free",   "closed", "stick",  "slip",
                                                         "bonded", "broken", "healed", "bad_input"};

// JSON has no infinity: scenes write it as text, too.
json number_or_inf(double value) { return std::isinf(value) ? json("inf") : json(value); }

json describe_amounts(const Interface& interface) {
  json amounts = json::object();
  for (std::size_t k = 0; k < interface.amounts().size(); ++k)
    amounts[interface.info().amounts[k]->name] = interface.amounts()[k];
  return amounts;
}

// first_contact: null where there was none.
json describe_interface(const Scene& scene, const Interface& interface, double first_contact) {
  double least_mass = std::numeric_limits<double>::infinity();
  for (const int node : interface.nodes())
    least_mass = std::min(least_mass, scene.model->mass()[Eigen::Index{node} * scene.model->dimension()]);
  json described = {{"name", interface.name()},
                    {"law", interface.setup().law},
                    {"library", interface.library().path()},
                    {"library_version", interface.library().plugin().version},
                    {"nodes", interface.nodes().size()},
                    {"least_mass", number_or_inf(least_mass)},
                    {"first_contact", std::isinf(first_contact) ? json() : json(first_contact)},
                    {"state_size", interface.info().state_size},
                    {"amounts", describe_amounts(interface)},
                    {"bytes_per_node", interface.bytes_per_contact()}};
  if (const std::string& owner = interface.setup().edges_of; !owner.empty()) described["edges_of"] = owner;
  return described;
}

// What to cite: of each law that the scene uses, once, the references of its description.
json cited_laws(const Scene& scene) {
  json cited = json::object();
  for (const auto& interface : scene.interfaces) {
    const ilaw_plugin& plugin = interface->library().plugin();
    for (std::uint32_t k = 0; k < plugin.law_count; ++k)
      if (const ilaw_law& law = *plugin.laws[k]; interface->setup().law == law.id)
        cited[law.id] = std::vector<std::string>(law.references, law.references + law.reference_count);
  }
  return cited;
}

json describe_energy(const EnergyReport& energy) {
  json described = {{"balance_error", energy.balance_error},
                    {"least_dissipation", energy.least_dissipation},
                    {"reaction_work", energy.reaction_work},
                    {"largest", energy.scale}};
  for (const auto& [name, value] : named(energy)) described[name] = value;
  return described;
}

json describe_heat(const HeatReport& heat) {
  json described = {{"balance_error", heat.balance_error},
                    {"lowest_temperature", heat.lowest},
                    {"highest_temperature", heat.highest}};
  for (const auto& [name, value] : named(heat)) described[name] = value;
  return described;
}

json describe_statuses(const Tally& tally) {
  json counts = json::object();
  for (std::size_t k = 0; k < ILAW_STATUS_COUNT; ++k) counts[status_names[k]] = tally.status_counts[k];
  return counts;
}

// Like the seconds, what may be another in a run that was interrupted: which contacts were looked at and
// stored depends on when the near ones were last found.
json describe_execution(const Scene& scene, const Tally& tally, const RunRecord& record,
                        const PhaseSeconds& seconds) {
  const double stepping = seconds.internal_forces + seconds.interfaces;
  json stored = json::array();
  for (const auto& interface : scene.interfaces) stored.push_back(interface->contact_count());
  return {{"resumed_at_step", record.resumed_at},
          {"interface_share", stepping > 0.0 ? seconds.interfaces / stepping : 0.0},
          {"node_steps", {{"active", tally.active}, {"skipped", tally.skipped}}},
          {"nodes_stored", stored}};
}

}  // namespace

json summary_of(const Scene& scene, const Integrator& integrator, const RunRecord& record) {
  const Tally& tally = integrator.tally();
  const PhaseSeconds seconds = integrator.seconds();
  json interfaces = json::array();
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i)
    interfaces.push_back(describe_interface(scene, *scene.interfaces[i], integrator.first_contact(i)));
  std::vector<std::string> warnings = scene.warnings;
  warnings.insert(warnings.end(), record.warnings.begin(), record.warnings.end());
  json summary = {
      {"program", {{"name", "ilaw"}, {"version", ILAW_VERSION}, {"abi", {ILAW_ABI_MAJOR, ILAW_ABI_MINOR}}}},
      {"scene", {{"file", scene.file.filename().string()}, {"title", scene.title}, {"source", scene.source}}},
      {"interfaces", interfaces},
      {"citations", cited_laws(scene)},
      {"interrupted", record.interrupted},
      {"failure", record.failure},
      {"steps", integrator.steps()},
      {"dt", scene.dt},
      {"critical_step", number_or_inf(scene.model->critical_step())},
      {"stable_step", number_or_inf(tally.stable_step)},
      {"time", integrator.time()},
      {"nodes", scene.model->node_count()},
      {"state_hash", state_hash(scene, integrator)},
      {"energy", describe_energy(integrator.energy())},
      {"forces", record.forces},
      {"warnings", warnings},
      {"penetration_max", tally.penetration_max},
      {"status_counts", describe_statuses(tally)},
      {"coupling",
       {{"sweeps", tally.sweeps},
        {"sweeps_max", tally.sweeps_max},
        {"residual_max", tally.coupling_residual_max},
        {"tolerance", tally.coupling_tolerance},
        {"energy", tally.coupling_energy},
        {"steps_unconverged", tally.unconverged},
        {"worst_node", tally.worst_node < 0 ? json() : json(tally.worst_node)}}},
      {"seconds",
       {{"total", record.seconds_total},
        {"steps", record.seconds_steps},
        {"internal_forces", seconds.internal_forces},
        {"interfaces", seconds.interfaces},
        {"output", record.seconds_output}}},
      {"execution", describe_execution(scene, tally, record, seconds)}};
  if (integrator.temperatures()) summary["heat"] = describe_heat(integrator.temperatures()->report());
  if (const auto& found = integrator.prestressed())
    summary["prestress"] = {{"steps", found->steps}, {"residual", found->residual}};
  else if (scene.prestress)  // before it is looked for
    summary["prestress"] = {{"steps", nullptr}, {"residual", nullptr}};
  if (!scene.meshes.empty()) summary["meshes"] = scene.meshes;
  return summary;
}

void write_summary(const json& summary, const std::filesystem::path& folder) {
  // Names of files need not be UTF-8.
  write_file(folder / "summary.json", summary.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

}  // namespace ilaw::host
