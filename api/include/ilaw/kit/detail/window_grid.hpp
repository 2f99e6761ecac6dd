// window_grid.hpp - the buckets of a window (window.hpp) as a step finds them: where they stand, what is
// summed of them, and how the step is spread over them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/window_lanes.hpp>
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
        ring_size_(static_cast<std::int64_t>(buckets) - 1),
        place_(has_grid_ ? place_of(now_ - 1.0) : 0),
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

  // Three numbers behind one that does not count: a vector of a history, behind what stands before it.
  struct row {
    static constexpr int lines = 4 / square_size;
    square::line line[lines];

    static row at(const double* four) {
      row r;
      __builtin_memcpy(&r, four, sizeof r);
      return r;
    }
    void put(double* four) const { __builtin_memcpy(four, this, sizeof *this); }
    double operator[](int k) const { return line[k / square_size][k % square_size]; }
    operator vector() const { return {(*this)[1], (*this)[2], (*this)[3]}; }
    friend row operator+(row a, const row& b) {
      for (int k = 0; k < lines; ++k) a.line[k] += b.line[k];
      return a;
    }
    friend row operator-(row a, const row& b) {
      for (int k = 0; k < lines; ++k) a.line[k] -= b.line[k];
      return a;
    }
    friend row operator*(double s, row a) {
      for (int k = 0; k < lines; ++k) a.line[k] *= s;
      return a;
    }
  };
  template <class Number>
  static row row_at(const neighbours<Number>& own, std::int64_t k) {
    return row::at(own.values + k - 1);
  }
  static row row_at(const const_history& own, std::int64_t k) {
    const double four[] = {0.0, own[k], own[k + 1], own[k + 2]};
    return row::at(four);
  }
  static void put_row(const neighbours<double>& own, std::int64_t k, row r) {
    r.line[0][0] = own[k - 1];
    r.put(own.values + k - 1);
  }
  static void put_row(const history& own, std::int64_t k, const row& r) {
    for (int c = 0; c < 3; ++c) own[k + c] = r[c + 1];
  }

  // What every step needs stands in front: the number of the newest bucket, which is open, its sum, that of
  // the middle ones, the oldest bucket and the slope in it. Behind are the middle buckets, as a ring.
  static constexpr std::int64_t current = 1, middle_sum = 4, oldest_bucket = 7, oldest_slope = 10,
                                first_bucket = 13, head_size = first_bucket;
  // Numbers of buckets that a double and a cast hold with room to spare. A grid finer than that is finer than
  // the clock: no step lies within tau of another.
  static constexpr double largest_number = 0x1p51;

  static void put_head(const history& own, double stamp, const row& newest, const row& middle,
                       const row& oldest, const row& slope) {
    own[0] = stamp;
    put_row(own, current, newest);
    put_row(own, middle_sum, middle);
    put_row(own, oldest_bucket, oldest);
    put_row(own, oldest_slope, slope);
  }
  // Each row over the end of the one in front of it, but with the stamp in front of the first.
  static void put_head(const neighbours<double>& own, double stamp, row newest, const row& middle,
                       const row& oldest, const row& slope) {
    newest.line[0][0] = stamp;
    slope.put(own.values + oldest_slope - 1);
    oldest.put(own.values + oldest_bucket - 1);
    middle.put(own.values + middle_sum - 1);
    newest.put(own.values + current - 1);
  }

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

  // Places in the ring: bucket j stands at j modulo B - 1, so that the bucket that closes takes the place of
  // the one that becomes the oldest.
  std::int64_t place_of(double bucket) const {
    const double size = buckets_ - 1.0;
    if (size < 1.0) return 0;
    const double place = bucket - floor_of(bucket * (1.0 / size)) * size;  // the quotient may be one off
    return static_cast<std::int64_t>(place < 0.0 ? place + size : (place < size ? place : place - size));
  }
  std::int64_t after(std::int64_t place) const { return place + 1 < ring_size_ ? place + 1 : 0; }
  std::int64_t previous(std::int64_t place) const { return place > 0 ? place - 1 : ring_size_ - 1; }
  static std::int64_t at(std::int64_t place) { return first_bucket + 3 * place; }
  // Where bucket j stands while k is the newest.
  std::int64_t index_of(double j, double k) const {
    return j == k ? current : (j == k - buckets_ ? oldest_bucket : at(place_of(j)));
  }

  // What a bucket that opens makes of the others: their sum, the oldest and the one after it.
  struct turned {
    row middle{}, oldest{}, next{};
  };
  // Bucket k is the newest, so many after the one that was.
  template <class History>
  turned turn(const History& own, double k, double turns) const {
    return turn_at(own, k == now_ ? place_ : place_of(k - 1.0), turns);
  }
  // Where the oldest bucket will be that of this place.
  template <class History>
  turned turn_at(const History& own, std::int64_t place, double turns) const {
    if (turns > buckets_) return {};
    const row last = row_at(own, current);
    if (turns == buckets_) return {.oldest = last};
    const std::int64_t next = after(place), count = ring_size_ - static_cast<std::int64_t>(turns);
    return {sum_from(own, next, count) + last, row_at(own, at(place)),
            count > 0 ? row_at(own, at(next)) : last};
  }
  // In the order in which they stand, whichever is the first of them.
  template <class History>
  row sum_from(const History& own, std::int64_t place, std::int64_t count) const {
    const std::int64_t beyond = place + count - ring_size_, end = beyond > 0 ? ring_size_ : place + count;
    row sum{};
    for (std::int64_t q = 0; q < beyond; ++q) sum = sum + row_at(own, at(q));
    for (std::int64_t q = place; q < end; ++q) sum = sum + row_at(own, at(q));
    return sum;
  }

  // What counts of the oldest bucket: the part that tau still covers, and its correction by the slope.
  struct edge {
    double part, slope;

    // Of vectors, or of rows that hold them.
    template <class Vector>
    Vector sum(const Vector& middle, const Vector& newest, const Vector& oldest,
               const Vector& difference) const {
      return (middle + newest) + (part * oldest + slope * difference);
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
  // Of doubles, or of a register of them.
  template <class Vector>
  static Vector limited_difference(const Vector& bucket, const Vector& next) {
    const auto n = next.n - bucket.n, t1 = next.t1 - bucket.t1, t2 = next.t2 - bucket.t2;
    const auto most = 2.0 * absolute(bucket.n);
    const auto scale = down_scale_of(
        larger(larger(absolute(bucket.t1), absolute(bucket.t2)), larger(absolute(t1), absolute(t2))));
    const auto a1 = scale * bucket.t1, a2 = scale * bucket.t2, b1 = scale * t1, b2 = scale * t2;
    const auto allowed = 4.0 * (a1 * a1 + a2 * a2), found = b1 * b1 + b2 * b2;
    const auto is_steep = found > allowed;
    const auto one = 0.0 * scale + 1.0;
    const auto factor = square_root((is_steep ? allowed : one) / (is_steep ? found : one));
    return {smaller(larger(n, -most), most), factor * t1, factor * t2};
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
  std::int64_t ring_size_, place_;  // of bucket now_ - 1, where now_ - B stood before
  edge edge_;
  shares shares_;
  double stamp_;  // of bucket now_
};

}  // namespace ilaw::kit::detail
