// Rows of numbers to columns and back, for every length and stride that states have.
#include <ilaw/kit/detail/gather.hpp>

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace ilaw::kit::detail {
namespace {

constexpr double untouched = -1.0;

void expect_there_and_back(int numbers, int stride, int count) {
  std::vector<double> rows(static_cast<std::size_t>(stride) * (block_size + 1));
  std::iota(rows.begin(), rows.end(), 0.0);
  std::vector<column> room(static_cast<std::size_t>(numbers));
  std::vector<const double*> found(room.size());
  std::vector<double*> columns;
  for (column& c : room) columns.push_back(c.values);
  const node_range nodes{nullptr, nullptr, 0, 0, count, false};
  gather_components_of<double>(rows.data(), stride, 1, numbers, nodes, room.data(), found.data());
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < numbers; ++k)
      ASSERT_EQ(found[k][i], stride * i + k) << "row " << i << ", number " << k;
  std::vector<double> back(rows.size(), untouched);
  for (int k = 0; k < numbers; ++k)
    if (found[k] != columns[k]) std::copy_n(found[k], count, columns[k]);
  scatter_components_of<double>(back.data(), stride, 1, numbers, nodes, columns.data());
  for (int i = 0; i < static_cast<int>(back.size()); ++i) {
    const bool is_of_a_row = i / stride < count && i % stride < numbers;
    ASSERT_EQ(back[static_cast<std::size_t>(i)], is_of_a_row ? i : untouched) << "place " << i;
  }
}

TEST(Rows, AreColumnsAndRowsAgain) {
  for (int numbers = 1; numbers <= 16; ++numbers)
    for (const int more : {0, 1, 6})
      for (const int count : {1, 3, 4, 7, 33, block_size}) {
        SCOPED_TRACE(::testing::Message()
                     << numbers << " numbers, " << more << " between, " << count << " rows");
        expect_there_and_back(numbers, numbers + more, count);
      }
}

}  // namespace
}  // namespace ilaw::kit::detail
