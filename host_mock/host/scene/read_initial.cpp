// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "model/elements.hpp"
#include "scene/json_text.hpp"
#include "scene/values.hpp"

#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

Eigen::MatrixXd read_gradient(const json& part, int d, const std::string& pointer) {
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(d, d);
  if (!part.contains("gradient")) return gradient;
  const json& rows = part["gradient"];
  if (static_cast<int>(rows.size()) != d)
    throw mistake(pointer, std::to_string(rows.size()) + " rows",
                  std::to_string(d) + ", the dimension of the model");
  for (int k = 0; k < d; ++k)
    gradient.row(k) =
        read_vector(rows[static_cast<std::size_t>(k)], d, at(pointer, static_cast<std::size_t>(k)));
  return gradient;
}

}  // namespace

void read_initial(const json& initial, Model& model) {
  const int d = model.dimension();
  Dofs u = model.initial_displacement();
  for (std::size_t i = 0; i < initial.size(); ++i) {
    const json& part = initial[i];
    const std::string pointer = at("/initial", i);
    if (!part.contains("displacement") && !part.contains("gradient"))
      throw mistake(pointer, part.dump(), "'displacement', 'gradient' or both");
    const Vector displacement = read_vector_or_zero(part, "displacement", d, pointer);
    const Eigen::MatrixXd gradient = read_gradient(part, d, pointer + "/gradient");
    for (const int node : select_nodes(part.value("nodes", json("all")), model, pointer + "/nodes").nodes) {
      const Eigen::Index first = Eigen::Index{node} * d;
      u.segment(first, d) += displacement + gradient * model.position().segment(first, d);
    }
  }
  if (const InvertedElement inverted = first_inverted(model, u); inverted.number >= 0)
    throw SceneError("/initial", "element " + std::to_string(inverted.number) +
                                     " is turned inside out at the start, expected smaller displacements");
  model.displace(u);
}

}  // namespace ilaw::host
