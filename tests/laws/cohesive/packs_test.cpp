// Cohesive zones that are solved side by side: the equations of the page, and the same bits in any company.
#include "any_inertia.hpp"

#include <ilaw/ext/draft/profile.h>
#include <ilaw/arrays.hpp>

#include <algorithm>
#include <cstring>

namespace ilaw::testing {
namespace {

Inertia transverse(Draw& draw, double decades) {
  Inertia made(draw, 0.0);
  const double tangential = draw.power_of_ten(-decades, decades);
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

// What a node gives: impulse, velocity, energies, state.
struct Given {
  std::vector<double> numbers;
  std::uint8_t status;
};

struct Nodes {
  static constexpr std::size_t states = 7, outputs = 3 + 3 + 4;

  explicit Nodes(std::size_t count)
      : h(6 * count),
        v_free(3 * count),
        before(3 * count),
        gap(count),
        area(count, 1.0),
        state(states * count),
        given(outputs * count),
        status(count) {}

  ilaw_batch batch() {
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = static_cast<std::int64_t>(status.size());
    b.velocity_step = step;
    b.position_step = position_step;
    b.v_free = ilaw::input(v_free.data(), 3, 1);
    b.delassus = ilaw::input(h.data(), 6, 1);
    b.gap = ilaw::input(gap.data(), 1, 1);
    b.v_previous = ilaw::input(before.data(), 3, 1);
    b.area = ilaw::input(area.data(), 1, 1);
    b.state_in = ilaw::input(state.data(), states, 1);
    b.state_out = ilaw::output(state.data(), states, 1);
    b.impulse = ilaw::output(given.data(), outputs, 1);
    b.velocity = ilaw::output(given.data() + 3, outputs, 1);
    b.energy = ilaw::output(given.data() + 6, outputs, 1);
    b.status = status.data();
    b.status_stride = 1;
    return b;
  }
  void set(std::size_t i, const Problem& p, double damage) {
    const std::array<double, 6> entries = p.inertia.entries();
    std::copy(entries.begin(), entries.end(), h.begin() + 6 * i);
    std::copy(p.v_free.begin(), p.v_free.end(), v_free.begin() + 3 * i);
    std::copy(p.v_previous.begin(), p.v_previous.end(), before.begin() + 3 * i);
    const double kept[] = {damage,       p.position[0], p.position[1], p.position[2],
                           p.opening[0], p.opening[1],  p.opening[2]};
    std::copy(std::begin(kept), std::end(kept), state.begin() + states * i);
  }
  // Node i of these as node k of others.
  void take(std::size_t k, const Nodes& from, std::size_t i) {
    std::copy_n(from.h.begin() + 6 * i, 6, h.begin() + 6 * k);
    std::copy_n(from.v_free.begin() + 3 * i, 3, v_free.begin() + 3 * k);
    std::copy_n(from.before.begin() + 3 * i, 3, before.begin() + 3 * k);
    std::copy_n(from.state.begin() + states * i, states, state.begin() + states * k);
    gap[k] = from.gap[i];
    step = from.step;
    position_step = from.position_step;
  }
  Given at(std::size_t i) const {
    Given g{{given.begin() + outputs * i, given.begin() + outputs * (i + 1)}, status[i]};
    g.numbers.insert(g.numbers.end(), state.begin() + states * i, state.begin() + states * (i + 1));
    return g;
  }

  double step = 0.0, position_step = 0.0;
  std::vector<double> h, v_free, before, gap, area, state, given;
  std::vector<std::uint8_t> status;
};

bool same_bits(const Given& a, const Given& b) {
  return a.status == b.status &&
         std::memcmp(a.numbers.data(), b.numbers.data(), a.numbers.size() * sizeof(double)) == 0;
}

// Bonds that hold, soften and are broken, of one kind; with an H that couples at so many of them.
Nodes drawn_nodes(Draw& draw, const Curve& curve, std::size_t count, double coupled) {
  Nodes nodes(count);
  for (std::size_t i = 0; i < count; ++i) {
    Problem p(draw, curve, 0.0);
    if (i == 0) nodes.step = p.step;
    p.inertia = draw.between(0.0, 1.0) < coupled ? Inertia(draw, 1.0) : transverse(draw, 1.0);
    const double kind = draw.between(0.0, 1.0), faster = p.step / nodes.step;
    for (Vector* velocity : {&p.v_free, &p.v_previous})
      for (double& component : *velocity) component *= faster;
    if (kind < 0.2) p.position = p.opening = {};
    nodes.set(i, p, kind < 0.2 ? 0.0 : kind < 0.4 ? 1.0 : p.damage);
    nodes.gap[i] = draw.between(-1.0, 1.0) * nodes.step;
  }
  nodes.position_step = nodes.step * (draw.between(0.0, 1.0) < 0.5 ? 1.0 : draw.between(0.7, 1.4));
  return nodes;
}

// Evaluates them; returns how many were solved one by one.
std::int64_t one_by_one(const ilaw::interface& law, Nodes& nodes) {
  const auto* profile = static_cast<const ilaw_profile*>(law.law().extension(ILAW_PROFILE));
  std::int64_t count = 0;
  const ilaw_batch b = nodes.batch();
  profile->evaluate_counting(law.instance(), &b, nullptr, &count);
  return count;
}

// Also where two axes are nearly one.
TEST(CohesivePacks, TakeAnIllConditionedInertia) {
  Draw draw(44);
  const Parameters parameters{{{"strength", 1.0}, {"toughness", 1.0}, {"stiffness", 100.0}},
                              {{"shape", "bilinear"}}};
  const ilaw::interface law = make_law("cohesive", SetupBuilder(parameters, 3, ILAW_DELASSUS_FULL));
  for (const bool is_fair : {true, false}) {
    Nodes nodes(100);
    for (std::size_t i = 0; i < 100; ++i) {
      Problem p(draw, Curve(parameters), 0.0);
      if (i == 0) nodes.step = nodes.position_step = p.step;
      const double coupling = 1.0 - (is_fair ? 0x1p-10 : 0x1p-24);
      p.inertia.h = {Vector{1.0, coupling, 0.0}, {coupling, 1.0, 0.0}, {0.0, 0.0, 1.0}};
      nodes.set(i, p, p.damage);
    }
    EXPECT_EQ(one_by_one(law, nodes), 0);
  }
}

TEST(CohesivePacks, AreTheSameOnAllInstructionSets) {
  Draw draw(43);
  for (int k = 0; k < 40 && !HasFailure(); ++k) {
    const Parameters parameters = any_bond(draw);
    const Nodes given = drawn_nodes(draw, Curve(parameters), 150, 0.5);
    std::vector<Nodes> all;
    for (const char* level : {"baseline", "v3", "v4"}) {
      setenv("ILAW_ISA", level, 1);
      const ilaw::interface law = make_law("cohesive", SetupBuilder(parameters, 3, ILAW_DELASSUS_FULL));
      const ilaw_batch b = all.emplace_back(given).batch();
      static_cast<void>(law.evaluate(b));
    }
    unsetenv("ILAW_ISA");
    for (std::size_t i = 0; i < 150; ++i) {
      EXPECT_TRUE(same_bits(all[0].at(i), all[1].at(i))) << "bond " << k << ", node " << i << ", v3";
      EXPECT_TRUE(same_bits(all[0].at(i), all[2].at(i))) << "bond " << k << ", node " << i << ", v4";
    }
  }
}

// Returns the share of nodes that were solved one by one.
double give_their_bits_in_any_company(double coupled) {
  Draw draw(42);
  constexpr std::size_t count = 150;  // more than two blocks
  std::int64_t alone = 0, all = 0;
  for (int k = 0; k < 40 && !::testing::Test::HasFailure(); ++k) {
    const Parameters parameters = any_bond(draw);
    Parameters varied = parameters;
    varied.numbers.erase("strength");
    varied.per_node = {"strength"};
    const ilaw::interface law = make_law("cohesive", SetupBuilder(parameters, 3, ILAW_DELASSUS_FULL));
    const ilaw::interface per_node = make_law("cohesive", SetupBuilder(varied, 3, ILAW_DELASSUS_FULL));
    const Nodes first = drawn_nodes(draw, Curve(parameters), count, coupled);
    Nodes together = first, apart = first;
    alone += one_by_one(law, together);
    all += static_cast<std::int64_t>(count);
    ilaw_batch c = apart.batch();
    const std::vector<double> strength(count, parameters.numbers.at("strength"));
    const ilaw_input values = ilaw::input(strength.data(), 1, 1);
    c.per_node_parameters = &values;
    static_cast<void>(per_node.evaluate(c));
    for (std::size_t i = 0; i < count; ++i) {
      Nodes one(1);
      one.take(0, first, i);
      const ilaw_batch single = one.batch();
      static_cast<void>(law.evaluate(single));  // refused nodes are to be the same, too
      EXPECT_TRUE(same_bits(together.at(i), one.at(0))) << "seed 42, bond " << k << ", node " << i;
      EXPECT_TRUE(same_bits(together.at(i), apart.at(i)))
          << "seed 42, bond " << k << ", node " << i << ", strength per node";
    }
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
