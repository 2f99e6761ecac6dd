// window_grid.hpp - the buckets of a window (window.hpp) as a step finds them: where they stand, what is
// summed of them, and how the step is spread over them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// What is the same at all nodes is worked out once.
class window_grid {
 public:
  window_grid(double duration, double buckets, step_interval step)
      : duration_(duration),
        buckets_(buckets),
        per_width_(buckets / duration),
        end_(step.end * per_width_),
        begin_(end_ - step.length * per_width_),
        now_(on_grid(end_) ? floor_of(end_) : 0.0),
        has_grid_(duration > 0.0 && duration < infinity && on_grid(end_)),
        is_short_(step.length < duration),
        ring_size_(static_cast<std::int64_t>(buckets) + 1),
        place_(has_grid_ ? place_of(now_) : 0),
        edge_(edge_at(now_)),
        shares_(has_grid_ ? shares_at(now_) : shares{}),
        stamp_(stamp_of(now_)) {}

 protected:
  // A history whose doubles are neighbours in memory, as those of most hosts are.
  template <class Number>
  struct neighbours {
    Number* values;
    static constexpr std::int64_t stride = 1;
    Number& operator[](std::int64_t k) const { return values[k]; }
  };

  static constexpr std::int64_t middle_sum = 1, first_bucket = 4;
  // Numbers of buckets that a double and a cast hold with room to spare. A grid finer than that is finer than
  // the clock: no step lies within tau of another.
  static constexpr double largest_number = 0x1p51;

  // The newest bucket is kept as a number other than zero, so that zeros are an empty window.
  static constexpr double empty = 0.0;
  static double stamp_of(double bucket) { return bucket >= 0.0 ? bucket + 1.0 : bucket; }
  static double bucket_of(double stamp) { return stamp > 0.0 ? stamp - 1.0 : stamp; }
  static bool on_grid(double x) { return absolute(x) < largest_number; }
  static bool is_stamp(double stamp) {
    return absolute(stamp) <= largest_number && floor_of(stamp) == stamp;  // false for NaN
  }

  template <class History>
  static vector read(const History& own, std::int64_t k) {
    return {own[k], own[k + 1], own[k + 2]};
  }
  template <class History>
  static void write(const History& own, std::int64_t k, vector sum) {
    own[k] = sum.n;
    own[k + 1] = sum.t1;
    own[k + 2] = sum.t2;
  }

  // Places in the ring: bucket j stands at j modulo B + 1, so that the next bucket to open takes that of the
  // oldest.
  std::int64_t ring_size() const { return ring_size_; }
  std::int64_t place_of(double bucket) const {
    const double size = buckets_ + 1.0;
    const double place = bucket - floor_of(bucket * (1.0 / size)) * size;  // the quotient may be one off
    return static_cast<std::int64_t>(place < 0.0 ? place + size : (place < size ? place : place - size));
  }
  std::int64_t after(std::int64_t place) const { return place + 1 < ring_size() ? place + 1 : 0; }
  std::int64_t previous(std::int64_t place) const { return place > 0 ? place - 1 : ring_size() - 1; }
  static std::int64_t at(std::int64_t place) { return first_bucket + 3 * place; }

  // The sum of the buckets between the oldest and k, of which those after newest are not open yet.
  template <class History>
  vector sum_between(const History& own, double k, double newest) const {
    const double first = (k - buckets_) + 1.0;
    const auto count = static_cast<std::int64_t>(smaller(k - 1.0, newest) - first) + 1;
    return sum_from(own, place_of(first), count);
  }
  // In two runs of neighbours.
  template <class History>
  vector sum_from(const History& own, std::int64_t place, std::int64_t count) const {
    const std::int64_t room = ring_size() - place, before_end = count < room ? count : room;
    return sum_of(own, place, before_end) + sum_of(own, 0, count - before_end);
  }
  // Two sums, of every other bucket, that do not wait for each other; of neighbours in memory in vector code.
  template <class History>
  static vector sum_of(const History& own, std::int64_t place, std::int64_t count) {
    if (own.stride == 1) return sum_of_neighbours(own.values + at(place), count);
    vector even, odd;
    const std::int64_t end = at(place + count);
    std::int64_t k = at(place);
    for (; k + 3 < end; k += 6) {
      even = even + read(own, k);
      odd = odd + read(own, k + 3);
    }
    return k < end ? (even + read(own, k)) + odd : even + odd;
  }
  static vector sum_of_neighbours(const double* values, std::int64_t count) {
    two_doubles a{}, b{}, c{};
    std::int64_t k = 0;
    for (; k + 1 < count; k += 2, values += 6) {
      a += two_at(values);
      b += two_at(values + 2);
      c += two_at(values + 4);
    }
    const vector even{a[0], a[1], b[0]}, odd{b[1], c[0], c[1]};
    return k < count ? (even + vector{values[0], values[1], values[2]}) + odd : even + odd;
  }
  using two_doubles = double __attribute__((vector_size(16)));
  static two_doubles two_at(const double* values) {
    two_doubles both;
    __builtin_memcpy(&both, values, sizeof both);
    return both;
  }

  // What counts of the oldest bucket: the part that tau still covers, and its correction by the slope.
  struct edge {
    double part, slope;

    vector sum(vector middle, vector current, vector oldest, vector next) const {
      return (middle + current) + (part * oldest + slope * limited_difference(oldest, next));
    }
  };
  // A step may have begun within the oldest bucket or the next, which are then filled up to there.
  edge edge_at(double k) const {
    const double oldest = k - buckets_, filled = smaller(oldest + 1.0, begin_);
    if (filled <= oldest) return {0.0, 0.0};
    const double live = filled - (end_ - buckets_);
    const double part = smaller(1.0, begin_ < oldest + 1.0 ? live / (filled - oldest) : live);
    return {part, begin_ < oldest + 2.0 ? 0.0 : 0.5 * part * (1.0 - part)};
  }
  static vector limited_difference(vector bucket, vector next) {
    const vector difference = next - bucket;
    const double most = 2.0 * absolute(bucket.n);
    const double largest = larger(larger(absolute(bucket.t1), absolute(bucket.t2)),
                                  larger(absolute(difference.t1), absolute(difference.t2)));
    const double scale = power_scale_of(largest).down;
    const vector a = scale * bucket, b = scale * difference;
    const double allowed = 4.0 * tangential_product(a, a), found = tangential_product(b, b);
    const bool is_steep = found > allowed;
    const double factor = square_root((is_steep ? allowed : 1.0) / (is_steep ? found : 1.0));
    return {smaller(larger(difference.n, -most), most), factor * difference.t1, factor * difference.t2};
  }

  // How a step is spread over the buckets that it covers, as far as tau reaches: from bucket first, which
  // gets its share, over others that get one each to the newest, which gets what is left where the whole
  // counts, else its share.
  struct shares {
    double first, of_first, of_others, of_last;
    bool is_whole;
  };
  shares shares_at(double k) const {
    const bool is_whole = begin_ >= k - buckets_;
    const double length = end_ - begin_, first = is_whole ? floor_of(begin_) : k - buckets_;
    return {first, (smaller(first + 1.0, end_) - larger(first, begin_)) / length, 1.0 / length,
            (end_ - larger(now_, begin_)) / length, is_whole};
  }

  double duration_, buckets_, per_width_, end_, begin_, now_;
  bool has_grid_, is_short_;
  std::int64_t ring_size_, place_;  // of bucket now_
  edge edge_;
  shares shares_;
  double stamp_;  // of bucket now_
};

}  // namespace ilaw::kit::detail
