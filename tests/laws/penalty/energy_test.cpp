// Energy that the penalty's springs take and give back, step by step, on random draws: any state, any
// velocity before (any external force, then), any H, two steps that have nothing to do with each other.
#include "support/law_runner.hpp"
#include "support/sizes.hpp"

#include <tuple>
#include <utility>

namespace ilaw::testing {
namespace {

// Parameters of one draw and what the page says is stored; a state is x, xi and W.
struct Springs {
  double stiffness, exponent, tangential, friction;

  double normal(double x) const {
    return stiffness < inf_value ? stiffness * std::pow(x, exponent + 1.0) / (exponent + 1.0) : 0.0;
  }
  double tangent(const std::vector<double>& state) const {
    double square = 0.0;
    for (std::size_t k = 1; k + 1 < state.size(); ++k) square += state[k] * state[k];
    return tangential < inf_value ? 0.5 * tangential * square : 0.0;
  }
};

struct Draw : Random {
  Draw() : Random(11) {}

  Vector in_dimension(std::size_t dimension) {
    Vector v{};
    for (std::size_t k = 0; k < dimension; ++k) v[k] = (*this)();
    return v;
  }
  // A positive definite H of the form; with correlations of at most `most` where it is full.
  std::array<double, 6> inertia(std::uint32_t form, std::size_t dimension, double most) {
    const double size = decades(1.0);
    std::array<double, 6> h{};
    for (std::size_t k = 0; k < dimension; ++k)
      h[k] = size * (form == ILAW_DELASSUS_SCALAR ? 1.0 : decades(0.5));
    if (form != ILAW_DELASSUS_FULL) return h;
    double n1 = most * (*this)(), n2 = 0.0, t12 = 0.0;
    if (dimension == 2) {
      h[2] = n1 * std::sqrt(h[0] * h[1]);
      return h;
    }
    do {
      n1 = most * (*this)();
      n2 = most * (*this)();
      t12 = most * (*this)();
    } while (1.0 + 2.0 * n1 * n2 * t12 - n1 * n1 - n2 * n2 - t12 * t12 < 0.01);
    h[3] = n1 * std::sqrt(h[0] * h[1]);
    h[4] = n2 * std::sqrt(h[0] * h[2]);
    h[5] = t12 * std::sqrt(h[1] * h[2]);
    return h;
  }
  // A velocity of any direction, or one turned round within the step, in part or more than that.
  Vector before(const Vector& v_free, std::size_t dimension) {
    Vector v = in_dimension(dimension);
    if ((*this)() < 0.0) return v;
    const double part = decades(1.0), aside = 0.3 * (*this)();
    for (std::size_t k = 1; k < dimension; ++k) v[k] = -part * (v_free[k] + aside * v[k]);
    return v;
  }
};

NodeRun run_of(const Parameters& parameters, double h, std::uint32_t form, std::uint32_t dimension) {
  NodeRun node("penalty", parameters, h, form);
  if (dimension == 3) return node;
  node.interface = make_law("penalty", SetupBuilder(parameters, dimension, form));
  node.state.assign(node.interface.info().state_size, 0.0);
  node.initialise();
  return node;
}

class ImplicitEnergy : public ::testing::TestWithParam<std::tuple<std::uint32_t, std::uint32_t>> {
 protected:
  std::uint32_t form() const { return std::get<0>(GetParam()); }
  std::uint32_t dimension() const { return std::get<1>(GetParam()); }

  // -r.(v^- + v)/2 = what is stored more + what is dissipated, the latter not negative in either part.
  void check(NodeRun& node, const Springs& springs, int seed) {
    const std::vector<double> before = node.state;
    const double held = springs.normal(before[0]) + before.back(), stored = held + springs.tangent(before);
    const Vector v_free = random_.in_dimension(dimension()), previous = random_.before(v_free, dimension());
    node.v_previous = previous;
    if (node.step(v_free) != ILAW_OK) {  // strong coupling: no impulse holds the node
      ASSERT_EQ(springs.friction, inf_value) << node.report.reason;
      ++refused_;
      return;
    }
    ++seen_[node.status];
    double work[3];
    for (std::size_t c = 0; c < 3; ++c) work[c] = 0.5 * node.r[c] * (previous[c] + node.v[c]);
    const double normal = springs.normal(node.state[0]) + node.state.back(),
                 tangent = springs.tangent(node.state);
    const double impact = -work[0] - (normal - held);
    const double dissipated = -work[1] - work[2] - (tangent - springs.tangent(before));
    double scale = normal + tangent + stored;
    for (std::size_t c = 0; c < 3; ++c)
      scale += std::abs(node.r[c]) * (std::abs(previous[c]) + std::abs(node.v[c]) + std::abs(node.v_free[c]));
    const double slack = 1e-12 * scale;
    const auto draw = [&] { return text_of(node, before, previous, seed); };
    ASSERT_GE(impact, -slack) << "the normal spring added energy; " << draw();
    ASSERT_GE(dissipated, -slack) << "friction added energy; " << draw();
    ASSERT_NEAR(node.energy[ILAW_ENERGY_IMPACT], impact, slack) << "reported as impact; " << draw();
    ASSERT_NEAR(node.energy[ILAW_ENERGY_FRICTION], dissipated, slack) << "reported as friction; " << draw();
    ASSERT_NEAR(node.energy[ILAW_ENERGY_STORED], normal + tangent, 1e-14 * (normal + tangent)) << draw();
    if (node.status == ILAW_STICK && springs.tangential < inf_value) {
      ASSERT_LE(dissipated, slack) << "sticking dissipated; " << draw();
    }
  }
  // The inputs that repeat a draw, and the results.
  static std::string text_of(const NodeRun& node, const std::vector<double>& before, const Vector& previous,
                             int seed) {
    return "draw " + std::to_string(seed) + ": state " + ::testing::PrintToString(before) + " -> " +
           ::testing::PrintToString(node.state) + ", v_previous " + ::testing::PrintToString(previous) +
           ", v_free " + ::testing::PrintToString(node.v_free) + ", H " + ::testing::PrintToString(node.h) +
           ", gap " + std::to_string(node.gap) + ", impulse " + ::testing::PrintToString(node.r);
  }

  Draw random_;
  std::map<int, int> seen_;
  int refused_ = 0;
};

TEST_P(ImplicitEnergy, GivesBackWhatItDoesNotDissipate) {
  Draw& random = random_;
  for (int instance = 0; instance < 500 && !HasFatalFailure(); ++instance) {
    const bool rigid_tangent = instance % 5 < 2, rigid = instance % 17 == 0;
    const double scale = random.decades(1.0), h = random.decades(1.0);
    const Springs springs{rigid ? inf_value : random.decades(3.0) / (h * h),
                          instance % 4 == 1 ? 1.5 : (instance % 16 == 2 ? 3.3 : 1.0),
                          rigid_tangent ? inf_value : random.decades(3.0) / (h * h),
                          instance % 7 ? random.decades(0.7) : inf_value};
    std::map<std::string, double> numbers{{"stiffness", springs.stiffness},
                                          {"exponent", springs.exponent},
                                          {"friction", springs.friction},
                                          {"tangential_stiffness", springs.tangential}};
    if (instance % 3 == 1) numbers["damping"] = random.decades(2.0) / h;
    if (instance % 3 == 2 && springs.exponent == 1.0) numbers["restitution"] = 0.5 + 0.5 * random();
    NodeRun node = run_of({numbers, {{"integration", "implicit"}}}, h, form(), dimension());
    node.position_dt = random.decades(1.0);
    for (int k = 0; k < 100 && !HasFatalFailure(); ++k) {
      node.h = random.inertia(form(), dimension(), 0.95);
      node.gap = scale * random();
      node.state.assign(node.state.size(), 0.0);
      if (!rigid && k % 4 != 0) node.state[0] = h * std::abs(random()) * random.decades(1.0);
      for (std::size_t t = 1; t + 1 < node.state.size() && !rigid_tangent; ++t) node.state[t] = h * random();
      if (numbers.contains("restitution") && k % 2 == 1)
        node.state.back() = springs.normal(node.state[0]) * random.decades(2.0);
      check(node, springs, 100 * instance + k);
    }
  }
  for (const int status : {ILAW_FREE, ILAW_STICK, ILAW_SLIP}) EXPECT_GT(seen_[status], 1500) << status;
  EXPECT_LT(refused_, form() == ILAW_DELASSUS_FULL ? 1000 : 1);
}

INSTANTIATE_TEST_SUITE_P(Inertia, ImplicitEnergy,
                         ::testing::Combine(::testing::Values(ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_DIAGONAL,
                                                              ILAW_DELASSUS_FULL),
                                            ::testing::Values(2U, 3U)));

// The law of a rigid tangential spring: its slip is v_T + e_T v_T^-, with e_T 0 where friction takes from
// what went before, 1 where it pushes along it, between where it does neither.
class StickOfAnyInertia {
 public:
  explicit StickOfAnyInertia(double friction) : friction_(friction) {}

  void check(NodeRun& node, Draw& random) {
    const Vector v_free = random.vector(), before = random.before(v_free, 3);
    node.h = random.inertia(ILAW_DELASSUS_FULL, 3, 0.95);
    node.v_previous = before;
    node.state.assign(node.state.size(), 0.0);
    if (node.step(v_free) != ILAW_OK && friction_ == inf_value) return;  // what no impulse holds
    const Vector &r = node.r, &v = node.v;
    if (!(r[0] > 0.0)) return;
    const double rubs = std::hypot(r[1], r[2]), part = part_given_back(r, v, before);
    const double u1 = v[1] + part * before[1], u2 = v[2] + part * before[2];
    const double slack = 1e-10 * (1.0 + std::hypot(v[1], v[2]) + std::hypot(before[1], before[2]) + r[0]);
    const bool sticks = rubs < (1.0 - 1e-9) * friction_ * r[0];
    ASSERT_LE(rubs, (1.0 + 1e-12) * friction_ * r[0]);
    ASSERT_NEAR(std::hypot(u1, u2), sticks ? 0.0 : -(u1 * r[1] + u2 * r[2]) / rubs, slack) << "part " << part;
  }

  int stopped = 0, between = 0, reversed = 0;

 private:
  double part_given_back(const Vector& r, const Vector& v, const Vector& before) {
    const double speed = std::hypot(before[1], before[2]), rubs = std::hypot(r[1], r[2]);
    const double along = r[1] * before[1] + r[2] * before[2], none = speed * (1e-9 * rubs + 1e-12 * r[0]);
    if (std::abs(along) <= none) {
      ++between;
      return std::clamp(-(v[1] * before[1] + v[2] * before[2]) / (speed * speed), 0.0, 1.0);
    }
    ++(along < 0.0 ? stopped : reversed);
    return along < 0.0 ? 0.0 : 1.0;
  }

  double friction_;
};

TEST(PenaltyStick, GivesBackNoMoreThanItMust) {
  Draw random;
  int stopped = 0, between = 0, reversed = 0;
  for (int instance = 0; instance < part_of(10000) && !HasFatalFailure(); ++instance) {
    const double friction = instance % 5 ? random.decades(0.7) : inf_value;
    std::map<std::string, double> numbers{{"stiffness", instance % 3 ? random.decades(3.0) : inf_value},
                                          {"friction", friction},
                                          {"restitution", instance % 2 ? 0.7 : 1.0}};
    NodeRun node = run_of({numbers, {{"integration", "implicit"}}}, 1.0, ILAW_DELASSUS_FULL, 3);
    node.gap = -1.0;
    StickOfAnyInertia stick(friction);
    for (int k = 0; k < 100 && !HasFatalFailure(); ++k) stick.check(node, random);
    stopped += stick.stopped;
    between += stick.between;
    reversed += stick.reversed;
  }
  EXPECT_GT(stopped, 2000);
  EXPECT_GT(between, 500);
  EXPECT_GT(reversed, 500);
}

// Along one axis: the free velocity stays where it turned round by less than the velocity before.
TEST(PenaltyStick, LeavesWhatTurnedRoundInPart) {
  for (const double turned : {0.1, 0.5, 0.9, 1.5}) {
    NodeRun node =
        run_of({{{"stiffness", inf_value}, {"friction", inf_value}}, {{"integration", "implicit"}}}, 1.0,
               ILAW_DELASSUS_SCALAR, 3);
    node.gap = -1.0;
    node.v_previous = {0.0, 2.0, 0.0};
    ASSERT_EQ(node.step({-1.0, -2.0 * turned, 0.0}), ILAW_OK) << node.report.reason;
    EXPECT_NEAR(node.v[1], -2.0 * std::min(turned, 1.0), 1e-12) << turned;
  }
}

// A step is continuous in the motion before it, whatever that turns to: cut in 64 parts, the largest change
// of a circle of such motions has no part that is a quarter of it, where a jump would leave one as large as
// all.
TEST(PenaltyStick, IsContinuousInWhatTurnedRound) {
  constexpr int steps = 2000, parts = 64;
  constexpr double angle = 6.283185307179586 / steps;
  Draw random;
  for (int draw = 0; draw < 100 && !HasFatalFailure(); ++draw) {
    NodeRun node =
        run_of({{{"stiffness", 100.0}, {"friction", random.decades(0.5)}}, {{"integration", "implicit"}}},
               1.0, ILAW_DELASSUS_FULL, 3);
    node.h = random.inertia(ILAW_DELASSUS_FULL, 3, 0.3);
    const Vector v_free{-1.0, random(), random()};
    const double speed = random.decades(1.0);
    const auto velocity_after = [&](double at) {
      node.v_previous = {-1.0, speed * std::cos(at), speed * std::sin(at)};
      node.state.assign(node.state.size(), 0.0);
      EXPECT_EQ(node.step(v_free), ILAW_OK);
      return node.v;
    };
    const auto largest_change = [&](double from, double by, int count) {
      std::pair<double, double> largest{0.0, from};
      Vector last = velocity_after(from);
      for (int k = 1; k <= count; ++k) {
        const Vector v = velocity_after(from + k * by);
        const double change = std::hypot(v[0] - last[0], v[1] - last[1], v[2] - last[2]);
        largest = std::max(largest, {change, from + (k - 1) * by});
        last = v;
      }
      return largest;
    };
    const auto [change, from] = largest_change(0.0, angle, steps);
    ASSERT_LE(largest_change(from, angle / parts, parts).first, 0.25 * change) << draw << ", angle " << from;
  }
}

// In the plane nothing rubs where what H makes of the impact turns the motion round in part; by itself, the
// stick would put 1.88 into it.
TEST(PenaltyStick, LetsGoWhatTheImpactTurnedRound) {
  NodeRun node = run_of({{{"stiffness", 1e9}, {"friction", 2.0}}, {{"integration", "implicit"}}}, 1e-3,
                        ILAW_DELASSUS_FULL, 2);
  node.h = {1.0, 1.0, 0.5};
  node.v_previous = {-1.0, -3.0, 0.0};
  ASSERT_EQ(node.step({-1.0, -0.05, 0.0}), ILAW_OK);
  EXPECT_NEAR(node.r[1], 0.0, 1e-15);
  EXPECT_NEAR(node.v[1], 0.5 * node.r[0] - 0.05, 1e-15);
  EXPECT_EQ(node.status, ILAW_STICK);
}

// Two steps of an undamped explicit spring in contact: the energy of the page, 1/2 k g g', with g' the gap
// that the position step leads to, is kept exactly where the impulse of the velocity step does the work.
TEST(ExplicitEnergy, KeepsItsOwnWhateverTheSteps) {
  for (const double ratio : {0.37, 1.0, 1.71}) {
    const double k = 10.0, l = 1e-2, h = ratio * l;
    NodeRun node("penalty", {{{"stiffness", k}}, {}}, h);
    node.position_dt = l;
    node.v = node.v_previous = {-1.0, 0, 0};
    node.gap = -0.3;
    double before = 0.0;
    for (int step = 0; step < 30; ++step) {
      const double previous = node.v[0];
      ASSERT_EQ(node.step(node.v), ILAW_OK);
      const double next = node.gap + l * node.v[0];
      EXPECT_NEAR(node.energy[ILAW_ENERGY_STORED], 0.5 * k * node.gap * next, 1e-14);
      // The impulse is h times the force and the way l times the velocity: h/l of what is stored is given.
      const double work = 0.5 * node.r[0] * (previous + node.v[0]);
      if (step > 0) {
        EXPECT_NEAR(work, (h / l) * (before - node.energy[ILAW_ENERGY_STORED]), 1e-13) << ratio;
      }
      before = node.energy[ILAW_ENERGY_STORED];
      node.gap = next;
    }
  }
}

// The same for its tangential spring: a sticking node, as it swings.
TEST(ExplicitEnergy, KeepsThatOfSlipWhateverTheSteps) {
  for (const double ratio : {0.37, 1.0, 1.71}) {
    const double k = 40.0, l = 1e-2, h = ratio * l;
    NodeRun node("penalty", {{{"stiffness", 1.0}, {"tangential_stiffness", k}, {"friction", inf_value}}, {}},
                 h);
    node.position_dt = l;
    node.gap = -1.0;
    node.v = node.v_previous = {0.0, 0.3, -0.4};
    double before = 0.0;
    for (int step = 0; step < 100; ++step) {
      const Vector previous = node.v;
      node.v[0] = 0.0;  // held in the normal direction
      const Vector free{0.0, node.v[1], node.v[2]};
      node.v_previous = {0.0, previous[1], previous[2]};
      ASSERT_EQ(node.step(free), ILAW_OK);
      const double spring = node.energy[ILAW_ENERGY_STORED] - 0.5 * node.gap * (node.gap + l * node.v[0]);
      double work = 0.0;
      for (std::size_t c = 1; c < 3; ++c) work += 0.5 * node.r[c] * (previous[c] + node.v[c]);
      if (step > 0) {
        EXPECT_NEAR(work, (h / l) * (before - spring), 1e-13) << ratio;
      }
      EXPECT_NEAR(node.energy[ILAW_ENERGY_FRICTION], 0.0, 1e-15) << ratio << " " << step;
      before = spring;
    }
  }
}

}  // namespace
}  // namespace ilaw::testing
