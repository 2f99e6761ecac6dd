// SPDX-License-Identifier: BSD-3-Clause
#include "output.hpp"

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

constexpr const char* status_names[ILAW_STATUS_COUNT] = {"free",   "closed", "stick",  "slip",
                                                         "bonded", "broken", "healed", "bad_input"};

// Shortest text that reads back to the same double.
std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

// Named state variables: histories mean nothing outside their law.
template <class Visit>
void for_each_state(const ilaw_instance_info& info, Visit visit) {
  int entry = 0;
  for (std::uint32_t i = 0; i < info.state_variable_count; ++i) {
    const ilaw_state_variable& variable = *info.state_variables[i];
    const auto count = static_cast<int>(variable.count);
    if (variable.kind == ILAW_STATE_SCALAR) visit(std::string(variable.name), entry);
    if (variable.kind == ILAW_STATE_VECTOR)
      for (int k = 0; k < count; ++k) visit(variable.name + std::to_string(k), entry + k);
    entry += count;
  }
}

json describe_interface(const Interface& interface) {
  return {{"name", interface.name()},
          {"law", interface.setup().law},
          {"library", interface.library().path()},
          {"library_version", interface.library().plugin().version},
          {"nodes", interface.nodes().size()},
          {"state_size", interface.info().state_size}};
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path file)
    : file_(std::move(file)), partial_(file_.string() + ".partial"), stream_(partial_) {
  if (!stream_) throw std::runtime_error(partial_.string() + ": cannot be written");
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!committed_) std::filesystem::remove(partial_, ignored);
}

void AtomicFile::commit() {
  stream_.close();
  if (!stream_)
    throw std::runtime_error(partial_.string() + ": could not be written whole; is the disk full?");
  std::filesystem::rename(partial_, file_);
  committed_ = true;
}

History::History(const Scene& scene, const std::filesystem::path& folder)
    : scene_(scene), file_(folder / "history.csv") {
  find_contacts();
  write_header();
}

void History::find_contacts() {
  for (int node : scene_.output.watch) {
    std::vector<Contact>& contacts = contacts_.emplace_back();
    for (const auto& interface : scene_.interfaces) {
      const auto found = std::find(interface->nodes().begin(), interface->nodes().end(), node);
      if (found != interface->nodes().end())
        contacts.push_back({interface.get(), static_cast<int>(found - interface->nodes().begin()), ""});
    }
    const std::string name = "n" + std::to_string(node) + ".";
    for (Contact& contact : contacts)
      contact.prefix = contacts.size() == 1 ? name : name + contact.interface->name() + ".";
  }
}

void History::write_header() {
  std::ostream& out = file_.stream();
  out << "time";
  for (std::size_t w = 0; w < contacts_.size(); ++w) {
    const std::string node = "n" + std::to_string(scene_.output.watch[w]) + ".";
    for (const char* quantity : {"u", "v", "r"})
      for (int c = 0; c < scene_.model->dimension(); ++c) out << ',' << node << quantity << c;
    for (const Contact& contact : contacts_[w]) {
      out << ',' << contact.prefix << "gap," << contact.prefix << "status";
      for_each_state(contact.interface->info(),
                     [&](const std::string& name, int) { out << ',' << contact.prefix << name; });
    }
  }
  out << '\n';
}

void History::add_row(const Integrator& integrator) {
  std::ostream& out = file_.stream();
  const int d = scene_.model->dimension();
  out << number(integrator.time());
  for (std::size_t w = 0; w < contacts_.size(); ++w) {
    const Eigen::Index node = scene_.output.watch[w] * d;
    for (const Dofs* quantity : {&integrator.displacement(), &integrator.velocity(), &integrator.impulse()})
      for (int c = 0; c < d; ++c) out << ',' << number((*quantity)[node + c]);
    for (const Contact& contact : contacts_[w]) {
      out << ',' << number(contact.interface->gap(contact.place)) << ','
          << contact.interface->status(contact.place);
      for_each_state(contact.interface->info(), [&](const std::string&, int entry) {
        out << ',' << number(contact.interface->state(contact.place, entry));
      });
    }
  }
  out << '\n';
}

void write_summary(const Scene& scene, const Integrator& integrator, const RunRecord& record,
                   const std::filesystem::path& folder) {
  const EnergyReport energy = integrator.energy();
  json statuses = json::object();
  for (std::size_t k = 0; k < ILAW_STATUS_COUNT; ++k)
    statuses[status_names[k]] = integrator.status_counts()[k];
  json interfaces = json::array();
  for (const auto& interface : scene.interfaces) interfaces.push_back(describe_interface(*interface));
  const json summary = {
      {"program", {{"name", "ilaw"}, {"version", ILAW_VERSION}, {"abi", {ILAW_ABI_MAJOR, ILAW_ABI_MINOR}}}},
      {"scene", {{"file", scene.file.filename().string()}, {"title", scene.title}, {"source", scene.source}}},
      {"interfaces", interfaces},
      {"interrupted", record.interrupted},
      {"failure", record.failure},
      {"steps", integrator.steps()},
      {"dt", scene.dt},
      {"time", integrator.time()},
      {"nodes", scene.model->node_count()},
      {"energy",
       {{"kinetic", energy.kinetic},
        {"internal", energy.internal},
        {"external_work", energy.external_work},
        {"interface_work", energy.interface_work},
        {"balance_error", energy.balance_error},
        {"dissipated_friction", energy.by_law[ILAW_ENERGY_FRICTION]},
        {"dissipated_impact", energy.by_law[ILAW_ENERGY_IMPACT]},
        {"dissipated_rupture", energy.by_law[ILAW_ENERGY_RUPTURE]},
        {"stored", energy.by_law[ILAW_ENERGY_STORED]},
        {"least_dissipation", energy.least_dissipation},
        {"reaction_work", energy.reaction_work}}},
      {"penetration_max", integrator.penetration_max()},
      {"status_counts", statuses},
      {"node_steps", {{"asked", integrator.node_steps_asked()}}},
      {"coupling",
       {{"sweeps_max", integrator.sweeps_max()}, {"residual_max", integrator.coupling_residual_max()}}},
      {"seconds",
       {{"total", record.seconds_total},
        {"internal_forces", integrator.seconds().internal_forces},
        {"interfaces", integrator.seconds().interfaces},
        {"output", record.seconds_output}}}};
  AtomicFile file(folder / "summary.json");
  file.stream() << summary.dump(2) << '\n';
  file.commit();
}

}  // namespace ilaw::host
