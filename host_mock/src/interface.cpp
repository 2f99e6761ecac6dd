// SPDX-License-Identifier: BSD-3-Clause
#include "interface.hpp"

#include <deque>
#include <utility>

namespace ilaw::host {
namespace {

// The arguments of create, with the pointers that it wants; deque keeps addresses while growing.
class ArgumentList {
 public:
  explicit ArgumentList(const Arguments& given) {
    for (const auto& [name, value] : given.numbers) add(ILAW_VALUE_NUMBER, name).number = value;
    for (const auto& [name, text] : given.texts) add(ILAW_VALUE_TEXT, name).text = text.c_str();
    for (const auto& [name, pairs] : given.tables) {
      ilaw_argument& argument = add(ILAW_VALUE_TABLE, name);
      argument.values = pairs.data();
      argument.count = pairs.size() / 2;
    }
    for (const auto& [name, values] : given.per_node) add(ILAW_VALUE_PER_NODE, name);
    for (const ilaw_argument& argument : arguments_) pointers_.push_back(&argument);
  }

  const std::vector<const ilaw_argument*>& pointers() const { return pointers_; }

 private:
  ilaw_argument& add(std::uint32_t kind, const std::string& name) {
    ilaw_argument& argument = arguments_.emplace_back();
    argument = {};
    argument.struct_size = sizeof argument;
    argument.kind = kind;
    argument.name = name.c_str();
    return argument;
  }

  std::deque<ilaw_argument> arguments_;
  std::vector<const ilaw_argument*> pointers_;
};

ilaw::interface create(const InterfaceSetup& setup, const ilaw::library& library, int dimension, double dt) {
  const ArgumentList arguments(setup.arguments);
  ilaw_setup law{};
  law.struct_size = sizeof law;
  law.dimension = static_cast<std::uint32_t>(dimension);
  law.delassus_form = ILAW_DELASSUS_SCALAR;
  law.frame = ILAW_FRAME_GLOBAL;
  law.velocity_step = dt;
  law.arguments = arguments.pointers().data();
  law.argument_count = static_cast<std::uint32_t>(arguments.pointers().size());
  return {library, setup.law, law};
}

}  // namespace

Interface::Interface(InterfaceSetup setup, const Model& model, double dt)
    : setup_(std::move(setup)),
      model_(model),
      dimension_(model.dimension()),
      library_(setup_.library),
      interface_(create(setup_, library_, dimension_, dt)),
      info_(interface_.info()),
      status_(setup_.nodes.size()) {
  const auto count = static_cast<Eigen::Index>(setup_.nodes.size());
  for (Dofs* dofs : {&v_free_, &v_previous_, &normal_, &impulse_}) dofs->setZero(count * dimension_);
  for (Eigen::VectorXd* scalars : {&delassus_, &gap_, &area_}) scalars->setZero(count);
  for (Eigen::VectorXd* states : {&state_, &next_state_})
    states->setZero(count * static_cast<Eigen::Index>(info_.state_size));
  energy_.setZero(count * ILAW_ENERGY_COUNT);
  obstacle_velocity_.setZero(dimension_);
  obstacle_velocity_before_.setZero(dimension_);
  for (Eigen::Index k = 0; k < count; ++k) {
    const int node = setup_.nodes[static_cast<std::size_t>(k)];
    delassus_[k] = 1.0 / model.mass()[node * dimension_];
    area_[k] = model.tributary_area()[node];
  }
  for (std::uint32_t k = 0; k < info_.per_node_parameter_count; ++k)
    per_node_.push_back({setup_.arguments.per_node.at(info_.per_node_parameters[k]).data(), 1, 1});
}

ilaw_batch Interface::batch(double time, double dt) const {
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = static_cast<std::int64_t>(setup_.nodes.size());
  batch.time = time;
  batch.velocity_step = dt;
  batch.position_step = dt;
  batch.area = {area_.data(), 1, 1};
  batch.normal = {normal_.data(), dimension_, 1};
  batch.per_node_parameters = per_node_.data();
  return batch;
}

std::string Interface::node_message(const ilaw_report& report) const {
  const std::string reason = report.reason ? report.reason : "no reason given";
  std::string text = "interface '" + setup_.name + "' (law '" + setup_.law + "'): ";
  if (report.first_bad_node < 0) return text + reason;
  const int node = setup_.nodes[static_cast<std::size_t>(report.first_bad_node)];
  return text + std::to_string(report.bad_count) + " node(s) refused, first node " + std::to_string(node) +
         ": " + reason;
}

void Interface::initialise(const Dofs& displacement, double time) {
  locate(displacement, time, 1.0);
  ilaw_batch b = batch(time, 1.0);
  b.state_out = {state_.data(), static_cast<std::int64_t>(info_.state_size), 1};
  ilaw_report report{};
  report.struct_size = sizeof report;
  const std::int32_t code = interface_.initialise(b, &report);
  if (code != ILAW_OK) throw ilaw::error(code, node_message(report));
}

void Interface::locate(const Dofs& displacement, double time, double dt) {
  const Obstacle& obstacle = *setup_.obstacle;
  obstacle_velocity_before_ = obstacle.velocity(time - dt, time);
  obstacle_velocity_ = obstacle.velocity(time, time + dt);
  for (std::size_t k = 0; k < setup_.nodes.size(); ++k) {
    const Eigen::Index node = setup_.nodes[k] * dimension_, place = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd x =
        model_.position().segment(node, dimension_) + displacement.segment(node, dimension_);
    gap_[place] = obstacle.gap(x, time);
    normal_.segment(place * dimension_, dimension_) = obstacle.normal(x, time);
  }
}

void Interface::evaluate(const Dofs& v_free, const Dofs& v_previous, double time, double dt) {
  for (std::size_t k = 0; k < setup_.nodes.size(); ++k) {
    const Eigen::Index node = setup_.nodes[k] * dimension_, place = static_cast<Eigen::Index>(k) * dimension_;
    v_free_.segment(place, dimension_) = v_free.segment(node, dimension_) - obstacle_velocity_;
    v_previous_.segment(place, dimension_) = v_previous.segment(node, dimension_) - obstacle_velocity_before_;
  }
  ilaw_batch b = batch(time, dt);
  const auto size = static_cast<std::int64_t>(info_.state_size);
  b.v_free = {v_free_.data(), dimension_, 1};
  b.v_previous = {v_previous_.data(), dimension_, 1};
  b.delassus = {delassus_.data(), 1, 1};
  b.gap = {gap_.data(), 1, 1};
  b.state_in = {state_.data(), size, 1};
  b.state_out = {next_state_.data(), size, 1};
  b.impulse = {impulse_.data(), dimension_, 1};
  b.energy = {energy_.data(), ILAW_ENERGY_COUNT, 1};
  b.status = status_.data();
  b.status_stride = 1;
  ilaw_report report{};
  report.struct_size = sizeof report;
  const std::int32_t code = interface_.evaluate(b, &report);
  if (code != ILAW_OK) throw ilaw::error(code, node_message(report));
}

}  // namespace ilaw::host
