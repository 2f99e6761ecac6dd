// SPDX-License-Identifier: BSD-3-Clause
#include "batch_source.hpp"

#include <utility>

namespace random_batches {
namespace {

constexpr int few_nodes = 8, many_nodes = 150;  // more than a block of the kit

// An array of room nodes with strides of any sort; only the elements of the nodes in use may be touched.
template <class Number>
Array make_array(Draw& draw, Region<Number>& region, Number* Array::*values, std::size_t components,
                 std::int64_t room, const std::vector<std::int64_t>& used, bool may_share) {
  Array made;
  const auto width = static_cast<std::int64_t>(components > 0 ? components : 1);
  const auto gap = static_cast<std::int64_t>(draw.below(3));
  if (draw.one_in(2)) {  // components first
    made.component_stride = 1 + gap;
    made.node_stride = width * (1 + gap) + static_cast<std::int64_t>(draw.below(3));
  } else {
    made.node_stride = 1 + gap;
    made.component_stride = room * (1 + gap) + static_cast<std::int64_t>(draw.below(3));
  }
  const std::int64_t span = (room - 1) * made.node_stride + (width - 1) * made.component_stride + 1;
  made.*values = region.span(static_cast<std::size_t>(span));
  if (draw.one_in(4)) {  // backwards
    made.*values += (room - 1) * made.node_stride;
    made.node_stride = -made.node_stride;
  }
  if (draw.one_in(4)) {
    made.*values += (width - 1) * made.component_stride;
    made.component_stride = -made.component_stride;
  }
  if (may_share && draw.one_in(4)) made.node_stride = 0;
  for (const std::int64_t node : used)
    for (std::size_t c = 0; c < components; ++c)
      ASAN_UNPOISON_MEMORY_REGION(made.*values + made.at(node, c), sizeof(Number));
  return made;
}

double value(Draw& draw, const ilaw_parameter& p) {
  if ((p.flags & ILAW_FLAG_ALLOWS_INFINITY) && draw.one_in(6)) return of_bits(0x7FF0000000000000);
  const bool count = p.kind == ILAW_KIND_INTEGER;
  const double most = count ? 40.0 : 1e6;  // no state of thousands of doubles
  const double high = p.maximum < most ? p.maximum : most, low = p.minimum > -1e6 ? p.minimum : -1e6;
  if (draw.one_in(6)) return high;
  if (draw.one_in(6) && !(p.flags & ILAW_FLAG_EXCLUDES_MINIMUM)) return low;
  const double reach = draw.one_in(3) ? 1e4 : 2.0;
  const double drawn = low + (reach < high - low ? reach : high - low) * (1.0 - draw.unit());
  return count ? static_cast<double>(static_cast<std::int64_t>(drawn)) : drawn;
}

// Up to three axes of two points, with what the argument points to.
struct Table {
  std::array<std::array<double, 2>, 3> points{};
  std::array<ilaw_axis, 3> axes{};
  std::array<const ilaw_axis*, 3> pointers{};
  std::array<double, 8> values{};
};

void give_table(Draw& draw, const ilaw_parameter& p, Table& table, ilaw_argument& a) {
  a.kind = ILAW_KIND_VALUE_TABLE;
  a.axis_count = 1 + static_cast<std::uint32_t>(draw.below(p.axis_count < 3 ? p.axis_count : 3));
  for (std::uint32_t k = 0; k < a.axis_count; ++k) {
    table.points[k] = {draw.unit(), 1.0 + draw.within(0.0, 400.0)};
    table.axes[k] = {sizeof(ilaw_axis), 0, p.axes[k], table.points[k].data(), 2};
    table.pointers[k] = &table.axes[k];
  }
  for (double& one : table.values) one = value(draw, p);
  a.axes = table.pointers.data();
  a.values = table.values.data();
}

ilaw_argument argument(Draw& draw, const ilaw_parameter& p, Table& table) {
  ilaw_argument a{};
  a.struct_size = sizeof a;
  a.name = p.name;
  if (p.kind == ILAW_KIND_CHOICE) {
    a.kind = ILAW_KIND_VALUE_TEXT;
    a.text = p.choices[draw.below(p.choice_count)];
  } else if ((p.flags & ILAW_FLAG_ALLOWS_PER_NODE) && draw.one_in(4)) {
    a.kind = ILAW_KIND_VALUE_PER_NODE;
  } else if (p.axis_count > 0 && draw.one_in(4)) {
    give_table(draw, p, table, a);
  } else {
    a.number = value(draw, p);
  }
  return a;
}

}  // namespace

std::optional<Drawn> Drawn::of(const ilaw::library& library, Draw& draw) {
  const ilaw_plugin& plugin = library.plugin();
  const ilaw_law& law = *plugin.laws[draw.below(plugin.law_count)];
  Drawn drawn;
  drawn.setup_.struct_size = sizeof drawn.setup_;
  drawn.setup_.dimension = 1 + static_cast<std::uint32_t>(draw.below(3));
  drawn.setup_.delassus_form = 1U << draw.below(5);
  drawn.setup_.frame = draw.one_in(2) ? ILAW_FRAME_GLOBAL : ILAW_FRAME_LOCAL;
  drawn.setup_.numbers = draw.one_in(3) ? ILAW_NUMBERS_FLOAT : ILAW_NUMBERS_DOUBLE;
  drawn.setup_.has_tangent = drawn.setup_.frame == ILAW_FRAME_GLOBAL && draw.one_in(2);
  std::vector<ilaw_argument> arguments;
  std::vector<Table> tables(law.parameter_count);
  for (std::uint32_t p = 0; p < law.parameter_count; ++p)
    if ((law.parameters[p]->flags & ILAW_FLAG_REQUIRED) || draw.one_in(2))
      arguments.push_back(argument(draw, *law.parameters[p], tables[p]));
  std::vector<const ilaw_argument*> pointers;
  for (const ilaw_argument& a : arguments) pointers.push_back(&a);
  drawn.setup_.arguments = pointers.data();
  drawn.setup_.argument_count = static_cast<std::uint32_t>(pointers.size());
  if (before) before();
  try {
    drawn.interface_.emplace(library, law.id, drawn.setup_);
  } catch (const ilaw::error&) {
    drawn.interface_.reset();
  }
  if (after) after();
  if (!drawn.interface_) return std::nullopt;
  drawn.info_ = drawn.interface_->info();
  drawn.setup_.arguments = nullptr;
  return drawn;
}

std::size_t Runner::form_width() const {
  const std::size_t d = drawn_.dimension();
  if (drawn_.form() == ILAW_DELASSUS_SCALAR) return 1;
  if (drawn_.form() == ILAW_DELASSUS_DIAGONAL) return d;
  if (drawn_.spins()) return 5;
  return drawn_.form() == ILAW_DELASSUS_FULL ? d * (d + 1) / 2 : 2;
}

void Runner::draw_nodes() {
  const auto count = static_cast<std::int64_t>(1 + draw_.below(draw_.one_in(20) ? many_nodes : few_nodes));
  const std::uint64_t list = draw_.below(3);  // none, 32 or 64 bits
  room_ = list == 0 ? count : count + static_cast<std::int64_t>(draw_.below(4));
  std::vector<std::int64_t> all;
  for (std::int64_t i = 0; i < room_; ++i) all.push_back(i);
  if (list != 0)
    for (std::size_t i = all.size() - 1; i > 0; --i) std::swap(all[i], all[draw_.below(i + 1)]);
  nodes_.assign(all.begin(), all.begin() + count);
  const auto base = static_cast<std::int32_t>(draw_.one_in(4) ? draw_.bits() % 2000 : draw_.below(2));
  batch_ = {};
  batch_.struct_size = sizeof batch_;
  batch_.index_base = base;
  batch_.node_count = count;
  for (const std::int64_t node : nodes_) {
    index_.push_back(static_cast<std::int32_t>(node) + base);
    index64_.push_back(node + base);
  }
  if (list == 1) batch_.index = index_.data();
  if (list == 2) batch_.index64 = index64_.data();
}

// The components from one to another.
void Runner::fill(const Array& a, std::size_t begin, std::size_t end, double low, double high) {
  for (const std::int64_t node : nodes_)
    for (std::size_t c = begin; c < end; ++c)
      if (temper_.is_odd(draw_))
        a.put_any(node, c, draw_);
      else
        a.put(node, c, draw_.within(low, high));
}

void Runner::draw_arrays() {
  const std::size_t d = drawn_.dimension();
  const auto make = [this](std::size_t components, bool may_share) {
    return drawn_.floats()
               ? make_array(draw_, arena_.floats, &Array::floats, components, room_, nodes_, may_share)
               : make_array(draw_, arena_.doubles, &Array::values, components, room_, nodes_, may_share);
  };
  const auto in = [&](std::size_t components) { return make(components, true); };
  const auto out = [&](std::size_t components) { return make(components, false); };
  const auto state = [this] {
    return make_array(draw_, arena_.doubles, &Array::values, drawn_.info().state_size, room_, nodes_, false);
  };
  v_free_ = in(d);
  delassus_ = in(form_width());
  gap_ = in(1);
  if (draw_.one_in(3)) offset_ = in(1);
  previous_ = in(d);
  if (draw_.one_in(2)) smooth_ = in(d);
  if (drawn_.spins()) {
    spin_free_ = in(d);
    spin_previous_ = in(d);
    moment_ = out(d);
    if (draw_.one_in(2)) spin_ = out(d);
  }
  area_ = in(1);
  if (drawn_.global()) normal_ = in(d);
  if (drawn_.tangent()) tangent_ = in(d);
  for (std::uint32_t k = 0; k < drawn_.info().per_node_parameter_count; ++k) per_node_.push_back(in(1));
  in_place_ = draw_.one_in(2);
  state_in_ = state();
  state_out_ = in_place_ ? state_in_ : state();
  impulse_ = out(d);
  if (draw_.one_in(2)) velocity_ = out(d);
  if (draw_.one_in(2)) energy_ = out(ILAW_ENERGY_COUNT);
  if (draw_.one_in(2)) amounts_.resize(drawn_.info().amount_count);
  for (Array& amount : amounts_)
    if (!draw_.one_in(3)) amount = out(1);
}

void Runner::describe() {
  batch_.v_free = v_free_.input();
  batch_.delassus = delassus_.input();
  batch_.gap = gap_.input();
  batch_.gap_offset = offset_.input();
  batch_.v_previous = previous_.input();
  batch_.v_smooth = smooth_.input();
  batch_.spin_free = spin_free_.input();
  batch_.spin_previous = spin_previous_.input();
  batch_.area = area_.input();
  batch_.normal = normal_.input();
  batch_.tangent = tangent_.input();
  for (const Array& a : per_node_) per_node_inputs_.push_back(a.input());
  for (const Array& a : amounts_) amount_outputs_.push_back(a.output());
  batch_.per_node_parameters = per_node_inputs_.empty() ? nullptr : per_node_inputs_.data();
  batch_.state_in = state_in_.input();
  batch_.state_out = state_out_.output();
  batch_.impulse = impulse_.output();
  batch_.moment = moment_.output();
  batch_.velocity = velocity_.output();
  batch_.spin = spin_.output();
  batch_.energy = energy_.output();
  batch_.amounts = amount_outputs_.empty() ? nullptr : amount_outputs_.data();
  if (draw_.one_in(2)) {
    batch_.status_stride = 1 + static_cast<std::int64_t>(draw_.below(3));
    status_.resize(static_cast<std::size_t>(room_ * batch_.status_stride));
    batch_.status = status_.data();
  }
  batch_.velocity_step = batch_.position_step = 1e-3;
  for (const std::int64_t node : nodes_)
    for (std::size_t c = 0; c < drawn_.info().state_size; ++c)
      for (const Array& state : {state_in_, state_out_}) state.put(node, c, 0.0);
  fill_frames();
  fill(area_, 0, 1, 0.5, 2.0);
  for (const Array& a : per_node_) fill(a, 0, 1, 0.0, 1.0);
}

// Unit normals of any direction, by Cayley's map of two numbers; the tangent is square to it.
void Runner::fill_frames() {
  if (!drawn_.global()) return;
  const std::size_t d = drawn_.dimension();
  for (const std::int64_t node : nodes_) {
    const double a = draw_.within(-2.0, 2.0), b = draw_.within(-2.0, 2.0), s = 1.0 + a * a + b * b;
    const double n[3] = {(1.0 - a * a - b * b) / s, 2.0 * a / s, 2.0 * b / s};
    const double flat[2] = {(1.0 - a * a) / (1.0 + a * a), 2.0 * a / (1.0 + a * a)};
    const double t[3] = {-2.0 * a / s, 1.0 - 2.0 * a * a / s, -2.0 * a * b / s};
    for (std::size_t c = 0; c < d; ++c) {
      const Temper rarer{8 * temper_.odd};
      normal_.put(node, c, d == 3 ? n[c] : d == 2 ? flat[c] : 1.0);
      if (rarer.is_odd(draw_)) normal_.put_any(node, c, draw_);
      if (!drawn_.tangent()) continue;
      tangent_.put(node, c, d == 3 ? t[c] : d == 2 ? (c == 0 ? -flat[1] : flat[0]) : 0.0);
      if (rarer.is_odd(draw_)) tangent_.put_any(node, c, draw_);
    }
  }
}

void Runner::fill_delassus() {
  const std::size_t d = drawn_.dimension(), width = form_width();
  const double scale = draw_.one_in(4) ? 1e6 : 1.0;
  const std::size_t diagonal = drawn_.spins() ? 2 : drawn_.form() == ILAW_DELASSUS_FULL ? d : width;
  fill(delassus_, 0, diagonal, 0.5 * scale, 2.0 * scale);
  fill(delassus_, diagonal, drawn_.spins() ? 3 : width, -0.24 * scale, 0.24 * scale);
  if (drawn_.spins()) fill(delassus_, 3, width, 0.5 * scale, 2.0 * scale);
}

void Runner::fill_step(int n) {
  const std::size_t d = drawn_.dimension();
  batch_.time = 1e-3 * n;
  batch_.velocity_step = 1e-3 * (0.5 + draw_.unit());
  batch_.position_step = 1e-3 * (0.5 + draw_.unit());
  if (temper_.odd != 0 && draw_.one_in(50)) batch_.time = any_double(draw_);
  if (temper_.odd != 0 && draw_.one_in(50)) batch_.velocity_step = any_double(draw_);
  if (temper_.odd != 0 && draw_.one_in(50)) batch_.position_step = any_double(draw_);
  const double speed = draw_.one_in(3) ? 100.0 : 1.0;
  fill(v_free_, 0, d, -speed, speed);
  fill(previous_, 0, d, -speed, speed);
  for (const Array& given : {smooth_, spin_free_, spin_previous_})
    if (given.is_given()) fill(given, 0, d, -speed, speed);
  const double depth = draw_.one_in(2) ? 1e-3 : 0.2;
  fill(gap_, 0, 1, -depth, depth);
  if (offset_.is_given()) fill(offset_, 0, 1, 0.0, 1e-3);
  fill_delassus();
  if (draw_.one_in(4)) fill_frames();
  fill_state();
}

// Takes the state that the law wrote, sometimes mixed with an older one or with numbers that nobody wrote.
void Runner::fill_state() {
  const std::size_t size = drawn_.info().state_size;
  if (size == 0) return;
  for (const std::int64_t node : nodes_) {
    const bool stale = draw_.one_in(4);
    for (std::size_t c = 0; !in_place_ && c < size; ++c)
      if (!stale || draw_.one_in(2)) state_in_.put(node, c, state_out_.get(node, c));
    if (temper_.odd == 0 || draw_.below(4 * temper_.odd) >= size) continue;
    for (std::uint64_t k = draw_.below(3) + 1; k > 0; --k) state_in_.put_any(node, draw_.below(size), draw_);
  }
}

void Runner::call(bool evaluates, Tally& tally) {
  ilaw_report report{};
  report.struct_size = sizeof report;
  if (before) before();
  const ilaw::interface& law = drawn_.interface();
  const std::int32_t code = evaluates ? law.evaluate(batch_, &report) : law.initialise(batch_, &report);
  if (after) after();
  if (evaluates) ++tally.batches;
  if (evaluates && drawn_.floats()) ++tally.of_floats;
  check(code, report, evaluates, tally);
  tally.add(static_cast<std::uint64_t>(code));
  if (code < 0) return;
  for (const std::int64_t node : nodes_) {
    for (std::size_t c = 0; c < drawn_.info().state_size; ++c) tally.add(state_out_.bits(node, c));
    for (std::size_t c = 0; evaluates && c < drawn_.dimension(); ++c) {
      tally.add(impulse_.bits(node, c));
      if (drawn_.spins()) tally.add(moment_.bits(node, c));
    }
  }
}

void Runner::check(std::int32_t code, const ilaw_report& report, bool evaluated, Tally& tally) {
  const auto refuse = [&](const std::string& what) {
    if (!tally.wrong.empty()) return;
    tally.wrong = std::string(drawn_.interface().law().id) + " (dimension " +
                  std::to_string(drawn_.dimension()) + ", form of H " + std::to_string(drawn_.form()) +
                  (drawn_.global() ? ", global" : ", local") + (drawn_.floats() ? ", floats" : "") +
                  "): batch " + std::to_string(tally.batches) + ": " + what;
  };
  if (code < 0) {
    ++tally.refused;
    if (!report.reason) refuse("refused with code " + std::to_string(code) + " and no reason");
    return;
  }
  if (code != ILAW_OK && code != ILAW_BAD_NODES) refuse("code " + std::to_string(code));
  if ((code == ILAW_BAD_NODES) != (report.bad_count > 0)) refuse("code and count of bad nodes differ");
  if (report.bad_count > 0 && !report.reason) refuse("a bad node without a reason");
  tally.nodes += nodes_.size();
  tally.bad += static_cast<std::uint64_t>(report.bad_count);
  for (const std::int64_t node : nodes_) {
    const std::string wrong =
        evaluated ? wrong_at(node, report.bad_count > 0 && node == report.first_bad_node) : "";
    if (!wrong.empty()) refuse(wrong + " at node " + std::to_string(node));
  }
}

// The violation at an evaluated node, empty where there is none.
std::string Runner::wrong_at(std::int64_t node, bool is_bad) const {
  bool zero = true;
  for (std::size_t c = 0; c < drawn_.dimension(); ++c) {
    for (const Array& given : {impulse_, drawn_.spins() ? moment_ : impulse_}) {
      if (!given.is_finite(node, c)) return "an impulse or moment of " + std::to_string(given.get(node, c));
      zero = zero && given.get(node, c) == 0.0;
    }
  }
  if (is_bad && !zero) return "bad input and an impulse";
  if (batch_.status && status_[static_cast<std::size_t>(node * batch_.status_stride)] >= ILAW_STATUS_COUNT)
    return "a status that is none";
  for (const Array& amount : amounts_)
    if (amount.is_given() && (amount.is_nan(node, 0) || (is_bad && amount.get(node, 0) != 0.0)))
      return "an amount of " + std::to_string(amount.get(node, 0));
  if (!energy_.is_given()) return "";
  for (std::size_t c = 0; c < ILAW_ENERGY_STORED; ++c)
    if (!(energy_.get(node, c) >= 0.0))  // infinite where its terms are beyond the largest number
      return "a dissipated energy of " + std::to_string(energy_.get(node, c));
  return energy_.is_nan(node, ILAW_ENERGY_STORED) ? "a stored energy of NaN" : "";
}

}  // namespace random_batches
