// SPDX-License-Identifier: BSD-3-Clause
#include "contacts.hpp"

#include "sizes.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <cmath>

namespace ilaw::coupled {
namespace {

// Largest part of an arm across the normal of a transverse H: arms that went through single precision pass.
constexpr double along_tolerance = 1e-6;

// What is no number is left to the law to refuse, at its contact.
bool leads_aside(const Vector& arm, const Vector& normal) {
  const Vector across = cross(arm, normal);
  return dot(across, across) > along_tolerance * along_tolerance * dot(arm, arm) * dot(normal, normal);
}

// H of one node in dimension d, of that in three.
void write_form(const Symmetric& h, const Vector& normal, std::uint32_t form, std::uint32_t dimension,
                double* out) {
  if (form == ILAW_DELASSUS_TRANSVERSE) {
    out[0] = dot(normal, h * normal);
    out[1] = 0.5 * (h[0] + h[1] + h[2] - out[0]);
  } else if (form == ILAW_DELASSUS_SCALAR || dimension == 1) {
    out[0] = h[0];
  } else if (dimension == 2) {
    out[0] = h[0], out[1] = h[1], out[2] = h[3];
  } else {
    std::copy(h.begin(), h.end(), out);
  }
}

ilaw_input input_of(const std::vector<Vector>& vectors) { return ilaw::input(vectors.data()->data(), 3, 1); }

bool is_zero(const Vector& a) { return a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0; }

}  // namespace

const char* Contacts::open(const ilaw_contacts& given, const Bodies& bodies) {
  if (!sized::is_complete(&given)) return "the struct_size of contacts is not that of any version";
  given_ = sized::read(&given);
  if (!sized::is_complete(given_.batch)) return "a batch is missing, or its struct_size is wrong";
  theirs_ = sized::read(given_.batch);
  dimension_ = bodies.dimension();
  for (const char* reason : {complaint(), complaint_of_law(bodies), complaint_of_bodies(bodies)})
    if (reason) return reason;
  read(bodies);
  return nullptr;
}

const char* Contacts::complaint() const {
  if (!given_.law || !given_.instance) return "law or instance is null";
  if (given_.delassus_form != ILAW_DELASSUS_SCALAR && given_.delassus_form != ILAW_DELASSUS_TRANSVERSE &&
      given_.delassus_form != ILAW_DELASSUS_FULL)
    return "delassus_form is neither scalar, transverse nor full";
  if (theirs_.node_count < 0) return "node_count is negative";
  if (theirs_.impulse.floats || theirs_.energy.floats || theirs_.state_in.floats || theirs_.state_out.floats)
    return "an array of a batch has floats; expected doubles";
  if (theirs_.index || theirs_.index64) return "contacts have no list of nodes";
  if (theirs_.node_count == 0) return nullptr;
  if (!given_.body || !given_.counterpart) return "body or counterpart is missing";
  return theirs_.impulse.values ? nullptr : "impulse is missing";
}

const char* Contacts::complaint_of_law(const Bodies& bodies) {
  if (!given_.law || !given_.instance) return nullptr;  // said already
  info_ = {};
  info_.struct_size = sizeof info_;
  if (given_.law->info(given_.instance, &info_) != ILAW_OK) return "info refuses the instance";
  const std::uint32_t read = info_.inputs | (asks_balance() ? info_.balance_inputs : 0U);
  constexpr std::uint32_t known =
      ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_AREA | ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT;
  if (read & ~known) return "the law reads an input that coupled contacts do not know";
  if ((read & ILAW_INPUT_V_PREVIOUS) && theirs_.node_count > 0 && !bodies.have_previous())
    return "the law reads v_previous, which the bodies do not have";
  if (info_.state_size > 0 && theirs_.node_count > 0 &&
      (!theirs_.state_in.values || !theirs_.state_out.values))
    return "state_in or state_out is missing";
  return nullptr;
}

const char* Contacts::complaint_of_bodies(const Bodies& bodies) const {
  const std::int64_t count = given_.body && given_.counterpart ? theirs_.node_count : 0;
  if (bodies.rotate() && count > 0) {
    if (given_.delassus_form == ILAW_DELASSUS_SCALAR)
      return "bodies rotate, so delassus_form has to be transverse or full";
    if (!given_.arm.values || !given_.counterpart_arm.values) return "bodies rotate, and an arm is missing";
    if (given_.delassus_form == ILAW_DELASSUS_TRANSVERSE && !bodies.are_spheres())
      return "delassus_form is transverse, and bodies are no spheres";
  }
  if (given_.delassus_form == ILAW_DELASSUS_TRANSVERSE && count > 0 && !theirs_.normal.values)
    return "delassus_form is transverse, and the normal is missing";
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t body = std::int64_t{given_.body[k]} - theirs_.index_base;
    const std::int64_t counterpart = std::int64_t{given_.counterpart[k]} - theirs_.index_base;
    if (body < 0 || body >= bodies.count() || counterpart >= bodies.count())
      return "a contact names a body that is not there";
    if (body == counterpart) return "a contact of a body with itself";
    if (given_.delassus_form == ILAW_DELASSUS_TRANSVERSE && bodies.rotate() && has_arm_aside(k))
      return "delassus_form is transverse, and an arm is not along the normal";
  }
  return nullptr;
}

bool Contacts::has_arm_aside(std::int64_t k) const {
  const Vector normal = vector(theirs_.normal, k, 3);
  const bool is_wall = given_.counterpart[k] < theirs_.index_base;
  return leads_aside(vector(given_.arm, k, 3), normal) ||
         (!is_wall && leads_aside(vector(given_.counterpart_arm, k, 3), normal));
}

void Contacts::make_room() {
  const auto count = static_cast<std::size_t>(theirs_.node_count);
  form_size_ = given_.delassus_form == ILAW_DELASSUS_SCALAR       ? 1
               : given_.delassus_form == ILAW_DELASSUS_TRANSVERSE ? 2
                                                                  : dimension_ * (dimension_ + 1) / 2;
  contacts_.resize(count);
  for (std::vector<Vector>* vectors : {&answer_, &before_, &trial_, &v_free_, &v_previous_})
    vectors->resize(count);
  delassus_.resize(count * form_size_);
  state_.resize(count * info_.state_size);
  energy_.resize(count * (theirs_.energy.values ? ILAW_ENERGY_COUNT : 0));
  status_.assign(count, ILAW_FREE);
}

void Contacts::read(const Bodies& bodies) {
  make_room();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto i = static_cast<std::int64_t>(k);
    Contact& contact = contacts_[k];
    contact.body = std::int64_t{given_.body[i]} - theirs_.index_base;
    contact.counterpart = std::int64_t{given_.counterpart[i]} - theirs_.index_base;
    contact.normal = vector(theirs_.normal, i, dimension_);
    contact.arm = vector(given_.arm, i, 3);
    contact.counterpart_arm = contact.counterpart < 0 ? Vector{} : vector(given_.counterpart_arm, i, 3);
    contact.wall = vector(given_.wall_velocity, i, dimension_);
    contact.wall_previous =
        given_.wall_previous.values ? vector(given_.wall_previous, i, dimension_) : contact.wall;
    contact.delassus = bodies.delassus(contact.body, contact.arm);
    contact.counterpart_delassus =
        contact.counterpart < 0 ? Symmetric{} : bodies.delassus(contact.counterpart, contact.counterpart_arm);
    v_previous_[k] = previous(contact, bodies);
    const ilaw_output& start = theirs_.impulse;
    answer_[k] = vector(ilaw::input(start.values, start.node_stride, start.component_stride), i, dimension_);
    if (!std::isfinite(dot(answer_[k], answer_[k]))) answer_[k] = {};
    contact.active = !is_zero(answer_[k]);
    trial_[k] = before_[k] = answer_[k];
  }
  describe_batch();
}

void Contacts::describe_batch() {
  ours_ = theirs_;
  ours_.struct_size = sizeof ours_;
  if (contacts_.empty()) return;
  const auto state_size = static_cast<std::int64_t>(info_.state_size);
  ours_.v_free = input_of(v_free_);
  ours_.delassus = ilaw::input(delassus_.data(), static_cast<std::int64_t>(form_size_), 1);
  ours_.v_previous = input_of(v_previous_);
  ours_.state_out = ilaw::output(state_.data(), state_size, 1);
  ours_.impulse = ilaw::output(answer_.data()->data(), 3, 1);
  ours_.velocity = {};
  ours_.energy = {};
  ours_.amounts = nullptr;
  const bool has_status = (given_.law->outputs & ILAW_OUTPUT_STATUS) != 0;
  ours_.status = has_status ? status_.data() : nullptr;
  ours_.status_stride = 1;
}

Vector Contacts::relative(const Contact& contact, const std::vector<Motion>& motions) const {
  const Motion& body = motions[static_cast<std::size_t>(contact.body)];
  const Vector velocity = body.velocity + cross(body.spin, contact.arm) - contact.wall;
  if (contact.counterpart < 0) return velocity;
  const Motion& other = motions[static_cast<std::size_t>(contact.counterpart)];
  return velocity - (other.velocity + cross(other.spin, contact.counterpart_arm));
}

Vector Contacts::previous(const Contact& contact, const Bodies& bodies) const {
  const Motion body = bodies.previous(contact.body);
  const Vector velocity = body.velocity + cross(body.spin, contact.arm) - contact.wall_previous;
  if (contact.counterpart < 0) return velocity;
  const Motion other = bodies.previous(contact.counterpart);
  return velocity - (other.velocity + cross(other.spin, contact.counterpart_arm));
}

void Contacts::add_to(std::vector<double>& sums, const Bodies& bodies) const {
  const auto add = [&](std::int64_t body, bool active, const Vector& impulse, const Vector& arm) {
    double* of_body = &sums[static_cast<std::size_t>(body * bodies.components())];
    of_body[0] += active ? 1.0 : 0.0;
    for (std::size_t c = 0; c < 3; ++c) of_body[1 + c] += impulse[c];
    if (!bodies.rotate()) return;
    const Vector moment = cross(arm, impulse);
    for (std::size_t c = 0; c < 3; ++c) of_body[4 + c] += moment[c];
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    add(contact.body, contact.active, answer_[k], contact.arm);
    if (contact.counterpart >= 0)
      add(contact.counterpart, contact.active, -1.0 * answer_[k], contact.counterpart_arm);
  }
}

void Contacts::split(const std::vector<double>& sums, const Bodies& bodies) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    const auto share = [&](std::int64_t body) {
      return body < 0
                 ? 0.0
                 : sums[static_cast<std::size_t>(body * bodies.components())] + (contact.active ? 0.0 : 1.0);
    };
    const Symmetric h =
        share(contact.body) * contact.delassus + share(contact.counterpart) * contact.counterpart_delassus;
    write_form(h, contact.normal, given_.delassus_form, dimension_, &delassus_[k * form_size_]);
  }
}

Vector Contacts::split_response(std::size_t k, const Vector& impulse) const {
  const double* h = &delassus_[k * form_size_];
  if (form_size_ == 1) return h[0] * impulse;
  if (form_size_ == 2) {
    const Vector& normal = contacts_[k].normal;
    return h[1] * impulse + ((h[0] - h[1]) * dot(normal, impulse)) * normal;
  }
  if (form_size_ == 3) return Symmetric{h[0], h[1], 0.0, h[2], 0.0, 0.0} * impulse;
  return Symmetric{h[0], h[1], h[2], h[3], h[4], h[5]} * impulse;
}

std::int32_t Contacts::call(const ilaw_batch& batch, const std::vector<Motion>& motions,
                            const std::vector<Vector>& impulses) {
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    v_free_[k] = relative(contacts_[k], motions) - split_response(k, impulses[k]);
  report_ = {};
  report_.struct_size = sizeof report_;
  return given_.law->evaluate(given_.instance, &batch, &report_);
}

std::int32_t Contacts::evaluate(const std::vector<Motion>& of_trial) {
  const std::int32_t code = call(ours_, of_trial, trial_);
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    if (!is_zero(answer_[k])) contacts_[k].active = true;
  return code;
}

Contacts::Residual Contacts::residual(const std::vector<Motion>& of_answer) const {
  Residual residual{0.0, 0.0};
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    if (is_bad(k)) continue;
    const Vector own = split_response(k, answer_[k]);
    residual.difference =
        std::fmax(residual.difference, largest(relative(contacts_[k], of_answer) - own - v_free_[k]));
    residual.size = std::fmax(residual.size, std::fmax(largest(own), largest(v_free_[k])));
  }
  return residual;
}

void Contacts::extrapolate(double by) {
  for (std::size_t k = 0; k < answer_.size(); ++k) {
    trial_[k] = by == 0.0 ? answer_[k] : answer_[k] + by * (answer_[k] - before_[k]);
    before_[k] = answer_[k];
  }
}

std::int32_t Contacts::write(const std::vector<Motion>& of_answer, const Bodies& bodies,
                             ilaw_coupled_report& report) {
  const auto state_size = static_cast<std::int64_t>(info_.state_size);
  if (asks_balance() && !contacts_.empty()) {
    spare_state_.resize(state_.size());
    ilaw_batch batch = ours_;
    if (theirs_.energy.values) batch.energy = ilaw::output(energy_.data(), ILAW_ENERGY_COUNT, 1);
    batch.amounts = theirs_.amounts;
    batch.impulse = ilaw::output(trial_.data()->data(), 3, 1);  // of no use any more, as the state
    batch.state_out.values = spare_state_.data();
    batch.status = nullptr;
    if (const std::int32_t code = call(batch, of_answer, answer_); code < 0) return code;
  }
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto i = static_cast<std::int64_t>(k);
    store(theirs_.impulse, i, dimension_, answer_[k]);
    for (std::int64_t c = 0; c < state_size; ++c)
      theirs_.state_out.values[i * theirs_.state_out.node_stride + c * theirs_.state_out.component_stride] =
          state_[k * info_.state_size + static_cast<std::size_t>(c)];
    if (theirs_.status) theirs_.status[i * theirs_.status_stride] = status_[k];
    for (std::size_t part = 0; part < ILAW_ENERGY_COUNT && !energy_.empty(); ++part) {
      const double energy = energy_[k * ILAW_ENERGY_COUNT + part];
      theirs_.energy.values[i * theirs_.energy.node_stride +
                            static_cast<std::int64_t>(part) * theirs_.energy.component_stride] = energy;
      report.energy[part] += energy;
    }
    report.work += 0.5 * dot(answer_[k], previous(contacts_[k], bodies) + relative(contacts_[k], of_answer));
  }
  return ILAW_OK;
}

}  // namespace ilaw::coupled
