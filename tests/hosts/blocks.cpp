// blocks.cpp - a small explicit code that hosts an interface law, in C++.
//
// Blocks on springs slide on a floor (z up): central differences with a lumped mass matrix, and at each step
// the law's impulse. The last block hangs in the air and is no interface node. Usage: blocks_cpp LIBRARY
// blocks.c is the same host in C and prints the same bits, though here components come first in the arrays.
//
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/arrays.hpp>
#include <ilaw/loader.hpp>

#include <array>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr int count = 7, steps = 3000;
constexpr double h = 1e-3;
constexpr std::array<double, 3> gravity{0.0, 0.0, -10.0}, up{0.0, 0.0, 1.0};
constexpr std::array<double, count> mass{1.0, 2.5, 0.7, 2.0, 1.5, 1.0, 0.8};
constexpr std::array<double, count> stiffness{0.0, 0.0, 0.0, 50.0, 20.0, 100.0, 30.0};
constexpr std::array<std::int32_t, 6> floor_nodes{0, 1, 2, 3, 4, 5};

using components = std::array<std::array<double, count>, 3>;  // x of all blocks, then y, then z

components u{{{0, 0, 0, 0.4, 0.06, -0.24, 0}, {0, 0, 0, -0.3, 0.08, 0.32, 0}, {0, 0, 0.05, 0, 0, 0, 0.1}}};
components v{{{0.72, -1.6, 1.8}, {0.96, 1.2, 2.4}, {}}};
components v_previous, force, impulse;
std::array<double, count> inverse_mass, friction_work;
std::array<std::array<double, count>, ILAW_ENERGY_COUNT> energy;
std::array<std::uint8_t, count> status;

void sum_forces() {
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < count; ++i) force[c][i] = mass[i] * gravity[c] - stiffness[i] * u[c][i];
}

void kick(double duration) {
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < count; ++i) v[c][i] += duration * inverse_mass[i] * force[c][i];
}

ilaw::interface create_interface(const char* library_name) {
  ilaw_argument friction{}, activation{};
  friction.struct_size = activation.struct_size = sizeof(ilaw_argument);
  friction.name = "friction";
  friction.number = 0.3;
  activation.name = "activation";
  activation.kind = ILAW_KIND_VALUE_TEXT;
  activation.text = "predictive";
  const std::array<const ilaw_argument*, 2> arguments{&friction, &activation};
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  setup.arguments = arguments.data();
  setup.argument_count = arguments.size();
  return {ilaw::library(library_name), "", setup};  // the interface keeps the library loaded
}

// An array with components first: the node stride is 1, the component stride the number of nodes.
ilaw_input input_of(const components& a) { return ilaw::input(a.front().data(), 1, count); }
template <std::size_t N>
ilaw_output output_of(std::array<std::array<double, count>, N>& a) {
  return ilaw::output(a.front().data(), 1, count);
}

ilaw_batch describe_batch(const ilaw_instance_info& info, std::vector<double>& state) {
  constexpr std::uint32_t given = ILAW_INPUT_GAP | ILAW_INPUT_V_PREVIOUS | ILAW_INPUT_NORMAL;
  if ((info.inputs | info.balance_inputs) & ~given)
    throw std::runtime_error("the law reads an input that this code does not have");
  const auto state_size = static_cast<std::int64_t>(info.state_size);
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = floor_nodes.size();
  batch.index = floor_nodes.data();  // the arrays below are the solver's own, over all its nodes
  batch.position_step = h;
  batch.v_free = input_of(v);
  batch.delassus = ilaw::input(inverse_mass.data(), 1, 0);
  batch.gap = ilaw::input(u[2].data(), 1, 0);  // height over the floor: a component of u, in place
  batch.v_previous = input_of(v_previous);
  batch.normal = ilaw::input(up.data(), 0, 1);  // the same at every node
  batch.state_in = ilaw::input(state.data(), state_size, 1);
  batch.state_out = ilaw::output(state.data(), state_size, 1);
  batch.impulse = output_of(impulse);
  batch.energy = output_of(energy);
  batch.status = status.data();
  batch.status_stride = 1;
  return batch;
}

// A kick by all forces, then the impulse of the law. impulse and energy stay 0 outside floor_nodes.
void kick_with_law(const ilaw::interface& interface, ilaw_batch& batch, double time, double duration) {
  sum_forces();
  v_previous = v;
  kick(duration);  // v is v_free now

  ilaw_report report{};
  report.struct_size = sizeof report;
  batch.time = time;
  batch.velocity_step = duration;
  if (interface.evaluate(batch, &report) != ILAW_OK) throw std::runtime_error(report.reason);

  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < count; ++i) v[c][i] += inverse_mass[i] * impulse[c][i];
  for (std::size_t i = 0; i < count; ++i) friction_work[i] += energy[ILAW_ENERGY_FRICTION][i];
}

void run(const char* library_name) {
  const ilaw::interface interface = create_interface(library_name);
  const ilaw_instance_info info = interface.info();
  std::vector<double> state(count * info.state_size);
  for (std::size_t i = 0; i < count; ++i) inverse_mass[i] = 1.0 / mass[i];

  ilaw_batch batch = describe_batch(info, state);
  if (interface.initialise(batch) != ILAW_OK) throw std::runtime_error("initialise refused");
  kick_with_law(interface, batch, 0.0, 0.5 * h);  // V_1/2
  for (int n = 0; n < steps; ++n) {
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < count; ++i) u[c][i] += h * v[c][i];
    kick_with_law(interface, batch, (n + 1) * h, h);
  }
  for (std::size_t i = 0; i < count; ++i)
    std::printf("%2zu %24.16E %24.16E %24.16E %24.16E %2d\n", i, u[0][i], u[1][i], u[2][i], friction_work[i],
                status[i]);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw std::runtime_error("usage: blocks_cpp LIBRARY");
    run(argv[1]);
  } catch (const std::exception& refused) {
    std::fprintf(stderr, "blocks_cpp: %s\n", refused.what());
    return 1;
  }
}
