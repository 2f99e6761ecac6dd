// minimal.hpp - the parts of a minimal host: points, loads, and contacts that have a law.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace minimal {

using Values = std::vector<double>;
using Nodes = std::vector<std::int32_t>;

// Arrays have one entry or d entries for each point, point by point.
struct Points {
  std::size_t d;
  Values mass, area, position, velocity, stiffness;
};

// A force history(t) * direction on each node, or an acceleration of that size. The history is piecewise
// linear, constant outside its rows.
struct Force {
  Nodes nodes;
  Values direction, times, values;
  bool is_acceleration;
  double at(double time) const;
};

struct Shock {
  Nodes nodes;
  double time;
  Values impulse;
};

// A plane through `center` if the radius is 0, else a sphere; it moves at a constant velocity.
struct Obstacle {
  Values center, normal, velocity;
  double radius;
};

// The nodes that have one instance of a law, and all that the law reads and writes there.
struct Contacts {
  Contacts(std::string name_of, ilaw::interface law_of, Nodes nodes_of)
      : name(std::move(name_of)), law(std::move(law_of)), info(law.info()), nodes(std::move(nodes_of)) {}

  std::string name;
  ilaw::interface law;
  ilaw_instance_info info;
  Nodes nodes, partners;  // partners: nodes of another body; empty at an obstacle
  Obstacle obstacle;
  std::vector<Values> parameters;  // per node
  Values v_free, v_previous, delassus, gap, normal, area, state, impulse;
  std::vector<std::uint8_t> status;
  std::vector<ilaw_input> parameter_inputs;
};

struct Scene {
  std::string title;
  Points points;
  std::vector<Force> forces;
  std::vector<Shock> shocks;
  std::vector<Contacts> contacts;
  double dt;
  std::int64_t steps, every;
  Nodes watch;
};

// Throws std::invalid_argument with what is wrong in the scene and what is allowed.
Scene read_scene(const std::string& file);

struct Step {
  double time;                          // of the positions
  double velocity_step, position_step;  // an impulse is force times the first; a gap changes over the second
};

// The arrays of contacts as a law takes them.
ilaw_batch batch_of(Contacts& contacts, std::size_t d, const Step& step);

// Contacts that share nodes. An impulse of one changes v_free of the others, so they are solved together.
class CoupledContacts {
 public:
  static bool is_needed(const Scene& scene);
  // Takes v from v_free to the velocities with which all laws hold.
  void solve(Scene& scene, const Step& step, const Values& u, const Values& v_before, Values& v);

 private:
  ilaw::coupled solver_;
  double velocity_step_ = 0.0;  // of the last solve
};

}  // namespace minimal
