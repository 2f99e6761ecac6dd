// Every law's contact on a bar between two walls, up to the critical step: interfaces put no energy in. There
// the end of the bar often moves off within the step whose forces would press it: a contact that stops it
// does positive work, and the motion diverges within some hundred steps.
#include "host_runner.hpp"

#include <ostream>

namespace ilaw::host::testing {
namespace {

struct Case {
  const char* name;
  const char* interface;  // law and parameters
  double start = 0.5;     // of a bar of length 1, between walls at 0 and 2
  double far_wall = 2.0;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

// A bond that is made at the start, where it may be at a distance, has to be broken, or to be made in touch.
const std::vector<Case> cases = {
    {"contact", R"("law": "contact")"},
    {"contact_05", R"("law": "contact", "parameters": {"restitution": 0.5})"},
    {"contact_1", R"("law": "contact", "parameters": {"restitution": 1.0})"},
    {"contact_moreau", R"("law": "contact", "parameters": {"activation": "moreau"})"},
    {"contact_moreau_05", R"("law": "contact", "parameters": {"activation": "moreau", "restitution": 0.5})"},
    {"coulomb", R"("law": "coulomb", "parameters": {"friction": 0.3})"},
    {"coulomb_moreau", R"("law": "coulomb", "parameters": {"friction": 0.3, "activation": "moreau"})"},
    {"postit", R"("law": "postit")"},
    {"postit_that_wears", R"("law": "postit", "parameters": {"efficiency_decrease": 5.0})"},
    {"postit_without_adhesion", R"("law": "postit", "parameters": {"adhesion_limit": 0.0})"},
    {"postit_saturated",
     R"("law": "postit", "parameters": {"rupture": "saturated", "efficiency_decrease": 5.0})"},
    {"postit_bonded", R"("law": "postit", "parameters": {"initial_adhesion": 0.01})", 0.0, 1.0},
    {"penalty_implicit", R"("law": "penalty", "parameters": {"stiffness": 1e3, "integration": "implicit"})"},
    {"penalty_implicit_05",
     R"("law": "penalty", "parameters": {"stiffness": 1e6, "integration": "implicit", "restitution": 0.5})"},
    {"tie", R"("law": "tie")", 0.0, 1.0},
    {"tie_broken", R"("law": "tie", "parameters": {"strength": 1e-9})"},
    {"cohesive_broken", R"("law": "cohesive", "parameters": {"strength": 1.0, "toughness": 0.0})"},
    {"cohesive", R"("law": "cohesive", "parameters": {"strength": 0.05, "toughness": 1e-4})", 0.0, 1.0},
    {"cohesive_that_softens",
     R"("law": "cohesive", "parameters": {"strength": 0.05, "toughness": 5e-3, "stiffness": 2.0})", 0.0, 1.0},
    {"cohesive_that_holds", R"("law": "cohesive", "parameters": {"strength": 10.0, "toughness": 1.0})", 0.0,
     1.0}};

json scene_of_case(const Case& drawn, double cfl) {
  const json law = json::parse(std::string("{") + drawn.interface + "}");
  const auto end = [&](const char* name, double wall, double normal) {
    json made = law;
    made.update(
        {{"name", name}, {"nodes", std::string("bar.") + name}, {"obstacle", plane({wall}, {normal})}});
    return made;
  };
  return until_at_cfl(1e9, cfl,
                      scene_of_bars({bar("bar", drawn.start, 1, 20, 1, 1, -0.1)},
                                    {end("left", 0.0, 1.0), end("right", drawn.far_wall, -1.0)}));
}

class CriticalStep : public ::testing::TestWithParam<Case> {};

// The number of steps may be set, for a run of a million, which tells what it found.
TEST_P(CriticalStep, InterfacesPutNoEnergyIn) {
  const char* given = std::getenv("ILAW_TEST_STEPS");
  const int steps = given ? std::atoi(given) : 20000;
  for (const double cfl : {0.9, 0.98, 0.99, 0.995, 0.999, 1.0}) {
    auto [scene, integrator] = simulation_of(scene_of_case(GetParam(), cfl));
    const EnergyReport first = integrator.energy();
    const double initial = first.kinetic + first.internal;
    // At the critical step itself the bar's fastest mode grows in proportion to time, without energy: what
    // rounding leaves is of the kinetic energy of then.
    double most = 0.0, largest = initial;
    for (int k = 0; k < steps && most < 1.0; ++k) {
      integrator.step();
      const EnergyReport energy = integrator.energy();
      most = std::max(most, energy.interface_work / initial);
      largest = std::max(largest, energy.kinetic);
    }
    if (given)
      std::printf("%s, cfl %g, %lld steps: %.1e, kinetic %.1e\n", GetParam().name, cfl,
                  static_cast<long long>(integrator.steps()), most, largest / initial);
    EXPECT_LE(most, 1e-10) << "of the energy put in at cfl " << cfl << " within " << integrator.steps()
                           << " steps";
    EXPECT_LE(integrator.energy().reaction_work, 1e-10 * largest)
        << "cfl " << cfl << ", largest kinetic energy " << largest / initial << " of the first";
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, CriticalStep, ::testing::ValuesIn(cases),
                         [](const auto& drawn) { return std::string(drawn.param.name); });

}  // namespace
}  // namespace ilaw::host::testing
