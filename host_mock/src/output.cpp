// SPDX-License-Identifier: BSD-3-Clause
#include "output.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
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
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Bytes up to the end of the last whole line.
std::uintmax_t size_of_lines(const std::filesystem::path& file) {
  std::uintmax_t size = 0;
  std::ifstream stream(file, std::ios::binary);
  for (std::string line; std::getline(stream, line) && !stream.eof();) size += line.size() + 1;
  return size;
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
          {"nodes_stored", interface.slot_count()},
          {"state_size", interface.info().state_size},
          {"bytes_per_node", interface.bytes_per_contact()}};
}

}  // namespace

bool make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::filesystem::path trial = folder / "ilaw.trial";
  const bool writable = std::ofstream(trial).is_open();
  std::filesystem::remove(trial, error);
  if (writable) return true;
  std::fprintf(stderr, "ilaw: --out %s: found a file or a place that cannot be written, expected a folder\n",
               folder.c_str());
  return false;
}

AtomicFile::AtomicFile(std::filesystem::path file)
    : file_(std::move(file)), partial_(file_.string() + ".partial"), stream_(partial_) {
  if (!stream_) throw std::runtime_error(partial_.string() + ": cannot be written");
}

AtomicFile::AtomicFile(std::filesystem::path file, std::uintmax_t size)
    : file_(std::move(file)), partial_(file_.string() + ".partial") {
  const std::filesystem::path found = std::filesystem::exists(partial_) ? partial_ : file_;
  const std::string expected = ", expected the first " + std::to_string(size) + " bytes of the run to resume";
  std::error_code error;
  const std::uintmax_t found_size = std::filesystem::file_size(found, error);
  if (error) throw std::runtime_error(found.string() + ": " + error.message() + expected);
  if (found_size < size)
    throw std::runtime_error(found.string() + ": found " + std::to_string(found_size) + " bytes" + expected);
  std::filesystem::rename(found, partial_, error);
  if (!error) std::filesystem::resize_file(partial_, size, error);
  if (error) throw std::runtime_error(partial_.string() + ": cannot be written: " + error.message());
  stream_.open(partial_, std::ios::app);
  if (!stream_) throw std::runtime_error(partial_.string() + ": cannot be written");
}

void AtomicFile::check() const {
  if (!stream_) throw std::runtime_error(file_.string() + ": could not be written whole; is the disk full?");
}

std::uintmax_t AtomicFile::flush() {
  stream_.flush();
  check();
  return std::filesystem::file_size(partial_);
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!committed_) std::filesystem::remove(partial_, ignored);
}

void AtomicFile::commit() {
  stream_.close();
  check();
  std::filesystem::rename(partial_, file_);
  committed_ = true;
}

void AtomicFile::keep_lines() {
  stream_.close();
  std::error_code ignored;
  if (!stream_) std::filesystem::resize_file(partial_, size_of_lines(partial_), ignored);
  std::filesystem::rename(partial_, file_, ignored);
  committed_ = true;
}

History::History(const Scene& scene, const Integrator& integrator, const std::filesystem::path& folder)
    : scene_(scene), file_(folder / "history.csv") {
  find_contacts(integrator);
  write_header();
}

History::History(const Scene& scene, const Integrator& integrator, const std::filesystem::path& folder,
                 std::uintmax_t size)
    : scene_(scene), file_(folder / "history.csv", size) {
  find_contacts(integrator);
}

void History::find_contacts(const Integrator& integrator) {
  for (int node : scene_.output.watch) {
    std::vector<Contact>& contacts = contacts_.emplace_back();
    for (const auto& interface : scene_.interfaces) {
      const auto found = std::find(interface->nodes().begin(), interface->nodes().end(), node);
      if (found == interface->nodes().end()) continue;
      const int place = static_cast<int>(found - interface->nodes().begin());
      contacts.push_back({interface.get(), place, interface->slot_of(place, integrator.displacement()), ""});
    }
    const std::string name = "n" + std::to_string(node) + ".";
    for (Contact& contact : contacts)
      contact.prefix = contacts.size() == 1 ? name : name + contact.interface->name() + ".";
  }
}

void History::write_header() {
  std::ostream& out = file_.stream();
  const int d = scene_.model->dimension();
  out << "time";
  for (std::size_t w = 0; w < contacts_.size(); ++w) {
    const std::string node = "n" + std::to_string(scene_.output.watch[w]) + ".";
    for (const char* quantity : {"u", "v", "r"})
      for (int c = 0; c < d; ++c) out << ',' << node << quantity << c;
    for (const Contact& contact : contacts_[w]) {
      out << ',' << contact.prefix << "gap," << contact.prefix << "status";
      for_each_state(contact.interface->info(),
                     [&](const std::string& name, int) { out << ',' << contact.prefix << name; });
    }
  }
  if (scene_.output.balance) {
    out << ",balance.kinetic,balance.internal,balance.potential,balance.external_work,balance.interface_work,"
           "balance.error";
    for (int c = 0; c < (d == 1 ? 0 : d == 2 ? 1 : 3); ++c) out << ",balance.angular_momentum" << c;
  }
  out << '\n';
}

void History::add_node(std::size_t watched, const Integrator& integrator, const Dofs& impulse) {
  std::ostream& out = file_.stream();
  const int d = scene_.model->dimension();
  const Eigen::Index node = static_cast<Eigen::Index>(scene_.output.watch[watched]) * d;
  for (const Dofs* quantity : {&integrator.displacement(), &integrator.velocity(), &impulse})
    for (int c = 0; c < d; ++c) out << ',' << number((*quantity)[node + c]);
  for (const Contact& contact : contacts_[watched]) {
    const Interface& interface = *contact.interface;
    const int status = interface.was_asked(contact.slot) ? interface.status(contact.slot) : int{ILAW_FREE};
    out << ',' << number(interface.gap_at(contact.place, integrator.displacement(), integrator.time())) << ','
        << status;
    for_each_state(interface.info(), [&](const std::string&, int entry) {
      out << ',' << number(interface.state(contact.slot, entry));
    });
  }
}

void History::add_row(const Integrator& integrator) {
  std::ostream& out = file_.stream();
  out << number(integrator.time());
  if (!contacts_.empty()) {
    const Dofs impulse = integrator.interface_impulse();
    for (std::size_t w = 0; w < contacts_.size(); ++w) add_node(w, integrator, impulse);
  }
  if (scene_.output.balance) {
    const EnergyReport energy = integrator.energy();
    for (const double value : {energy.kinetic, energy.internal, energy.potential, energy.external_work,
                               energy.interface_work, energy.balance_error})
      out << ',' << number(value);
    for (const double component : integrator.angular_momentum()) out << ',' << number(component);
  }
  out << '\n';
  file_.check();
}

void write_summary(const Scene& scene, const Integrator& integrator, const RunRecord& record,
                   const std::filesystem::path& folder) {
  const EnergyReport energy = integrator.energy();
  const Tally& tally = integrator.tally();
  json statuses = json::object();
  for (std::size_t k = 0; k < ILAW_STATUS_COUNT; ++k) statuses[status_names[k]] = tally.status_counts[k];
  const PhaseSeconds& seconds = integrator.seconds();
  const double stepping = seconds.internal_forces + seconds.interfaces;
  const double interface_share = stepping > 0.0 ? seconds.interfaces / stepping : 0.0;
  json interfaces = json::array();
  for (const auto& interface : scene.interfaces) interfaces.push_back(describe_interface(*interface));
  std::vector<std::string> warnings = scene.warnings;
  warnings.insert(warnings.end(), record.warnings.begin(), record.warnings.end());
  const json summary = {
      {"program", {{"name", "ilaw"}, {"version", ILAW_VERSION}, {"abi", {ILAW_ABI_MAJOR, ILAW_ABI_MINOR}}}},
      {"scene", {{"file", scene.file.filename().string()}, {"title", scene.title}, {"source", scene.source}}},
      {"interfaces", interfaces},
      {"resumed_at_step", record.resumed_at},
      {"interrupted", record.interrupted},
      {"failure", record.failure},
      {"steps", integrator.steps()},
      {"dt", scene.dt},
      {"time", integrator.time()},
      {"nodes", scene.model->node_count()},
      {"energy",
       {{"kinetic", energy.kinetic},
        {"internal", energy.internal},
        {"potential", energy.potential},
        {"external_work", energy.external_work},
        {"interface_work", energy.interface_work},
        {"balance_error", energy.balance_error},
        {"dissipated_friction", energy.by_law[ILAW_ENERGY_FRICTION]},
        {"dissipated_impact", energy.by_law[ILAW_ENERGY_IMPACT]},
        {"dissipated_rupture", energy.by_law[ILAW_ENERGY_RUPTURE]},
        {"stored", energy.by_law[ILAW_ENERGY_STORED]},
        {"least_dissipation", energy.least_dissipation},
        {"reaction_work", energy.reaction_work}}},
      {"warnings", warnings},
      {"penetration_max", tally.penetration_max},
      {"status_counts", statuses},
      {"node_steps", {{"asked", tally.asked}, {"skipped", tally.skipped}}},
      {"coupling",
       {{"sweeps", tally.sweeps},
        {"sweeps_max", tally.sweeps_max},
        {"residual_max", tally.coupling_residual_max},
        {"steps_unconverged", tally.unconverged}}},
      {"seconds",
       {{"total", record.seconds_total},
        {"internal_forces", integrator.seconds().internal_forces},
        {"interfaces", integrator.seconds().interfaces},
        {"output", record.seconds_output}}},
      {"interface_share", interface_share}};
  AtomicFile file(folder / "summary.json");
  file.stream() << summary.dump(2) << '\n';
  file.commit();
}

}  // namespace ilaw::host
