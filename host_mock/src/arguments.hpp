// arguments.hpp - parameters of a law, from a scene to the library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vector.hpp"

#include <ilaw/loader.hpp>
#include <nlohmann/json.hpp>

#include <map>
#include <string>
#include <vector>

namespace ilaw::host {

// Parameters of a law as a scene gives them.
struct Arguments {
  std::map<std::string, double> numbers;
  std::map<std::string, std::string> texts;
  std::map<std::string, std::vector<double>> tables;    // pairs (time, value)
  std::map<std::string, std::vector<double>> per_node;  // one value per node of the interface
};

// Reads the "parameters" of an interface of node_count nodes. Throws SceneError at the pointer.
Arguments read_arguments(const nlohmann::json& parameters, std::size_t node_count,
                         const std::string& pointer);

// Creates the law for nodes with spherical H and global axes; tangent is empty where none is given. Throws
// ilaw::error with the law's message, also about values per node.
ilaw::interface create_law(const std::string& law, const Arguments& given, const Vector& tangent,
                           const ilaw::library& library, int dimension, double dt);

}  // namespace ilaw::host
