// The windows of a block of nodes against those of each node alone.
#include <ilaw/kit/detail/window_block.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

namespace {

using ilaw::kit::vector;
using ilaw::kit::window;
using namespace ilaw::kit::detail;

// The kit reads and writes the windows of a block together, where most stand alike: nobody notices, to the
// last bit, whether the numbers of a node are neighbours, those of the nodes, or the nodes are listed.
void compare_with_nodes_alone(double buckets, bool in_rows, bool listed) {
  constexpr int nodes = block_size - 1;
  constexpr double duration = 1.0;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const std::int64_t size = window::doubles(duration, buckets);
  std::vector<double> values(static_cast<std::size_t>(size * nodes)), values_alone = values;
  std::vector<std::int64_t> backwards;
  for (int i = nodes; i-- > 0;) backwards.push_back(i);
  const auto of = [&](std::vector<double>& all) -> histories {
    return {all.data(), in_rows ? size : 1, in_rows ? 1 : nodes, listed ? backwards.data() : nullptr};
  };
  const histories own = of(values), own_alone = of(values_alone);
  const window alone(duration, buckets);
  double end = -3.0;
  int together = 0;
  for (int step = 0; step < 1000; ++step) {
    const double h = step % 50 == 0 ? 0.3 : 0.01 * (1.0 + 0.5 * uniform(random));
    end += h;
    const window_block block(alone.in({end, h}));
    window_block::block_reading read;
    given_impulses given;
    block.before(own, nodes, read);
    for (int i = 0; i < nodes; ++i) {
      const window::reading expected = alone.before(own_alone.at(i), {end, h});
      const double found[4] = {read.sum[0].values[i], read.sum[1].values[i], read.sum[2].values[i],
                               read.refused.values[i]};
      const double each[4] = {expected.sum.n, expected.sum.t1, expected.sum.t2, expected.refused};
      ASSERT_EQ(std::memcmp(found, each, sizeof found), 0) << "step " << step << ", node " << i;
      together += found[0] != 0.0 ? 1 : 0;
      const bool all_alike = step > 500;  // before that some lag behind, or are empty
      const bool adds = all_alike || i % 3 == 0 || uniform(random) > 0.5;
      const bool clears = !all_alike && i % 7 == 6 && step % 100 == i;
      const double strength = !all_alike && i % 5 == 4 ? 0.0 : 1.0;
      const vector impulse = strength * vector{uniform(random), uniform(random), uniform(random)};
      given.impulse[0].values[i] = impulse.n;
      given.impulse[1].values[i] = impulse.t1;
      given.impulse[2].values[i] = impulse.t2;
      given.adds.values[i] = adds ? 1.0 : 0.0;
      given.clears.values[i] = clears ? 1.0 : 0.0;
      if (clears) alone.in({end, h}).clear(own_alone.at(i));
      if (adds) alone.add(own_alone.at(i), {end, h}, impulse);
    }
    block.add(own, nodes, given, read);
    ASSERT_EQ(std::memcmp(values.data(), values_alone.data(), values.size() * sizeof(double)), 0)
        << "step " << step;
  }
  EXPECT_GT(together, 20000);
}

TEST(Window, ABlockIsWhatItsNodesAre) {
  for (const double buckets : {1.0, 2.0, 3.0, 8.0, 33.0})
    for (const bool in_rows : {false, true})
      for (const bool listed : {false, true}) {
        SCOPED_TRACE(testing::Message() << buckets << " buckets, rows " << in_rows << ", listed " << listed);
        compare_with_nodes_alone(buckets, in_rows, listed);
      }
}

}  // namespace
