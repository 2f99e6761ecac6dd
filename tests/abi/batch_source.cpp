// SPDX-License-Identifier: BSD-3-Clause
#include "batch_source.hpp"

#include <utility>

namespace random_batches {
namespace {

constexpr int most_nodes = 8;

// An array of room nodes with strides of any sort; only the elements of the nodes in use may be touched.
Array make_array(Draw& draw, Arena& arena, std::size_t components, std::int64_t room,
                 const std::vector<std::int64_t>& used, bool may_share) {
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
  made.values = arena.span(static_cast<std::size_t>(span));
  if (draw.one_in(4)) {  // backwards
    made.values += (room - 1) * made.node_stride;
    made.node_stride = -made.node_stride;
  }
  if (draw.one_in(4)) {
    made.values += (width - 1) * made.component_stride;
    made.component_stride = -made.component_stride;
  }
  if (may_share && draw.one_in(4)) made.node_stride = 0;
  for (const std::int64_t node : used)
    for (std::size_t c = 0; c < components; ++c)
      ASAN_UNPOISON_MEMORY_REGION(&made.at(node, c), sizeof(double));
  return made;
}

void fill(Draw& draw, const Array& a, const std::vector<std::int64_t>& used, std::size_t components,
          const Temper& temper, double low, double high) {
  for (const std::int64_t node : used)
    for (std::size_t c = 0; c < components; ++c) a.at(node, c) = temper.number(draw, low, high);
}

double value(Draw& draw, const ilaw_parameter& p) {
  if (p.infinity_allowed && draw.one_in(6)) return of_bits(0x7FF0000000000000);
  const bool count = p.kind == ILAW_PARAMETER_COUNT;
  const double most = count ? 40.0 : 1e6;  // no state of thousands of doubles
  const double high = p.maximum < most ? p.maximum : most, low = p.minimum > -1e6 ? p.minimum : -1e6;
  if (draw.one_in(6)) return high;
  if (draw.one_in(6) && !p.minimum_excluded) return low;
  const double reach = draw.one_in(3) ? 1e4 : 2.0;
  const double drawn = low + (reach < high - low ? reach : high - low) * (1.0 - draw.unit());
  return count ? static_cast<double>(static_cast<std::int64_t>(drawn)) : drawn;
}

ilaw_argument argument(Draw& draw, const ilaw_parameter& p, std::array<double, 6>& table) {
  ilaw_argument a{};
  a.struct_size = sizeof a;
  a.name = p.name;
  if (p.kind == ILAW_PARAMETER_CHOICE) {
    a.kind = ILAW_VALUE_TEXT;
    a.text = p.choices[draw.below(p.choice_count)];
  } else if ((p.may_be & ILAW_MAY_BE_PER_NODE) && draw.one_in(4)) {
    a.kind = ILAW_VALUE_PER_NODE;
  } else if ((p.may_be & ILAW_MAY_BE_TABLE) && draw.one_in(4)) {
    for (std::size_t k = 0; k < 3; ++k) {
      table[2 * k] = static_cast<double>(k);
      table[2 * k + 1] = value(draw, p);
    }
    a.kind = ILAW_VALUE_TABLE;
    a.values = table.data();
    a.count = 3;
  } else {
    a.number = value(draw, p);
  }
  return a;
}

// By their bits, since -ffast-math would have no number be infinite or NaN.
std::uint64_t bits_of(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
bool is_finite(double value) { return (bits_of(value) >> 52 & 0x7FF) != 0x7FF; }
bool is_nan(double value) { return (bits_of(value) & ~(std::uint64_t{1} << 63)) > 0x7FF0000000000000; }

}  // namespace

std::optional<Drawn> Drawn::of(const ilaw::library& library, Draw& draw) {
  const ilaw_plugin& plugin = library.plugin();
  const ilaw_law& law = *plugin.laws[draw.below(plugin.law_count)];
  Drawn drawn;
  drawn.setup_.struct_size = sizeof drawn.setup_;
  drawn.setup_.dimension = 1 + static_cast<std::uint32_t>(draw.below(3));
  drawn.setup_.delassus_form = 1U << draw.below(4);
  drawn.setup_.frame = draw.one_in(2) ? ILAW_FRAME_GLOBAL : ILAW_FRAME_LOCAL;
  drawn.setup_.tangent_given = drawn.setup_.frame == ILAW_FRAME_GLOBAL && draw.one_in(2);
  std::vector<ilaw_argument> arguments;
  std::vector<std::array<double, 6>> tables(law.parameter_count);
  for (std::uint32_t p = 0; p < law.parameter_count; ++p)
    if (law.parameters[p]->required || draw.one_in(2))
      arguments.push_back(argument(draw, *law.parameters[p], tables[p]));
  std::vector<const ilaw_argument*> pointers;
  for (const ilaw_argument& a : arguments) pointers.push_back(&a);
  drawn.setup_.arguments = pointers.data();
  drawn.setup_.argument_count = static_cast<std::uint32_t>(pointers.size());
  try {
    drawn.interface_.emplace(library, law.id, drawn.setup_);
  } catch (const ilaw::error&) {
    return std::nullopt;
  }
  drawn.info_ = drawn.interface_->info();
  drawn.setup_.arguments = nullptr;
  return drawn;
}

std::size_t Runner::form_width() const {
  const std::size_t d = drawn_.dimension();
  if (drawn_.form() == ILAW_DELASSUS_SCALAR) return 1;
  if (drawn_.form() == ILAW_DELASSUS_DIAGONAL) return d;
  return drawn_.form() == ILAW_DELASSUS_FULL ? d * (d + 1) / 2 : 2;
}

void Runner::draw_nodes() {
  const auto count = static_cast<std::int64_t>(1 + draw_.below(most_nodes));
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

void Runner::draw_arrays() {
  const std::size_t d = drawn_.dimension();
  const auto in = [this](std::size_t components) {
    return make_array(draw_, arena_, components, room_, nodes_, true);
  };
  const auto out = [this](std::size_t components) {
    return make_array(draw_, arena_, components, room_, nodes_, false);
  };
  v_free_ = in(d);
  delassus_ = in(form_width());
  gap_ = in(1);
  if (draw_.one_in(3)) offset_ = in(1);
  previous_ = in(d);
  area_ = in(1);
  if (drawn_.global()) normal_ = in(d);
  if (drawn_.tangent()) tangent_ = in(d);
  for (std::uint32_t k = 0; k < drawn_.info().per_node_parameter_count; ++k) per_node_.push_back(in(1));
  in_place_ = draw_.one_in(2);
  state_in_ = out(drawn_.info().state_size);
  state_out_ = in_place_ ? state_in_ : out(drawn_.info().state_size);
  impulse_ = out(d);
  if (draw_.one_in(2)) velocity_ = out(d);
  if (draw_.one_in(2)) energy_ = out(ILAW_ENERGY_COUNT);
}

void Runner::describe() {
  batch_.v_free = v_free_.input();
  batch_.delassus = delassus_.input();
  batch_.gap = gap_.input();
  batch_.gap_offset = offset_.input();
  batch_.v_previous = previous_.input();
  batch_.area = area_.input();
  batch_.normal = normal_.input();
  batch_.tangent = tangent_.input();
  for (const Array& a : per_node_) per_node_inputs_.push_back(a.input());
  batch_.per_node_parameters = per_node_inputs_.empty() ? nullptr : per_node_inputs_.data();
  batch_.state_in = state_in_.input();
  batch_.state_out = state_out_.output();
  batch_.impulse = impulse_.output();
  batch_.velocity = velocity_.output();
  batch_.energy = energy_.output();
  if (draw_.one_in(2)) {
    batch_.status = status_.data();
    batch_.status_stride = 1 + static_cast<std::int64_t>(draw_.below(3));
  }
  batch_.velocity_step = batch_.position_step = 1e-3;
  for (const std::int64_t node : nodes_)
    for (std::size_t c = 0; c < drawn_.info().state_size; ++c)
      state_in_.at(node, c) = state_out_.at(node, c) = 0.0;
  fill_frames();
  fill(draw_, area_, nodes_, 1, temper_, 0.5, 2.0);
  for (const Array& a : per_node_) fill(draw_, a, nodes_, 1, temper_, 0.0, 1.0);
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
      normal_.at(node, c) = d == 3 ? n[c] : d == 2 ? flat[c] : 1.0;
      if (drawn_.tangent())
        tangent_.at(node, c) = d == 3 ? t[c] : d == 2 ? (c == 0 ? -flat[1] : flat[0]) : 0.0;
      if (temper_.odd != 0 && draw_.one_in(8 * temper_.odd)) normal_.at(node, c) = any_double(draw_);
      if (drawn_.tangent() && temper_.odd != 0 && draw_.one_in(8 * temper_.odd))
        tangent_.at(node, c) = any_double(draw_);
    }
  }
}

void Runner::fill_delassus() {
  const std::size_t d = drawn_.dimension();
  const double scale = draw_.one_in(4) ? 1e6 : 1.0;
  fill(draw_, delassus_, nodes_, form_width(), temper_, 0.5 * scale, 2.0 * scale);
  if (drawn_.form() == ILAW_DELASSUS_FULL)
    for (const std::int64_t node : nodes_)
      for (std::size_t c = d; c < form_width(); ++c)
        delassus_.at(node, c) = temper_.number(draw_, -0.24 * scale, 0.24 * scale);
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
  fill(draw_, v_free_, nodes_, d, temper_, -speed, speed);
  fill(draw_, previous_, nodes_, d, temper_, -speed, speed);
  const double depth = draw_.one_in(2) ? 1e-3 : 0.2;
  fill(draw_, gap_, nodes_, 1, temper_, -depth, depth);
  if (offset_.values) fill(draw_, offset_, nodes_, 1, temper_, 0.0, 1e-3);
  fill_delassus();
  if (draw_.one_in(4)) fill_frames();
  fill_state();
}

// What the law wrote, sometimes mixed with what it wrote before, sometimes with numbers that nobody wrote.
void Runner::fill_state() {
  const std::size_t size = drawn_.info().state_size;
  if (size == 0) return;
  for (const std::int64_t node : nodes_) {
    const bool stale = draw_.one_in(4);
    for (std::size_t c = 0; !in_place_ && c < size; ++c)
      if (!stale || draw_.one_in(2)) state_in_.at(node, c) = state_out_.at(node, c);
    if (temper_.odd == 0 || draw_.below(4 * temper_.odd) >= size) continue;
    for (std::uint64_t k = draw_.below(3) + 1; k > 0; --k)
      state_in_.at(node, draw_.below(size)) = any_double(draw_);
  }
}

void Runner::call(Call function, Tally& tally) {
  ilaw_report report{};
  report.struct_size = sizeof report;
  const bool evaluated = function == &ilaw::interface::evaluate;
  if (before) before();
  const std::int32_t code = (drawn_.interface().*function)(batch_, &report);
  if (after) after();
  if (evaluated) ++tally.batches;
  check(code, report, evaluated, tally);
  tally.add(static_cast<std::uint64_t>(code));
  if (code < 0) return;
  for (const std::int64_t node : nodes_) {
    for (std::size_t c = 0; c < drawn_.info().state_size; ++c) tally.add(state_out_.at(node, c));
    for (std::size_t c = 0; evaluated && c < drawn_.dimension(); ++c) tally.add(impulse_.at(node, c));
  }
}

void Runner::check(std::int32_t code, const ilaw_report& report, bool evaluated, Tally& tally) {
  const auto refuse = [&](const std::string& what) {
    if (!tally.wrong.empty()) return;
    tally.wrong = std::string(drawn_.interface().law().id) + " (dimension " +
                  std::to_string(drawn_.dimension()) + ", form of H " + std::to_string(drawn_.form()) +
                  (drawn_.global() ? ", global" : ", local") + "): batch " + std::to_string(tally.batches) +
                  ": " + what;
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
  if (!evaluated) return;
  for (const std::int64_t node : nodes_) {
    bool zero = true;
    for (std::size_t c = 0; c < drawn_.dimension(); ++c) {
      if (!is_finite(impulse_.at(node, c)))
        refuse("an impulse of " + std::to_string(impulse_.at(node, c)) + " at node " + std::to_string(node));
      zero = zero && impulse_.at(node, c) == 0.0;
    }
    if (node == report.first_bad_node && report.bad_count > 0 && !zero) refuse("a bad node with an impulse");
    if (batch_.status && status_[static_cast<std::size_t>(node * batch_.status_stride)] >= ILAW_STATUS_COUNT)
      refuse("a status that is none");
    for (std::size_t c = 0; energy_.values && c < ILAW_ENERGY_STORED; ++c)
      if (!(energy_.at(node, c) >= 0.0))  // infinite where its terms are beyond the largest double
        refuse("a dissipated energy of " + std::to_string(energy_.at(node, c)));
    if (energy_.values && is_nan(energy_.at(node, ILAW_ENERGY_STORED))) refuse("a stored energy of NaN");
  }
}

}  // namespace random_batches
