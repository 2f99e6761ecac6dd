// SPDX-License-Identifier: BSD-3-Clause
#include "scene/sharp_nodes.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace ilaw::host {

SharpNodes sharp_nodes_of(const NodeSet& face, const Model& model) {
  constexpr double smooth_cosine = 0.766;                             // of 40 degrees
  std::map<std::pair<int, int>, std::vector<Eigen::Vector3d>> edges;  // normals of their facets
  const auto place = [&](int node) -> Eigen::Vector3d { return model.position(node); };
  for (const auto& facet : face.facets) {
    const Eigen::Vector3d normal =
        (place(facet[2]) - place(facet[0])).cross(place(facet[3]) - place(facet[1])).normalized();
    for (std::size_t k = 0; k < 4; ++k)
      if (const int one = facet[k], next = facet[(k + 1) % 4];
          one != next)  // a triangle names a corner twice
        edges[std::minmax(one, next)].push_back(normal);
  }
  SharpNodes found{{}, std::numeric_limits<double>::infinity()};
  std::set<int> nodes;
  for (const auto& [ends, normals] : edges) {
    found.shortest_edge = std::min(found.shortest_edge, (place(ends.first) - place(ends.second)).norm());
    if (normals.size() == 2 && normals[0].dot(normals[1]) > smooth_cosine) continue;
    nodes.insert({ends.first, ends.second});
  }
  for (std::size_t k = 0; k < face.nodes.size(); ++k) {
    if (!nodes.contains(face.nodes[k])) continue;
    found.set.nodes.push_back(face.nodes[k]);
    found.set.areas.push_back(face.areas[k]);
  }
  return found;
}

}  // namespace ilaw::host
