// No bond puts energy in, and what it reports is its work: where it is made on a node that moves, with
// velocities before and free that have nothing to do with each other, and after that; with an H of any form,
// and where the steps of velocity and position differ.
#include "laws/random_nodes.hpp"

#include "support/sizes.hpp"

namespace ilaw::testing {
namespace {

constexpr int draws = 400000;  // a quarter of them by default
constexpr std::size_t count = 200;
constexpr double allowed = 8.0;  // ulp of the terms of the balance

double decades(Random& draw, double low, double high) { return std::pow(10.0, draw(low, high)); }

// Bonds of all shapes, from soft to rigid, with a toughness that mostly leaves one solution.
Parameters any_bond(Random& draw) {
  const char* shapes[] = {"bilinear", "exponential", "camacho_ortiz"};
  const std::string shape = shapes[static_cast<int>(draw(0.0, 3.0))];
  const double strength = decades(draw, -1.0, 6.0), strength_2 = strength * decades(draw, -1.0, 1.0);
  const bool rigid = shape == "camacho_ortiz" || draw(0.0, 1.0) < 0.3;
  const double stiffness = rigid ? inf_value : decades(draw, -2.0, 12.0);
  const auto toughness = [&](double peak) {
    const double stretched = decades(draw, -1.0, 4.0) * RandomNodes::step * RandomNodes::step;
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
    p.numbers.insert({{"delay_time", decades(draw, -1.0, 2.0) * RandomNodes::step},
                      {"delay_exponent", decades(draw, -1.0, 2.0)}});
  return p;
}

// Each entry beside the diagonal up to 0.9 of what it may be.
void couple(Matrix& m, std::size_t dimension, Random& draw) {
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
  Random& draw = nodes.uniform;
  nodes.draw();
  run.initialise();
  for (std::size_t i = 0; i < count; ++i) {
    const double before = decades(draw, -2.0, 1.0);
    for (std::size_t c = 0; c < 3; ++c) {
      nodes.v_free[i][c] = c < nodes.dimension ? draw() : 0.0;
      nodes.v_previous[i][c] = c < nodes.dimension ? before * draw() : 0.0;
    }
    if (nodes.form == ILAW_DELASSUS_FULL && nodes.dimension > 1) couple(nodes.h[i], nodes.dimension, draw);
    if (draw(0.0, 1.0) < 0.3) run.set("damage", i, draw(0.05, 0.95));
  }
}

struct Seen {
  std::size_t done = 0, solved = 0, turned = 0, pressed = 0, slowed = 0, broken = 0, uneven = 0;
};

// Sum of the sizes of all terms of v_free + H r, to which the rounding of v is relative.
double natural_velocity(const RandomNodes& nodes, const Runner& run, std::size_t i) {
  double sum = 0.0;
  for (std::size_t a = 0; a < nodes.dimension; ++a) {
    sum += std::abs(nodes.v_free[i][a]);
    for (std::size_t b = 0; b < nodes.dimension; ++b) sum += std::abs(nodes.h[i][a][b] * run.r[i][b]);
  }
  return sum;
}

// Before a step: the energy stored, and the natural velocity of the step before, whose rounding the position
// has.
struct Before {
  double stored = 0.0, velocity = 0.0;
};

// Energy balance of node i in the step: a sum that is to be 0, and the size that its rounding is relative to.
struct Balance {
  double sum, size;
};
Balance balance_of(const RandomNodes& nodes, const Runner& run, std::size_t i, const Before& last) {
  const auto length_of = [&](const std::array<const char*, 3>& names) {
    return std::hypot(run.named(names[0], i), run.named(names[1], i), run.named(names[2], i));
  };
  const double position = length_of({"opening", "slip_1", "slip_2"}),
               mean = length_of({"mean_opening", "mean_slip_1", "mean_slip_2"});
  const double motion = (position + mean) / run.velocity_step + natural_velocity(nodes, run, i);
  const double stored = last.stored + run.energy[i][ILAW_ENERGY_STORED];
  double sum = -last.stored, size = stored;
  for (std::size_t a = 0; a < nodes.dimension; ++a) {
    sum += 0.5 * run.r[i][a] * (nodes.v_previous[i][a] + run.v[i][a]);
    size += std::abs(run.r[i][a]) * (std::abs(nodes.v_previous[i][a]) + motion);
  }
  for (const double part : run.energy[i]) sum += part;
  // The bond's own impulse, which contact may have taken away.
  if (mean > 0.0) size += 2.0 * stored / mean * run.velocity_step * last.velocity;
  return {sum, size};
}

// The violation at node i, if any.
std::optional<std::string> judge(const RandomNodes& nodes, const Runner& run, std::size_t i,
                                 const Before& last, Seen& seen) {
  for (const double part : run.energy[i])
    if (part < 0.0) return "a part of the energy is negative";
  const auto [sum, size] = balance_of(nodes, run, i, last);
  ++seen.solved;
  seen.turned += dot(nodes.v_previous[i], nodes.v_free[i]) < 0.0;
  seen.pressed += run.r[i][0] > 0.0;
  seen.slowed += run.energy[i][ILAW_ENERGY_IMPACT] > 1e-6 * size;
  seen.broken += run.status[i] == ILAW_BROKEN;
  seen.uneven += run.velocity_step != run.position_step;
  if (std::abs(sum) <= allowed * ulp * size) return std::nullopt;
  return (sum > 0.0 ? "puts energy in: " : "its parts are not the work: ") +
         std::to_string(sum / (ulp * size)) + " ulp of " + std::to_string(size);
}

// Follows the nodes for so many steps; a node that was refused, for it has several solutions, is left out.
std::optional<std::string> follow(RandomNodes& nodes, Runner& run, int steps, Seen& seen) {
  std::vector<Before> last(count);
  std::vector<bool> refused(count, false);
  for (int k = 0; k < steps; ++k) {
    const std::int32_t code = run.evaluate();
    if (code != ILAW_OK && code != ILAW_BAD_NODES) return "is not evaluated";
    for (std::size_t i = 0; i < count; ++i) {
      ++seen.done;
      refused[i] = refused[i] || run.status[i] == ILAW_BAD_INPUT;
      if (refused[i]) continue;
      const std::optional<std::string> wrong = judge(nodes, run, i, last[i], seen);
      if (wrong) return *wrong + ", step " + std::to_string(k) + ", node " + std::to_string(i);
      last[i] = {run.energy[i][ILAW_ENERGY_STORED], natural_velocity(nodes, run, i)};
    }
    const double position_step = run.position_step;
    if (nodes.uniform() < 0.5) run.position_step *= decades(nodes.uniform, -1.0, 1.0);
    run.velocity_step = 0.5 * (position_step + run.position_step);
    const double kick = decades(nodes.uniform, -2.0, 0.5);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t c = 0; c < nodes.dimension; ++c) {
        nodes.v_previous[i][c] = run.v[i][c];
        nodes.v_free[i][c] = run.v[i][c] + kick * nodes.uniform();
      }
  }
  return std::nullopt;
}

// Bonds of all kinds at nodes of all forms and dimensions.
Seen expect_no_energy(int steps) {
  Seen seen;
  std::optional<std::string> wrong;
  const auto wanted = static_cast<std::size_t>(part_of(draws));
  for (unsigned seed = 1; seen.done < wanted && !wrong; ++seed)
    for (const std::uint32_t form :
         {std::uint32_t{ILAW_DELASSUS_SCALAR}, std::uint32_t{ILAW_DELASSUS_DIAGONAL},
          std::uint32_t{ILAW_DELASSUS_FULL}, std::uint32_t{ILAW_DELASSUS_TRANSVERSE}})
      for (std::uint32_t dimension = 1; dimension <= 3 && !wrong; ++dimension) {
        RandomNodes nodes(count, dimension, form, Inertia::any, 1000 * seed + 10 * form + dimension);
        Runner run("cohesive", any_bond(nodes.uniform), nodes);
        if (seed % 3 > 0) run.velocity_step *= decades(nodes.uniform, -1.0, 1.0);
        draw_nodes(nodes, run);
        wrong = follow(nodes, run, steps, seen);
        if (wrong)
          *wrong += ", seed " + std::to_string(seed) + ", form " + std::to_string(form) + ", " +
                    std::to_string(dimension) + "D";
      }
  EXPECT_FALSE(wrong) << *wrong;
  EXPECT_GT(seen.solved, seen.done / 10 * 9);
  EXPECT_GT(seen.turned, seen.done / 10);
  EXPECT_GT(seen.pressed, seen.done / 10);
  EXPECT_GT(seen.slowed, seen.done / 20);
  EXPECT_GT(seen.broken, seen.done / 100);
  EXPECT_GT(seen.uneven, seen.done / 4);
  return seen;
}

TEST(CohesiveEnergy, IsNotPutInWhereABondIsMade) {
  const Seen seen = expect_no_energy(1);
  EXPECT_GT(seen.turned, seen.done / 3);
}

// With w^+ = h (s v^- + v)/2, s is the least in [0, 1] with which r.v^- is not positive: 0, or the work on
// v^- is 0, or s is 1.
TEST(CohesiveEnergy, IsLeftAsItIsByTheLeastChange) {
  int whole = 0, part = 0, none = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    RandomNodes nodes(count, 3, ILAW_DELASSUS_FULL, Inertia::any, seed);
    const double step = RandomNodes::step, stiffness = decades(nodes.uniform, 4.0, 9.0);
    Runner run("cohesive", {{{"strength", inf_value}, {"toughness", 1.0}, {"stiffness", stiffness}}, {}},
               nodes);
    draw_nodes(nodes, run);
    ASSERT_EQ(run.evaluate(), ILAW_OK);
    for (std::size_t i = 0; i < count; ++i) {
      const Vector &r = run.r[i], &v = run.v[i], &u = nodes.v_previous[i];
      const Vector w{run.named("mean_opening", i), run.named("mean_slip_1", i), run.named("mean_slip_2", i)};
      const double pull = 0.5 * step * nodes.area[i] * stiffness;
      if (std::abs(r[0] + pull * w[0]) > 1e-6 * std::abs(r[0])) continue;  // contact
      double s = 0.0;
      for (std::size_t c = 0; c < 3; ++c) s += (2.0 / step * w[c] - v[c]) * u[c] / dot(u, u);
      const double work = dot(r, u) / std::sqrt(dot(r, r) * dot(u, u));
      ASSERT_GE(s, -1e-9) << "seed " << seed << ", node " << i;
      ASSERT_LE(s, 1.0 + 1e-9) << "seed " << seed << ", node " << i;
      if (s < 1.0 - 1e-9) {
        ASSERT_LE(work, 1e-9) << "seed " << seed << ", node " << i;
      }
      if (s > 1e-9) {
        ASSERT_GE(work, -1e-9) << "seed " << seed << ", node " << i;
      }
      ++(s <= 1e-9 ? none : s < 1.0 - 1e-9 ? part : whole);
    }
  }
  EXPECT_GT(none, 1000);
  EXPECT_GT(part, 500);
  EXPECT_GT(whole, 500);
}

TEST(CohesiveEnergy, IsNotPutInWhereStepsVary) { expect_no_energy(8); }

}  // namespace
}  // namespace ilaw::testing
