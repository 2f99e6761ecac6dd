// SPDX-License-Identifier: BSD-3-Clause
#include "contact/block_step.hpp"

#include "contact/contact_columns.hpp"
#include "contact/contact_geometry.hpp"
#include "contact/law_faults.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

namespace ilaw::host {
namespace {

// Contacts that a step takes at once: as many as stay in the first caches.
constexpr std::ptrdiff_t block_size = 192;  // below 256: statuses are counted in bytes

// Whether values count up by one. Most often the last tells that they do not.
bool follow_each_other(const std::int32_t* values, std::ptrdiff_t count) {
  if (values[count - 1] - values[0] != count - 1) return false;
  std::int32_t difference = 0;
  for (std::ptrdiff_t i = 0; i < count; ++i)
    difference |= values[i] - values[0] - static_cast<std::int32_t>(i);
  return difference == 0;
}

struct Block {
  NearContacts contacts;
  bool in_row;  // they follow each other
};

// The contacts that make the next block: those that follow each other, where they are enough to be
// worth a call of the law; what does not is copied to and fro.
Block next_block(NearContacts contacts, bool one_by_one) {
  constexpr std::ptrdiff_t enough = 24;
  if (one_by_one) {
    contacts.count = 1;
    return {contacts, false};
  }
  contacts.count = std::min(block_size, contacts.count);
  if (follow_each_other(contacts.index, contacts.count)) return {contacts, true};
  std::ptrdiff_t row = 1;
  while (contacts.index[row] == contacts.index[row - 1] + 1) ++row;
  if (row < enough) return {contacts, false};
  contacts.count = row;
  return {contacts, true};
}

enum class Meets { obstacle, turning_obstacle, partners };

// One block after the other, in D dimensions.
template <int D, Meets What>
class BlockWalk {
 public:
  BlockWalk(const BlockStep& step, ContactColumns& columns)
      : step_(step),
        at_(step.contacts),
        columns_(columns),
        obstacle_(components(step.obstacle.velocity())),
        obstacle_before_(components(step.obstacle.velocity_before())),
        moves_(obstacle_ != Components{}),
        moved_(obstacle_before_ != Components{}),
        stands_still_(!Turns && !moves_ && !moved_) {
    columns.use(step.law, D, {step.gets_energies, step.gets_amounts}, block_size);
  }

  void solve(const Block& block, ChunkOutcome& outcome) {
    contacts_ = block.contacts.index;
    node_ = block.contacts.nodes;
    count_ = block.contacts.count;
    contacts_in_row_ = block.in_row;
    nodes_in_row_ = !step_.one_by_one && follow_each_other(node_, count_);
    locate();
    if (step_.heat) give_temperatures();
    columns_.take(at_, contacts_, count_, {contacts_in_row_, contacts_in_row_ && !Turns});
    if constexpr (Turns) turn_states();
    const ilaw_batch batch = make_batch();
    if (!accept(step_.law.evaluate(batch), outcome)) return;
    columns_.complete_statuses();
    mark_touched(batch, count_statuses(outcome.sums));
    apply(outcome.sums);
    add_dissipation(outcome.sums);
    if (step_.heat) columns_.give_heat(*step_.heat);
    if (show_fault(outcome.sums)) find_fault(outcome.refusal);
    columns_.scatter_results();
    columns_.scatter_states();
  }

 private:
  static constexpr bool Partnered = What == Meets::partners, Turns = What == Meets::turning_obstacle;
  using Column = std::array<double, block_size>;
  using Vectors = std::array<double, D * block_size>;
  using Components = std::array<double, D>;
  using TurnVectors = std::conditional_t<Turns, Vectors, std::array<double, 0>>;

  // One by one: a loop over so few becomes a call of memmove.
  static Components components(const Vector& vector) {
    return [&]<std::size_t... C>(std::index_sequence<C...>) { return Components{vector[Eigen::Index{C}]...}; }
    (std::make_index_sequence<D>());
  }
  std::size_t contact(std::ptrdiff_t i) const { return static_cast<std::size_t>(contacts_[i]); }
  Eigen::Index first_dof(std::ptrdiff_t i) const { return Eigen::Index{D} * node_[i]; }

  void locate() {
    if (meets_plane())
      locate_at_plane();
    else
      locate_each();
    if constexpr (Turns) find_turns();
    const InterfaceSetup& setup = step_.setup;
    if (setup.common_gap_offset != 0.0 || !setup.own_gap_offsets.empty())
      for (std::ptrdiff_t i = 0; i < count_; ++i) gap_[i] -= setup.gap_offset(node_index(i));
    for (std::ptrdiff_t i = 0; i < count_; ++i)
      gap_[i] = setup.counterpart->known_gap(node_index(i), step_.step.u, gap_[i]);
  }
  int node_index(std::ptrdiff_t i) const { return at_.node_index[contact(i)]; }

  void locate_each() {
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
      const ContactPoint point =
          step_.setup.counterpart->contact_point(node_index(i), step_.step.u, step_.step.time);
      gap_[i] = point.gap;
      for (int c = 0; c < D; ++c) normal_[D * i + c] = point.normal[c];
      if constexpr (Partnered) {
        at_.point[contact(i)] = point;
        at_.delassus[contact(i)] = point.delassus(step_.inverse_mass, D, node_[i]);
      }
    }
  }

  // All nodes have the plane's normal: it is written once.
  void locate_at_plane() {
    flat_gaps<D>(step_.model, node_, count_, step_.step.u, *step_.obstacle.flat(), gap_.data());
    for (; normals_ < count_; ++normals_)
      for (int c = 0; c < D; ++c) normal_[c * block_size + normals_] = step_.obstacle.flat()->normal[c];
  }

  // Velocities of the surface where it is touched: a gap offset is a body's own.
  void find_turns() {
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
      const RigidSurface there{gap_[i], Eigen::Map<const Vector>(&normal_[D * i], D)};
      const SurfaceVelocities turn = surface_velocities(*step_.setup.counterpart, node_index(i), step_.step.u,
                                                        step_.step.time, there, step_.obstacle.rates());
      for (int c = 0; c < D; ++c) {
        turn_before_[D * i + c] = turn.before[c];
        turn_after_[D * i + c] = turn.after[c];
      }
    }
  }

  // ---- what the law reads and writes ----

  // A component of a velocity, relative to the partners but not to the obstacle.
  double component(const double* v, std::ptrdiff_t i, int c) const {
    double value = v[first_dof(i) + c];
    if constexpr (Partnered) {
      const ContactPoint& point = at_.point[contact(i)];
      for (const Partner& partner : point.partners)
        value -= partner.weight * v[Eigen::Index{D} * partner.node + c];
    }
    return value;
  }

  // is_moving: whether the obstacle's velocity is not zero; turn: velocities of a surface that turns.
  ilaw_input relative(const Dofs& v, const Components& obstacle, bool is_moving, const TurnVectors& turn,
                      Vectors& room) const {
    if (What == Meets::obstacle && !is_moving) return seen_at_rest(v, room);
    for (std::ptrdiff_t i = 0; i < count_; ++i)
      for (int c = 0; c < D; ++c) {
        double& value = room[c * block_size + i];
        value = component(v.data(), i, c) - obstacle[c];
        if constexpr (Turns) value -= turn[D * i + c];
      }
    return in_columns(room);
  }
  ilaw_input seen_at_rest(const Dofs& v, Vectors& room) const {
    if (nodes_in_row_) return ilaw::input(&v[first_dof(0)], D, 1);
    const double* const all = v.data();
    for (std::ptrdiff_t i = 0; i < count_; ++i)
      for (int c = 0; c < D; ++c) room[c * block_size + i] = all[first_dof(i) + c];
    return in_columns(room);
  }
  // Component by component, as laws work on them.
  static ilaw_input in_columns(const Vectors& vectors) { return ilaw::input(vectors.data(), 1, block_size); }
  bool meets_plane() const { return What == Meets::obstacle && !step_.one_by_one && step_.obstacle.flat(); }

  // A copy of the states turns: a law that refuses leaves none.
  void turn_states() const {
    for (std::ptrdiff_t i = 0; i < count_; ++i)
      turn_axes(step_.setup, step_.axes, D, step_.step,
                [&](std::size_t number) -> double& { return columns_.state(i, number); });
  }

  ilaw_batch make_batch() {
    const ilaw_instance_info& info = step_.law.info();
    ilaw_batch batch =
        empty_batch(step_.obstacle.tangent(), step_.step.time, step_.step.velocity_step(), step_.step.dt);
    columns_.fill(batch);
    batch.v_free = relative(step_.v, obstacle_, moves_, turn_after_, v_free_);
    if ((info.inputs | (step_.gets_energies || step_.gets_amounts ? info.balance_inputs : 0U)) &
        ILAW_INPUT_V_PREVIOUS)
      batch.v_previous = relative(step_.step.v_before, obstacle_before_, moved_, turn_before_, v_previous_);
    batch.delassus = ilaw::input(columns_.delassus(), 1, 0);
    batch.gap = ilaw::input(gap_.data(), 1, 0);
    batch.normal = meets_plane() ? in_columns(normal_) : ilaw::input(normal_.data(), D, 1);
    return batch;
  }

  void give_temperatures() {
    static const ContactPoint alone;
    for (std::ptrdiff_t i = 0; i < count_; ++i)
      step_.heat->give(contact(i), node_[i], Partnered ? at_.point[contact(i)] : alone, at_);
  }

  // ---- the law, and what follows from it ----

  bool accept(const Answer& answer, ChunkOutcome& outcome) const {
    outcome.refusal.add(answer, static_cast<std::size_t>(count_), contacts_);
    outcome.sums.add_stable_step(answer.report.stable_velocity_step);
    outcome.refusal.add_unknown(columns_.status(), contacts_, answer.code == ILAW_OK ? count_ : 0);
    return outcome.refusal.code == ILAW_OK;
  }

  // Returns how many contacts are free. Most often all have the first one's status, and one round will do.
  std::ptrdiff_t count_statuses(ContactSums& sums) const {
    const std::uint8_t* const status = columns_.status();
    std::ptrdiff_t free = 0, others = count_;
    for (int round = 0; others > 0 && round < ILAW_STATUS_COUNT; ++round) {
      const auto k = static_cast<std::uint8_t>((status[0] + round) % ILAW_STATUS_COUNT);
      std::uint8_t found = 0;
      for (std::ptrdiff_t i = 0; i < count_; ++i) found += status[i] == k ? 1 : 0;
      sums.statuses[k] += found;
      others -= found;
      if (k == ILAW_FREE) free = found;
    }
    return free;
  }

  void mark_touched(const ilaw_batch& batch, std::ptrdiff_t free) {
    if (at_.state.empty()) return;
    if (free == 0 && contacts_in_row_) return at_.mark_acting(contact(0), count_);
    const std::uint8_t* const status = columns_.status();
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
      if (status[i] != ILAW_FREE) {
        at_.mark_acting(contact(i), 1);
        continue;
      }
      const Components n = vector_at(batch.normal, i), v = vector_at(batch.v_free, i);
      const bool in_reach = is_in_reach(gap_[i], n.data(), v.data(), D, step_.step.dt);
      at_.mark_touched(contact(i), false, in_reach, step_.law.may_skip_free());
    }
  }

  static Components vector_at(const ilaw_input& vectors, std::ptrdiff_t i) {
    Components components;
    for (int c = 0; c < D; ++c)
      components[c] = vectors.values[i * vectors.node_stride + c * vectors.component_stride];
    return components;
  }

  // Adds the impulses to the velocities, and up what they work over the step, r . (v_before + v)/2: no two
  // contacts share a node. Sums wait for their last addition: together they do so once.
  void apply(ContactSums& sums) {
    double* const v = step_.v.data();
    const double* const before = step_.step.v_before.data();
    const double *const energies = columns_.energy(ILAW_ENERGY_STORED), *const impulse = columns_.impulse();
    double work = sums.work, relative_work = sums.relative_work, penetration = sums.penetration,
           stored = sums.energy[ILAW_ENERGY_STORED];
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
      penetration = -gap_[i] > penetration ? -gap_[i] : penetration;
      if (energies) stored += energies[i];
      Components r;
      bool acts = false;
      for (int c = 0; c < D; ++c) {
        r[c] = impulse[D * i + c];
        acts = acts || r[c] != 0.0;
      }
      if (!acts) continue;
      push(i, r, v);
      const Works works = works_of(i, r, before, v);
      work += 0.5 * works.all;
      relative_work += 0.5 * works.relative;
    }
    sums.work = work;
    sums.relative_work = relative_work;
    sums.penetration = penetration;
    sums.energy[ILAW_ENERGY_STORED] = stored;
  }
  void push(std::ptrdiff_t i, const Components& r, double* v) {
    if constexpr (Partnered)
      at_.point[contact(i)].for_each_node(node_[i], [&](int node, double weight) {
        const double scale = weight * step_.inverse_mass[Eigen::Index{D} * node];
        for (int c = 0; c < D; ++c) v[Eigen::Index{D} * node + c] += scale * r[c];
      });
    else {
      const double inverse_mass = columns_.delassus()[i];
      for (int c = 0; c < D; ++c) v[first_dof(i) + c] += inverse_mass * r[c];
    }
  }
  // Twice what an impulse works, and relative to the obstacle.
  struct Works {
    double all = 0.0, relative = 0.0;
  };
  Works works_of(std::ptrdiff_t i, const Components& r, const double* before, const double* v) const {
    Works works;
    for (int c = 0; c < D; ++c) {
      const double sum = component(before, i, c) + component(v, i, c);
      works.all += r[c] * sum;
      if (stands_still_) continue;
      works.relative += r[c] * (sum - (obstacle_[c] + obstacle_before_[c]));
      if constexpr (Turns) works.relative -= r[c] * (turn_before_[D * i + c] + turn_after_[D * i + c]);
    }
    if (stands_still_) works.relative = works.all;
    return works;
  }

  void add_dissipation(ContactSums& sums) const {
    columns_.sum_amounts(sums);
    for (std::size_t k = 0; step_.gets_energies && k < ILAW_ENERGY_STORED; ++k)
      sums.add_dissipation(k, columns_.energy(k), count_);
  }

  void find_fault(Refusal& refusal) const {
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
      const std::array energies = columns_.energies(i);
      if (const char* fault = fault_of(columns_.impulse() + D * i, D, energies.data(), columns_.status()[i]))
        return refusal.add({ILAW_BAD_LIBRARY, 0, contacts_[i], 0, fault});
    }
  }

  const BlockStep& step_;
  ContactArrays& at_;
  ContactColumns& columns_;
  const Components obstacle_, obstacle_before_;
  const bool moves_, moved_, stands_still_;  // the obstacle, in the coming step and before
  const std::int32_t *contacts_ = nullptr, *node_ = nullptr;
  std::ptrdiff_t count_ = 0;
  bool contacts_in_row_ = false, nodes_in_row_ = false;
  std::ptrdiff_t normals_ = 0;  // nodes whose normal is already that of the plane
  Column gap_;
  Vectors v_free_, v_previous_, normal_;
  TurnVectors turn_before_, turn_after_;  // velocities of the surface
};

template <int D, Meets What>
void step_blocks(const BlockStep& step, NearContacts contacts, ChunkOutcome& outcome) {
  static thread_local ContactColumns columns;  // stays in the cache from chunk to chunk
  BlockWalk<D, What> blocks(step, columns);
  while (contacts.count > 0) {
    const Block block = next_block(contacts, step.one_by_one);
    blocks.solve(block, outcome);
    contacts.leave_out(block.contacts.count);
  }
}

template <int D>
ChunkStep chunk_step_in(const BlockStep& step) {
  if (!step.contacts.point.empty()) return step_blocks<D, Meets::partners>;
  return step.setup.counterpart->turns() ? step_blocks<D, Meets::turning_obstacle>
                                         : step_blocks<D, Meets::obstacle>;
}

}  // namespace

ChunkStep chunk_step_of(const BlockStep& step) {
  const int d = step.model.dimension();
  if (d == 1) return chunk_step_in<1>(step);
  return d == 2 ? chunk_step_in<2>(step) : chunk_step_in<3>(step);
}

}  // namespace ilaw::host
