// SPDX-License-Identifier: BSD-3-Clause
#include "contact/interface.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <istream>
#include <ostream>
#include <utility>

namespace ilaw::host {
namespace {

// Contacts of one evaluate when threads share a batch.
constexpr int chunk = 2048;

// For all contacts that find no other colour: they are solved one by one.
constexpr std::size_t serial_colour = 63;

template <class T>
void write(std::ostream& out, const std::vector<T>& values) {
  const std::uint64_t size = values.size();
  out.write(reinterpret_cast<const char*>(&size), sizeof size);
  out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(size * sizeof(T)));
}

template <class T>
std::vector<T> read(std::istream& in, std::uint64_t most) {
  std::uint64_t size = 0;
  in.read(reinterpret_cast<char*>(&size), sizeof size);
  if (!in || size > most) throw std::runtime_error("the checkpoint is damaged");
  std::vector<T> values(size);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(size * sizeof(T)));
  return values;
}

// Whether the state holds axes, which turn with the normal from step to step.
bool carries_axes(const ilaw_instance_info& info) {
  for (std::uint32_t i = 0; i < info.state_variable_count; ++i)
    if (info.state_variables[i]->kind == ILAW_STATE_AXIS) return true;
  return false;
}

}  // namespace

Interface::Interface(InterfaceSetup setup, const Model& model)
    : setup_(std::move(setup)),
      model_(model),
      dimension_(model.dimension()),
      library_(setup_.library),
      interface_(create_law(setup_.law, setup_.arguments, setup_.tangent, library_, dimension_)),
      info_(interface_.info()),
      contact_index_of_(setup_.nodes.size(), -1),
      obstacle_velocity_(Vector::Zero(dimension_)),
      obstacle_velocity_before_(obstacle_velocity_) {
  per_node_.resize(info_.per_node_parameter_count);
}

void Interface::set_coupled() {
  coupled_ = true;
  colours_of_node_.resize(static_cast<std::size_t>(model_.node_count()));
}

ilaw_batch Interface::batch(double time, double dt) const {
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.time = time;
  batch.velocity_step = dt;
  batch.position_step = dt;
  batch.area = {area_.data(), 1, 1};
  batch.normal = {normal_.data(), dimension_, 1};
  if (setup_.tangent.size() > 0) batch.tangent = {setup_.tangent.data(), 0, 1};
  batch.per_node_parameters = per_node_inputs_.data();
  return batch;
}

std::string Interface::node_message(const ilaw_report& report) const {
  const std::string reason = report.reason ? report.reason : "no reason given";
  std::string text = "interface '" + setup_.name + "' (law '" + setup_.law + "'): ";
  if (report.first_bad_node < 0) return text + reason;
  const auto node_index =
      static_cast<std::size_t>(node_index_of_[static_cast<std::size_t>(report.first_bad_node)]);
  return text + std::to_string(report.bad_count) + " node(s) refused, first node " +
         std::to_string(setup_.nodes[node_index]) + ": " + reason;
}

// ---- slots ----------------------------------------------------------------------------------------------

int Interface::contact_index_of(int node_index, const Dofs& u) {
  int& contact_index = contact_index_of_[static_cast<std::size_t>(node_index)];
  if (contact_index < 0) {
    contact_index = static_cast<int>(node_index_of_.size());
    open_contact(node_index, u);
  }
  return contact_index;
}

void Interface::open_contact(int node_index, const Dofs& u) {
  const auto k = static_cast<std::size_t>(node_index);
  node_index_of_.push_back(node_index);
  const std::size_t contact_indices = node_index_of_.size(), d = static_cast<std::size_t>(dimension_);
  contact_points_.emplace_back();
  for (std::vector<double>* vectors : {&v_free_, &v_previous_, &normal_, &impulse_, &previous_impulse_})
    vectors->resize(contact_indices * d);
  delassus_.push_back(1.0 / model_.mass()[setup_.nodes[k] * dimension_]);
  gap_.push_back(0.0);
  area_.push_back(setup_.areas[k]);
  energy_.resize(contact_indices * ILAW_ENERGY_COUNT);
  status_.push_back(ILAW_FREE);
  touched_.push_back(0);
  state_.resize(contact_indices * info_.state_size);
  per_node_inputs_.clear();
  for (std::size_t p = 0; p < per_node_.size(); ++p) {
    per_node_[p].push_back(setup_.arguments.per_node.at(info_.per_node_parameters[p])[k]);
    per_node_inputs_.push_back({per_node_[p].data(), 1, 1});
  }
  initialise(static_cast<int>(contact_indices) - 1, u);
}

// The state that the law starts with at time 0, whenever the slot is made. Its axes are those of the first
// time that it is asked: where the normal turns, a law whose state has axes is asked from the first step
// (may_skip).
void Interface::initialise(int contact_index, const Dofs& u) {
  const ContactPoint start =
      setup_.counterpart->meet(node_index_of_[static_cast<std::size_t>(contact_index)], u, 0.0);
  std::copy_n(start.normal.data(), dimension_, &normal_[at(contact_index)]);
  if (info_.state_size == 0) return;
  const std::int32_t index = contact_index;
  ilaw_batch b = batch(0.0, 1.0);
  b.node_count = 1;
  b.index = &index;
  b.state_out = {state_.data(), static_cast<std::int64_t>(info_.state_size), 1};
  ilaw_report report{};
  report.struct_size = sizeof report;
  const std::int32_t code = interface_.initialise(b, &report);
  if (code != ILAW_OK) throw ilaw::error(code, node_message(report));
}

std::size_t Interface::bytes_per_contact() const {
  const auto d = static_cast<std::size_t>(dimension_);
  return sizeof(ContactPoint) + sizeof(int) + 2 +
         sizeof(double) *
             (5 * d + 3 + ILAW_ENERGY_COUNT + per_node_.size() + info_.state_size * (coupled_ ? 2 : 1));
}

// ---- a step ---------------------------------------------------------------------------------------------

bool Interface::may_skip() const {
  if (setup_.keeps_all_active || (info_.capabilities & ILAW_CAN_ACT_AT_DISTANCE)) return false;
  return setup_.counterpart->keeps_normal() || !carries_axes(info_);
}

// Touched contacts with a state stay near for good: only fresh ones are known to do nothing at a distance.
void Interface::look(const StepView& step) {
  near_.clear();
  setup_.counterpart->look(step.u);
  for (std::size_t k = 0; k < setup_.nodes.size(); ++k) {
    const int node_index = static_cast<int>(k), contact_index = contact_index_of_[k];
    const bool touched = contact_index >= 0 && touched_[static_cast<std::size_t>(contact_index)];
    if (touched || !may_skip() ||
        proximity_.is_near(setup_.counterpart->gap_bound(node_index, step.u, step.time) - setup_.gap_offset))
      near_.push_back(contact_index_of(node_index, step.u));
  }
}

void Interface::open_step(const StepView& step) {
  active_.clear();
  colours_.clear();
  const Counterpart& counterpart = *setup_.counterpart;
  obstacle_velocity_before_ = counterpart.velocity(step.time - step.dt, step.time);
  obstacle_velocity_ = counterpart.velocity(step.time, step.time + step.dt);
  const double moving = counterpart.partners().empty() ? 1.0 : 2.0;
  const double closing_before = moving * step.speed_before + obstacle_velocity_before_.norm(),
               closing_after = moving * step.speed_after + obstacle_velocity_.norm();
  ahead_ = step.dt * closing_after;
  const bool due = proximity_.refresh_due(step.dt, closing_before, closing_after, counterpart.validity());
  if (step.time < setup_.birth || step.time >= setup_.death) {
    proximity_.forget();
    return;
  }
  if (due) look(step);
  active_ = near_;
  for (const std::int32_t contact_index : active_) locate(contact_index, step);
  colour_contacts();
}

void Interface::locate(int contact_index, const StepView& step) {
  const auto k = static_cast<std::size_t>(contact_index);
  contact_points_[k] = setup_.counterpart->meet(node_index_of_[k], step.u, step.time);
  const ContactPoint& contact_point = contact_points_[k];
  gap_[k] = contact_point.gap - setup_.gap_offset;
  std::copy_n(contact_point.normal.data(), dimension_, &normal_[at(contact_index)]);
  std::fill_n(&impulse_[at(contact_index)], dimension_, 0.0);
  const auto mass = [this](int node) { return model_.mass()[static_cast<Eigen::Index>(node) * dimension_]; };
  if (contact_point.partner_count == 0) return;
  delassus_[k] = 1.0 / mass(setup_.nodes[static_cast<std::size_t>(node_index_of_[k])]);
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact_point.partner_count); ++i)
    delassus_[k] += contact_point.weights[i] * contact_point.weights[i] / mass(contact_point.partners[i]);
}

// Whether a contact cannot act in this step, as those that are not asked (reach.hpp).
bool Interface::is_idle(int contact_index) const {
  const auto k = static_cast<std::size_t>(contact_index);
  return !(info_.capabilities & ILAW_CAN_ACT_AT_DISTANCE) && !touched_[k] && gap_[k] > ahead_;
}

// Idle contacts come last, whatever nodes they share: the order of those that act must not depend on how many
// others are asked.
void Interface::colour_contacts() {
  if (active_.empty()) return;
  if (!coupled_) {
    colours_.assign(1, active_);
    return;
  }
  std::fill(colours_of_node_.begin(), colours_of_node_.end(), 0);
  std::vector<std::int32_t> idle;
  for (const std::int32_t contact_index : active_) {
    if (is_idle(contact_index)) {
      idle.push_back(contact_index);
      continue;
    }
    const std::size_t colour = colour_of(contact_index);
    if (colours_.size() <= colour) colours_.resize(colour + 1);
    colours_[colour].push_back(contact_index);
  }
  colours_.push_back(std::move(idle));
}

// Greedy: the first colour that none of the contact's nodes has.
std::size_t Interface::colour_of(int contact_index) {
  const ContactPoint& contact_point = contact_points_[static_cast<std::size_t>(contact_index)];
  std::uint64_t& own = colours_of_node_[static_cast<std::size_t>(node_of(contact_index))];
  const auto of_partner = [&](int i) -> std::uint64_t& {
    return colours_of_node_[static_cast<std::size_t>(contact_point.partners[static_cast<std::size_t>(i)])];
  };
  std::uint64_t taken = own;
  for (int i = 0; i < contact_point.partner_count; ++i) taken |= of_partner(i);
  const auto colour = std::min(static_cast<std::size_t>(std::countr_one(taken)), serial_colour);
  const std::uint64_t mark = std::uint64_t{1} << colour;
  own |= mark;
  for (int i = 0; i < contact_point.partner_count; ++i) of_partner(i) |= mark;
  return colour;
}

Vector Interface::relative(int contact_index, const Dofs& v) const {
  const auto k = static_cast<std::size_t>(contact_index);
  const Eigen::Index d = dimension_;
  Vector relative = v.segment(setup_.nodes[static_cast<std::size_t>(node_index_of_[k])] * d, d);
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact_points_[k].partner_count); ++i)
    relative -= contact_points_[k].weights[i] * v.segment(contact_points_[k].partners[i] * d, d);
  return relative;
}

void Interface::add_impulse(int contact_index, Dofs& impulse) const {
  const auto k = static_cast<std::size_t>(contact_index);
  const Eigen::Index d = dimension_;
  impulse.segment(setup_.nodes[static_cast<std::size_t>(node_index_of_[k])] * d, d) +=
      this->impulse(contact_index);
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact_points_[k].partner_count); ++i)
    impulse.segment(contact_points_[k].partners[i] * d, d) -=
        contact_points_[k].weights[i] * this->impulse(contact_index);
}

// Velocities without the contact's own impulse.
void Interface::gather(const std::vector<std::int32_t>& contact_indices, const Dofs& v,
                       const StepView& step) {
#pragma omp parallel for schedule(static) if (contact_indices.size() > 2 * std::size_t{chunk})
  for (std::size_t i = 0; i < contact_indices.size(); ++i) {
    const std::int32_t contact_index = contact_indices[i];
    const std::size_t first = at(contact_index);
    Eigen::Map<Vector>(&v_free_[first], dimension_) =
        relative(contact_index, v) - obstacle_velocity_ -
        delassus_[static_cast<std::size_t>(contact_index)] * impulse(contact_index);
    Eigen::Map<Vector>(&v_previous_[first], dimension_) =
        relative(contact_index, step.v_before) - obstacle_velocity_before_;
    std::copy_n(&impulse_[first], dimension_, &previous_impulse_[first]);
  }
}

// Calls visit(slots) with what may be done at once.
template <class Visit>
void Interface::for_each_batch(std::size_t colour, Visit visit) const {
  const std::vector<std::int32_t>& contact_indices = colours_[colour];
  if (colour == serial_colour)
    for (const std::int32_t contact_index : contact_indices) visit(std::vector{contact_index});
  else if (!contact_indices.empty())
    visit(contact_indices);
}

double Interface::solve(int colour, Dofs& v, const StepView& step) {
  double speed = 0.0;
  for_each_batch(static_cast<std::size_t>(colour), [&](const std::vector<std::int32_t>& contact_indices) {
    gather(contact_indices, v, step);
    evaluate(contact_indices, step);
    speed = std::max(speed, apply(contact_indices, v));
  });
  return speed;
}

void Interface::evaluate(const std::vector<std::int32_t>& contact_indices, const StepView& step) {
  ilaw_batch b = batch(step.time, step.dt);
  const auto size = static_cast<std::int64_t>(info_.state_size);
  if (coupled_) next_state_.resize(state_.size());
  b.v_free = {v_free_.data(), dimension_, 1};
  b.v_previous = {v_previous_.data(), dimension_, 1};
  b.delassus = {delassus_.data(), 1, 1};
  b.gap = {gap_.data(), 1, 1};
  b.state_in = {state_.data(), size, 1};
  b.state_out = {coupled_ ? next_state_.data() : state_.data(), size, 1};
  b.impulse = {impulse_.data(), dimension_, 1};
  b.energy = {energy_.data(), ILAW_ENERGY_COUNT, 1};
  b.status = status_.data();
  b.status_stride = 1;
  const auto count = static_cast<std::ptrdiff_t>(contact_indices.size());
  const std::ptrdiff_t chunks = (count + chunk - 1) / chunk;
  std::vector<std::int32_t> codes(static_cast<std::size_t>(chunks));
  std::vector<ilaw_report> reports(codes.size());
#pragma omp parallel for schedule(static) if (chunks > 1)
  for (std::ptrdiff_t c = 0; c < chunks; ++c) {
    const auto k = static_cast<std::size_t>(c);
    ilaw_batch part = b;
    part.index = contact_indices.data() + c * chunk;
    part.node_count = std::min(std::ptrdiff_t{chunk}, count - c * chunk);
    reports[k].struct_size = sizeof(ilaw_report);
    codes[k] = interface_.evaluate(part, &reports[k]);
  }
  for (std::size_t k = 0; k < codes.size(); ++k)
    if (codes[k] != ILAW_OK) throw ilaw::error(codes[k], node_message(reports[k]));
}

double Interface::apply(const std::vector<std::int32_t>& contact_indices, Dofs& v) {
  double speed = 0.0;
  const Eigen::Index d = dimension_;
#pragma omp parallel for schedule(static) \
    reduction(max                         \
              : speed) if (contact_indices.size() > 2 * std::size_t{chunk})
  for (std::size_t i = 0; i < contact_indices.size(); ++i) {
    const std::int32_t contact_index = contact_indices[i];
    const auto k = static_cast<std::size_t>(contact_index);
    const Vector added =
        impulse(contact_index) - Eigen::Map<const Vector>(&previous_impulse_[at(contact_index)], d);
    if (added.isZero(0.0)) continue;  // idle contacts may share nodes, which they must not even write
    const auto move = [&](int node, double weight) {
      v.segment(node * d, d) += (weight / model_.mass()[node * d]) * added;
      speed = std::max(speed, v.segment(node * d, d).norm());
    };
    move(node_of(contact_index), 1.0);
    for (std::size_t p = 0; p < static_cast<std::size_t>(contact_points_[k].partner_count); ++p)
      move(contact_points_[k].partners[p], -contact_points_[k].weights[p]);
  }
  return speed;
}

// Of contacts that may act: what the others were asked about must not matter.
Residual Interface::residual(const Dofs& v) const {
  Residual residual;
  for (std::size_t colour = 0; colour + 1 < colours_.size(); ++colour)
    for (const std::int32_t contact_index : colours_[colour]) {
      const Vector own = delassus(contact_index) * impulse(contact_index);
      const Vector since = relative(contact_index, v) - obstacle_velocity_ - own -
                           Eigen::Map<const Vector>(&v_free_[at(contact_index)], dimension_);
      residual.change = std::max(residual.change, since.cwiseAbs().maxCoeff());
      residual.size = std::max(residual.size, own.cwiseAbs().maxCoeff());
    }
  return residual;
}

void Interface::append_impulses(std::vector<double>& scaled) const {
  for (std::size_t colour = 0; colour + 1 < colours_.size(); ++colour)
    for (const std::int32_t contact_index : colours_[colour])
      for (const double component : impulse(contact_index))
        scaled.push_back(std::sqrt(delassus(contact_index)) * component);
}

double Interface::add_impulses(const double*& scaled, Dofs& v) {
  double speed = 0.0;
  const auto add = [&](const std::vector<std::int32_t>& contact_indices) {
    for (const std::int32_t contact_index : contact_indices)
      for (std::size_t i = at(contact_index); i < at(contact_index) + static_cast<std::size_t>(dimension_);
           ++i) {
        previous_impulse_[i] = impulse_[i];
        impulse_[i] += *scaled++ / std::sqrt(delassus(contact_index));
      }
    speed = std::max(speed, apply(contact_indices, v));
  };
  for (std::size_t colour = 0; colour + 1 < colours_.size(); ++colour) for_each_batch(colour, add);
  return speed;
}

void Interface::accept(double dt) {
  if (info_.state_size == 0) return;
  for (const std::int32_t contact_index : active_) {
    const auto k = static_cast<std::size_t>(contact_index);
    const double approach = dt * Eigen::Map<const Vector>(&v_free_[at(contact_index)], dimension_).norm();
    if (status_[k] != ILAW_FREE || !(gap_[k] > approach)) touched_[k] = 1;
    if (coupled_)
      std::copy_n(&next_state_[state_at(contact_index)], info_.state_size, &state_[state_at(contact_index)]);
  }
}

bool Interface::is_active(int contact_index) const {
  return std::find(active_.begin(), active_.end(), contact_index) != active_.end();
}

void Interface::save(std::ostream& out) const {
  write(out, node_index_of_);
  write(out, touched_);
  write(out, state_);
}

void Interface::load(std::istream& in, const Dofs& u) {
  const auto node_indices = read<int>(in, setup_.nodes.size());
  for (const int node_index : node_indices) {
    if (node_index < 0 || node_index >= static_cast<int>(setup_.nodes.size()))
      throw std::runtime_error("the checkpoint is damaged");
    contact_index_of(node_index, u);
  }
  if (node_index_of_ != node_indices) throw std::runtime_error("the checkpoint is damaged");
  touched_ = read<std::uint8_t>(in, node_indices.size());
  state_ = read<double>(in, node_indices.size() * info_.state_size);
  if (touched_.size() != node_indices.size() || state_.size() != node_indices.size() * info_.state_size)
    throw std::runtime_error("the checkpoint is damaged");
  proximity_.forget();
}

}  // namespace ilaw::host
