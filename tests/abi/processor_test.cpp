// A level is chosen only where the processor and the operating system have all that a compiler may use of it.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/kit/detail/dispatch.hpp>

#include <gtest/gtest.h>

namespace {

using namespace ilaw::kit::detail;

// Each required bit alone taken away refuses the level.
void expect_every_bit_needed(const processor& level, int count) {
  ASSERT_TRUE(serves(level, level));
  int needed = 0;
  for (std::uint32_t processor::*word :
       {&processor::leaf_1_ecx, &processor::leaf_7_ebx, &processor::extended_ecx, &processor::kept})
    for (int place = 0; place < 32; ++place) {
      processor lacking = level;
      lacking.*word &= ~(std::uint32_t{1} << place);
      if (lacking.*word == level.*word) continue;
      ++needed;
      EXPECT_FALSE(serves(lacking, level)) << "bit " << place;
    }
  EXPECT_EQ(needed, count);
}

TEST(Processor, EveryExtensionOfALevelIsNeeded) {
  expect_every_bit_needed(level_v3, 12 + 3 + 2 + 2);
  expect_every_bit_needed(level_v4, 12 + 8 + 2 + 5);
}

// The compiler's own answer, of GCC 12 on: as -march=x86-64-v3 and -v4 define them.
TEST(Processor, AgreesWithTheCompilerAboutThisOne) {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12
  __builtin_cpu_init();
  EXPECT_EQ(serves(this_processor(), level_v3), __builtin_cpu_supports("x86-64-v3") != 0);
  EXPECT_EQ(serves(this_processor(), level_v4), __builtin_cpu_supports("x86-64-v4") != 0);
#else
  GTEST_SKIP() << "this compiler does not say";
#endif
}

}  // namespace
