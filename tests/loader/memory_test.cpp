// Whichever allocation fails, the C interface answers with a code: nothing escapes from it.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.h>

#include "support/program.hpp"

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <string>

namespace {

std::atomic<long> allowed{-1};  // allocations until one fails; negative: none does

void* allocate(std::size_t size) {
  if (allowed >= 0 && allowed-- == 0) throw std::bad_alloc();
  if (void* room = std::malloc(size == 0 ? 1 : size)) return room;
  throw std::bad_alloc();
}

// Runs work with the first, the second ... allocation failing, until none does; returns how many there were.
template <class Work>
int with_every_allocation_failing(Work work) {
  for (int k = 0; k < 100000; ++k) {
    allowed = k;
    work();
    const bool failed = allowed < 0;
    allowed = -1;
    if (!failed) return k;
  }
  return -1;
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
void operator delete(void* room) noexcept { std::free(room); }
void operator delete[](void* room) noexcept { std::free(room); }
void operator delete(void* room, std::size_t) noexcept { std::free(room); }
void operator delete[](void* room, std::size_t) noexcept { std::free(room); }

namespace {

constexpr const char* file = ILAW_TEST_PLUGINS "/good.so";

TEST(OutOfMemory, ReadingADescriptionSaysIt) {
  // With the description beside it, as `ilaw-describe` wrote it.
  const ilaw::testing::programs::TemporaryFolder folder;
  const std::string library = (folder.path / "good.so").string();
  std::filesystem::copy_file(file, library);
  ASSERT_EQ(ilaw::testing::programs::run_command(ILAW_HOSTS "/ilaw-describe " + library).code, 0);
  std::int32_t code = ILAW_OK;
  char text[8192];
  std::size_t length = 0, needed = 0;
  EXPECT_GE(with_every_allocation_failing([&] {
              code = ilaw_library_read_description(library.c_str(), text, sizeof text, &length, nullptr, 0);
              if (code != ILAW_OK && code != ILAW_OUT_OF_MEMORY) std::abort();
            }),
            100);
  EXPECT_EQ(code, ILAW_OK);
  EXPECT_GT(length, 100U);
  EXPECT_GE(with_every_allocation_failing([&] {
              ilaw_library* opened = nullptr;
              code = ilaw_library_open(library.c_str(), &opened, nullptr, 0);
              if (code != ILAW_OK && (code != ILAW_OUT_OF_MEMORY || opened)) std::abort();
              needed = ilaw_library_describe(opened, text, sizeof text);
              ilaw_library_close(opened);
            }),
            100);
  EXPECT_GT(needed, 100U);
}

TEST(OutOfMemory, OpeningAndCreatingSayItAndLeaveNothingBehind) {
  std::int32_t code = ILAW_OK;
  char message[256];
  const int allocations = with_every_allocation_failing([&] {
    ilaw_library* library = nullptr;
    ilaw_interface* interface = nullptr;
    ilaw_setup setup{};
    setup.struct_size = sizeof setup;
    setup.dimension = 1;
    setup.delassus_form = ILAW_DELASSUS_SCALAR;
    setup.frame = ILAW_FRAME_LOCAL;
    setup.numbers = ILAW_NUMBERS_DOUBLE;
    code = ilaw_library_open(file, &library, message, sizeof message);
    if (code == ILAW_OK)
      code = ilaw_interface_create(library, "zero", &setup, &interface, message, sizeof message);
    if (code != ILAW_OK && code != ILAW_OUT_OF_MEMORY) std::abort();
    if (code != ILAW_OK && interface) std::abort();
    ilaw_interface_destroy(interface);
    ilaw_library_close(library);
  });
  EXPECT_GE(allocations, 10);
  EXPECT_EQ(code, ILAW_OK);
}

TEST(OutOfMemory, SearchingSaysIt) {
  setenv("ILAW_PATH", ILAW_TEST_PLUGINS, 1);
  std::int32_t code = ILAW_OK;
  const auto visit = [](const char*, void*) -> std::int32_t { return 0; };
  EXPECT_GE(with_every_allocation_failing([&] {
              code = ilaw_search(visit, nullptr);
              if (code != ILAW_OK && code != ILAW_OUT_OF_MEMORY) std::abort();
            }),
            10);
  EXPECT_EQ(code, ILAW_OK);
  char text[256];
  std::size_t length = 0;
  EXPECT_GE(with_every_allocation_failing([&] { length = ilaw_search_path(text, sizeof text); }), 2);
  EXPECT_GT(length, std::size_t{1});
}

}  // namespace
