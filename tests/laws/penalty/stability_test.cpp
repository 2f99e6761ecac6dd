// The implicit penalty keeps the limit of the central-difference scheme, whatever its stiffness.
#include "support/law_runner.hpp"
#include "support/sizes.hpp"

namespace ilaw::testing {
namespace {

// A chain of unit masses and springs, fixed at its far end, whose first node meets a penalised stop at
// `stop`. The largest frequency is below 2, so that the central-difference limit is h = 1; a single mass on a
// single spring has frequency 1 and the limit 2.
class Chain {
 public:
  Chain(const Parameters& parameters, std::size_t nodes, double step, double stop)
      : node_("penalty", parameters, step), h_(step), stop_(stop), u_(nodes, 1.0), v_(nodes, -0.7) {
    node_.v_previous = {-0.7, 0, 0};
  }

  void step() {
    for (std::size_t i = 0; i < u_.size(); ++i) v_[i] += h_ * force(i);
    node_.gap = u_[0] - stop_;
    ASSERT_EQ(node_.step({v_[0], 0, 0}), ILAW_OK);
    v_[0] = node_.v[0];
    for (std::size_t i = 0; i < u_.size(); ++i) u_[i] += h_ * v_[i];
  }

  // The scheme's own, v^2/2 + u_n.K u_{n+1}/2, which is positive below its limit; and the penalty's.
  double energy() const {
    double twice = 2.0 * node_.energy[ILAW_ENERGY_STORED];
    for (std::size_t i = 0; i < u_.size(); ++i) twice += v_[i] * v_[i] - force(i) * (u_[i] - h_ * v_[i]);
    return 0.5 * twice;
  }

 private:
  double force(std::size_t i) const {
    const double next = i + 1 < u_.size() ? u_[i + 1] : 0.0;
    return (next - u_[i]) + (i > 0 ? u_[i - 1] - u_[i] : 0.0);
  }

  NodeRun node_;
  double h_, stop_;
  std::vector<double> u_, v_;
};

// Energy at the start, and the largest in the first and in the second half of a run.
struct Energies {
  double start, early = 0.0, late = 0.0;
};
Energies run(Chain chain, int steps) {
  Energies energies{chain.energy()};
  for (int k = 0; k < steps; ++k) {
    chain.step();
    double& half = 2 * k < steps ? energies.early : energies.late;
    half = std::max(half, chain.energy());
  }
  return energies;
}

Parameters implicit_penalty(double stiffness, double exponent, double restitution) {
  return {{{"stiffness", stiffness}, {"exponent", exponent}, {"restitution", restitution}},
          {{"integration", "implicit"}}};
}

// Up to the limit of the chain itself no impact adds energy, whatever the stiffness: from a hundredth of the
// element's own to infinite. Without restitution below one none is lost either.
TEST(Stability, ImplicitEnergyNeverGrows) {
  for (const std::size_t nodes : {1U, 20U})
    for (const double part : {0.1, 0.5, 0.9, 0.999})
      for (const double stiffness : {1e-2, 1.0, 1e2, 1e6, inf_value})
        for (const double e : {1.0, 0.5, 0.0})
          for (const double stop : {0.0, -0.3, 0.3}) {
            GIVEN(nodes, part, stiffness, e);
            const double h = part * (nodes == 1 ? 2.0 : 1.0), exponent = e == 1.0 && stop < 0.0 ? 1.5 : 1.0;
            const Energies found =
                run({implicit_penalty(stiffness, exponent, e), nodes, h, stop}, part_of(4000));
            EXPECT_LE(std::max(found.early, found.late), found.start * (1.0 + 1e-11));
            if (e == 1.0) {
              EXPECT_GE(found.late, found.start * (1.0 - 1e-11));
            }
          }
}

// A million steps beside the limit: what rounding does stays below 1e-10.
TEST(Stability, ImplicitKeepsItsEnergyForAMillionSteps) {
  for (const double stiffness : {1.0, 1e6}) {
    const Energies found = run({implicit_penalty(stiffness, 1.0, 1.0), 1, 1.99, 0.3}, 1000000);
    EXPECT_NEAR(found.early, found.start, 1e-10 * found.start) << stiffness;
    EXPECT_NEAR(found.late, found.start, 1e-10 * found.start) << stiffness;
  }
}

}  // namespace
}  // namespace ilaw::testing
