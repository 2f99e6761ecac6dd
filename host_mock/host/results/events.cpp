// SPDX-License-Identifier: BSD-3-Clause
#include "results/events.hpp"

#include <array>
#include <string>

namespace ilaw::host {

Events::Events(const Scene& scene, const std::filesystem::path& folder,
               const std::optional<FileMark>& written, const Touching& touching)
    : scene_(scene),
      file_(folder / "events.csv", written),
      table_(file_.stream()),
      touching_(touching),
      still_touching_(scene.interfaces.size()) {
  touching_.resize(scene.interfaces.size());
  if (written) return;
  for (const char* column : {"time", "node", "interface", "event"}) table_ << column;
  for (int c = 0; c < scene.model->dimension(); ++c) table_ << "r" + std::to_string(c);
  table_.end_row();
}

void Events::add_step(const Integrator& integrator) {
  for (std::size_t i = 0; i < scene_.interfaces.size(); ++i) add_interface(i, integrator);
  file_.check();
}

// Both the active contacts and those that touched before are in the order of the interface's nodes.
// Contacts that are not active are free.
void Events::add_interface(std::size_t number, const Integrator& integrator) {
  static constexpr std::array<double, 3> none{};
  const Interface& interface = *scene_.interfaces[number];
  const double time = integrator.time();
  const std::vector<int>& before = touching_[number];
  std::vector<int>& now = still_touching_[number];
  now.clear();
  auto next = before.begin();
  const auto release_up_to = [&](int node_index) {
    for (; next != before.end() && *next < node_index; ++next)
      add_row(time, interface.nodes()[static_cast<std::size_t>(*next)], interface, "release", none.data());
  };
  for (const std::int32_t contact : interface.active()) {
    const int node_index = interface.node_index_of(contact), status = interface.status(contact);
    release_up_to(node_index);
    const bool touched = next != before.end() && *next == node_index, touches = status != ILAW_FREE;
    if (touched) ++next;
    if (touches) now.push_back(node_index);
    const auto add = [&](const char* event) {
      add_row(time, interface.node_of(contact), interface, event, interface.impulse(contact).data());
    };
    if (touches && !touched) add("contact");
    if (status == ILAW_HEALED) add("healing");
    if (status == ILAW_BROKEN) add("rupture");
    if (touched && !touches) add("release");
  }
  release_up_to(static_cast<int>(interface.nodes().size()));
  touching_[number].swap(now);
}

void Events::add_row(double time, int node, const Interface& interface, const char* event,
                     const double* impulse) {
  table_ << time << node << interface.name() << event;
  for (int c = 0; c < scene_.model->dimension(); ++c) table_ << impulse[c];
  table_.end_row();
}

}  // namespace ilaw::host
