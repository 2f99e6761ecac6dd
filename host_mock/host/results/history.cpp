// SPDX-License-Identifier: BSD-3-Clause
#include "results/history.hpp"

#include "base/words.hpp"

#include <algorithm>
#include <string>

namespace ilaw::host {
namespace {

// Named state variables. Histories and what is internal mean nothing outside their law.
template <class Visit>
void for_each_state(const ilaw_instance_info& info, Visit visit) {
  int entry = 0;
  for (std::uint32_t i = 0; i < info.state_variable_count; ++i) {
    const ilaw_state_variable& variable = *info.state_variables[i];
    const auto count = static_cast<int>(variable.count);
    const bool is_shown = (variable.flags & ILAW_FLAG_INTERNAL) == 0;
    if (is_shown && variable.kind == ILAW_KIND_SCALAR) visit(std::string(variable.name), entry);
    if (is_shown && (variable.kind == ILAW_KIND_VECTOR || variable.kind == ILAW_KIND_TANGENTIAL))
      for (int k = 0; k < count; ++k) visit(variable.name + std::to_string(k), entry + k);
    entry += count;
  }
}

}  // namespace

History::History(const Scene& scene, Integrator& integrator) : scene_(scene), forces_(scene, integrator) {
  find_contacts();
  find_motions(integrator);
}

void History::open(const std::filesystem::path& folder, const std::optional<FileMark>& written) {
  file_.emplace(folder / "history.csv", written);
  table_.emplace(file_->stream());
  if (written) return;
  for (const std::string& name : columns()) *table_ << name;
  table_->end_row();
}

// The impulse of a driven node that is in no interface is the reaction of its holder.
void History::find_motions(Integrator& integrator) {
  const std::vector<int>& watch = scene_.output.watch;
  for (std::size_t k = 0; k < scene_.loads.size(); ++k) {
    const std::vector<int>& driven = scene_.loads[k]->prescribed_nodes();
    if (std::find_first_of(watch.begin(), watch.end(), driven.begin(), driven.end()) == watch.end()) continue;
    integrator.keep_load_impulse(k);
    motions_.push_back(k);
  }
}

void History::find_contacts() {
  for (int node : scene_.output.watch) {
    std::vector<Contact>& contacts = contacts_.emplace_back();
    is_alone_.push_back(true);
    for (const auto& interface : scene_.interfaces) {
      const std::vector<int>& partners = interface->setup().counterpart->partners();
      if (std::find(partners.begin(), partners.end(), node) != partners.end()) is_alone_.back() = false;
      const auto found = std::find(interface->nodes().begin(), interface->nodes().end(), node);
      if (found == interface->nodes().end()) continue;
      const int node_index = static_cast<int>(found - interface->nodes().begin());
      contacts.push_back({interface.get(), node_index, ""});
      if (scene_.output.contact) interface->keep_wear();
    }
    if (!contacts.empty()) is_alone_.back() = false;
    const std::string name = "n" + std::to_string(node) + ".";
    for (Contact& contact : contacts)
      contact.prefix = contacts.size() == 1 ? name : name + contact.interface->name() + ".";
  }
}

std::vector<std::string> History::columns() const {
  const int d = scene_.model->dimension();
  std::vector<std::string> names = {"time"};
  for (std::size_t w = 0; w < contacts_.size(); ++w) {
    const std::string node = "n" + std::to_string(scene_.output.watch[w]) + ".";
    for (const char* quantity : {"u", "v", "r"})
      for (int c = 0; c < d; ++c) names.push_back(node + quantity + std::to_string(c));
    if (has_temperature(scene_.output.watch[w])) names.push_back(node + "T");
    for (const Contact& contact : contacts_[w]) {
      names.push_back(contact.prefix + "gap");
      names.push_back(contact.prefix + "status");
      for_each_state(contact.interface->info(),
                     [&](const std::string& name, int) { names.push_back(contact.prefix + name); });
      if (!scene_.output.contact) continue;
      for (const char* quantity : {"pressure", "shear", "slip_length", "wear_depth"})
        names.push_back(contact.prefix + quantity);
    }
  }
  forces_.add_names(names);
  if (!scene_.output.energy.empty()) names.push_back("balance." + scene_.output.energy);
  if (scene_.output.energy == "reaction_work") names.emplace_back("balance.largest");
  if (scene_.output.balance) {
    for (const char* quantity :
         {"kinetic", "internal", "potential", "external_work", "damping_work", "interface_work",
          "dissipated_friction", "dissipated_impact", "dissipated_rupture", "stored", "error"})
      names.push_back(std::string("balance.") + quantity);
    for (int c = 0; c < (d == 1 ? 0 : d == 2 ? 1 : 3); ++c)
      names.push_back("balance.angular_momentum" + std::to_string(c));
    if (scene_.model->thermal())
      for (const char* quantity : {"stored", "obstacles", "friction", "supplied", "error"})
        names.push_back(std::string("heat.") + quantity);
  }
  return names;
}

bool History::has_temperature(int node) const {
  return scene_.model->thermal() && scene_.model->thermal()->has_temperature(node);
}

void History::add_node(std::size_t watched, const Integrator& integrator, const Dofs& impulse) {
  const int d = scene_.model->dimension();
  const Eigen::Index node = static_cast<Eigen::Index>(scene_.output.watch[watched]) * d;
  const auto add = [&](const Dofs& quantity) {
    for (int c = 0; c < d; ++c) *table_ << quantity[node + c];
  };
  add(integrator.displacement());
  add(integrator.velocity());
  add(impulse);
  if (has_temperature(scene_.output.watch[watched]))
    *table_ << integrator.temperatures()->at(scene_.output.watch[watched]);
  for (const Contact& contact : contacts_[watched]) {
    const Interface& interface = *contact.interface;
    interface.setup().counterpart->follow(integrator.displacement());
    const int contact_index = interface.contact_at(contact.node_index);
    const int status = interface.is_active(contact_index) ? interface.status(contact_index) : int{ILAW_FREE};
    *table_ << interface.gap_at(contact.node_index, integrator.displacement(), integrator.time()) << status;
    const std::vector<double> state = interface.state_at(contact.node_index, integrator.displacement());
    for_each_state(interface.info(),
                   [&](const std::string&, int entry) { *table_ << state[static_cast<std::size_t>(entry)]; });
    if (!scene_.output.contact) continue;
    // A point may have no area.
    *table_ << contact.last.pressure << contact.last.shear << contact.slip << contact.wear;
  }
}

template <class Visit>
void History::for_each_acting(Visit visit) {
  if (!scene_.output.contact) return;
  for (std::vector<Contact>& contacts : contacts_)
    for (Contact& contact : contacts) {
      const int index = contact.interface->contact_at(contact.node_index);
      if (contact.interface->is_active(index) && contact.interface->status(index) != ILAW_FREE)
        visit(contact, index);
    }
}

void History::add_start(const Integrator& integrator) {
  forces_.add_start(integrator);
  for_each_acting([](Contact& contact, int index) { contact.wear += contact.interface->wear(index); });
}

void History::add_step(const Integrator& integrator) {
  forces_.add_step(integrator);
  for (std::vector<Contact>& contacts : contacts_)
    for (Contact& contact : contacts) contact.last = {};
  const StepView step{
      integrator.displacement(), integrator.velocity_before(), integrator.time(), scene_.dt, 0.0, 0.0,
      integrator.steps()};
  for_each_acting([&](Contact& contact, int index) {
    contact.last = contact.interface->rubbing(index, step);
    contact.slip += contact.last.slip;
    contact.wear += contact.interface->wear(index);
  });
}

nlohmann::json History::state() const {
  nlohmann::json sums = nlohmann::json::object();
  for (const std::vector<Contact>& contacts : contacts_)
    for (const Contact& contact : contacts)
      if (scene_.output.contact) sums[contact.prefix] = {contact.slip, contact.wear};
  return {{"columns", layout()}, {"forces", forces_.state()}, {"contacts", sums}, {"late_sums", late_sums_}};
}

void History::load(const nlohmann::json& state, std::int64_t step) {
  state.at("late_sums").get_to(late_sums_);
  std::vector<std::string> unknown = forces_.load(state.at("forces"));
  const nlohmann::json& sums = state.at("contacts");
  for (std::vector<Contact>& contacts : contacts_)
    for (Contact& contact : contacts)
      if (sums.contains(contact.prefix)) {
        sums.at(contact.prefix).at(0).get_to(contact.slip);
        sums.at(contact.prefix).at(1).get_to(contact.wear);
      } else if (scene_.output.contact) {
        unknown.push_back(contact.prefix + "slip_length");
        unknown.push_back(contact.prefix + "wear_depth");
      }
  if (!unknown.empty())
    late_sums_.push_back(joined(unknown) + ": summed from step " + std::to_string(step) +
                         " only, because the run before it did not ask for them");
}

void History::add_row(const Integrator& integrator) {
  *table_ << integrator.time();
  if (!contacts_.empty()) {
    const Dofs impulse = integrator.interface_impulse();
    Dofs held = Dofs::Zero(motions_.empty() ? 0 : impulse.size());
    for (const std::size_t load : motions_) integrator.add_load_impulse(load, held);
    for (std::size_t w = 0; w < contacts_.size(); ++w)
      add_node(w, integrator, is_alone_[w] && !motions_.empty() ? held : impulse);
  }
  forces_.write_row(*table_, integrator.time());
  if (scene_.output.energy == "interface_work") *table_ << integrator.interface_work();
  if (scene_.output.energy == "reaction_work") {
    const EnergyReport energy = integrator.energy();
    *table_ << energy.reaction_work << energy.scale;
  }
  if (scene_.output.balance) {
    const EnergyReport energy = integrator.energy();
    for (const double value :
         {energy.kinetic, energy.internal, energy.potential, energy.external_work, energy.damping_work,
          energy.interface_work, energy.by_law[ILAW_ENERGY_FRICTION], energy.by_law[ILAW_ENERGY_IMPACT],
          energy.by_law[ILAW_ENERGY_RUPTURE], energy.by_law[ILAW_ENERGY_STORED], energy.balance_error})
      *table_ << value;
    for (const double component : integrator.angular_momentum()) *table_ << component;
    if (integrator.temperatures()) {
      const HeatReport heat = integrator.temperatures()->report();
      for (const double value :
           {heat.stored, heat.obstacles, heat.friction, heat.supplied, heat.balance_error})
        *table_ << value;
    }
  }
  table_->end_row();
  file_->check();
}

}  // namespace ilaw::host
