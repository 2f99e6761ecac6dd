// SPDX-License-Identifier: BSD-3-Clause
#include "results/history.hpp"

#include "base/words.hpp"
#include "results/quantities.hpp"

#include <algorithm>
#include <string>

namespace ilaw::host {
History::History(const Scene& scene, Integrator& integrator)
    : scene_(scene), integrator_(integrator), forces_(scene, integrator) {
  find_contacts();
  find_motions(integrator);
  describe_columns();
}

void History::open(const std::filesystem::path& folder, const std::optional<FileMark>& written) {
  file_.emplace(folder / "history.csv", written);
  table_.emplace(file_->stream());
  if (written) return;
  for (const Column& column : columns_) *table_ << column.name;
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

// Names, and what stands below them once refresh() was called.
void History::describe_columns() {
  const Integrator& at = integrator_;
  const int d = scene_.model->dimension();
  const auto add = [this](const std::string& name, auto value) { columns_.push_back({name, value}); };
  add("time", [&at] { return at.time(); });
  for (std::size_t w = 0; w < contacts_.size(); ++w) {
    const int node = scene_.output.watch[w];
    const std::string name = "n" + std::to_string(node) + ".";
    const auto add_vector = [&](const char* quantity, auto dofs) {
      for (int c = 0; c < d; ++c)
        add(name + quantity + std::to_string(c), [=] { return dofs()[Eigen::Index{node} * d + c]; });
    };
    const Dofs& impulse = is_alone_[w] && !motions_.empty() ? held_ : impulse_;
    add_vector("u", [&at]() -> const Dofs& { return at.displacement(); });
    add_vector("v", [&at]() -> const Dofs& { return at.velocity(); });
    add_vector("r", [&impulse]() -> const Dofs& { return impulse; });
    if (scene_.model->thermal() && scene_.model->thermal()->has_temperature(node))
      add(name + "T", [&at, node] { return at.temperatures()->at(node); });
    for (const Contact& contact : contacts_[w]) {
      add(contact.prefix + "gap", [&at, &contact] {
        return contact.interface->gap_at(contact.node_index, at.displacement(), at.time());
      });
      add(contact.prefix + "status", [&contact] {
        const int index = contact.interface->contact_at(contact.node_index);
        return contact.interface->is_active(index) ? contact.interface->status(index) : int{ILAW_FREE};
      });
      for (const ShownState& state : shown_states(contact.interface->info()))
        for (std::size_t k = 0; k < state.count; ++k)
          add(contact.prefix + state.name + (state.is_vector ? std::to_string(k) : ""),
              [&contact, entry = state.entry + k] { return contact.state[entry]; });
      if (!scene_.output.contact) continue;
      add(contact.prefix + "pressure", [&contact] { return contact.last.pressure; });
      add(contact.prefix + "shear", [&contact] { return contact.last.shear; });
      add(contact.prefix + "slip_length", [&contact] { return contact.slip; });
      add(contact.prefix + "wear_depth", [&contact] { return contact.wear; });
    }
  }
  const std::vector<std::string> forces = forces_.names();
  for (std::size_t k = 0; k < forces.size(); ++k) add(forces[k], [this, k] { return forces_.means()[k]; });
  if (scene_.output.energy == "interface_work")
    add("balance.interface_work", [&at] { return at.interface_work(); });
  if (scene_.output.energy == "reaction_work") {
    add("balance.reaction_work", [this] { return energy_.reaction_work; });
    add("balance.largest", [this] { return energy_.scale; });
  }
  if (!scene_.output.balance) return;
  for (std::size_t k = 0; k < named(energy_).size(); ++k)
    add("balance." + std::string(named(energy_)[k].first), [this, k] { return named(energy_)[k].second; });
  add("balance.error", [this] { return energy_.balance_error; });
  for (Eigen::Index c = 0; c < (d == 1 ? 0 : d == 2 ? 1 : 3); ++c)
    add("balance.angular_momentum" + std::to_string(c), [this, c] { return angular_momentum_[c]; });
  if (!scene_.model->thermal()) return;
  for (std::size_t k = 0; k < named(heat_).size(); ++k)
    add("heat." + std::string(named(heat_)[k].first), [this, k] { return named(heat_)[k].second; });
  add("heat.error", [this] { return heat_.balance_error; });
}

// What several columns of a row are part of.
void History::refresh() {
  if (!contacts_.empty()) impulse_ = integrator_.interface_impulse();
  if (!motions_.empty()) held_.setZero(impulse_.size());
  for (const std::size_t load : motions_) integrator_.add_load_impulse(load, held_);
  for (std::vector<Contact>& contacts : contacts_)
    for (Contact& contact : contacts) {
      contact.interface->setup().counterpart->follow(integrator_.displacement());
      contact.state = contact.interface->state_at(contact.node_index, integrator_.displacement());
    }
  forces_.close_row(integrator_.time());
  if (scene_.output.balance || scene_.output.energy == "reaction_work") energy_ = integrator_.energy();
  if (scene_.output.balance) angular_momentum_ = integrator_.angular_momentum();
  if (scene_.output.balance && integrator_.temperatures()) heat_ = integrator_.temperatures()->report();
}

void History::add_row() {
  refresh();
  for (const Column& column : columns_) *table_ << column.value();
  table_->end_row();
  file_->check();
}

std::vector<std::string> History::names() const {
  std::vector<std::string> names;
  for (const Column& column : columns_) names.push_back(column.name);
  return names;
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

void History::add_start() {
  forces_.add_start(integrator_);
  for_each_acting([](Contact& contact, int index) { contact.wear += contact.interface->wear(index); });
}

void History::add_step() {
  forces_.add_step(integrator_);
  for (std::vector<Contact>& contacts : contacts_)
    for (Contact& contact : contacts) contact.last = {};
  const StepView step{
      integrator_.displacement(), integrator_.velocity_before(), integrator_.time(), scene_.dt, 0.0, 0.0,
      integrator_.steps()};
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

}  // namespace ilaw::host
