// The status of a node stands where its stride says, and nowhere else.
#include <support/law_runner.hpp>

#include <cstring>

namespace ilaw::testing {
namespace {

constexpr std::uint8_t untouched_status = 99;
constexpr std::int64_t node_count = 150;  // more than a block of the kit's

// Nodes that touch where their number is a multiple of three.
std::uint8_t expected_of(std::int64_t node) { return node % 3 == 0 ? ILAW_CLOSED : ILAW_FREE; }

TEST(Status, StandsWhereItsStrideSays) {
  const SetupBuilder setup({});
  const ilaw::interface law = make_law("contact", setup);
  const double one = 1.0;
  const Vector v{-1.0, 0.0, 0.0};
  std::vector<double> gap(node_count), r(3 * node_count);
  std::vector<std::int32_t> odd;  // backwards, of Fortran
  for (std::int64_t i = 0; i < node_count; ++i) gap[static_cast<std::size_t>(i)] = i % 3 == 0 ? 0.0 : 1.0;
  for (std::int64_t i = node_count - 1; i > 0; i -= 2) odd.push_back(static_cast<std::int32_t>(i + 1));
  ilaw_batch b{};
  b.struct_size = sizeof b;
  b.velocity_step = b.position_step = 1e-3;
  b.v_free = b.v_previous = ilaw::input(v.data(), 0, 1);
  b.delassus = ilaw::input(&one, 0, 1);
  b.gap = ilaw::input(gap.data(), 1, 1);
  b.impulse = ilaw::output(r.data(), 3, 1);
  for (const std::int64_t stride : {1, 2, 3, 24, -1, -5})
    for (const bool listed : {false, true}) {
      const std::int64_t reach = std::abs(stride);
      std::vector<std::uint8_t> status(static_cast<std::size_t>(node_count * reach), untouched_status);
      std::uint8_t* first = status.data() + (stride < 0 ? (node_count - 1) * reach : 0);
      b.status = first;
      b.status_stride = stride;
      b.index = listed ? odd.data() : nullptr;
      b.index_base = listed ? 1 : 0;
      b.node_count = listed ? static_cast<std::int64_t>(odd.size()) : node_count;
      ASSERT_EQ(law.evaluate(b), ILAW_OK) << "listed " << listed;
      std::vector<std::uint8_t> expected(status.size(), untouched_status);
      for (std::int64_t i = 0; i < node_count; ++i)
        if (!listed || i % 2 == 1)
          expected[static_cast<std::size_t>(first - status.data() + i * stride)] = expected_of(i);
      EXPECT_EQ(status, expected) << "stride " << stride << (listed ? ", listed" : "");
    }
}

}  // namespace
}  // namespace ilaw::testing
