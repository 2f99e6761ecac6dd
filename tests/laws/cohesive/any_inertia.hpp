// any_inertia.hpp - bonds that have been opened, on nodes of any inertia, and the curves of cohesive.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/law_runner.hpp"

namespace ilaw::testing {

inline constexpr const char* several_solutions =
    "the law's equations have several solutions for this H and step: a smaller step is needed";

// Bonds at random.
struct Draw : Random {
  using Random::Random;

  // Any bond: of any shape, rigid or not, with its mixed mode, friction and delay.
  Parameters bond() {
    const bool is_delayed = between(0.0, 1.0) < 0.2;
    const char* shapes[] = {"bilinear", "exponential", "camacho_ortiz"};
    const std::string shape = shapes[static_cast<int>(between(0.0, is_delayed ? 2.0 : 3.0))];
    const double strength = between(0.5, 2.0), strength_2 = between(0.5, 4.0), toughness = between(0.5, 2.0);
    Parameters p{{{"strength", strength}, {"strength_2", strength_2}, {"toughness", toughness}},
                 {{"shape", shape}}};
    p.numbers["friction"] = between(0.0, 1.0) < 0.3 ? 0.0 : between(0.0, 1.5);
    if (shape != "camacho_ortiz") {
      p.numbers["toughness_2"] = between(0.5, 4.0);
      p.numbers["mixing_exponent"] = between(0.3, 3.0);
      if (is_delayed || between(0.0, 1.0) < 0.7) p.numbers["stiffness"] = decades(1.5, 9.0);
    }
    if (is_delayed)
      p.numbers.insert({{"delay_time", decades(-2.0, 1.0)}, {"delay_exponent", decades(-1.0, 2.0)}});
    return p;
  }
};

inline double norm(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }

// Q diag Q^T with a condition of up to 10^decades, then scaled by axis; and what that makes of the condition.
struct Inertia {
  Matrix h{};
  double condition;

  Inertia(Draw& draw, double decades) {
    Matrix q{};
    for (Vector& axis : q) axis = draw.vector(1.0);
    for (std::size_t i = 0; i < 3; ++i)
      for (int pass = 0; pass < 2; ++pass) {
        for (std::size_t j = 0; j < i; ++j) {
          const double along = dot(q[i], q[j]);
          for (std::size_t c = 0; c < 3; ++c) q[i][c] -= along * q[j][c];
        }
        const double size = norm(q[i]);
        for (double& component : q[i]) component /= size;
      }
    const double part = draw.between(0.0, 0.7);
    const Vector value{1.0, draw.decades(-part * decades, 0.0), draw.decades(-part * decades, 0.0)};
    const double across = draw.decades(-0.15 * decades, 0.15 * decades);
    const Vector scale{1.0, across, across};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k) h[i][j] += scale[i] * scale[j] * value[k] * q[k][i] * q[k][j];
    condition = std::pow(10.0, decades);
  }
  std::array<double, 6> entries() const { return {h[0][0], h[1][1], h[2][2], h[0][1], h[0][2], h[1][2]}; }
};

// The curves of the page, written anew.
struct Curve {
  explicit Curve(const Parameters& p) {
    const auto number = [&p](const char* name, double otherwise) {
      const auto found = p.numbers.find(name);
      return found == p.numbers.end() ? otherwise : found->second;
    };
    shape = p.texts.at("shape");
    s1 = number("strength", 0.0);
    s2 = number("strength_2", s1);
    g1 = number("toughness", 0.0);
    g2 = number("toughness_2", g1);
    eta = number("mixing_exponent", 1.0);
    flexibility = 1.0 / number("stiffness", inf_value);
    friction = number("friction", 0.0);
    delay = number("delay_time", 0.0);
    a = number("delay_exponent", 1.0);
    weight = shape == "camacho_ortiz" ? s2 / s1 : 1.0;
  }

  struct Mode {
    double strength, onset, width;
  };
  Mode mode(double shear) const {
    const double part = shape == "camacho_ortiz" || shear == 0.0 ? 0.0 : std::pow(shear, eta);
    const auto between = [part](double one,
                                double two) {  // nothing is left of a difference where one is tiny
      return part > 0.5 ? two + (1.0 - part) * (one - two) : one + part * (two - one);
    };
    const double strength = std::sqrt(between(s1 * s1, s2 * s2)), onset = strength * flexibility;
    const double full = shape == "exponential" ? 0.125 - std::exp(-8.0) / -std::expm1(-8.0) : 0.5;
    return {strength, onset, (between(g1, g2) / strength - 0.5 * onset) / full};
  }
  double traction(const Mode& m, double y) const {
    const double p = std::clamp((y - m.onset) / m.width, 0.0, 1.0);
    return m.strength *
           (shape == "exponential" ? (std::exp(-8.0 * p) - std::exp(-8.0)) / -std::expm1(-8.0) : 1.0 - p);
  }
  // b of the page.
  double softness() const {
    const Mode opened = mode(0.0), sheared = mode(1.0);
    return std::max(opened.width / opened.strength, sheared.width / sheared.strength / 1024.0);
  }
  // Damage of a bond whose mode I alone would call it so much.
  double spent(double alone) const {
    const Mode opened = mode(0.0);
    const double k = (1.0 - alone) / (flexibility + alone * opened.width / opened.strength);
    return (1.0 - k * flexibility) / (1.0 + k * softness());
  }
  double secant(double damage) const { return (1.0 - damage) / (flexibility + damage * softness()); }
  double damage_of(double y, double traction) const {
    return (y - flexibility * traction) / (y + softness() * traction);
  }
  double size(const Vector& w) const { return std::hypot(w[0], weight * w[1], weight * w[2]); }
  double shear(const Vector& w) const {
    const double t = std::hypot(w[1], w[2]), all = norm(w);
    return all > 0.0 ? std::min(1.0, t * t / (all * all)) : 0.0;
  }

  // Mean of min(k y, T(y)) between two openings: Gauss's rule between the kinks.
  double mean(const Mode& m, double k, double start, double end) const {
    const double from = std::min(start, end), to = std::max(start, end);
    const auto pull = [&](double y) { return std::min(k * y, traction(m, y)); };
    if (to - from < 1e-9 * to) return pull(0.5 * (from + to));
    double low = 0.0, high = m.onset + m.width;  // where the secant meets the curve
    for (int n = 0; n < 64; ++n)
      (k * 0.5 * (low + high) < traction(m, 0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    std::vector<double> ends{from};
    for (const double kink : {high, m.onset + m.width})
      if (kink > ends.back() && kink < to) ends.push_back(kink);
    ends.push_back(to);
    constexpr double points[] = {0.0, 0.5384693101056831, 0.9061798459386640},
                     weights[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    double sum = 0.0;
    for (std::size_t part = 0; part + 1 < ends.size(); ++part) {
      constexpr int pieces = 64;
      const double h = 0.5 * (ends[part + 1] - ends[part]) / pieces;
      for (int n = 0; n < pieces; ++n) {
        const double middle = ends[part] + (2 * n + 1) * h;
        sum += h * weights[0] * pull(middle);
        for (int q = 1; q < 3; ++q)
          sum += h * weights[q] * (pull(middle - h * points[q]) + pull(middle + h * points[q]));
      }
    }
    return sum / (to - from);
  }

  // Allix and Deu's damage after a step.
  double delayed(double damage, double step, const Vector& w) const {
    const Mode m = mode(shear(w));
    const double y = size(w), p = (y - m.onset) / m.width;
    const double target = p <= 0.0 ? 0.0 : p < 1.0 ? damage_of(y, traction(m, y)) : p;
    if (target <= damage) return damage;
    const double grown =
        target - std::log1p(std::expm1(a * (target - damage)) * std::exp(-a * step / delay)) / a;
    return std::clamp(std::isfinite(grown) ? grown : damage + step / delay, damage, 1.0);
  }

  // Where the secant meets the curve of mode I: what the bond has been opened to at least once.
  double meets(double damage) const {
    const Mode m = mode(0.0);
    double low = 0.0, high = m.onset + m.width;
    for (int n = 0; n < 100; ++n)
      (secant(damage) * 0.5 * (low + high) < traction(m, 0.5 * (low + high)) ? low : high) =
          0.5 * (low + high);
    return low;
  }
  // Whether the bond holds there without more damage.
  bool holds(double damage, const Vector& w) const {
    return delay == 0.0 && secant(damage) * size(w) <= traction(mode(shear(w)), size(w));
  }

  // Mean stiffness of the step that leads from one opening to another.
  double stiffness(double damage, double step, const Vector& before, const Vector& after) const {
    if (delay > 0.0) return 0.5 * (secant(damage) + secant(delayed(damage, step, after)));
    const double from = size(before), to = size(after);
    return 2.0 * mean(mode(shear(after)), secant(damage), from, to) / (from + to);
  }

  std::string shape;
  double s1, s2, g1, g2, eta, flexibility, friction, delay, a, weight;
};

// A bond that has been opened before, and an inertia.
struct Problem {
  Problem(Draw& draw, const Curve& of, double decades)
      : inertia(draw, decades), curve(of), step(draw.decades(-3.0, -1.0)) {
    const double last = draw.between(0.0, 1.0) < 0.3 ? draw.between(0.7, 1.4) * step : step;
    velocity_step = 0.5 * (last + step);
    damage = curve.spent(draw.between(0.05, 0.95));
    const double reach =
        0.6 * curve.meets(damage) * std::min(curve.s2 / curve.s1, 1.0) / std::max(curve.weight, 1.0);
    opening = draw.vector(reach);
    opening[0] = std::abs(opening[0]);
    if (draw.between(0.0, 1.0) < 0.3) opening[0] = 0.0;
    position = opening;
    const Vector moved = draw.vector(0.1 * reach);
    for (std::size_t c = opening[0] > 0.0 ? 0 : 1; c < 3; ++c) position[c] += moved[c];
    position[0] = std::clamp(position[0], 0.0, 2.0 * opening[0]);  // so that the one before was not negative
    for (std::size_t c = 0; c < 3; ++c) v_previous[c] = 2.0 * (position[c] - opening[c]) / last;
    const Vector kick = draw.vector(draw.decades(-1.0, 0.5) * reach / step);
    for (std::size_t c = 0; c < 3; ++c) v_free[c] = v_previous[c] + kick[c];
  }

  std::int32_t solve(NodeRun& node) const {
    node.h = inertia.entries();
    node.state = {damage, position[0], position[1], position[2], opening[0], opening[1], opening[2]};
    node.v_previous = v_previous;
    node.dt = velocity_step;
    node.position_dt = step;
    return node.step(v_free);
  }

  Inertia inertia;
  Curve curve;
  double step, velocity_step, damage;
  Vector opening, position, v_previous, v_free;
};

// The violation in a solution, if any; pressed: whether there was contact.
inline std::optional<std::string> judge(const Problem& p, const NodeRun& node, bool& pressed) {
  const Matrix& h = p.inertia.h;
  const Vector h_r = times(h, node.r);
  Vector after{}, sum{}, v{}, bond{}, contact{};
  for (std::size_t c = 0; c < 3; ++c) {
    v[c] = p.v_free[c] + h_r[c];
    after[c] = p.opening[c] + 0.5 * p.velocity_step * (p.v_previous[c] + v[c]);
    sum[c] = after[c] + p.opening[c];
  }
  const double k = p.curve.holds(p.damage, after) ? p.curve.secant(p.damage)
                                                  : p.curve.stiffness(p.damage, p.step, p.opening, after);
  for (std::size_t c = 0; c < 3; ++c) {
    const double weight = c == 0 ? 1.0 : p.curve.weight * p.curve.weight;
    bond[c] = -0.5 * p.velocity_step * k * weight * sum[c];
    contact[c] = node.r[c] - bond[c];
  }
  // r is right to the condition; the opening, which it moves by h H r/2, as well; and so the traction.
  const double smallest = 1.0 / p.inertia.condition * (h[0][0] + h[1][1] + h[2][2]);
  const double size = norm(p.v_free) + norm(h_r) + (norm(p.position) + norm(p.opening)) / p.step;
  const double impulse = 64 * ulp * (size / smallest + 0.5 * p.step * k * p.step * size);
  const double speed = 64 * ulp * p.inertia.condition * size;
  const auto say = [&](const char* what, double found, double allowed) {
    return std::string(what) + ": " + std::to_string(found / allowed) + " of what is allowed";
  };
  pressed = node.r[0] - bond[0] > impulse;
  const double next = p.position[0] + p.step * v[0];  // or as far as the node was leaving
  const double ground = std::min(0.0, p.position[0] - p.step * p.v_previous[0]);
  if (!pressed) {
    if (next < ground - p.step * speed) return say("goes in", ground - next, p.step * speed);
    if (norm(contact) > 4.0 * impulse) return say("not the bond's impulse", norm(contact), impulse);
    return std::nullopt;
  }
  const double damage = 0.5 * (p.damage + node.named("damage"));
  const double limit = p.curve.friction * damage * contact[0], slip = std::hypot(v[1], v[2]);
  if (std::hypot(contact[1], contact[2]) > limit + impulse)
    return say("beyond the cone", std::hypot(contact[1], contact[2]) - limit, impulse);
  double work = 0.0;
  for (std::size_t c = 0; c < 3; ++c) work += contact[c] * (p.v_previous[c] + v[c]);
  const double rounding =
      impulse * (slip + speed) + speed * (limit + contact[0]) + impulse * norm(p.v_previous);
  if (work > rounding) return say("contact puts energy in", work, rounding);
  if (work > -rounding) return std::nullopt;  // all of what does no positive work
  if (std::abs(next - ground) > p.step * speed && std::abs(next) > p.step * speed)
    return say("pressed and not closed", next, p.step * speed);
  if (std::hypot(contact[1], contact[2]) <= impulse) return std::nullopt;  // no friction does none either
  const double along = contact[1] * v[1] + contact[2] * v[2];
  if (std::abs(along + limit * slip) > rounding)
    return say("not most dissipation", along + limit * slip, rounding);
  return std::nullopt;
}

// The work of the impulse is what was dissipated and stored.
inline void keep_energy(const Problem& p, const NodeRun& node) {
  const double y = p.curve.size(p.opening), stored = 0.5 * p.curve.secant(p.damage) * y * y;
  const Vector h_r = times(p.inertia.h, node.r);
  double balance = node.energy[ILAW_ENERGY_STORED] - stored, scale = stored + node.energy[ILAW_ENERGY_STORED];
  for (std::size_t c = 0; c < 3; ++c) {
    balance += node.energy[c] + 0.5 * node.r[c] * (p.v_previous[c] + node.v[c]);
    scale += norm(node.r) * (std::abs(p.v_previous[c]) + std::abs(p.v_free[c]) + norm(h_r));
  }
  ASSERT_LE(std::abs(balance), 64 * ulp * p.inertia.condition * scale);
}

// Random problems, 30 of each bond, judged by the equations of the page; and what came of them.
struct SolvedProblems {
  int count = 0, several = 0, pressed = 0, softened = 0, held = 0, broken = 0;

  template <class DrawnBond, class DrawnProblem>
  void solve(unsigned seed, DrawnBond drawn_bond, DrawnProblem drawn_problem) {
    Draw draw(seed);
    std::optional<Curve> curve;
    std::optional<NodeRun> node;
    const char* given = std::getenv("ILAW_TEST_STEPS");  // for a run of a million
    const int wanted = given ? std::atoi(given) : 6000;
    for (; count < wanted && !::testing::Test::HasFailure(); ++count) {
      if (count % 30 == 0) {
        const Parameters parameters = drawn_bond(draw);
        curve.emplace(parameters);
        node.emplace("cohesive", parameters, 1.0, ILAW_DELASSUS_FULL);
      }
      SCOPED_TRACE(::testing::Message()
                   << "seed " << seed << ", problem " << count << ", shape " << curve->shape << ", strengths "
                   << curve->s1 << " and " << curve->s2 << ", delay " << curve->delay);
      solve(drawn_problem(draw, *curve), *node);
    }
  }
  void expect_variety() const {
    EXPECT_GT(pressed, count / 20);
    EXPECT_GT(softened, count / 20);
    EXPECT_GT(held, count / 20);
    EXPECT_GT(broken, count / 200);
    EXPECT_LT(several, count / 50);
  }

 private:
  void solve(const Problem& p, NodeRun& node) {
    const std::int32_t code = p.solve(node);
    if (code == ILAW_BAD_NODES) {
      ASSERT_STREQ(node.report.reason, several_solutions);
      ++several;
      return;
    }
    ASSERT_EQ(code, ILAW_OK);
    bool is_pressed = false;
    const std::optional<std::string> wrong = judge(p, node, is_pressed);
    ASSERT_FALSE(wrong) << *wrong << ", condition " << p.inertia.condition;
    ASSERT_GE(node.energy[ILAW_ENERGY_RUPTURE], 0.0);
    keep_energy(p, node);
    pressed += is_pressed;
    softened += node.named("damage") > p.damage;
    held += node.named("damage") == p.damage;
    broken += node.status == ILAW_BROKEN;
  }
};

}  // namespace ilaw::testing
