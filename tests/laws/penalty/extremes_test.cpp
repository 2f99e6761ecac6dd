// Springs where a number is zero, or as small or large as numbers are: no spring, no step, rest.
#include "support/law_runner.hpp"

#include <sstream>

namespace ilaw::testing {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
using Given = std::map<std::string, double>;

// Parameters that may stand beside a stiffness, explicit and implicit.
std::vector<Parameters> beside(double stiffness) {
  std::vector<Parameters> all;
  for (const char* integration : {"explicit", "implicit"})
    for (const double friction : {0.0, 0.4})
      for (const double tangential : {5e-324, 1e-3, 1e3, inf})
        for (const Given& more : {Given{},
                                  {{"damping", 7.0}},
                                  {{"restitution", 0.5}},
                                  {{"exponent", 1.5}},
                                  {{"exponent", 2.3}},
                                  {{"exponent", 1.5}, {"damping", 7.0}}}) {
          const bool is_explicit = integration == std::string("explicit");
          if (is_explicit && (stiffness == inf || more.contains("restitution"))) continue;
          if (is_explicit && friction > 0.0 && tangential == inf) continue;
          Given numbers = more;
          numbers.insert(
              {{"stiffness", stiffness}, {"friction", friction}, {"tangential_stiffness", tangential}});
          all.push_back({numbers, {{"integration", integration}}});
        }
  return all;
}

std::string words_of(const Parameters& given) {
  std::ostringstream words;
  words << given.texts.at("integration");
  for (const auto& [name, value] : given.numbers) words << ", " << name << " " << value;
  return words.str();
}

// Whether a node holds to `does` on every instruction set, with a scalar H and a full one, in steps and with
// inverse masses far apart.
template <class Does>
void expect_of_each(const Parameters& given, Does does) {
  for (const char* level : {"baseline", "v3", "v4"}) {
    setenv("ILAW_ISA", level, 1);
    for (const std::uint32_t form : {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_FULL}) {
      NodeRun node("penalty", given, 1.0, form);
      for (const double h : {1e-30, 1.0, 1e6})
        for (const double size : {1e-300, 11.0, 1e30}) {
          node.dt = h;
          node.h = {size, 1.5 * size, 0.8 * size, 0.2 * size, 0.1 * size, 0.0};
          node.state = {0.0, 0.0, 0.0, 0.0};
          EXPECT_TRUE(does(node)) << words_of(given) << "; " << level << ", form " << form << ", h " << h
                                  << ", H " << size << ", r " << ::testing::PrintToString(node.r);
        }
    }
  }
  unsetenv("ILAW_ISA");
}

// A step of a node that touches.
bool is_left_alone(NodeRun& node, const Vector& v) {
  node.v_previous = v;
  return node.step(v) == ILAW_OK && node.r == Vector{} && node.v == v && node.status == ILAW_FREE;
}

// A node at rest that touches stays there, whatever the spring.
TEST(PenaltyExtremes, NothingActsOnANodeAtRest) {
  for (const double stiffness : {0.0, 5e-324, 1e200, inf})
    for (const Parameters& given : beside(stiffness))
      expect_of_each(given, [](NodeRun& node) {
        const bool is_alone = is_left_alone(node, {});
        return is_alone && node.state == std::vector<double>(4);
      });
}

// Without stiffness and damper nothing acts on a node that comes, either.
TEST(PenaltyExtremes, NoSpringIsNoContact) {
  for (const Parameters& given : beside(0.0))
    if (!given.numbers.contains("damping"))
      expect_of_each(given, [](NodeRun& node) {
        bool are_alone = true;
        for (const double speed : {5e-324, 1e-300, 1e-160, 1.0, 1e150})
          are_alone &= is_left_alone(node, {-speed, 0.5 * speed, 0.0});
        return are_alone;
      });
}

// Speeds times a power of two are impulses times it, to the last bit and close to the least number, however
// small mass and step.
TEST(PenaltyExtremes, ImpulsesGrowWithTheSpeeds) {
  constexpr double h = 0x1p-30, delassus = 0x1p33;
  for (const double restitution : {1.0, 0.5}) {
    const auto impulse_at = [restitution](double speed) {
      NodeRun node("penalty",
                   {{{"stiffness", 0x1.8p27}, {"restitution", restitution}}, {{"integration", "implicit"}}},
                   h);
      node.h[0] = delassus;
      node.state[0] = 0.125 * h * speed;
      node.v_previous = {-0.75 * speed, 0.0, 0.0};
      EXPECT_EQ(node.step({-speed, 0.0, 0.0}), ILAW_OK);
      return node.r[0];
    };
    EXPECT_GT(impulse_at(1.0), 0.1 / delassus);
    EXPECT_EQ(impulse_at(0x1p-980), 0x1p-980 * impulse_at(1.0)) << "restitution " << restitution;
    EXPECT_EQ(impulse_at(0x1p900), 0x1p900 * impulse_at(1.0)) << "restitution " << restitution;
  }
}

// A rigid tangential spring has no slip: one that a state has of another spring counts nowhere.
TEST(PenaltyExtremes, ARigidTangentialSpringHasNoSlip) {
  for (const Given& more : {Given{}, {{"damping", 7.0}}, {{"exponent", 1.5}}, {{"exponent", 2.3}}})
    for (const std::uint32_t form : {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_FULL}) {
      Given numbers = more;
      numbers.insert({{"stiffness", 1e4}, {"friction", 0.4}});
      const auto impulse_with = [&](double slip) {
        NodeRun node("penalty", {numbers, {{"integration", "implicit"}}}, 1e-2, form);
        node.h = {1.0, 1.3, 0.8, 0.2, -0.1, 0.15};
        node.state = {0.01, slip, -slip, 0.0};
        node.v_previous = {-0.1, 0.02, 0.01};
        EXPECT_EQ(node.step({-0.1, 0.02, 0.01}), ILAW_OK);
        EXPECT_EQ(node.state[1], 0.0);
        return node.r;
      };
      EXPECT_EQ(impulse_with(1e-3), impulse_with(0.0)) << numbers.size() << " parameters, form " << form;
    }
}

}  // namespace
}  // namespace ilaw::testing
