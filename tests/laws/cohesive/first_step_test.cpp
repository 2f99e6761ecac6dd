// The step in which a bond is made, on a node that moves: with an H of any form, velocities before and free
// that have nothing to do with each other, and steps of velocity and position that differ, no bond puts
// energy in, and what it reports is its work.
#include "laws/random_nodes.hpp"

#include "support/numbers.hpp"
#include "support/sizes.hpp"

#include <algorithm>
#include <optional>

namespace ilaw::testing {
namespace {

constexpr int draws = 400000;  // a quarter of them by default
constexpr std::size_t count = 200;

double power_of_ten(Uniform& draw, double low, double high) { return std::pow(10.0, draw(low, high)); }

// Of all shapes, from soft to rigid, with a toughness that mostly leaves one solution.
Parameters any_bond(Uniform& draw) {
  const char* shapes[] = {"bilinear", "exponential", "camacho_ortiz"};
  const std::string shape = shapes[static_cast<int>(draw(0.0, 3.0))];
  const double strength = power_of_ten(draw, -1.0, 6.0),
               strength_2 = strength * power_of_ten(draw, -1.0, 1.0);
  const bool rigid = shape == "camacho_ortiz" || draw(0.0, 1.0) < 0.3;
  const double stiffness = rigid ? inf_value : power_of_ten(draw, -2.0, 12.0);
  const auto toughness = [&](double peak) {
    const double stretched = power_of_ten(draw, -1.0, 4.0) * RandomNodes::step * RandomNodes::step;
    return peak * peak * (0.5 / stiffness * draw(1.01, 2.0) + stretched);
  };
  Parameters p{{{"strength", strength}, {"strength_2", strength_2}, {"toughness", toughness(strength)}},
               {{"shape", shape}}};
  if (draw(0.0, 1.0) < 0.7) p.numbers["friction"] = draw(0.0, 1.5);
  if (shape == "camacho_ortiz") return p;
  p.numbers.insert({{"stiffness", stiffness},
                    {"toughness_2", toughness(strength_2)},
                    {"mixing_exponent", draw(0.3, 3.0)}});
  if (!rigid && draw(0.0, 1.0) < 0.2)
    p.numbers.insert({{"delay_time", power_of_ten(draw, -1.0, 2.0) * RandomNodes::step},
                      {"delay_exponent", power_of_ten(draw, -1.0, 2.0)}});
  return p;
}

// Each entry beside the diagonal up to 0.9 of what it may be.
void couple(Matrix& m, std::size_t dimension, Uniform& draw) {
  double c[3] = {}, determinant = 0.0;
  while (determinant < 0.01) {
    for (double& each : c) each = draw(-0.9, 0.9);
    if (dimension == 2) c[1] = c[2] = 0.0;
    determinant = 1.0 - c[0] * c[0] - c[1] * c[1] - c[2] * c[2] + 2.0 * c[0] * c[1] * c[2];
  }
  for (const auto [i, j, k] : {std::array<std::size_t, 3>{0, 1, 0}, {0, 2, 1}, {1, 2, 2}})
    m[i][j] = m[j][i] = c[k] * std::sqrt(m[i][i] * m[j][j]);
}

void draw_nodes(RandomNodes& nodes, Runner& run) {
  Uniform& draw = nodes.uniform;
  nodes.draw();
  run.initialise();
  for (std::size_t i = 0; i < count; ++i) {
    const double before = power_of_ten(draw, -2.0, 1.0);
    for (std::size_t c = 0; c < 3; ++c) {
      nodes.v_free[i][c] = c < nodes.dimension ? draw() : 0.0;
      nodes.v_previous[i][c] = c < nodes.dimension ? before * draw() : 0.0;
    }
    if (nodes.form == ILAW_DELASSUS_FULL && nodes.dimension > 1) couple(nodes.h[i], nodes.dimension, draw);
    if (draw(0.0, 1.0) < 0.3) run.set("damage", i, draw(0.05, 0.95));
  }
}

struct Seen {
  std::size_t solved = 0, turned = 0, pressed = 0, slowed = 0, broken = 0;
};

// What is wrong with node i.
std::optional<std::string> judge(const RandomNodes& nodes, const Runner& run, std::size_t i, Seen& seen) {
  const Vector &r = run.r[i], &v = run.v[i], &before = nodes.v_previous[i];
  double work = 0.0, size = 0.0, along = 0.0;
  for (std::size_t a = 0; a < nodes.dimension; ++a) {
    work += 0.5 * r[a] * (before[a] + v[a]);
    along += before[a] * nodes.v_free[i][a];
    double natural = std::abs(before[a]) + std::abs(nodes.v_free[i][a]);
    for (std::size_t b = 0; b < nodes.dimension; ++b) natural += std::abs(nodes.h[i][a][b] * r[b]);
    size += std::abs(r[a]) * natural;
  }
  double balance = work;
  for (const double part : run.energy[i]) {
    if (part < 0.0) return "a part of the energy is negative";
    balance += part;
  }
  ++seen.solved;
  seen.turned += along < 0.0;
  seen.pressed += r[0] > 0.0;
  seen.slowed += run.energy[i][ILAW_ENERGY_IMPACT] > 1e-6 * size;
  seen.broken += run.status[i] == ILAW_BROKEN;
  if (std::abs(balance) <= 16 * ulp * size) return std::nullopt;
  return (balance > 0.0 ? "puts energy in: " : "its parts are not the work: ") +
         std::to_string(balance / (ulp * size)) + " ulp of " + std::to_string(size);
}

TEST(CohesiveFirstStep, PutsNoEnergyIn) {
  Seen seen;
  std::size_t done = 0;
  std::optional<std::string> wrong;
  const auto wanted = static_cast<std::size_t>(part_of(draws));
  for (unsigned seed = 1; done < wanted && !wrong; ++seed)
    for (const std::uint32_t form :
         {std::uint32_t{ILAW_DELASSUS_SCALAR}, std::uint32_t{ILAW_DELASSUS_DIAGONAL},
          std::uint32_t{ILAW_DELASSUS_FULL}, std::uint32_t{ILAW_DELASSUS_TRANSVERSE}})
      for (std::uint32_t dimension = 1; dimension <= 3 && !wrong; ++dimension) {
        RandomNodes nodes(count, dimension, form, Inertia::any, 1000 * seed + 10 * form + dimension);
        Runner run("cohesive", any_bond(nodes.uniform), nodes);
        if (seed % 3 > 0) run.velocity_step *= power_of_ten(nodes.uniform, -1.0, 1.0);
        draw_nodes(nodes, run);
        const std::int32_t code = run.evaluate();
        ASSERT_TRUE(code == ILAW_OK || code == ILAW_BAD_NODES);
        for (std::size_t i = 0; i < count && !wrong; ++i) {
          if (run.status[i] == ILAW_BAD_INPUT) continue;  // several solutions
          wrong = judge(nodes, run, i, seen);
          if (wrong)
            *wrong += ", seed " + std::to_string(seed) + ", node " + std::to_string(i) + ", form " +
                      std::to_string(form) + ", " + std::to_string(dimension) + "D";
        }
        done += count;
      }
  EXPECT_FALSE(wrong) << *wrong;
  EXPECT_GT(seen.solved, done / 10 * 9);
  EXPECT_GT(seen.turned, done / 3);
  EXPECT_GT(seen.pressed, done / 10);
  EXPECT_GT(seen.slowed, done / 10);
  EXPECT_GT(seen.broken, done / 100);
}

}  // namespace
}  // namespace ilaw::testing
