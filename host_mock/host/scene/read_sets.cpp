// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "model/model.hpp"
#include "scene/json_text.hpp"
#include "scene/selection.hpp"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

void check_name(const std::string& name, const Model& model, const std::string& pointer) {
  if (name.empty() || !is_letter(name.front()) || !std::all_of(name.begin(), name.end(), is_in_name))
    throw mistake(pointer, "the name '" + name + "'", "a letter, then letters, digits and _");
  if (model.sets().count(name) > 0)
    throw mistake(pointer, "'" + name + "', which the model has", "a name of its own");
}

}  // namespace

// By the model's own sets, not by each other: members of a JSON object have no order.
void read_sets(const json& sets, Model& model) {
  std::vector<std::pair<std::string, NodeSet>> found;
  for (const auto& [name, selection] : sets.items()) {
    const std::string pointer = "/sets/" + name;
    check_name(name, model, pointer);
    found.emplace_back(name, select_nodes(selection, model, pointer));
  }
  for (auto& [name, set] : found) model.add_set(name, std::move(set));
}

}  // namespace ilaw::host
