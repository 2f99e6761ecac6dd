// late_host LIBRARY LAW - keeps an interface at namespace scope, where it ends after main.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include <cstdio>
#include <optional>

namespace {

struct Kept {
  std::optional<ilaw::interface> interface;
  ~Kept() {
    interface.reset();
    std::puts("ended");
  }
} kept;

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 1;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_LOCAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  kept.interface.emplace(ilaw::library(argv[1]), argv[2], setup);
}
