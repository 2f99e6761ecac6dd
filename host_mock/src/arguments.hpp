// arguments.hpp - parameters of a law, from a scene to the library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vector.hpp"

#include <ilaw/loader.hpp>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
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

// A parameter that a law refuses: where it stands below "parameters" (empty: no single one is at fault), and
// whose values they are where they are given per node.
class ParameterError : public ilaw::error {
 public:
  ParameterError(const ilaw::error& refusal, std::string pointer, std::optional<std::size_t> place)
      : ilaw::error(refusal), pointer_(std::move(pointer)), place_(place) {}
  const std::string& pointer() const { return pointer_; }
  std::optional<std::size_t> place() const { return place_; }  // in the interface's list of nodes

 private:
  std::string pointer_;
  std::optional<std::size_t> place_;
};

// Creates the law for nodes with spherical H and global axes; tangent is empty where none is given. Throws
// ParameterError, also about values per node, or ilaw::error, with the law's message.
ilaw::interface create_law(const std::string& law, const Arguments& given, const Vector& tangent,
                           const ilaw::library& library, int dimension);

}  // namespace ilaw::host
