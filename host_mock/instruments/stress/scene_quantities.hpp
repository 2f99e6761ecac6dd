// scene_quantities.hpp - what each number of a scene measures, so that a scene can be written in other
// units, axes and origins of space and time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <functional>
#include <string>
#include <string_view>

namespace ilaw::host {

struct Quantity {
  enum class Form {
    scalar,
    place,    // a point, or its coordinate in 1D
    vector,   // with a direction
    each,     // a number per axis, without a direction
    axes,     // numbers of axes
    spin,     // about an axis or a normal: a mirror changes its sign
    instant,  // a time since the start
    neutral   // the same in all units and axes, as a node's number or a Poisson's ratio
  };
  std::string_view pattern;  // a JSON pointer, with * for any index; of rows [time, ...]: what they give
  Form form;
  double mass = 0.0, length = 0.0, time = 0.0;  // powers in its unit
};

// Calls visit for the number or the vector of each known quantity below "model", "loads", "interfaces" and
// the other parts of a scene but the parameters of laws. Returns false if a number is of no known quantity.
bool for_each_quantity(nlohmann::json& scene,
                       const std::function<void(const Quantity&, nlohmann::json&)>& visit);

}  // namespace ilaw::host
