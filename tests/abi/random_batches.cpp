// random_batches - hostile batches for the laws of libraries, meant to run under sanitizers: what a law is
// given may be wrong in any way but its addresses. Stops at the first promise broken, with all that is needed
// to repeat it. Usage: random_batches [--batches N] [--seed S] LIBRARY...
// SPDX-License-Identifier: BSD-3-Clause
#include "batch_source.hpp"

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace {

using namespace random_batches;

struct Options {
  std::uint64_t batches = 100000, seed = 1;
  std::vector<std::string> libraries;
};

Options options_of(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word.rfind("--", 0) != 0) {
      options.libraries.push_back(word);
      continue;
    }
    if ((word != "--batches" && word != "--seed") || k + 1 == argc)
      throw std::runtime_error("usage: random_batches [--batches N] [--seed S] LIBRARY...");
    (word == "--seed" ? options.seed : options.batches) = std::strtoull(argv[++k], nullptr, 10);
  }
  if (options.libraries.empty()) throw std::runtime_error("no LIBRARY given");
  return options;
}

// Every run has a seed of its own, so that the last one can be repeated alone.
void run(const std::vector<ilaw::library>& libraries, std::uint64_t seed, Arena& arena, Tally& tally) {
  Draw draw(seed);
  const std::optional<Drawn> drawn = Drawn::of(libraries[draw.below(libraries.size())], draw);
  if (!drawn) return;
  constexpr std::uint64_t odds[] = {0, 5, 30, 300};
  for (int k = 0; k < 8 && tally.wrong.empty(); ++k)
    Runner(*drawn, draw, {odds[draw.below(4)]}, arena).run(1 + static_cast<int>(draw.below(20)), tally);
}

int run_all(const Options& options) {
  std::vector<ilaw::library> libraries;
  for (const std::string& path : options.libraries) libraries.emplace_back(path);
  Arena arena;
  Tally tally;
  std::uint64_t seed = options.seed;
  for (; tally.batches < options.batches && tally.wrong.empty(); ++seed) run(libraries, seed, arena, tally);
  std::printf(
      "%llu batches, %llu of floats, %llu nodes, %llu of them bad, %llu calls refused, digest %016llx\n",
      static_cast<unsigned long long>(tally.batches), static_cast<unsigned long long>(tally.of_floats),
      static_cast<unsigned long long>(tally.nodes), static_cast<unsigned long long>(tally.bad),
      static_cast<unsigned long long>(tally.refused), static_cast<unsigned long long>(tally.digest));
  if (tally.wrong.empty()) return 0;
  std::fprintf(stderr, "random_batches: %s; repeat with --batches 1 --seed %llu\n", tally.wrong.c_str(),
               static_cast<unsigned long long>(seed - 1));
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_all(options_of(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "random_batches: %s\n", error.what());
    return 2;
  }
}
