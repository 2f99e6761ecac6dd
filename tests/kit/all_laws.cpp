// all_laws library.so...: steps every law of the libraries in every dimension, form of H and frame, with each
// of its choices and with all of its numbers other than by default. To be run under an emulated processor.
#include <ilaw/arrays.hpp>
#include <ilaw/loader.hpp>

#include <array>
#include <cstdio>
#include <deque>
#include <random>
#include <vector>

namespace {

constexpr std::size_t count = 70;

// Arguments: one text at most, and the required or all numbers.
struct Arguments {
  Arguments(const ilaw_law& law, const char* choice_of, const char* choice, bool all_numbers) {
    for (std::uint32_t k = 0; k < law.parameter_count; ++k) {
      const ilaw_parameter& p = *law.parameters[k];
      if (p.kind == ILAW_KIND_CHOICE && choice_of == p.name) add(p, ILAW_KIND_VALUE_TEXT).text = choice;
      if (p.kind != ILAW_KIND_CHOICE && ((p.flags & ILAW_FLAG_REQUIRED) || all_numbers))
        add(p, ILAW_KIND_VALUE_NUMBER).number =
            p.maximum < 1e6 ? 0.25 * p.maximum + 0.75 * p.minimum : p.minimum + 2.0;
    }
    for (ilaw_argument& a : arguments) pointers.push_back(&a);
  }
  ilaw_argument& add(const ilaw_parameter& p, std::uint32_t kind) {
    ilaw_argument& a = arguments.emplace_back();
    a = {};
    a.struct_size = sizeof a;
    a.kind = kind;
    a.name = p.name;
    if (p.kind == ILAW_KIND_INTEGER) a.number = p.minimum;
    return a;
  }
  std::deque<ilaw_argument> arguments;
  std::vector<const ilaw_argument*> pointers;
};

struct Arrays {
  Arrays() {
    std::mt19937_64 random(1);
    const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0; };
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        v[i][c] = uniform();
        h[i][c] = 1.5 + uniform();
        h[i][3 + c] = 0.05 * uniform();
      }
      normal[i] = {i % 2 ? 1.0 : 0.6, i % 2 ? 0.0 : 0.8, 0.0};
      gap[i] = 1e-3 * uniform();
    }
  }
  std::array<std::array<double, 3>, count> v, normal;
  std::array<std::array<double, 6>, count> h;
  std::array<double, count> gap;
};

bool run(const ilaw::library& library, const ilaw_law& law, ilaw_setup setup) {
  char message[300];
  ilaw_instance* instance;
  const std::int32_t code = law.create(law.id, &setup, &instance, message, sizeof message);
  if (code == ILAW_INVALID_PARAMETER || code == ILAW_UNSUPPORTED) return false;
  if (code != ILAW_OK) std::printf("%s: %s\n", law.id, message);
  ilaw_instance_info info{};
  info.struct_size = sizeof info;
  law.info(instance, &info);
  static const Arrays arrays;
  static const double area = 1.0;
  const auto s = static_cast<std::int64_t>(info.state_size);
  std::vector<double> state(count * info.state_size + 1), r(3 * count), v(3 * count), energy(4 * count);
  std::uint8_t status[count];
  ilaw_batch b{};
  b.struct_size = sizeof b;
  b.node_count = count;
  b.velocity_step = b.position_step = 1e-3;
  b.v_free = b.v_previous = ilaw::input(arrays.v[0].data(), 3, 1);
  b.delassus = ilaw::input(arrays.h[0].data(), 6, 1);
  b.normal = ilaw::input(arrays.normal[0].data(), setup.dimension == 1 ? 6 : 3, 1);
  b.gap = ilaw::input(arrays.gap.data(), 1, 1);
  b.area = ilaw::input(&area, 0, 1);
  b.state_in = ilaw::input(state.data(), s, 1);
  b.state_out = ilaw::output(state.data(), s, 1);
  b.impulse = ilaw::output(r.data(), 3, 1);
  law.initialise(instance, &b, nullptr);
  for (int step = 0; step < 4; ++step) {
    if (step == 2) {
      b.velocity = ilaw::output(v.data(), 3, 1);
      b.energy = ilaw::output(energy.data(), 4, 1);
      b.status = status;
      b.status_stride = 1;
    }
    b.time += 1e-3;
    law.evaluate(instance, &b, nullptr);
  }
  law.destroy(instance);
  (void)library;
  return true;
}

int run_all(const ilaw::library& library, const ilaw_law& law) {
  std::vector<std::pair<const char*, const char*>> choices = {{nullptr, nullptr}};
  for (std::uint32_t k = 0; k < law.parameter_count; ++k)
    for (std::uint32_t c = 0; c < law.parameters[k]->choice_count; ++c)
      choices.emplace_back(law.parameters[k]->name, law.parameters[k]->choices[c]);
  int runs = 0;
  for (const auto& [name, choice] : choices)
    for (const bool all_numbers : {false, true})
      for (const std::uint32_t d : {1U, 2U, 3U})
        for (const int form : {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL})
          for (const int frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL}) {
            const Arguments arguments(law, name, choice, all_numbers);
            ilaw_setup setup{};
            setup.struct_size = sizeof setup;
            setup.dimension = d;
            setup.delassus_form = static_cast<std::uint32_t>(form);
            setup.frame = static_cast<std::uint32_t>(frame);
            setup.numbers = ILAW_NUMBERS_DOUBLE;
            setup.arguments = arguments.pointers.data();
            setup.argument_count = static_cast<std::uint32_t>(arguments.pointers.size());
            runs += run(library, law, setup);
          }
  return runs;
}

}  // namespace

int main(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const ilaw::library library(argv[k]);
    for (std::uint32_t l = 0; l < library.plugin().law_count; ++l) {
      const ilaw_law& law = *library.plugin().laws[l];
      const int runs = run_all(library, law);
      std::printf("%s: %d instances\n", law.id, runs);
      if (runs == 0) return 1;
    }
  }
  return 0;
}
