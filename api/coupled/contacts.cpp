// SPDX-License-Identifier: BSD-3-Clause
#include "contacts.hpp"

#include "doubles.hpp"
#include "sizes.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace ilaw::coupled {
namespace {

// Largest part of an arm across the normal of a transverse H: arms that went through single precision pass.
constexpr double along_tolerance = 1e-6;
constexpr std::uint32_t max_ends = 1U << 16;

// Arms that are not numbers are left to the law to refuse, at their contact.
bool leads_aside(const Vector& arm, const Vector& normal) {
  const Vector across = cross(arm, normal);
  return dot(across, across) > along_tolerance * along_tolerance * dot(arm, arm) * dot(normal, normal);
}

}  // namespace

const char* Contacts::open(const ilaw_contacts& given, const Bodies& bodies) {
  if (!sized::is_complete(&given)) return "the struct_size of contacts is not that of any version";
  given_ = sized::read(&given);
  holds_bonds_ = true;
  if (!sized::is_complete(given_.batch)) return "a batch is missing, or its struct_size is wrong";
  theirs_ = sized::read(given_.batch);
  dimension_ = bodies.dimension();
  body_count_ = std::max(1U, given_.body_count);
  counterpart_count_ = std::max(1U, given_.counterpart_count);
  for (const char* reason : {complaint(), complaint_of_law(bodies), complaint_of_bodies(bodies)})
    if (reason) return reason;
  lay_out(bodies);
  read_ends(bodies);
  for (std::int64_t k = 0; k < count(); ++k)
    if (const char* reason = complaint_of_contact(k, bodies)) return reason;
  return nullptr;
}

const char* Contacts::complaint() const {
  if (!given_.law || !given_.instance) return "law or instance is null";
  if (given_.delassus_form != ILAW_DELASSUS_SCALAR && given_.delassus_form != ILAW_DELASSUS_FULL &&
      !is_transverse())
    return "delassus_form is neither scalar, transverse, transverse_spin nor full";
  if (theirs_.node_count < 0) return "node_count is negative";
  if (theirs_.node_count >= INT32_MAX) return "node_count is above 2^31 - 2";
  if (const char* reason = complaint_of_floats(given_, theirs_)) return reason;
  if (theirs_.index || theirs_.index64) return "contacts have no list of nodes";
  if (given_.weight_size > 1 && given_.weight_size != dimension_ * dimension_)
    return "weight_size is not 0, 1 or d * d";
  if (body_count_ > max_ends || counterpart_count_ > max_ends)
    return "body_count or counterpart_count is above 2^16";
  if (theirs_.node_count == 0) return nullptr;
  if (!given_.body || !given_.counterpart) return "body or counterpart is missing";
  if ((body_count_ > 1 && !given_.body_weight.values) ||
      (counterpart_count_ > 1 && !given_.counterpart_weight.values))
    return "several bodies on a side, and their weights are missing";
  if (!theirs_.impulse.values) return "impulse is missing";
  if (collides(theirs_.impulse, theirs_.node_count, dimension_)) return "impulse overlaps itself";
  if (has_spins()) {
    if (!theirs_.moment.values) return "delassus_form has spins, and moment is missing";
    if (collides(theirs_.moment, theirs_.node_count, 3)) return "moment overlaps itself";
    if (is_weighted()) return "delassus_form has spins; expected one body on either side, without weights";
  }
  if (collides(theirs_.energy, theirs_.node_count, ILAW_ENERGY_COUNT)) return "energy overlaps itself";
  return theirs_.status && theirs_.node_count > 1 && theirs_.status_stride == 0 ? "status_stride is 0"
                                                                                : nullptr;
}

const char* Contacts::complaint_of_law(const Bodies& bodies) {
  if (!given_.law || !given_.instance) return nullptr;  // complaint() names it
  if (has_spins() && !(given_.law->delassus_forms & ILAW_DELASSUS_TRANSVERSE_SPIN))
    return "delassus_form has spins, which the law does not serve";
  info_ = {};
  info_.struct_size = sizeof info_;
  if (given_.law->info(given_.instance, &info_) != ILAW_OK) return "info refuses the instance";
  if (const char* reason = complaint_of_floats(theirs_, info_)) return reason;
  if (!(info_.inputs & ILAW_INPUT_NORMAL))
    return "the instance is for the local frame; expected the global one";
  if (theirs_.energy.values && !(given_.law->outputs & ILAW_OUTPUT_ENERGY))
    return "energies are asked for, which the law does not give";
  const std::uint32_t read = info_.inputs | (asks_balance() ? info_.balance_inputs : 0U);
  constexpr std::uint32_t known = ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_AREA |
                                  ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT | ILAW_INPUT_V_SMOOTH;
  if (read & ~known) return "the law reads an input that coupled contacts do not know";
  if ((read & ILAW_INPUT_V_PREVIOUS) && theirs_.node_count > 0 && !bodies.have_previous())
    return "the law reads v_previous, which the bodies do not have";
  if (info_.state_size > 0 && theirs_.node_count > 0 &&
      (!theirs_.state_in.values || !theirs_.state_out.values))
    return "state_in or state_out is missing";
  if (collides(theirs_.state_out, theirs_.node_count, static_cast<std::int64_t>(info_.state_size)))
    return "state_out overlaps itself";
  for (std::uint32_t a = 0; theirs_.amounts && a < info_.amount_count; ++a)
    if (collides(theirs_.amounts[a], theirs_.node_count, 1)) return "an array of amounts overlaps itself";
  return nullptr;
}

const char* Contacts::complaint_of_bodies(const Bodies& bodies) const {
  if (!given_.body || !given_.counterpart || count() == 0) return nullptr;
  if (bodies.rotate()) {
    if (given_.delassus_form == ILAW_DELASSUS_SCALAR)
      return "bodies rotate, so delassus_form has to be transverse or full";
    if (!given_.arm.values || !given_.counterpart_arm.values) return "bodies rotate, and an arm is missing";
  } else if (has_spins()) {
    return "delassus_form has spins, and bodies do not rotate: inverse_inertia is missing";
  }
  if (is_flat(theirs_.normal, dimension_) || is_flat(theirs_.tangent, dimension_))
    return "normal or tangent has one component per contact (component stride 0), expected a (d,n) array";
  if (!is_transverse()) return nullptr;
  if (bodies.rotate() && !bodies.are_spheres())
    return "delassus_form is transverse, and bodies are no spheres";
  if (!bodies.are_isotropic()) return "delassus_form is transverse, and bodies have masses per axis";
  if (given_.weight_size > 1) return "delassus_form is transverse, and weights are matrices";
  return theirs_.normal.values ? nullptr : "delassus_form is transverse, and the normal is missing";
}

const char* Contacts::complaint_of_contact(std::int64_t k, const Bodies& bodies) const {
  if (given_.body[k * body_count_] < theirs_.index_base) return "a contact names a body that is not there";
  for (std::uint32_t e = 0; e < ends(); ++e)
    if (end(k, e) > bodies.wall()) return "a contact names a body that is not there";
  for (std::uint32_t i = 0; i < body_count_; ++i)
    for (std::uint32_t j = body_count_; j < ends(); ++j)
      if (const std::int32_t body = end(k, i); body != bodies.wall() && body == end(k, j))
        return "a contact of a body with itself";
  const std::int64_t size = std::max(1U, given_.weight_size);
  for (std::int64_t c = 0; is_weighted() && c < size * ends(); ++c) {
    const bool first_side = c < size * body_count_;
    const double w = first_side ? value(given_.body_weight, k, c)
                                : value(given_.counterpart_weight, k, c - size * body_count_);
    if (!std::isfinite(w)) return "a weight is not finite";
  }
  return nullptr;
}

// Beyond Bodies::wall() where the host names no body of theirs.
void Contacts::read_ends(const Bodies& bodies) {
  ends_.resize(static_cast<std::size_t>(count()) * ends());
  const auto read = [&](const std::int32_t* given, std::uint32_t side, std::uint32_t first) {
    for (std::int64_t k = 0; k < count(); ++k)
      for (std::uint32_t i = 0; i < side; ++i) {
        const std::int64_t index = std::int64_t{given[k * side + i]} - theirs_.index_base;
        std::int32_t& end = ends_[static_cast<std::size_t>(k) * ends() + first + i];
        end = index < 0 ? bodies.wall() : bodies.wall() + 1;
        if (index >= 0 && index < bodies.count()) end = static_cast<std::int32_t>(index);
      }
  };
  read(given_.body, body_count_, 0);
  read(given_.counterpart, counterpart_count_, body_count_);
}

bool Contacts::is_weighted() const {
  return body_count_ > 1 || counterpart_count_ > 1 || given_.body_weight.values ||
         given_.counterpart_weight.values;
}

void Contacts::lay_out(const Bodies& bodies) {
  layout_ = Layout(has_spins() ? 6 : 3);
  layout_.ends = static_cast<int>(body_count_ + counterpart_count_);
  layout_.weight_size = static_cast<int>(std::max(1U, given_.weight_size));
  if (layout_.weight_size > 1) layout_.weight_size = 9;
  layout_.state_size = static_cast<int>(info_.state_size);
  layout_.delassus_size = given_.delassus_form == ILAW_DELASSUS_SCALAR       ? 1
                          : given_.delassus_form == ILAW_DELASSUS_TRANSVERSE ? 2
                          : has_spins()                                      ? 5
                                        : static_cast<int>(dimension_ * (dimension_ + 1) / 2);
  const bool weighted = is_weighted();
  const bool has_rows = !bodies.rotate() && bodies.are_isotropic() && layout_.weight_size == 1;
  kind_ = has_spins()                                        ? Kind::spin
          : weighted && has_rows                             ? Kind::points
          : weighted                                         ? Kind::weighted
          : !bodies.are_isotropic()                          ? Kind::rigid
          : !bodies.rotate()                                 ? Kind::point
          : given_.delassus_form == ILAW_DELASSUS_TRANSVERSE ? Kind::sphere
                                                             : Kind::rigid;
  int next = layout_.delassus + layout_.delassus_size;
  const auto take = [&next](bool needed, int columns) {
    const int first = needed ? next : -1;
    next += needed ? columns : 0;
    return first;
  };
  const std::uint32_t read = info_.inputs | (asks_balance() ? info_.balance_inputs : 0U);
  const bool has_arms = kind_ == Kind::rigid || (kind_ == Kind::weighted && bodies.rotate());
  const bool has_lengths = kind_ == Kind::sphere || kind_ == Kind::spin;
  layout_.arm = take(has_arms || has_lengths, has_arms ? 3 : 1);
  layout_.counterpart_arm = take(has_arms || has_lengths, has_arms ? 3 : 1);
  layout_.length = take(has_spins(), 1);
  layout_.weight = take(weighted, layout_.ends * layout_.weight_size);
  const bool wall_moves = given_.wall_velocity.values || given_.wall_previous.values;
  const bool wall_spins = has_spins() && (given_.wall_spin.values || given_.wall_spin_previous.values);
  layout_.wall = take(wall_moves || wall_spins, layout_.width);
  layout_.gap = take(theirs_.gap.values != nullptr && (read & ILAW_INPUT_GAP), 1);
  layout_.gap_offset = take(theirs_.gap_offset.values != nullptr && (read & ILAW_INPUT_GAP), 1);
  layout_.area = take(theirs_.area.values != nullptr && (read & ILAW_INPUT_AREA), 1);
  layout_.v_smooth = take(read & ILAW_INPUT_V_SMOOTH, 3);
  layout_.v_previous = take(read & ILAW_INPUT_V_PREVIOUS, layout_.width);
  layout_.tangent = take(theirs_.tangent.values != nullptr, 3);
  layout_.parameters = take(theirs_.per_node_parameters && info_.per_node_parameter_count > 0,
                            static_cast<int>(info_.per_node_parameter_count));
  layout_.state_in = take(info_.state_size > 0, layout_.state_size);
  layout_.state_out = take(info_.state_size > 0, layout_.state_size);
  layout_.columns = next;
}

// The value that iterations begin with, of impulse or moment.
Vector Contacts::start(const ilaw_output& a, std::int64_t k) const {
  const Vector start = vector(ilaw::input(a.values, a.node_stride, a.component_stride), k, dimension_);
  return std::isfinite(dot(start, start)) ? start : Vector{};
}

void Contacts::add_outputs(std::vector<const double*>& outputs) const {
  if (count() == 0) return;
  for (const ilaw_output* a : {&theirs_.impulse, &theirs_.moment, &theirs_.energy})
    if (a->values) outputs.push_back(a->values);
  if (layout_.state_size > 0) outputs.push_back(theirs_.state_out.values);
}

Vector Contacts::relative(std::int64_t k, const Bodies& bodies) const {
  const Body &x = bodies.now()[end(k, 0)], &y = bodies.now()[end(k, 1)];
  Vector u = x.velocity - y.velocity - vector(given_.wall_velocity, k, dimension_);
  if (bodies.rotate()) {
    u = u + cross(x.spin, vector(given_.arm, k, 3));
    if (end(k, 1) != bodies.wall()) u = u - cross(y.spin, vector(given_.counterpart_arm, k, 3));
  }
  return u;
}

// The order of operations of ilaw.h, "out of reach". Whether a state is fresh the solver does not know.
bool Contacts::is_out_of_reach(std::int64_t k, const Bodies& bodies) const {
  if (!(info_.permissions & ILAW_MAY_SKIP_FREE) || is_weighted() || !theirs_.gap.values) return false;
  const double gap = value(theirs_.gap, k) - value(theirs_.gap_offset, k);
  if (!(gap > 0.0) || !is_zero(start(theirs_.impulse, k))) return false;
  if (has_spins() && !is_zero(start(theirs_.moment, k))) return false;
  return gap + theirs_.position_step * dot(vector(theirs_.normal, k, dimension_), relative(k, bodies)) > 0.0;
}

bool Contacts::is_in_reach(const Block& block, std::size_t lane, const Vector& v) const {
  double gap = layout_.gap < 0 ? 0.0 : block.column(layout_.gap)[lane];
  if (layout_.gap_offset >= 0) gap -= block.column(layout_.gap_offset)[lane];
  const Vector n = block.at(layout_.normal, lane);
  const double approach = (n[0] * v[0] + n[1] * v[1]) + n[2] * v[2];
  return !(gap > 0.0 && gap + theirs_.position_step * approach > 0.0);
}

bool Contacts::fill(Block& block, std::size_t lane, std::int64_t k, const Bodies& bodies) const {
  for (std::uint32_t e = 0; e < ends(); ++e) block.ends[e * block.stride + lane] = end(k, e);
  block.contact[lane] = static_cast<std::int32_t>(k);
  const Vector normal = vector(theirs_.normal, k, dimension_);
  block.put(layout_.normal, lane, normal);
  block.put(layout_.impulse, lane, start(theirs_.impulse, k));
  if (has_spins()) block.put(layout_.impulse + 3, lane, start(theirs_.moment, k));
  for (int c = 0; c < layout_.width; ++c)
    block.column(layout_.direction + c)[lane] = block.column(layout_.change + c)[lane] = 0.0;
  bool acts = true;
  if (layout_.arm >= 0) {
    const bool is_wall = layout_.weight < 0 && end(k, 1) == bodies.wall();
    const Vector arm = vector(given_.arm, k, 3);
    const Vector other = is_wall ? Vector{} : vector(given_.counterpart_arm, k, 3);
    if (is_transverse() && (leads_aside(arm, normal) || leads_aside(other, normal))) return false;
    acts = is_finite(normal) && is_finite(arm) && is_finite(other);
    if (kind_ == Kind::sphere || kind_ == Kind::spin) {
      block.column(layout_.arm)[lane] = dot(arm, normal);
      block.column(layout_.counterpart_arm)[lane] = dot(other, normal);
    } else {
      block.put(layout_.arm, lane, arm);
      block.put(layout_.counterpart_arm, lane, other);
    }
  }
  if (layout_.weight >= 0) fill_weights(block, lane, k);
  fill_delassus(block, lane, bodies);
  // Its law finds bad input and an impulse of 0, whose moment would be no number at the bodies.
  for (std::uint32_t e = 0; !acts && e < ends(); ++e) block.ends[e * block.stride + lane] = bodies.wall();
  if (layout_.wall >= 0) block.put(layout_.wall, lane, vector(given_.wall_velocity, k, dimension_));
  if (layout_.wall >= 0 && has_spins()) block.put(layout_.wall + 3, lane, vector(given_.wall_spin, k, 3));
  if (layout_.gap >= 0) block.column(layout_.gap)[lane] = value(theirs_.gap, k);
  if (layout_.gap_offset >= 0) block.column(layout_.gap_offset)[lane] = value(theirs_.gap_offset, k);
  if (layout_.area >= 0) block.column(layout_.area)[lane] = value(theirs_.area, k);
  if (layout_.tangent >= 0) block.put(layout_.tangent, lane, vector(theirs_.tangent, k, dimension_));
  if (layout_.v_previous >= 0) {  // to which those of the bodies are added
    const auto or_else = [](const ilaw_input& before, const ilaw_input& now) -> const ilaw_input& {
      return before.values ? before : now;
    };
    const ilaw_input& velocity = or_else(given_.wall_previous, given_.wall_velocity);
    block.put(layout_.v_previous, lane, -1.0 * vector(velocity, k, dimension_));
    const ilaw_input& spin = or_else(given_.wall_spin_previous, given_.wall_spin);
    if (has_spins()) block.put(layout_.v_previous + 3, lane, -1.0 * vector(spin, k, 3));
  }
  for (std::uint32_t p = 0; layout_.parameters >= 0 && p < info_.per_node_parameter_count; ++p)
    block.column(layout_.parameters + static_cast<int>(p))[lane] = value(theirs_.per_node_parameters[p], k);
  for (int c = 0; c < layout_.state_size; ++c)
    block.column(layout_.state_in + c)[lane] = value(theirs_.state_in, k, c);
  return true;
}

void Contacts::close_gaps(Block& block, double known_velocity, double part, const double* speeds) const {
  if (layout_.gap < 0) return;
  double* gap = block.column(layout_.gap);
  for (std::size_t q = 0; q < block.count; ++q) {
    const double offset = layout_.gap_offset < 0 ? 0.0 : block.column(layout_.gap_offset)[q];
    const double known = theirs_.position_step * std::max(known_velocity, part * speeds[q]);
    if (gap[q] > offset && gap[q] - offset <= known) gap[q] = offset;
  }
}

std::int32_t Contacts::evaluate(const Block& block, const Call& call, ilaw_report& report) const {
  const auto stride = static_cast<std::int64_t>(block.stride);
  const auto input = [&](int column) {
    return column < 0 ? ilaw_input{} : ilaw::input(block.column(column), 1, stride);
  };
  std::array<ilaw_input, 16> parameters;
  std::vector<ilaw_input> many_parameters;
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = static_cast<std::int64_t>(block.count);
  batch.flags = theirs_.flags;
  batch.time = theirs_.time;
  batch.velocity_step = theirs_.velocity_step;
  batch.position_step = theirs_.position_step;
  batch.v_free = ilaw::input(call.v_free, 1, max_stride);
  batch.delassus = ilaw::input(call.delassus, 1, static_cast<std::int64_t>(call.delassus_stride));
  batch.gap = input(layout_.gap);
  batch.gap_offset = input(layout_.gap_offset);
  batch.v_smooth = input(layout_.v_smooth);
  batch.v_previous = input(layout_.v_previous);
  batch.area = input(layout_.area);
  batch.normal = input(layout_.normal);
  batch.tangent = input(layout_.tangent);
  if (layout_.parameters >= 0) {
    ilaw_input* list = parameters.data();
    if (info_.per_node_parameter_count > parameters.size()) {
      many_parameters.resize(info_.per_node_parameter_count);
      list = many_parameters.data();
    }
    for (std::uint32_t p = 0; p < info_.per_node_parameter_count; ++p)
      list[p] = input(layout_.parameters + static_cast<int>(p));
    batch.per_node_parameters = list;
  }
  batch.state_in = input(layout_.state_in);
  if (layout_.state_out >= 0)
    batch.state_out = ilaw::output(
        call.state_out ? call.state_out : const_cast<double*>(block.column(layout_.state_out)), 1, stride);
  batch.impulse = ilaw::output(call.impulse, 1, max_stride);
  if (has_spins()) {
    batch.spin_free = ilaw::input(call.v_free + 3 * max_stride, 1, max_stride);
    batch.spin_previous = input(layout_.v_previous < 0 ? -1 : layout_.v_previous + 3);
    batch.moment = ilaw::output(call.impulse + 3 * max_stride, 1, max_stride);
  }
  if (call.energy) batch.energy = ilaw::output(call.energy, 1, max_stride);
  batch.amounts = call.amounts;
  if (call.status && (given_.law->outputs & ILAW_OUTPUT_STATUS)) batch.status = call.status;
  batch.status_stride = 1;
  report = {};
  report.struct_size = sizeof report;
  if (holds_bonds() && !call.judges) batch.flags = ILAW_BATCH_HOLD_BONDS;
  const std::int32_t code = given_.law->evaluate(given_.instance, &batch, &report);
  return code < 0 || !block.has_broken ? code : evaluate_broken(block, batch, report);
}

// The lanes whose bonds broke in this step, again.
std::int32_t Contacts::evaluate_broken(const Block& block, ilaw_batch& batch, ilaw_report& report) const {
  std::array<std::int32_t, max_lanes> broken;
  batch.node_count = 0;
  for (std::size_t q = 0; q < block.count; ++q)
    if (block.broken[q]) broken[static_cast<std::size_t>(batch.node_count++)] = static_cast<std::int32_t>(q);
  batch.index = broken.data();
  batch.index_base = 0;
  batch.flags = ILAW_BATCH_BREAK_BONDS;
  ilaw_report of_broken{};
  of_broken.struct_size = sizeof of_broken;
  const std::int32_t code = given_.law->evaluate(given_.instance, &batch, &of_broken);
  if (report.bad_count == 0) {
    of_broken.stable_velocity_step = std::min(of_broken.stable_velocity_step, report.stable_velocity_step);
    report = of_broken;
  }
  return report.bad_count > 0 && code >= 0 ? std::int32_t{ILAW_BAD_NODES} : code;
}

double Contacts::wall_work(const Block& block, std::size_t lane) const {
  const std::int64_t k = block.contact[lane];
  const auto of = [&](int column, const ilaw_input& now, const ilaw_input& before) {
    return dot(block.at(column, lane),
               vector(before.values ? before : now, k, dimension_) + vector(now, k, dimension_));
  };
  const double work = of(layout_.impulse, given_.wall_velocity, given_.wall_previous);
  return has_spins() ? work + of(layout_.impulse + 3, given_.wall_spin, given_.wall_spin_previous) : work;
}

void Contacts::write(const Block& block, std::size_t lane) const {
  const std::int64_t k = block.contact[lane];
  store(theirs_.impulse, k, dimension_, block.at(layout_.impulse, lane));
  if (has_spins()) store(theirs_.moment, k, 3, block.at(layout_.impulse + 3, lane));
  if (theirs_.status) theirs_.status[k * theirs_.status_stride] = block.status[lane];
  if (layout_.state_size == 0) return;
  double* state = theirs_.state_out.values + k * theirs_.state_out.node_stride;
  for (int c = 0; c < layout_.state_size; ++c)
    state[c * theirs_.state_out.component_stride] = block.column(layout_.state_out + c)[lane];
}

void Contacts::write_balance(const Block& block, std::size_t lane, const double* energy,
                             const double* amounts, double* energy_sums) const {
  const std::int64_t k = block.contact[lane];
  for (std::size_t part = 0; theirs_.energy.values && part < ILAW_ENERGY_COUNT; ++part) {
    const double of_part = energy[part * max_stride + lane];
    theirs_.energy.values[k * theirs_.energy.node_stride +
                          static_cast<std::int64_t>(part) * theirs_.energy.component_stride] = of_part;
    energy_sums[part] += of_part;
  }
  for (std::uint32_t a = 0; a < amount_count(); ++a)
    if (const ilaw_output& out = theirs_.amounts[a]; out.values)
      out.values[k * out.node_stride] = amounts[a * max_stride + lane];
}

}  // namespace ilaw::coupled
