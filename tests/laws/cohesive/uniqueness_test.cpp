// Steps of cohesive zones that have several solutions: said by the node, found here by hand and by a dense
// search.
#include "any_inertia.hpp"

namespace ilaw::testing {
namespace {

// A bilinear bond in one direction, by hand: y opens where q(y) = (y - f)(y + f - D) + 2 c E(y) = 0, with E
// the area below min(k t, T(t)) from f, the opening before, to y. It holds up to y = z, where the secant
// meets the curve. Between z and the end, and beyond, q is quadratic.
struct OneDirection {
  double strength, onset, width, secant, f, z, c, drive;

  double end() const { return onset + width; }
  double area(double y) const {
    const double reached = std::min(y, end()), slope = strength / width;
    const double at_z = std::isfinite(secant) ? 0.5 * secant * (z * z - f * f) : 0.0;
    return at_z + 0.5 * slope * (reached - z) * (2.0 * end() - z - reached);
  }
  double q(double y) const { return (y - f) * (y + f - drive) + 2.0 * c * area(y); }
  // On the way to an opening that it holds.
  double mean_traction(double y) const { return std::isfinite(secant) ? 0.5 * secant * (f + y) : strength; }
  bool holds() const { return drive <= z + f + 2.0 * c * mean_traction(z); }

  // Roots beyond z, if they lie apart.
  std::optional<int> roots() const {
    const double slope = strength / width, scale = drive * drive, e = end();
    const double peak = (0.5 * drive - c * slope * e) / (1.0 - c * slope), beyond = 0.5 * drive;
    if (std::abs(1.0 - c * slope) < 1e-6) return std::nullopt;
    int found = 0;
    const auto count = [&](double low, double high, double turn) {
      std::vector<double> ends{low};
      if (turn > low && turn < high) ends.push_back(turn);
      ends.push_back(high);
      for (std::size_t k = 0; k + 1 < ends.size(); ++k) found += (q(ends[k]) > 0.0) != (q(ends[k + 1]) > 0.0);
    };
    for (const double close : {e, peak, beyond})
      if (close > z && std::abs(q(close)) < 1e-9 * scale) return std::nullopt;
    const double start = z + 1e-9 * e;  // a rigid bond has the root y = f
    count(start, e, peak);
    count(e, std::max(e, 2.0 * drive), beyond);
    return found;
  }
};

// A bilinear bond, and steps of nodes on it that it can hardly hold.
struct BilinearBond {
  BilinearBond(Draw& draw, bool is_rigid)
      : strength(draw.between(0.5, 2.0)),
        width(draw.decades(-1.0, 1.0)),
        onset(is_rigid ? 0.0 : draw.decades(-0.5, 1.0)) {}

  Parameters parameters() const {
    return {{{"strength", strength},
             {"toughness", 0.5 * strength * (onset + width)},
             {"stiffness", onset > 0.0 ? strength / onset : inf_value}},
            {{"shape", "bilinear"}}};
  }
  OneDirection step(Draw& draw, double damage) const {
    const double softness = (onset + damage * width) / strength;
    OneDirection d{};
    d.strength = strength;
    d.onset = onset;
    d.width = width;
    d.secant = softness > 0.0 ? (1.0 - damage) / softness : inf_value;
    d.z = softness > 0.0 ? strength * d.end() / (strength + width * d.secant) : 0.0;
    d.f = draw.between(0.0, 1.0) < 0.3 ? 0.0 : draw.between(0.0, 0.95) * d.z;
    d.c = draw.decades(-0.5, 1.5) * width / strength;
    const double beyond = draw.between(0.0, 1.0) < 0.2 ? -0.05 : draw.decades(-3.0, -0.3);
    d.drive = d.f + (d.z + 2.0 * d.c * d.mean_traction(d.z)) * (1.0 + beyond);
    return d;
  }

  double strength, width, onset;
};

// Where a step has several solutions beyond what holds, the node says so; where it has one, it is found; and
// a bond that can hold holds.
TEST(CohesiveUniqueness, IsSaidInOneDirection) {
  Draw draw(24);
  int several = 0, single = 0, held = 0;
  std::optional<BilinearBond> bond;
  std::optional<NodeRun> run;
  for (int k = 0; k < 10000 && !HasFailure(); ++k) {
    if (k % 50 == 0) {
      bond.emplace(draw, k % 150 == 0);
      run.emplace("cohesive", bond->parameters(), 0.5);
    }
    const double damage = draw.between(0.0, 1.0) < 0.5 ? 0.0 : draw.between(0.02, 0.9);
    const OneDirection d = bond->step(draw, damage);
    const std::optional<int> roots = d.roots();
    if (!roots) continue;
    NodeRun& node = *run;
    node.h[0] = 4.0 * d.c / (node.dt * node.dt);
    node.state = {damage, d.f, 0.0, 0.0, d.f, 0.0, 0.0};
    node.v_previous = {};  // at rest before: a new bond starts where the node is
    const std::int32_t code = node.step({2.0 * (d.drive - 2.0 * d.f) / node.dt, 0.0, 0.0});
    if (d.holds()) {
      ASSERT_EQ(code, ILAW_OK) << k;
      ASSERT_EQ(node.named("damage"), damage) << k;
      ++held;
    } else if (*roots > 1) {
      ASSERT_EQ(code, ILAW_BAD_NODES) << k << ": " << *roots << " roots";
      ASSERT_STREQ(node.report.reason, several_solutions);
      ++several;
    } else {
      ASSERT_EQ(code, ILAW_OK) << k << ": " << *roots << " roots";
      const double y = node.named("mean_opening");
      ASSERT_GE(y, d.z - 1e-12 * d.drive) << k;
      ASSERT_NEAR(d.q(y), 0.0, 1e-11 * d.drive * d.drive) << k;
      ++single;
    }
  }
  EXPECT_GT(held, 1000);
  EXPECT_GT(single, 1000);
  EXPECT_GT(several, 500);
}

// The excess of a trial stiffness over that of the law, for any H and no contact; none where that would act.
class Trials {
 public:
  explicit Trials(const Problem& p) : p_(p), before_(p.curve.secant(p.damage)) {
    for (std::size_t c = 0; c < 3; ++c) drive_[c] = 0.5 * p.step * p.v_free[c] + p.position[c] + p.opening[c];
  }

  // With all of the normal motion left at part 1, and as much as the bond before leaves at 0.
  std::optional<double> excess(double part) const {
    const double c = 0.25 * p_.step * p_.velocity_step, h = c * p_.inertia.h[0][0];
    const double least = 1.0 / (1.0 + h * before_), left = least + part * (1.0 - least);
    const double k = (1.0 - left) / (left * h), heavy = p_.curve.weight * p_.curve.weight;
    Matrix m{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        m[i][j] = (i == j ? 1.0 : 0.0) + c * k * p_.inertia.h[i][j] * (j == 0 ? 1.0 : heavy);
    Vector after = solution(m, drive_);
    for (std::size_t i = 0; i < 3; ++i) after[i] -= p_.opening[i];
    if (2.0 * after[0] < p_.position[0]) return std::nullopt;
    return k - p_.curve.stiffness(p_.damage, p_.step, p_.opening, after);
  }
  std::optional<int> sign_changes(int samples) const {
    int changes = 0;
    bool before = true;
    for (int n = 1; n <= samples; ++n) {
      const double part = static_cast<double>(n) / samples;
      const std::optional<double> e = excess(part * part);
      if (!e) return std::nullopt;
      changes += (*e > 0.0) != before;
      before = *e > 0.0;
    }
    return changes;
  }

 private:
  static double determinant(const Matrix& m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  }
  static Vector solution(const Matrix& m, const Vector& b) {  // Cramer
    Vector x{};
    for (std::size_t c = 0; c < 3; ++c) {
      Matrix with = m;
      for (std::size_t i = 0; i < 3; ++i) with[i][c] = b[i];
      x[c] = determinant(with) / determinant(m);
    }
    return x;
  }

  const Problem& p_;
  double before_;
  Vector drive_{};
};

// As soft as its toughness allows, or up to three times stiffer.
Parameters soft_bond(Draw& draw) {
  Parameters p = draw.bond();
  if (p.numbers.count("stiffness")) {
    const auto least = [&p](const char* peak, const char* energy) {
      return p.numbers[peak] * p.numbers[peak] / (2.0 * p.numbers[energy]);
    };
    p.numbers["stiffness"] = std::max(least("strength", "toughness"), least("strength_2", "toughness_2")) *
                             draw.between(1.01, 3.0);
  }
  return p;
}

// Pulled by what it can hardly hold; compliance(H) is c h_N.
template <class Compliance>
Problem pulled(Draw& draw, const Curve& curve, Compliance compliance) {
  Problem p(draw, curve, 1.0);
  const double c = compliance(p.inertia.h);
  const double times = 4.0 * c / (p.step * p.velocity_step * p.inertia.h[0][0]);
  for (Vector& row : p.inertia.h)
    for (double& entry : row) entry *= times;
  const Vector way = draw.vector(1.0);
  const double far =
      (curve.size(p.opening) + 2.0 * c * curve.s1) * draw.between(0.5, 2.0) / (norm(way) * p.step);
  p.v_free = {2.0 * std::abs(way[0]) * far, 2.0 * way[1] * far, 2.0 * way[2] * far};
  return p;
}
// With c h_N |T'| from 0.1 to 30.
Problem steep(Draw& draw, const Curve& curve) {
  return pulled(draw, curve,
                [&](const Matrix&) { return draw.decades(-1.0, 1.5) * curve.mode(0.0).width / curve.s1; });
}

// The same in three directions, with mixed modes and delay: what a dense search finds, the node says, and
// nothing else.
TEST(CohesiveUniqueness, IsSaidInThreeDirections) {
  Draw draw(25);
  int several = 0, single = 0;
  std::optional<Curve> drawn;
  std::optional<NodeRun> run;
  const char* given = std::getenv("ILAW_TEST_STEPS");
  const int steps = given ? std::atoi(given) : 400;
  for (int k = 0; k < steps && !HasFailure(); ++k) {
    if (k % 10 == 0) {
      const Parameters parameters = soft_bond(draw);
      drawn.emplace(parameters);
      run.emplace("cohesive", parameters, 1.0, ILAW_DELASSUS_FULL);
    }
    const Curve& curve = *drawn;
    NodeRun& node = *run;
    const Problem p = steep(draw, curve);
    const Trials trials(p);
    const bool solved = p.solve(node) == ILAW_OK;
    if (solved && node.named("damage") == p.damage) continue;
    if (!solved) {
      ASSERT_STREQ(node.report.reason, several_solutions) << k;
    }
    std::optional<int> found = trials.sign_changes(300);
    if (!found) continue;
    if (!solved && *found == 1) found = trials.sign_changes(20000);
    ASSERT_EQ(solved, found == 1) << k << ", shape " << curve.shape << ", delay " << curve.delay << ": "
                                  << found.value_or(0) << " solutions";
    solved ? ++single : ++several;
  }
  if (given) std::printf("several solutions: %d, one: %d\n", several, single);
  EXPECT_GT(several, steps / 100);
  EXPECT_GT(single, steps / 4);
}

// The steepest softening that the page gives for a bond, and the longest step with one solution.
double steepest_slope(const Parameters& p) {
  const auto number = [&p](const char* name, double otherwise) {
    const auto found = p.numbers.find(name);
    return found == p.numbers.end() ? otherwise : found->second;
  };
  const bool is_one_curve = p.texts.at("shape") == "camacho_ortiz";
  const double s1 = number("strength", 0.0), g1 = number("toughness", 0.0),
               s2 = is_one_curve ? s1 : number("strength_2", s1),
               g2 = is_one_curve ? g1 : number("toughness_2", g1), k = number("stiffness", inf_value);
  const double factor = p.texts.at("shape") == "exponential" ? 0.998 : 0.5;
  return factor * std::max(s1 * s1 / (g1 - s1 * s1 / (2.0 * k)), s2 * s2 / (g2 - s2 * s2 / (2.0 * k)));
}
double longest_step(const Parameters& p, const Matrix& h) {
  const bool is_weighted = p.texts.at("shape") == "camacho_ortiz";
  const double beta = is_weighted ? p.numbers.at("strength_2") / p.numbers.at("strength") : 1.0;
  const double trace = h[0][0] + beta * beta * (h[1][1] + h[2][2]);
  return 2.0 / std::sqrt(trace * steepest_slope(p));
}

// Below the step that the page gives no node is refused, whatever its H, mode and delay; at four times that
// step some are.
TEST(CohesiveUniqueness, HoldsBelowTheStepOfThePage) {
  Draw draw(26);
  int softened = 0, beyond = 0;
  for (int k = 0; k < 2000 && !HasFailure(); ++k) {
    const Parameters parameters = soft_bond(draw);
    const Curve curve(parameters);
    NodeRun node("cohesive", parameters, 1.0, ILAW_DELASSUS_FULL);
    const auto at_part = [&](double part) {
      return pulled(draw, curve, [&](const Matrix& h) {
        const double step = part * longest_step(parameters, h);
        return 0.25 * step * step * h[0][0];
      });
    };
    const Problem below = at_part(0.99);
    ASSERT_EQ(below.solve(node), ILAW_OK) << k << ", shape " << curve.shape << ": " << node.report.reason;
    softened += node.named("damage") > below.damage ? 1 : 0;
    beyond += at_part(4.0).solve(node) == ILAW_OK ? 0 : 1;
  }
  EXPECT_GT(softened, 500);
  EXPECT_GT(beyond, 20);
}

}  // namespace
}  // namespace ilaw::testing
