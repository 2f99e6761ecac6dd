// The windows of the nodes of a pack against those of each node alone.
#include "window_in_test.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

namespace {

using namespace ilaw::kit;
using namespace ilaw::kit::detail;
constexpr int nodes = lanes_of<pack>;

enum class Layout { rows, columns, rows_with_a_stride };

// The windows of a pack and of its nodes alone, in the same steps.
class Windows {
 public:
  Windows(double buckets, Layout layout)
      : size_{1.0, buckets},
        layout_(layout),
        numbers_(window::doubles(size_)),
        values_(static_cast<std::size_t>(2 * numbers_ * nodes)),
        alone_(values_) {}

  void step(double end, double h, bool all_alike, std::mt19937_64& random) {
    const window w(size_, {end, h});
    ilaw::kit::vector<pack> sum;
    pack refused = 0.0;
    with(values_, [&](const auto& own) { refused = w.read(own, sum); });
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    double impulses[3][nodes];
    unsigned adds = 0, clears = 0;
    for (int i = 0; i < nodes; ++i) {
      ilaw::kit::vector<double> sum_alone;
      const double refused_alone = w.read(of(alone_, i), sum_alone);
      const double found[4] = {sum.n[i], sum.t1[i], sum.t2[i], refused[i]};
      const double each[4] = {sum_alone.n, sum_alone.t1, sum_alone.t2, refused_alone};
      ASSERT_EQ(std::memcmp(found, each, sizeof found), 0) << "end " << end << ", node " << i;
      sums_ += found[0] != 0.0 ? 1 : 0;
      const bool add = all_alike || uniform(random) > 0.0, clear = !all_alike && uniform(random) > 0.97;
      const double strength = !all_alike && uniform(random) > 0.8 ? 0.0 : 1.0;
      for (auto& component : impulses) component[i] = strength * uniform(random);
      adds |= add ? 1U << i : 0U;
      clears |= clear ? 1U << i : 0U;
      w.write(of(alone_, i), clear, add, {impulses[0][i], impulses[1][i], impulses[2][i]});
    }
    const ilaw::kit::vector<pack> impulse{load<pack>(impulses[0]), load<pack>(impulses[1]),
                                          load<pack>(impulses[2])};
    with(values_,
         [&](const auto& own) { w.write(own, mask_from<pack>(clears), mask_from<pack>(adds), impulse); });
    ASSERT_EQ(std::memcmp(values_.data(), alone_.data(), values_.size() * sizeof(double)), 0)
        << "end " << end;
  }
  int sums() const { return sums_; }

 private:
  std::int64_t stride() const { return layout_ == Layout::columns ? nodes : layout_ == Layout::rows ? 1 : 2; }
  double* first(std::vector<double>& all, int node) const {
    return all.data() + (layout_ == Layout::columns ? node : node * numbers_ * stride());
  }
  window_columns<double> of(std::vector<double>& all, int node) const { return {first(all, node), stride()}; }
  template <class Work>
  void with(std::vector<double>& all, Work work) const {
    if (layout_ == Layout::columns) return work(window_columns<pack>{all.data(), stride()});
    window_rows own;
    own.stride = stride();
    for (int i = 0; i < nodes; ++i) own.first[i] = first(all, i);
    work(own);
  }

  window_size size_;
  Layout layout_;
  std::int64_t numbers_;
  std::vector<double> values_, alone_;
  int sums_ = 0;
};

// To the last bit, whether the numbers of a node are neighbours or those of the nodes, and whether the nodes'
// newest buckets are the same.
TEST(Window, OfAPackIsThatOfEachNode) {
  for (const double buckets : {1.0, 2.0, 3.0, 8.0, 33.0})
    for (const Layout layout : {Layout::rows, Layout::columns, Layout::rows_with_a_stride}) {
      SCOPED_TRACE(testing::Message() << buckets << " buckets, layout " << static_cast<int>(layout));
      Windows windows(buckets, layout);
      std::mt19937_64 random(5);
      std::uniform_real_distribution<double> uniform(-1.0, 1.0);
      double end = -3.0;
      for (int step = 0; step < 2000; ++step) {
        const double h = step % 50 == 0 ? 0.3 : 0.01 * (1.0 + 0.5 * uniform(random));
        windows.step(end += h, h, step > 1000, random);
      }
      EXPECT_GT(windows.sums(), 1500 * nodes);
    }
}

}  // namespace
