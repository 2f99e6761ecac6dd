// SPDX-License-Identifier: BSD-3-Clause
#include "step/islands.hpp"

#include <cmath>
#include <cstddef>
#include <unordered_map>

namespace ilaw::host {
namespace {

// Nodes that contacts join, as a forest: each points to one that it is joined to, roots to themselves. Those
// that no contact has are not in it.
class JoinedNodes {
 public:
  int root(int node) {
    while (at(node) != node) node = at(node) = at(at(node));
    return node;
  }
  void join(int a, int b) {
    const int other = root(b);
    at(root(a)) = other;
  }

 private:
  int& at(int node) { return joined_to_.try_emplace(node, node).first->second; }
  std::unordered_map<int, int> joined_to_;
};

}  // namespace

Eigen::Index contact_count(const ContactGroup& group) {
  std::size_t count = 0;
  for (const ContactPart& part : group) count += part.contacts.size();
  return static_cast<Eigen::Index>(count);
}

Dofs scaled_impulses(const ContactGroup& group) {
  std::vector<double> scaled;
  for_each_contact(group, [&](const Interface& interface, int contact, Eigen::Index /*k*/) {
    for (const double component : interface.impulse(contact))
      scaled.push_back(std::sqrt(interface.delassus(contact)) * component);
  });
  return Eigen::Map<const Dofs>(scaled.data(), static_cast<Eigen::Index>(scaled.size()));
}

std::vector<Vector> asked_velocities(const ContactGroup& group) {
  std::vector<Vector> velocities;
  for_each_contact(group, [&](const Interface& interface, int contact, Eigen::Index /*k*/) {
    velocities.emplace_back(interface.v_free(contact));
  });
  return velocities;
}

void answer_at(const ContactGroup& group, const std::vector<Vector>& velocities, const StepView& step) {
  for_each_contact(group, [&](Interface& interface, int contact, Eigen::Index k) {
    interface.ask_at(contact, velocities[static_cast<std::size_t>(k)]);
  });
  for (const auto& [interface, contacts] : group) interface->evaluate(contacts, step);
}

std::vector<ContactGroup> islands_of(const ContactGroup& group) {
  JoinedNodes nodes;
  for_each_contact(group, [&](const Interface& interface, int contact, Eigen::Index /*k*/) {
    const int own = interface.node_of(contact);
    interface.point(contact).for_each_node(own, [&](int node, double) { nodes.join(own, node); });
  });
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::unordered_map<int, std::size_t> island_of_root;
  std::vector<std::size_t> last_part;
  std::vector<ContactGroup> islands;
  for (std::size_t part = 0; part < group.size(); ++part)
    for (const std::int32_t contact : group[part].contacts) {
      const int root = nodes.root(group[part].interface->node_of(contact));
      const auto [found, is_new] = island_of_root.try_emplace(root, islands.size());
      const std::size_t island = found->second;
      if (is_new) {
        islands.emplace_back();
        last_part.push_back(none);
      }
      if (last_part[island] != part) islands[island].push_back({group[part].interface, {}});
      last_part[island] = part;
      islands[island].back().contacts.push_back(contact);
    }
  return islands;
}

}  // namespace ilaw::host
