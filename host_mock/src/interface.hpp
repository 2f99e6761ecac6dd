// interface.hpp - one interface of a scene: a law between some nodes and an obstacle, driven through the ABI.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model.hpp"
#include "obstacle.hpp"

#include <ilaw/loader.hpp>

#include <cstdint>
#include <map>
#include <memory>
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

struct InterfaceSetup {
  std::string name, law, library;  // library: name or path
  Arguments arguments;
  std::vector<int> nodes;
  std::shared_ptr<const Obstacle> obstacle;
};

class Interface {
 public:
  // Loads the library and creates the law; throws ilaw::error with the loader's or the law's message.
  Interface(InterfaceSetup setup, const Model& model, double dt);

  const std::string& name() const { return setup_.name; }
  const InterfaceSetup& setup() const { return setup_; }
  const ilaw::library& library() const { return library_; }
  const ilaw_law& law() const { return interface_.law(); }
  const ilaw_instance_info& info() const { return info_; }
  const std::vector<int>& nodes() const { return setup_.nodes; }

  // First state of all nodes. Throws ilaw::error.
  void initialise(const Dofs& displacement, double time);

  // Gap, normal and obstacle velocity for a step that ends at time; displacement is that of time.
  void locate(const Dofs& displacement, double time, double dt);

  // Before the first evaluate of a step: no impulse yet.
  void forget_impulse() { impulse_.setZero(); }

  // Impulses for these velocities, always from the state before the step. Throws ilaw::error on bad nodes.
  void evaluate(const Dofs& v_free, const Dofs& v_previous, double time, double dt);

  // The step is done: its state becomes the state before the next.
  void accept() { state_.swap(next_state_); }

  // Of the last step, by place in nodes().
  auto impulse(int place) const { return impulse_.segment(place * dimension_, dimension_); }
  double gap(int place) const { return gap_[place]; }
  int status(int place) const { return status_[static_cast<std::size_t>(place)]; }
  // part: ILAW_ENERGY_*
  double energy(int place, int part) const { return energy_[ILAW_ENERGY_COUNT * place + part]; }
  Eigen::VectorXd obstacle_velocity() const { return obstacle_velocity_; }
  Eigen::VectorXd obstacle_velocity_before() const { return obstacle_velocity_before_; }
  // Accepted state; entry: double of the node's state.
  double state(int place, int entry) const {
    return state_[static_cast<Eigen::Index>(info_.state_size) * place + entry];
  }

 private:
  ilaw_batch batch(double time, double dt) const;
  std::string node_message(const ilaw_report& report) const;

  InterfaceSetup setup_;
  const Model& model_;
  int dimension_;
  ilaw::library library_;
  ilaw::interface interface_;
  ilaw_instance_info info_;
  std::vector<ilaw_input> per_node_;
  Dofs v_free_, v_previous_, normal_, impulse_;
  Eigen::VectorXd delassus_, gap_, area_, state_, next_state_, energy_;
  Eigen::VectorXd obstacle_velocity_, obstacle_velocity_before_;
  std::vector<std::uint8_t> status_;
};

}  // namespace ilaw::host
