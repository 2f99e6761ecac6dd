// law_arguments.hpp - parameters of a law, and how they reach the library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vector.hpp"

#include <ilaw/loader.hpp>

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::host {

// A parameter over one to three axes; the last axis varies fastest in values.
struct ArgumentTable {
  std::vector<ilaw::parameters::axis> axes;
  std::vector<double> values;
};

// Parameters of a law as a scene gives them.
struct Arguments {
  std::map<std::string, double> numbers;
  std::map<std::string, std::string> texts;
  std::map<std::string, ArgumentTable> tables;
  std::map<std::string, std::vector<double>> per_node;  // one value per node of the interface
  // Fields of the model at the interface's nodes. A law that has a field parameter of such a name gets it per
  // node, unless the scene gives the parameter.
  std::map<std::string, std::vector<double>> fields;
  bool is_reversed = false;  // the order in which the law is given them, which must change nothing

  bool gives(const std::string& name) const {
    return numbers.contains(name) || texts.contains(name) || tables.contains(name) || per_node.contains(name);
  }
  // Values of a parameter that the law reads per node.
  const std::vector<double>& values_of(const std::string& name) const {
    const auto given = per_node.find(name);
    return given == per_node.end() ? fields.at(name) : given->second;
  }
};

// A parameter that a law refuses: where it stands below "parameters" (empty: no single one is at
// fault), and whose values they are where they are given per node.
class ParameterError : public ilaw::error {
 public:
  ParameterError(const ilaw::error& refusal, std::string pointer, std::optional<std::size_t> node_index)
      : ilaw::error(refusal), pointer_(std::move(pointer)), node_index_(node_index) {}
  const std::string& pointer() const { return pointer_; }
  std::optional<std::size_t> node_index() const { return node_index_; }  // in the interface's list of nodes

 private:
  std::string pointer_;
  std::optional<std::size_t> node_index_;
};

// Creates the law for nodes with spherical or diagonal H in global axes; tangent is empty where none is
// given. Throws ParameterError, also about values per node, or ilaw::error, with the law's message.
ilaw::interface create_law(const std::string& law, const Arguments& given, const Vector& tangent,
                           const ilaw::library& library, int dimension,
                           std::uint32_t delassus_form = ILAW_DELASSUS_SCALAR);

// The same for a setup of any form of H, in any axes, that has no arguments yet.
ilaw::interface create_law(const std::string& law, const Arguments& given, ilaw_setup setup,
                           const ilaw::library& library);

}  // namespace ilaw::host
