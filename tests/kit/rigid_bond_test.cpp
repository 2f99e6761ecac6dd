// A bond that broke, and the contact that is left of it: their work together.
#include <ilaw/kit/rigid_bond.hpp>

#include "support/matchers.hpp"
#include "support/random.hpp"

namespace {

using ilaw::kit::full;
using ilaw::testing::Random;
using Vector = ilaw::kit::vector<double>;

struct Node {
  using number = double;
  full<double> delassus;
  Vector v_free, v_previous;
};

// Twice the work of an impulse over the step.
double work(const Node& node, Vector r) {
  return ilaw::kit::product(r, node.v_previous + node.v_free + node.delassus.times(r));
}

TEST(RigidBond, DoesNoPositiveWorkTogetherWithContact) {
  Random random(7);
  const auto drawn = [&] { return Vector{random(), random(), random()}; };
  int scaled = 0;
  for (int k = 0; k < 20000; ++k) {
    // Diagonally dominant: positive definite.
    const Node node{{1.0, 0.8, 1.2, 0.3 * random(), 0.3 * random(), 0.3 * random()}, drawn(), drawn()};
    const Vector held = drawn(), contact{std::abs(random()), random(), random()};
    const double of_held = work(node, held);
    if (of_held > 0.0) continue;
    const Vector both = ilaw::kit::joined(node, held, contact);
    ASSERT_LE(work(node, both), 1e-14) << "draw " << k;
    // Nothing is taken off where both together take energy.
    if (work(node, held + Vector{contact.n}) <= 0.0 && work(node, held + contact) <= 0.0)
      ASSERT_EQ(both.n, held.n + contact.n) << "draw " << k;
    else
      ++scaled;
  }
  EXPECT_GT(scaled, 1000);
}

}  // namespace
