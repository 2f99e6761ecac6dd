// window.hpp - nodes of a model that one law acts on, against a rigid shape. The lines of a /USERWI say
// which:
//
//   law coulomb
//   friction 0.3
//   plane 0 0 0  0 0 1
//   nodes 1 to 25 31
//
// Shapes: plane POINT NORMAL, sphere CENTER RADIUS, cylinder POINT AXIS RADIUS. A line `area` is of each
// node. All other lines are parameters of the law.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/loader.hpp>
#include <ilaw/shapes.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::openradioss {

// Of all nodes, in the order of the engine.
struct Arrays {
  std::size_t count;
  const int *user, *kinematic;  // user numbers; not 0: a rigid body, wall or tie moves the node
  double *x, *v, *d;
  const double* mass;
};

struct Shape {
  std::string kind;
  shapes::vector point{}, axis{};
  double radius = 0.0;

  shapes::surface surface_at(const shapes::vector& x) const;
};

struct Settings {
  std::string law;
  std::vector<std::pair<std::string, std::string>> parameters;
  std::vector<Shape> shapes;
  std::vector<int> nodes;
  double area = -1.0;  // not given
};

class Window {
 public:
  // Throws std::runtime_error with what is wrong with the lines.
  explicit Window(const std::string& lines);

  const Settings& settings() const { return settings_; }
  // Doubles that the engine keeps in its restart file. They begin as 0.
  std::size_t memory_size() const { return head_size + settings_.nodes.size() * state_size_; }

  // Before the first cycle of a run. last_step: of the run that this one continues, 0 of none.
  void bind(const Arrays& arrays, double* memory, double last_step);
  // At the end of a cycle, which has moved x by step times v. `time` is of its end.
  void apply(double time, double step);
  // Work of the law since the last call, for the energy balance of the engine.
  double take_work();

 private:
  enum Head : std::size_t {
    work,
    version,
    head_size
  };  // version: 1 + that of the state, 0 before a first step

  void gather(double step);
  void evaluate(double time, double velocity_step, double position_step);
  void scatter(double step);
  void check(ilaw_result code, const ilaw_report& report, double time, double velocity_step) const;

  Settings settings_;
  ilaw::interface law_;
  std::size_t state_size_;
  double state_version_;

  Arrays arrays_{};
  double* memory_ = nullptr;
  double last_step_ = 0.0;
  std::vector<std::size_t> rows_;
  std::vector<double> gap_, normal_, inverse_mass_, v_free_, v_previous_, impulse_;
};

}  // namespace ilaw::openradioss
