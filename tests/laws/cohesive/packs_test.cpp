// Cohesive zones that are solved side by side: the equations of the page, and the same bits in any company.
#include "any_inertia.hpp"
#include "support/profile.hpp"

namespace ilaw::testing {
namespace {

Inertia transverse(Draw& draw, double decades) {
  Inertia made(draw, 0.0);
  const double tangential = draw.decades(-decades, decades);
  made.h = {Vector{1.0, 0.0, 0.0}, {0.0, tangential, 0.0}, {0.0, 0.0, tangential}};
  made.condition = 3.0 * std::max(tangential, 1.0 / tangential);
  return made;
}

// Bonds of all shapes and modes, rigid or not, with and without delay.
Parameters any_bond(Draw& draw) { return draw.bond(); }

TEST(CohesivePacks, SolveTheEquationsOfThePage) {
  SolvedProblems solved;
  solved.solve(41, any_bond, [](Draw& draw, const Curve& curve) {
    Problem p(draw, curve, 0.0);
    p.inertia = transverse(draw, 2.0);
    return p;
  });
  solved.expect_variety();
}

ilaw::interface bond_of(const Parameters& parameters) {
  return make_law("cohesive", SetupBuilder(parameters, 3, ILAW_DELASSUS_FULL));
}

constexpr std::size_t node_count = 150;  // more than two blocks

struct Nodes : LawBatch {
  using LawBatch::LawBatch;

  void set(std::size_t i, const Problem& p, double damage) {
    h[i] = p.inertia.entries();
    v_free[i] = p.v_free;
    v_previous[i] = p.v_previous;
    const double kept[] = {damage,       p.position[0], p.position[1], p.position[2],
                           p.opening[0], p.opening[1],  p.opening[2]};
    std::copy(std::begin(kept), std::end(kept), state.begin() + state_size() * i);
  }
  // Node i of these as node k of others.
  void take(std::size_t k, const Nodes& from, std::size_t i) {
    h[k] = from.h[i];
    v_free[k] = from.v_free[i];
    v_previous[k] = from.v_previous[i];
    std::copy_n(from.state.begin() + state_size() * i, state_size(), state.begin() + state_size() * k);
    gap[k] = from.gap[i];
    velocity_step = from.velocity_step;
    position_step = from.position_step;
  }
  // Whether node i gives the bits of node k of others.
  bool gives_bits_of(std::size_t i, const Nodes& others, std::size_t k) const {
    const auto own = [&](const Nodes& nodes, std::size_t at) {
      return std::vector(nodes.state.begin() + state_size() * at,
                         nodes.state.begin() + state_size() * (at + 1));
    };
    return same_bits(r[i], others.r[k]) && same_bits(v[i], others.v[k]) &&
           same_bits(energy[i], others.energy[k]) && same_bits(own(*this, i), own(others, k)) &&
           status[i] == others.status[k];
  }
};

// Bonds that hold, soften and are broken, of one kind; with an H that couples at so many of them.
Nodes drawn_nodes(const Parameters& parameters, Draw& draw, double coupled) {
  const Curve curve(parameters);
  Nodes nodes(bond_of(parameters), node_count);
  for (std::size_t i = 0; i < node_count; ++i) {
    Problem p(draw, curve, 0.0);
    if (i == 0) nodes.velocity_step = p.step;
    p.inertia = draw.between(0.0, 1.0) < coupled ? Inertia(draw, 1.0) : transverse(draw, 1.0);
    const double kind = draw.between(0.0, 1.0), faster = p.step / nodes.velocity_step;
    for (Vector* velocity : {&p.v_free, &p.v_previous})
      for (double& component : *velocity) component *= faster;
    if (kind < 0.2) p.position = p.opening = {};
    nodes.set(i, p, kind < 0.2 ? 0.0 : kind < 0.4 ? 1.0 : p.damage);
    nodes.gap[i] = draw.between(-1.0, 1.0) * nodes.velocity_step;
  }
  nodes.position_step = nodes.velocity_step * (draw.between(0.0, 1.0) < 0.5 ? 1.0 : draw.between(0.7, 1.4));
  return nodes;
}

// Also where two axes are nearly one.
TEST(CohesivePacks, TakeAnIllConditionedInertia) {
  Draw draw(44);
  const Parameters parameters{{{"strength", 1.0}, {"toughness", 1.0}, {"stiffness", 100.0}},
                              {{"shape", "bilinear"}}};
  const ilaw::interface law = bond_of(parameters);
  for (const bool is_fair : {true, false}) {
    Nodes nodes(law, 100);
    for (std::size_t i = 0; i < 100; ++i) {
      Problem p(draw, Curve(parameters), 0.0);
      if (i == 0) nodes.velocity_step = nodes.position_step = p.step;
      const double coupling = 1.0 - (is_fair ? 0x1p-10 : 0x1p-24);
      p.inertia.h = {Vector{1.0, coupling, 0.0}, {coupling, 1.0, 0.0}, {0.0, 0.0, 1.0}};
      nodes.set(i, p, p.damage);
    }
    EXPECT_EQ(one_by_one(nodes), 0);
  }
}

TEST(CohesivePacks, AreTheSameOnAllInstructionSets) {
  Draw draw(43);
  for (int k = 0; k < 40 && !HasFailure(); ++k) {
    const Parameters parameters = any_bond(draw);
    const Nodes given = drawn_nodes(parameters, draw, 0.5);
    std::vector<Nodes> all;
    for (const char* level : {"baseline", "v3", "v4"}) {
      setenv("ILAW_ISA", level, 1);
      all.emplace_back(given).law = std::make_shared<ilaw::interface>(bond_of(parameters));
      static_cast<void>(all.back().evaluate());
    }
    unsetenv("ILAW_ISA");
    EXPECT_TRUE(all[0] == all[1]) << "bond " << k << ", v3";
    EXPECT_TRUE(all[0] == all[2]) << "bond " << k << ", v4";
  }
}

// Returns the share of nodes that were solved one by one.
double give_their_bits_in_any_company(double coupled) {
  Draw draw(42);
  std::int64_t alone = 0, all = 0;
  for (int k = 0; k < 40 && !::testing::Test::HasFailure(); ++k) {
    const Parameters parameters = any_bond(draw);
    Parameters varied = parameters;
    varied.numbers.erase("strength");
    varied.per_node = {"strength"};
    const Nodes first = drawn_nodes(parameters, draw, coupled);
    Nodes together = first, apart = first;
    alone += one_by_one(together);
    all += static_cast<std::int64_t>(node_count);
    const std::vector<double> strength(node_count, parameters.numbers.at("strength"));
    apart.law = std::make_shared<ilaw::interface>(bond_of(varied));
    apart.per_node = {ilaw::input(strength.data(), 1, 1)};
    static_cast<void>(apart.evaluate());
    for (std::size_t i = 0; i < node_count; ++i) {
      Nodes one(first.law, 1);
      one.take(0, first, i);
      static_cast<void>(one.evaluate());  // refused nodes are to be the same, too
      EXPECT_TRUE(together.gives_bits_of(i, one, 0)) << "seed 42, bond " << k << ", node " << i;
    }
    EXPECT_TRUE(together == apart) << "seed 42, bond " << k << ", strength per node";
  }
  return static_cast<double>(alone) / static_cast<double>(all);
}

// Alone: a node that turns round as its bond is made; where H couples, what is broken, or breaks now, and
// what rubs.
TEST(CohesivePacks, GiveANodeItsBitsInAnyCompany) {
  EXPECT_LT(give_their_bits_in_any_company(0.0), 0.08);
  EXPECT_LT(give_their_bits_in_any_company(0.5), 0.3);
}

}  // namespace
}  // namespace ilaw::testing
