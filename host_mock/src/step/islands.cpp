// SPDX-License-Identifier: BSD-3-Clause
#include "step/islands.hpp"

#include <cstddef>
#include <numeric>

namespace ilaw::host {
namespace {

// Nodes that contacts join, as a forest: each points to one that it is joined to, roots to
// themselves.
class JoinedNodes {
 public:
  explicit JoinedNodes(int node_count) : joined_to_(static_cast<std::size_t>(node_count)) {
    std::iota(joined_to_.begin(), joined_to_.end(), 0);
  }
  int root(int node) {
    while (at(node) != node) node = at(node) = at(at(node));
    return node;
  }
  void join(int a, int b) { at(root(a)) = root(b); }

 private:
  int& at(int node) { return joined_to_[static_cast<std::size_t>(node)]; }
  std::vector<int> joined_to_;
};

}  // namespace

std::vector<ContactGroup> islands_of(const ContactGroup& group, int node_count) {
  JoinedNodes nodes(node_count);
  for (const auto& [interface, contacts] : group)
    for (const std::int32_t contact : contacts) {
      const int own = interface->node_of(contact);
      interface->point(contact).for_each_node(own, [&](int node, double) { nodes.join(own, node); });
    }
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> number(static_cast<std::size_t>(node_count), none), last_part;
  std::vector<ContactGroup> islands;
  for (std::size_t part = 0; part < group.size(); ++part)
    for (const std::int32_t contact : group[part].contacts) {
      std::size_t& island =
          number[static_cast<std::size_t>(nodes.root(group[part].interface->node_of(contact)))];
      if (island == none) {
        island = islands.size();
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
