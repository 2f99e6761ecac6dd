// SPDX-License-Identifier: BSD-3-Clause
#include "interface.hpp"

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
      slot_of_(setup_.nodes.size(), -1),
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
  const auto place = static_cast<std::size_t>(place_of_[static_cast<std::size_t>(report.first_bad_node)]);
  return text + std::to_string(report.bad_count) + " node(s) refused, first node " +
         std::to_string(setup_.nodes[place]) + ": " + reason;
}

// ---- slots ----------------------------------------------------------------------------------------------

int Interface::slot_of(int place, const Dofs& u) {
  int& slot = slot_of_[static_cast<std::size_t>(place)];
  if (slot < 0) {
    slot = static_cast<int>(place_of_.size());
    open_slot(place, u);
  }
  return slot;
}

void Interface::open_slot(int place, const Dofs& u) {
  const auto k = static_cast<std::size_t>(place);
  place_of_.push_back(place);
  const std::size_t slots = place_of_.size(), d = static_cast<std::size_t>(dimension_);
  meetings_.emplace_back();
  for (std::vector<double>* vectors : {&v_free_, &v_previous_, &normal_, &impulse_, &previous_impulse_})
    vectors->resize(slots * d);
  delassus_.push_back(1.0 / model_.mass()[setup_.nodes[k] * dimension_]);
  gap_.push_back(0.0);
  area_.push_back(setup_.areas[k]);
  energy_.resize(slots * ILAW_ENERGY_COUNT);
  status_.push_back(ILAW_FREE);
  touched_.push_back(0);
  state_.resize(slots * info_.state_size);
  per_node_inputs_.clear();
  for (std::size_t p = 0; p < per_node_.size(); ++p) {
    per_node_[p].push_back(setup_.arguments.per_node.at(info_.per_node_parameters[p])[k]);
    per_node_inputs_.push_back({per_node_[p].data(), 1, 1});
  }
  initialise(static_cast<int>(slots) - 1, u);
}

// The state that the law starts with at time 0, whenever the slot is made. Its axes are those of the first
// time that it is asked: where the normal turns, a law whose state has axes is asked from the first step
// (may_skip).
void Interface::initialise(int slot, const Dofs& u) {
  const Meeting start = setup_.opponent->meet(place_of_[static_cast<std::size_t>(slot)], u, 0.0);
  std::copy_n(start.normal.data(), dimension_, &normal_[at(slot)]);
  if (info_.state_size == 0) return;
  const std::int32_t index = slot;
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
  return sizeof(Meeting) + sizeof(int) + 2 +
         sizeof(double) *
             (5 * d + 3 + ILAW_ENERGY_COUNT + per_node_.size() + info_.state_size * (coupled_ ? 2 : 1));
}

// ---- a step ---------------------------------------------------------------------------------------------

bool Interface::may_skip() const {
  if (setup_.asks_all || (info_.capabilities & ILAW_CAN_ACT_AT_DISTANCE)) return false;
  return setup_.opponent->keeps_normal() || !carries_axes(info_);
}

// Touched contacts with a state stay near for good: only fresh ones are known to do nothing at a distance.
void Interface::look(const StepView& step) {
  near_.clear();
  setup_.opponent->look(step.u);
  for (std::size_t k = 0; k < setup_.nodes.size(); ++k) {
    const int place = static_cast<int>(k), slot = slot_of_[k];
    const bool touched = slot >= 0 && touched_[static_cast<std::size_t>(slot)];
    if (touched || !may_skip() ||
        reach_.is_near(setup_.opponent->gap_bound(place, step.u, step.time) - setup_.gap_offset))
      near_.push_back(slot_of(place, step.u));
  }
}

void Interface::open_step(const StepView& step) {
  asked_.clear();
  colours_.clear();
  const Opponent& opponent = *setup_.opponent;
  obstacle_velocity_before_ = opponent.velocity(step.time - step.dt, step.time);
  obstacle_velocity_ = opponent.velocity(step.time, step.time + step.dt);
  const double moving = opponent.partners().empty() ? 1.0 : 2.0;
  const double closing_before = moving * step.speed_before + obstacle_velocity_before_.norm(),
               closing_after = moving * step.speed_after + obstacle_velocity_.norm();
  ahead_ = step.dt * closing_after;
  const bool due = reach_.look_due(step.dt, closing_before, closing_after, opponent.sight());
  if (step.time < setup_.birth || step.time >= setup_.death) {
    reach_.forget();
    return;
  }
  if (due) look(step);
  asked_ = near_;
  for (const std::int32_t slot : asked_) locate(slot, step);
  colour_contacts();
}

void Interface::locate(int slot, const StepView& step) {
  const auto k = static_cast<std::size_t>(slot);
  meetings_[k] = setup_.opponent->meet(place_of_[k], step.u, step.time);
  const Meeting& meeting = meetings_[k];
  gap_[k] = meeting.gap - setup_.gap_offset;
  std::copy_n(meeting.normal.data(), dimension_, &normal_[at(slot)]);
  std::fill_n(&impulse_[at(slot)], dimension_, 0.0);
  const auto mass = [this](int node) { return model_.mass()[static_cast<Eigen::Index>(node) * dimension_]; };
  if (meeting.partner_count == 0) return;
  delassus_[k] = 1.0 / mass(setup_.nodes[static_cast<std::size_t>(place_of_[k])]);
  for (std::size_t i = 0; i < static_cast<std::size_t>(meeting.partner_count); ++i)
    delassus_[k] += meeting.weights[i] * meeting.weights[i] / mass(meeting.partners[i]);
}

// Whether a contact cannot act in this step, as those that are not asked (reach.hpp).
bool Interface::is_idle(int slot) const {
  const auto k = static_cast<std::size_t>(slot);
  return !(info_.capabilities & ILAW_CAN_ACT_AT_DISTANCE) && !touched_[k] && gap_[k] > ahead_;
}

// Idle contacts come last, whatever nodes they share: the order of those that act must not depend on how many
// others are asked.
void Interface::colour_contacts() {
  if (asked_.empty()) return;
  if (!coupled_) {
    colours_.assign(1, asked_);
    return;
  }
  std::fill(colours_of_node_.begin(), colours_of_node_.end(), 0);
  std::vector<std::int32_t> idle;
  for (const std::int32_t slot : asked_) {
    if (is_idle(slot)) {
      idle.push_back(slot);
      continue;
    }
    const std::size_t colour = colour_of(slot);
    if (colours_.size() <= colour) colours_.resize(colour + 1);
    colours_[colour].push_back(slot);
  }
  colours_.push_back(std::move(idle));
}

// Greedy: the first colour that none of the contact's nodes has.
std::size_t Interface::colour_of(int slot) {
  const Meeting& meeting = meetings_[static_cast<std::size_t>(slot)];
  std::uint64_t& own = colours_of_node_[static_cast<std::size_t>(node_of(slot))];
  const auto of_partner = [&](int i) -> std::uint64_t& {
    return colours_of_node_[static_cast<std::size_t>(meeting.partners[static_cast<std::size_t>(i)])];
  };
  std::uint64_t taken = own;
  for (int i = 0; i < meeting.partner_count; ++i) taken |= of_partner(i);
  const auto colour = std::min(static_cast<std::size_t>(std::countr_one(taken)), serial_colour);
  const std::uint64_t mark = std::uint64_t{1} << colour;
  own |= mark;
  for (int i = 0; i < meeting.partner_count; ++i) of_partner(i) |= mark;
  return colour;
}

Vector Interface::relative(int slot, const Dofs& v) const {
  const auto k = static_cast<std::size_t>(slot);
  const Eigen::Index d = dimension_;
  Vector relative = v.segment(setup_.nodes[static_cast<std::size_t>(place_of_[k])] * d, d);
  for (std::size_t i = 0; i < static_cast<std::size_t>(meetings_[k].partner_count); ++i)
    relative -= meetings_[k].weights[i] * v.segment(meetings_[k].partners[i] * d, d);
  return relative;
}

void Interface::add_impulse(int slot, Dofs& impulse) const {
  const auto k = static_cast<std::size_t>(slot);
  const Eigen::Index d = dimension_;
  impulse.segment(setup_.nodes[static_cast<std::size_t>(place_of_[k])] * d, d) += this->impulse(slot);
  for (std::size_t i = 0; i < static_cast<std::size_t>(meetings_[k].partner_count); ++i)
    impulse.segment(meetings_[k].partners[i] * d, d) -= meetings_[k].weights[i] * this->impulse(slot);
}

// Velocities without the contact's own impulse.
void Interface::gather(const std::vector<std::int32_t>& slots, const Dofs& v, const StepView& step) {
#pragma omp parallel for schedule(static) if (slots.size() > 2 * std::size_t{chunk})
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const std::int32_t slot = slots[i];
    const std::size_t first = at(slot);
    Eigen::Map<Vector>(&v_free_[first], dimension_) =
        relative(slot, v) - obstacle_velocity_ - delassus_[static_cast<std::size_t>(slot)] * impulse(slot);
    Eigen::Map<Vector>(&v_previous_[first], dimension_) =
        relative(slot, step.v_before) - obstacle_velocity_before_;
    std::copy_n(&impulse_[first], dimension_, &previous_impulse_[first]);
  }
}

// Calls visit(slots) with what may be done at once.
template <class Visit>
void Interface::for_each_batch(std::size_t colour, Visit visit) const {
  const std::vector<std::int32_t>& slots = colours_[colour];
  if (colour == serial_colour)
    for (const std::int32_t slot : slots) visit(std::vector{slot});
  else if (!slots.empty())
    visit(slots);
}

double Interface::solve(int colour, Dofs& v, const StepView& step) {
  double speed = 0.0;
  for_each_batch(static_cast<std::size_t>(colour), [&](const std::vector<std::int32_t>& slots) {
    gather(slots, v, step);
    evaluate(slots, step);
    speed = std::max(speed, apply(slots, v));
  });
  return speed;
}

void Interface::evaluate(const std::vector<std::int32_t>& slots, const StepView& step) {
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
  const auto count = static_cast<std::ptrdiff_t>(slots.size());
  const std::ptrdiff_t chunks = (count + chunk - 1) / chunk;
  std::vector<std::int32_t> codes(static_cast<std::size_t>(chunks));
  std::vector<ilaw_report> reports(codes.size());
#pragma omp parallel for schedule(static) if (chunks > 1)
  for (std::ptrdiff_t c = 0; c < chunks; ++c) {
    const auto k = static_cast<std::size_t>(c);
    ilaw_batch part = b;
    part.index = slots.data() + c * chunk;
    part.node_count = std::min(std::ptrdiff_t{chunk}, count - c * chunk);
    reports[k].struct_size = sizeof(ilaw_report);
    codes[k] = interface_.evaluate(part, &reports[k]);
  }
  for (std::size_t k = 0; k < codes.size(); ++k)
    if (codes[k] != ILAW_OK) throw ilaw::error(codes[k], node_message(reports[k]));
}

double Interface::apply(const std::vector<std::int32_t>& slots, Dofs& v) {
  double speed = 0.0;
  const Eigen::Index d = dimension_;
#pragma omp parallel for schedule(static) reduction(max : speed) if (slots.size() > 2 * std::size_t{chunk})
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const std::int32_t slot = slots[i];
    const auto k = static_cast<std::size_t>(slot);
    const Vector added = impulse(slot) - Eigen::Map<const Vector>(&previous_impulse_[at(slot)], d);
    if (added.isZero(0.0)) continue;  // idle contacts may share nodes, which they must not even write
    const auto move = [&](int node, double weight) {
      v.segment(node * d, d) += (weight / model_.mass()[node * d]) * added;
      speed = std::max(speed, v.segment(node * d, d).norm());
    };
    move(node_of(slot), 1.0);
    for (std::size_t p = 0; p < static_cast<std::size_t>(meetings_[k].partner_count); ++p)
      move(meetings_[k].partners[p], -meetings_[k].weights[p]);
  }
  return speed;
}

// Of contacts that may act: what the others were asked about must not matter.
Misfit Interface::misfit(const Dofs& v) const {
  Misfit misfit;
  for (std::size_t colour = 0; colour + 1 < colours_.size(); ++colour)
    for (const std::int32_t slot : colours_[colour]) {
      const Vector own = delassus(slot) * impulse(slot);
      const Vector since = relative(slot, v) - obstacle_velocity_ - own -
                           Eigen::Map<const Vector>(&v_free_[at(slot)], dimension_);
      misfit.change = std::max(misfit.change, since.cwiseAbs().maxCoeff());
      misfit.size = std::max(misfit.size, own.cwiseAbs().maxCoeff());
    }
  return misfit;
}

void Interface::append_impulses(std::vector<double>& scaled) const {
  for (std::size_t colour = 0; colour + 1 < colours_.size(); ++colour)
    for (const std::int32_t slot : colours_[colour])
      for (const double component : impulse(slot)) scaled.push_back(std::sqrt(delassus(slot)) * component);
}

double Interface::add_impulses(const double*& scaled, Dofs& v) {
  double speed = 0.0;
  const auto add = [&](const std::vector<std::int32_t>& slots) {
    for (const std::int32_t slot : slots)
      for (std::size_t i = at(slot); i < at(slot) + static_cast<std::size_t>(dimension_); ++i) {
        previous_impulse_[i] = impulse_[i];
        impulse_[i] += *scaled++ / std::sqrt(delassus(slot));
      }
    speed = std::max(speed, apply(slots, v));
  };
  for (std::size_t colour = 0; colour + 1 < colours_.size(); ++colour) for_each_batch(colour, add);
  return speed;
}

void Interface::accept(double dt) {
  if (info_.state_size == 0) return;
  for (const std::int32_t slot : asked_) {
    const auto k = static_cast<std::size_t>(slot);
    const double approach = dt * Eigen::Map<const Vector>(&v_free_[at(slot)], dimension_).norm();
    if (status_[k] != ILAW_FREE || !(gap_[k] > approach)) touched_[k] = 1;
    if (coupled_) std::copy_n(&next_state_[state_at(slot)], info_.state_size, &state_[state_at(slot)]);
  }
}

bool Interface::was_asked(int slot) const {
  return std::find(asked_.begin(), asked_.end(), slot) != asked_.end();
}

void Interface::save(std::ostream& out) const {
  write(out, place_of_);
  write(out, touched_);
  write(out, state_);
}

void Interface::load(std::istream& in, const Dofs& u) {
  const auto places = read<int>(in, setup_.nodes.size());
  for (const int place : places) {
    if (place < 0 || place >= static_cast<int>(setup_.nodes.size()))
      throw std::runtime_error("the checkpoint is damaged");
    slot_of(place, u);
  }
  if (place_of_ != places) throw std::runtime_error("the checkpoint is damaged");
  touched_ = read<std::uint8_t>(in, places.size());
  state_ = read<double>(in, places.size() * info_.state_size);
  if (touched_.size() != places.size() || state_.size() != places.size() * info_.state_size)
    throw std::runtime_error("the checkpoint is damaged");
  reach_.forget();
}

}  // namespace ilaw::host
