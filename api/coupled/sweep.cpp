// SPDX-License-Identifier: BSD-3-Clause
#include "sweep.hpp"

#include "lanes.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>

// Compiled for AVX2 as well; the loader chooses. Without contraction the bits are the same.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && defined(__OPTIMIZE__)
#define ILAW_COUPLED_VERSIONS [[gnu::flatten, gnu::target_clones("avx2", "default")]]
#else
#define ILAW_COUPLED_VERSIONS
#endif

namespace ilaw::coupled {
namespace {

std::size_t padded(std::size_t count) { return (count + 7) / 8 * 8; }

// Calls visit with H of a block as a function.
template <class Visit>
void with_form(const Block& block, Visit&& visit) {
  const Layout& layout = *block.layout;
  const double* h = block.column(layout.delassus);
  switch (layout.delassus_size) {
    case 1:
      return visit(ScalarForm{h});
    case 2:
      return visit(TransverseForm{h, block.column(layout.normal), block.stride});
    case 3:
      return visit(PlaneForm{h, block.stride});
    case 5:
      return visit(SpinForm{h, block.column(layout.normal), block.column(layout.length), block.stride});
    default:
      return visit(FullForm{h, block.stride});
  }
}

// With every four lanes a part of the next block, whose columns follow those of this one, where all blocks
// exceed the second cache. A block has more columns than the processor follows by itself.
void prefetch_next(const Block& block, std::size_t lane) {
  const auto columns = static_cast<std::size_t>(block.layout->columns);
  const double* next = block.values + (block.stride + lane) * columns;
  for (std::size_t k = 0; k < 4 * columns; k += 8) __builtin_prefetch(next + k, 0, 2);
}

// A law that gives no status, or not that of bad input, names one node at least.
void mark_refused(Block& block, std::int64_t first_bad) {
  const auto is_bad = [](std::uint8_t status) { return status >= ILAW_BAD_INPUT; };
  if (std::any_of(block.status, block.status + block.count, is_bad)) return;
  const auto lane = static_cast<std::size_t>(first_bad);
  block.status[lane < block.count ? lane : 0] = ILAW_BAD_INPUT;
}

// Whether the last evaluation of a contact left no trace.
bool has_not_acted(const Block& block, std::size_t lane) {
  const Layout& layout = *block.layout;
  if (!block.is_free(lane) || block.status[lane] != ILAW_FREE) return false;
  for (int c = 0; c < layout.state_size; ++c)
    if (block.column(layout.state_out + c)[lane] != block.column(layout.state_in + c)[lane]) return false;
  return true;
}

}  // namespace

void Sweep::use(std::size_t threads, const ilaw_threads* pool) {
  threads_ = threads;
  team_.use(pool ? *pool : ilaw_threads{});
  data_.resize(threads);
  if (team_.size() > threads) team_.resize(threads);
}

void Sweep::reset() {
  report_ = {};
  failed_group_ = -1;
  for (ThreadData& own : data_) own.stable_step = std::numeric_limits<double>::infinity();
}

double Sweep::stable_step() const {
  double least = std::numeric_limits<double>::infinity();
  for (const ThreadData& own : data_) least = std::min(least, own.stable_step);
  return least;
}

void Sweep::respond(const Block& block, const double* x, std::size_t xs, double* y) const {
  with_form(block, [&](const auto& form) {
    for (std::size_t q = 0; q < padded(block.count); q += lane_count)
      put(form(q, read(form, x + q, xs)), y + q, max_stride);
  });
}

void Sweep::gather(const Block& block, double* velocity) const {
  const Layout& layout = *block.layout;
  gather(block, problem_.bodies.now(), velocity);
  if (layout.wall < 0) return;
  for (std::size_t c = 0; c < static_cast<std::size_t>(layout.width); ++c) {
    const double* wall = block.column(layout.wall + static_cast<int>(c));
    for (std::size_t q = 0; q < padded(block.count); ++q) velocity[c * max_stride + q] -= wall[q];
  }
}

void Sweep::read_velocities(Block& block) const {
  const Layout& layout = *block.layout;
  Columns velocity;
  if (layout.v_smooth >= 0) {
    gather(block, velocity.data());
    for (std::size_t c = 0; c < 3; ++c)
      std::copy_n(velocity.data() + c * max_stride, block.count,
                  block.column(layout.v_smooth + static_cast<int>(c)));
  }
  if (layout.v_previous < 0) return;
  gather(block, problem_.bodies.previous(), velocity.data());
  for (std::size_t c = 0; c < static_cast<std::size_t>(layout.width); ++c)
    for (std::size_t q = 0; q < block.count; ++q)
      block.column(layout.v_previous + static_cast<int>(c))[q] += velocity[c * max_stride + q];
}

void Sweep::find_speeds(const Block& block, double* speeds) const {
  const Layout& layout = *block.layout;
  Columns velocity;
  gather(block, velocity.data());
  with_form(block, [&](const auto& form) {
    for (std::size_t q = 0; q < padded(block.count); q += lane_count) {
      Lanes most = size(form, q, read(form, velocity.data() + q, max_stride));
      for (const int column : {layout.wall, layout.v_previous})
        if (column >= 0)
          most = larger(size(form, q, read(form, block.column(column) + q, block.stride)), most);
      for (std::size_t k = q; k < std::min(q + lane_count, block.count); ++k) speeds[k] = most[k - q];
    }
  });
}

void Sweep::gather(const Block& block, const Body* bodies, double* velocity) const {
  const Contacts& group = problem_.group(block);
  with_kernel(group.kind(), block, group.body_count(), [&](const auto& kernel) {
    std::size_t q = 0;
    if constexpr (takes_four<decltype(kernel)>) {
      for (; q + 4 <= block.count; q += 4) {
        if (prefetches_) prefetch_next(block, q);
        put(kernel.relative_of_four(bodies, q), velocity + q, max_stride);
      }
    }
    for (; q < block.count; ++q) {
      const auto u = kernel.relative(bodies, q);
      for (std::size_t c = 0; c < u.size(); ++c) velocity[c * max_stride + q] = u[c];
    }
  });
  for (std::size_t c = 0; c < static_cast<std::size_t>(block.layout->width); ++c)
    for (std::size_t q = block.count; q < padded(block.count); ++q) velocity[c * max_stride + q] = 0.0;
}

namespace {

std::size_t end_of_color(const std::vector<Block>& blocks, std::size_t first) {
  std::size_t end = first + 1;
  while (end < blocks.size() && blocks[end].colour == blocks[first].colour) ++end;
  return end;
}

}  // namespace

template <class Work>
bool Sweep::is_served(Block& block, ThreadData& own, const Work& work) const {
  try {
    return work(block, own);
  } catch (const std::bad_alloc&) {
    own.change.code = ILAW_OUT_OF_MEMORY;
    own.report.reason = "out of memory";
    return false;
  }
}

template <class Work>
Change Sweep::for_blocks(Blocks& blocks, const Work& work) {
  std::vector<Block>& list = blocks.list();
  prefetches_ = blocks.bytes() > knobs::cached_bytes;
  for (ThreadData& own : data_) {
    own.change = {};
    own.failed = nullptr;
  }
  // Of a color that fails all blocks are tried, and none of a later one, so that the first that failed is
  // told.
  std::atomic<std::size_t> failed_at{list.size()};
  const auto serve = [&](std::size_t color, std::size_t first, std::size_t end, ThreadData& own) {
    for (std::size_t i = first; i < end && failed_at.load(std::memory_order_relaxed) >= color; ++i) {
      if (is_served(list[i], own, work)) continue;
      own.failed = &list[i];
      failed_at = color;
      return;
    }
  };
  if (threads_ == 1 || !prefetches_) {  // barriers would cost more than they save
    serve(0, 0, list.size(), data_[0]);
  } else {
    team_.resize(threads_);
    team_.run([&](std::size_t t) {
      for (std::size_t first = 0, end = 0; first < list.size(); first = end) {
        end = end_of_color(list, first);
        const bool is_single = end - first == 1;
        while (is_single && end < list.size() && end_of_color(list, end) - end == 1) ++end;
        const std::size_t share = end - first;
        if (!is_single)
          serve(first, first + team_.part(share, t), first + team_.part(share, t + 1), data_[t]);
        else if (t == 0)
          serve(first, first, end, data_[0]);
        if (end < list.size()) team_.barrier();
      }
    });
  }
  Change change;
  const ThreadData* first_failed = nullptr;
  for (const ThreadData& own : data_) {
    change.largest = std::max(change.largest, own.change.largest);
    change.size = std::max(change.size, own.change.size);
    if (own.failed && (!first_failed || own.failed < first_failed->failed)) first_failed = &own;
  }
  for (const Block& block : list)
    if (!block.asleep) change.square += block.square;
  if (first_failed) {
    change.code = first_failed->change.code;
    failed_group_ = first_failed->failed->group;
    report_ = first_failed->report;
  }
  return change;
}

Change Sweep::run(Blocks& blocks, const Conjugate& conjugate) {
  return for_blocks(blocks, [&](Block& block, ThreadData& own) {
    if (block.asleep) return true;
    if (conjugate.active) extrapolate(block, conjugate.beta);
    if (!evaluate(block, own)) return false;
    scatter(block, own);
    return true;
  });
}

Change Sweep::run_all(Blocks& blocks) {
  return for_blocks(blocks, [&](Block& block, ThreadData& own) {
    if (!evaluate(block, own)) return false;
    scatter(block, own);
    for (std::size_t q = 0; q < block.count && block.asleep; ++q) block.asleep = has_not_acted(block, q);
    return true;
  });
}

ILAW_COUPLED_VERSIONS void Sweep::extrapolate(Block& block, double beta) const {
  const Layout& layout = *block.layout;
  double *r = block.column(layout.impulse), *direction = block.column(layout.direction);
  const double* last = block.column(layout.change);
  for (std::size_t c = 0; c < static_cast<std::size_t>(layout.width); ++c)
    for (std::size_t q = c * block.stride; q < c * block.stride + padded(block.count); q += lane_count) {
      const Lanes step = beta * *lanes(direction + q);
      *lanes(r + q) += step;
      *lanes(direction + q) = step + *lanes(last + q);
    }
}

// v_free = u - H r. Returns the largest velocity in it.
ILAW_COUPLED_VERSIONS double Sweep::prepare(Block& block, ThreadData& own) const {
  const Layout& layout = *block.layout;
  gather(block, own.v_free.data());
  const double* r = block.column(layout.impulse);
  double* asked = block.column(layout.asked);
  Lanes most{};
  with_form(block, [&](const auto& form) {
    for (std::size_t q = 0; q < padded(block.count); q += lane_count) {
      const auto made = form(q, read(form, r + q, block.stride));
      const auto v = read(form, own.v_free.data() + q, max_stride) - made;
      put(v, own.v_free.data() + q, max_stride);
      put(v, asked + q, block.stride);
      most = larger(larger(size(form, q, v), size(form, q, made)), most);
    }
  });
  return largest(most);
}

bool Sweep::evaluate(Block& block, ThreadData& own) const {
  const Layout& layout = *block.layout;
  const double size = prepare(block, own);
  Change& change = own.change;
  change.size = size > change.size ? size : change.size;
  const Contacts::Call call{own.v_free.data(), block.column(layout.delassus),
                            block.stride,      own.answer.data(),
                            nullptr,           block.status,
                            nullptr,           nullptr};
  ilaw_report& report = own.report;
  if (block.is_refused) std::fill_n(block.status, block.count, std::uint8_t{ILAW_FREE});
  const std::int32_t code = problem_.group(block).evaluate(block, call, report);
  block.is_refused = code == ILAW_BAD_NODES;
  block.reason = report.reason;
  if (block.is_refused) mark_refused(block, report.first_bad_node);
  // NaN, or below 0, would pass for no limit at all.
  const bool has_step = report.stable_velocity_step >= 0.0;
  if (report.stable_velocity_step > 0.0)
    own.stable_step = std::min(own.stable_step, report.stable_velocity_step);
  if (code >= 0 && has_step) return true;
  change.code = code < 0 ? code : ILAW_BAD_LIBRARY;
  if (code >= 0) report.reason = "a law reported a stable step that is below 0 or not a number";
  return false;
}

ILAW_COUPLED_VERSIONS void Sweep::scatter(Block& block, ThreadData& own) const {
  const Layout& layout = *block.layout;
  const std::size_t n = padded(block.count), s = block.stride;
  double *r = block.column(layout.impulse), *dr = block.column(layout.change);
  for (std::size_t c = 0; c < static_cast<std::size_t>(layout.width); ++c)
    for (std::size_t q = block.count; q < n; ++q) own.answer[c * max_stride + q] = 0.0;
  Lanes most{}, square{};
  with_form(block, [&](const auto& form) {
    for (std::size_t q = 0; q < n; q += lane_count) {
      const auto answer = read(form, own.answer.data() + q, max_stride), by = answer - read(form, r + q, s);
      put(answer, r + q, s);
      put(by, dr + q, s);
      const auto made = form(q, by);
      most = larger(size(form, q, made), most);
      square += dot(by, made);
    }
  });
  own.change.largest = std::max(own.change.largest, largest(most));
  block.square = sum(square);
  const Contacts& group = problem_.group(block);
  with_kernel(group.kind(), block, group.body_count(), [&](const auto& kernel) {
    std::size_t q = 0;
    if constexpr (takes_four<decltype(kernel)>)
      for (; q + 4 <= block.count; q += 4)
        kernel.apply_four(q, lanes_at<width_of<decltype(kernel)>>(dr + q, s), problem_.bodies.now());
    with_velocities(problem_.bodies, group.kind(), [&](const auto& add) {
      for (; q < block.count; ++q) kernel.apply(q, columns_at<width_of<decltype(kernel)>>(dr + q, s), add);
    });
  });
}

bool Sweep::wake(Blocks& blocks) {
  bool woken = false;
  Columns& v_free = data_[0].v_free;
  for (Block& block : blocks.list()) {
    if (!block.asleep) continue;
    gather(block, v_free.data());
    const Contacts& group = problem_.group(block);
    for (std::size_t q = 0; q < block.count && block.asleep; ++q) {
      const Vector v{v_free[q], v_free[max_stride + q], v_free[2 * max_stride + q]};
      if (group.is_in_reach(block, q, v)) block.asleep = false;
    }
    woken = woken || !block.asleep;
  }
  return woken;
}

bool Sweep::break_bonds(Blocks& blocks) {
  bool any = false;
  std::vector<double> state;
  std::array<std::uint8_t, max_stride> status{};
  ThreadData& own = data_[0];
  for (Block& block : blocks.list()) {
    const Contacts& group = problem_.group(block);
    if (block.asleep || !group.holds_bonds()) continue;
    gather(block, own.v_free.data());
    respond(block, block.column(block.layout->impulse), block.stride, own.answer.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(block.layout->width) * max_stride; ++i)
      own.v_free[i] -= own.answer[i];
    state.resize(block.stride * static_cast<std::size_t>(block.layout->state_size) + 1);
    Contacts::Call call{own.v_free.data(), block.column(block.layout->delassus),
                        block.stride,      own.answer.data(),
                        state.data(),      status.data()};
    call.judges = true;
    ilaw_report found{};
    if (group.evaluate(block, call, found) < 0) continue;  // the iterations name it
    for (std::size_t q = 0; q < block.count; ++q) {
      if (block.broken[q] || status[q] != ILAW_BROKEN) continue;
      block.broken[q] = 1;
      any = block.has_broken = true;
    }
  }
  return any;
}

void Sweep::add_impulses(const Blocks& blocks, std::vector<Motion>& sums) const {
  const auto add = [&](std::int32_t b, const Vector& p, const Vector& l) {
    Motion& sum = sums[static_cast<std::size_t>(b)];
    sum = {sum.velocity + p, sum.spin + l};
  };
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const Contacts& group = problem_.group(block);
    with_kernel(group.kind(), block, group.body_count(), [&](const auto& kernel) {
      const double* r = block.column(block.layout->impulse);
      for (std::size_t q = 0; q < block.count; ++q)
        kernel.apply(q, columns_at<width_of<decltype(kernel)>>(r + q, block.stride), add);
    });
  }
}

void Sweep::add_changes(Blocks& blocks, const double* changes) {
  for (Block& block : blocks.list()) {
    if (block.asleep) continue;
    const Contacts& group = problem_.group(block);
    const Layout& layout = *block.layout;
    with_kernel(group.kind(), block, group.body_count(), [&](const auto& kernel) {
      with_velocities(problem_.bodies, group.kind(), [&](const auto& add) {
        for (std::size_t q = 0; q < block.count; ++q, changes += width_of<decltype(kernel)>) {
          const auto by = columns_at<width_of<decltype(kernel)>>(changes, 1);
          for (std::size_t c = 0; c < by.size(); ++c)
            block.column(layout.impulse)[c * block.stride + q] += by[c];
          kernel.apply(q, by, add);
        }
      });
    });
  }
}

}  // namespace ilaw::coupled
