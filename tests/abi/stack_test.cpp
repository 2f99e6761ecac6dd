// ILAW_STACK_SIZE: the stack that create, initialise and evaluate of each law of the tree touch, measured on
// a thread whose stack is filled with a pattern; by random batches in every form of H, frame, number type and
// layout, through the loader.
#include "batch_source.hpp"

#include "support/law_cases.hpp"

#include <pthread.h>
#include <sys/mman.h>

#include <algorithm>
#include <functional>
#include <set>

namespace ilaw::testing {
namespace {

// Laws that need more than was promised (GCC 12, v4): whoever brings one of them within it
// takes it off the list. The loops of the kit keep copies of a block of nodes on the stack.
const std::set<std::string> too_deep = {"cohesive", "coulomb",        "grain",         "penalty",
                                        "postit",   "rate_and_state", "rccm",          "rolling",
                                        "rubber",   "slip_weakening", "table_friction"};

// ---- the deepest byte that a call touches

constexpr std::size_t page = 4096, stack_size = 128 * page;
constexpr unsigned char pattern = 0xA5;
// Between the caller's frame and the pattern, for the measurement itself; counted as used.
constexpr std::size_t margin = 512;

// A stack of our own that ends in a guard page; clean: the end of what no call has touched since it was
// filled.
struct Stack {
  unsigned char *bottom, *clean, *frame;
};
Stack& stack() {
  static Stack made = [] {
    auto* memory = static_cast<unsigned char*>(
        mmap(nullptr, stack_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    EXPECT_EQ(mprotect(memory, page, PROT_NONE), 0);
    return Stack{memory + page, memory + page, nullptr};
  }();
  return made;
}

std::size_t most = 0;

[[gnu::noinline]] void fill_stack() {
  stack().frame = static_cast<unsigned char*>(__builtin_frame_address(0));
  unsigned char* const top = stack().frame - margin;
  if (stack().clean < top) std::memset(stack().clean, pattern, static_cast<std::size_t>(top - stack().clean));
}
[[gnu::noinline]] void measure_stack() {
  const unsigned char* const top = stack().frame - margin;
  unsigned char* at = stack().bottom;
  while (at + page < top && std::all_of(at, at + page, [](unsigned char c) { return c == pattern; }))
    at += page;
  while (at < top && *at == pattern) ++at;
  stack().clean = at;
  most = std::max(most, static_cast<std::size_t>(stack().frame - at));
}

// Bytes of stack of the deepest call between both functions above.
std::size_t stack_of(std::function<void()> calls) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstack(&attributes, stack().bottom, stack_size - page);
  stack().clean = stack().bottom;
  most = 0;
  pthread_t thread;
  const auto run = [](void* opaque) -> void* {
    (*static_cast<std::function<void()>*>(opaque))();
    return nullptr;
  };
  EXPECT_EQ(pthread_create(&thread, &attributes, run, &calls), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  return most;
}

// ---- laws

// A refusal prints numbers.
void refuse(const ilaw_law& law) {
  for (std::uint32_t k = 0; k < law.parameter_count; ++k) {
    const SetupBuilder setup({{{law.parameters[k]->name, -1.2345678901234567e300}}, {}});
    ilaw_instance* instance = nullptr;
    char message[300];
    fill_stack();
    law.create(law.id, &setup.setup, &instance, message, sizeof message);
    measure_stack();
    EXPECT_EQ(instance, nullptr) << law.id;
  }
}

void run_batches(const ilaw::library& library) {
  using namespace random_batches;
  Drawn::before = fill_stack;
  Drawn::after = measure_stack;
  Arena arena;
  Tally tally;
  for (std::uint64_t seed = 1; tally.batches < 1500; ++seed) {
    Draw draw(seed);
    const std::optional<Drawn> drawn = Drawn::of(library, draw);
    if (!drawn) continue;
    Runner runner(*drawn, draw, {draw.one_in(2) ? 0U : 30U}, arena);
    runner.before = fill_stack;
    runner.after = measure_stack;
    runner.run(4, tally);
  }
  EXPECT_EQ(tally.wrong, "");
}

template <std::size_t Size>
[[gnu::noinline]] void touch() {
  volatile unsigned char touched[Size];
  for (std::size_t k = 0; k < Size; ++k) touched[k] = 1;
  static_cast<void>(touched[0]);
}
template <std::size_t Size>
void use_stack() {
  fill_stack();
  touch<Size>();
  measure_stack();
}

TEST(Stack, IsMeasuredToTheDeepestByte) {
  EXPECT_LT(stack_of(use_stack<100>), 2048U);
  for (int k = 0; k < 2; ++k) {
    const std::size_t used = stack_of(use_stack<100000>);
    EXPECT_GE(used, 100000U);
    EXPECT_LT(used, 102048U);
  }
}

TEST(Stack, IsWithinThePromise) {
  std::vector<std::string> laws = laws_of_tree();
  laws.emplace_back("template_c");
  std::printf("bytes of stack, %d promised\n", ILAW_STACK_SIZE);
  for (const std::string& name : laws) {
    const ilaw::library library(plugin_file(name));
    std::size_t deepest = 0;
    for (const char* level : {"baseline", "v4"}) {
      setenv("ILAW_ISA", level, 1);
      deepest = std::max(
          {deepest, stack_of([&] { refuse(*library.law(name)); }), stack_of([&] { run_batches(library); })});
    }
    std::printf("%-16s %9zu\n", name.c_str(), deepest);
    if (!too_deep.contains(name)) {
      EXPECT_LE(deepest, std::size_t{ILAW_STACK_SIZE}) << name;
    } else {
      EXPECT_GT(deepest, std::size_t{ILAW_STACK_SIZE})
          << name << " keeps the promise now: take it off the list";
    }
  }
  unsetenv("ILAW_ISA");
}

}  // namespace
}  // namespace ilaw::testing
