// sweep.hpp - one iteration of nonlinear Gauss-Seidel over all contacts (Jourdan, Alart, Jean 1998, A
// Gauss-Seidel like algorithm to solve frictional contact problems), block by block: velocities of the bodies
// are gathered, the law is evaluated at v_free = u - H r, and changes of impulses are scattered to the bodies
// at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blocks.hpp"
#include "bodies.hpp"
#include "contacts.hpp"
#include "team.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ilaw::coupled {

// The step that all parts of the solver work on.
struct Problem {
  Bodies bodies;
  std::vector<Contacts> groups;
  std::size_t group_count = 0;
  std::vector<double> speeds;  // per contact, in the order of the blocks: the largest velocity it is given

  const Contacts& group(const Block& block) const { return groups[static_cast<std::size_t>(block.group)]; }
  bool has_integrated() const {
    return std::any_of(groups.begin(), groups.begin() + static_cast<std::ptrdiff_t>(group_count),
                       [](const Contacts& group) { return group.is_integrated(); });
  }
};

// Findings of an iteration.
struct Change {
  double largest = 0.0;  // |H dr|, components
  double size = 0.0;     // velocity of a contact, or made by an impulse
  double square = 0.0;   // sum of dr.H dr: not a number if any impulse is none
  std::int32_t code = ILAW_OK;
};

class Sweep {
 public:
  explicit Sweep(Problem& problem) : problem_(problem) { use(1); }
  // Blocks of a color are evaluated by this many threads, with the bits of one; pool: whose they are.
  void use(std::size_t threads, const ilaw_threads* pool = nullptr);

  // Extrapolation of the impulses before the iteration: r += beta d, d = beta d + (last change of r).
  struct Conjugate {
    bool active = false;
    double beta = 0.0;
  };
  Change run(Blocks& blocks, const Conjugate& conjugate);
  // Iterates over all blocks, those asleep as well: those with an impulse, status or change of state wake.
  Change run_all(Blocks& blocks);

  // Wakes blocks with a contact within reach. True if there was one.
  bool wake(Blocks& blocks);
  // Bonds that the law lets break at the present velocities: they stay broken until the next step. True if
  // there was one.
  bool break_bonds(Blocks& blocks);
  // Velocity of each lane, and spin where it has a moment, into columns at distances of max_stride.
  void gather(const Block& block, double* velocity) const;
  // Writes the present velocities of its contacts to v_smooth, and adds those of its bodies before the step
  // to v_previous, where the law reads them. Before any impulse acts.
  void read_velocities(Block& block) const;
  // Largest velocity of each lane that the problem brings, with the bodies at their free velocities: free,
  // before the step, of the wall.
  void find_speeds(const Block& block, double* speeds) const;
  // H of the law times columns x, into y: columns at distances of max_stride.
  void respond(const Block& block, const double* x, std::size_t x_stride, double* y) const;
  // Adds impulses of all contacts and their moments to the sums per body.
  void add_impulses(const Blocks& blocks, std::vector<Motion>& sums) const;
  // Adds changes of impulses, given by contact in the order of lanes, to impulses and velocities.
  void add_changes(Blocks& blocks, const double* changes);

  const ilaw_report& last_report() const { return report_; }
  std::int32_t failed_group() const { return failed_group_; }
  double stable_step() const;
  void reset();

  // Calls work(first, end) for parts of `count` things, on several threads unless they are few.
  template <class Work>
  void share(std::size_t count, std::size_t few, const Work& work) {
    if (count < few) return work(std::size_t{0}, count);
    team_.run([&](std::size_t t) { work(team_.part(count, t), team_.part(count, t + 1)); });
  }

 private:
  // Scratch and results of a thread.
  struct alignas(64) ThreadData {
    alignas(64) Columns v_free{};
    alignas(64) Columns answer{};
    ilaw_report report{};
    Change change;
    double stable_step = 0.0;
    const Block* failed = nullptr;
  };
  // Calls work(block, own) for all blocks, those of a color on all threads, until it returns false.
  template <class Work>
  Change for_blocks(Blocks& blocks, const Work& work);
  template <class Work>
  bool is_served(Block& block, ThreadData& own, const Work& work) const;
  void gather(const Block& block, const Body* bodies, double* velocity) const;
  void extrapolate(Block& block, double beta) const;
  double prepare(Block& block, ThreadData& own) const;
  bool evaluate(Block& block, ThreadData& own) const;
  void scatter(Block& block, ThreadData& own) const;

  std::vector<ThreadData> data_;
  Team team_;  // of threads_ from the first iteration on that is worth it
  std::size_t threads_ = 1;
  ilaw_report report_{};
  Problem& problem_;
  bool prefetches_ = false;
  std::int32_t failed_group_ = -1;
};

// Adds an impulse and its moment to a body's velocities. Bodies that cannot move are left alone, as contacts
// that share them are worked on at once.
template <class Visit>
void with_velocities(Bodies& bodies, Kind kind, Visit&& visit) {
  Body* now = bodies.now();
  const auto add_linear = [now](std::int32_t b, const Vector& p, const Vector&) {
    if (moves(now[b])) now[b].velocity = now[b].velocity + now[b].inverse_mass * p;
  };
  const auto add_sphere = [now](std::int32_t b, const Vector& p, const Vector& l) {
    if (!moves(now[b])) return;
    now[b].velocity = now[b].velocity + now[b].inverse_mass * p;
    now[b].spin = now[b].spin + now[b].inverse_inertia * l;
  };
  const Inertia* inertia = bodies.inertia();
  const auto add_tensor = [now, inertia, &bodies](std::int32_t b, const Vector& p, const Vector& l) {
    if (!bodies.is_movable(b)) return;
    now[b].velocity = now[b].velocity + scaled(inertia[b].inverse_mass, p);
    now[b].spin = now[b].spin + inertia[b].inverse_inertia * l;
  };
  if (!bodies.are_isotropic()) return visit(add_tensor);
  if (kind == Kind::point || !bodies.rotate()) return visit(add_linear);
  visit(add_sphere);
}

}  // namespace ilaw::coupled
