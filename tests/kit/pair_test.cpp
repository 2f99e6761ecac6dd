// A law's memory of a pair of bodies goes on where the two change roles, as the page on the ABI says
// ("Pairs of bodies"), and where the normal turns, by any angle.
#include "support/law_batch.hpp"
#include "support/law_cases.hpp"

namespace ilaw::testing {
namespace {

struct Axes {
  Vector n, t1, t2;
};

Vector global(const Axes& axes, const Vector& local) {
  return local[0] * axes.n + local[1] * axes.t1 + local[2] * axes.t2;
}
Vector local(const Axes& axes, const Vector& a) { return {dot(axes.n, a), dot(axes.t1, a), dot(axes.t2, a)}; }

// A right-handed frame; its first two axes span the plane of a model in 2D, the first the line of one in 1D.
Axes first_axes(int dimension) {
  if (dimension == 1) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const double c = 0.6, s = 0.8;
  if (dimension == 2) return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
  return {{c, s * c, s * s}, {-s, c * c, c * s}, {0, -s, c}};
}

// Turned by the shortest rotation from n to n cos + across sin; across is a unit tangent.
Axes turned(const Axes& axes, double angle, const Vector& across) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto turn = [&](const Vector& a) {
    const double normal = dot(a, axes.n), along = dot(a, across);
    return a + (normal * (c - 1.0) - along * s) * axes.n + (normal * s + along * (c - 1.0)) * across;
  };
  return {turn(axes.n), turn(axes.t1), turn(axes.t2)};
}

// A contact in global axes, driven on a path that is given in the axes of the pair.
class Contact : public LawBatch {
 public:
  Contact(const LawCase& given, int dimension, bool has_tangent)
      : LawBatch(make_law(given.law, SetupBuilder(given.parameters, static_cast<std::uint32_t>(dimension),
                                                  ILAW_DELASSUS_SCALAR, ILAW_FRAME_GLOBAL, has_tangent))) {}

  bool remembers() const { return !state.empty(); }
  bool remembers_direction() const { return state.size() >= 3; }  // its last three numbers
  void forget() { steps_ = 0; }

  // Impulse, in global axes.
  Vector step(const Axes& axes, const Vector& velocity) {
    // Closed, and open for a while before it is closed again.
    gap[0] = time_ % 16 < 13 ? -1e-4 : 1e-4;
    time = 1e-3 * ++time_;
    v_free[0] = v_previous[0] = velocity;
    normal[0] = axes.n;
    tangent[0] = axes.t1;
    if (steps_++ == 0) {
      EXPECT_EQ(initialise(), ILAW_OK);
    }
    EXPECT_EQ(evaluate(), ILAW_OK) << report.reason;
    return r[0];
  }

 private:
  int steps_ = 0, time_ = 0;
};

// Pressed, dragged in both tangents, and pulled at in the end: nothing breaks at once, all comes into play.
Vector velocity_of(int step, int dimension, double speed) {
  const double k = step;
  return {step % 16 < 13 && step < 32 ? -0.3 * speed : 0.6 * speed,
          dimension > 1 ? speed * (1.0 - 0.02 * k) : 0.0, dimension > 2 ? speed * (0.4 + 0.03 * k) : 0.0};
}

constexpr int all_steps = 40, swap_step = 25;

// The largest difference of two impulses, with the step where it is.
struct Worst {
  double difference = 0.0, size = 0.0;
  int step = 0;
  void note(int n, const Vector& found, const Vector& expected) {
    for (std::size_t c = 0; c < 3; ++c) {
      size = std::max(size, std::abs(expected[c]));
      if (!(std::abs(found[c] - expected[c]) <= difference)) {
        difference = std::abs(found[c] - expected[c]);
        step = n;
      }
    }
  }
};

// A state whose roles are swapped, as the page says; false where it has what cannot be.
bool swap_roles(const ilaw_instance_info& info, int dimension, std::vector<double>& state) {
  if (dimension < 3) return true;
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < info.state_variable_count; ++i) {
    const ilaw_state_variable& v = *info.state_variables[i];
    if (v.kind == ILAW_KIND_HISTORY) return false;
    if (v.kind == ILAW_KIND_AXIS)
      for (std::size_t c = 0; c < 3; ++c) state[at + c] = -state[at + c];
    if (v.kind == ILAW_KIND_VECTOR || v.kind == ILAW_KIND_TANGENTIAL)
      state[at + v.count - 1] = -state[at + v.count - 1];
    at += v.count;
  }
  return true;
}

class Pair : public ::testing::TestWithParam<LawCase> {};

// Runs a path on which the roles are swapped, beside one where they are kept and one where the memory is lost
// instead; notes how far each is from the second. False where the state cannot be swapped.
bool run_swapped(const LawCase& law, int dimension, bool tangent, double speed, Worst& swapped, Worst& lost) {
  Contact keeps(law, dimension, tangent), swaps(law, dimension, tangent), forgets(law, dimension, tangent);
  const Axes axes = first_axes(dimension), other{-axes.n, -axes.t1, axes.t2};
  for (int n = 0; n < all_steps; ++n) {
    if (n == swap_step && !swap_roles(swaps.law->info(), dimension, swaps.state)) return false;
    if (n == swap_step) forgets.forget();
    const Vector v = global(axes, velocity_of(n, dimension, speed)), expected = keeps.step(axes, v);
    swapped.note(n, n < swap_step ? swaps.step(axes, v) : -swaps.step(other, -v), expected);
    lost.note(n, forgets.step(axes, v), expected);
  }
  return true;
}

// The obstacle becomes the body: n, relative velocities and impulses change sign, and nothing else happens.
TEST_P(Pair, GoesOnWhereItsRolesAreSwapped) {
  bool remembers = false, needed = false;
  for (const int dimension : {1, 2, 3})
    for (const double speed : {0.005, 0.05, 0.5})
      for (const bool tangent : {false, true}) {
        if (tangent && dimension < 3) continue;
        Worst swapped, lost;
        remembers = remembers || Contact(GetParam(), dimension, tangent).remembers();
        if (!run_swapped(GetParam(), dimension, tangent, speed, swapped, lost)) continue;
        EXPECT_LE(swapped.difference, 1e-14 * swapped.size)
            << "dimension " << dimension << ", speed " << speed << ", tangent " << tangent << ", step "
            << swapped.step;
        needed = needed || lost.difference > 1e-3 * lost.size;
      }
  EXPECT_EQ(needed, remembers) << "whether the path needs the memory";
}

// By the shortest rotation, of up to the half turn; where the normal turns to its opposite, by the half turn
// about the tangent that the state holds.
TEST_P(Pair, GoesOnWhereTheNormalTurnsByAnyAngle) {
  const Axes axes = first_axes(3);
  const double pi = std::acos(-1.0);
  Contact probe(GetParam(), 3, false);
  if (!probe.remembers()) return;
  probe.step(axes, {});
  const std::size_t s = probe.state.size();
  for (int degrees = 0; degrees <= 180; degrees += 5) {
    const double angle = degrees * pi / 180.0, about = 0.3 + 0.7 * degrees;
    Vector across = std::cos(about) * axes.t1 + std::sin(about) * axes.t2;
    Axes after = turned(axes, angle, across);
    Contact still(GetParam(), 3, false), turning(GetParam(), 3, false);
    Worst worst;
    for (int n = 0; n < all_steps; ++n) {
      if (n == swap_step && degrees == 180 &&
          turning.remembers_direction()) {  // about the stored tangent: across is square to it
        const Vector t{turning.state[s - 3], turning.state[s - 2], turning.state[s - 1]};
        across = dot(t, axes.t1) * axes.t2 - dot(t, axes.t2) * axes.t1;
        after = turned(axes, angle, across);
        after.n = -axes.n;
      }
      const Axes& now = n < swap_step ? axes : after;
      const Vector v = velocity_of(n, 3, 0.05);
      worst.note(n, local(now, turning.step(now, global(now, v))),
                 local(axes, still.step(axes, global(axes, v))));
    }
    EXPECT_LE(worst.difference, 2e-13 * worst.size) << degrees << " degrees, step " << worst.step;
  }
}

INSTANTIATE_TEST_SUITE_P(AnyLaw, Pair, ::testing::ValuesIn(law_cases("contract")),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace ilaw::testing
