// SPDX-License-Identifier: BSD-3-Clause
#include "base/words.hpp"
#include "stress/made_problem.hpp"
#include "stress/random_parts.hpp"
#include "stress/stress.hpp"

namespace ilaw::host {
namespace {

ilaw_delassus_form random_form(const ilaw_law& law, Draw& draw) {
  std::vector<ilaw_delassus_form> forms;
  for (const ilaw_delassus_form form :
       {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_TRANSVERSE, ILAW_DELASSUS_FULL, ILAW_DELASSUS_TRANSVERSE_SPIN})
    if (law.delassus_forms & form) forms.push_back(form);
  return forms.empty() ? ilaw_delassus_form{ILAW_DELASSUS_FULL} : draw.one_of(forms);
}

MadeSetup random_setup(ilaw_delassus_form form, Draw& draw) {
  MadeSetup setup;
  setup.bodies = draw.whole(1, 8);
  setup.contacts = draw.whole(1, 2 * setup.bodies + 2);
  setup.mass_decades = draw.chance(0.3) ? 6.0 : 0.0;
  setup.normals = draw.one_of<MadeSetup::Normals>(
      {MadeSetup::Normals::any, MadeSetup::Normals::wedged, MadeSetup::Normals::redundant});
  setup.gap = draw.one_of<double>({0.0, 1e-6, 0.1});
  if (form != ILAW_DELASSUS_FULL) return setup;
  setup.rotate = draw.chance(0.5);
  if (!setup.rotate && draw.chance(0.5)) setup.no_freedom = 0.3;
  return setup;
}

// Most draws are refused by laws whose parameters depend on each other: a few tries are made.
std::optional<interface> random_interface(const LawBook::Entry& entry, ilaw_delassus_form form, double step,
                                          Draw& draw) {
  constexpr int most_tries = 20;
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = form;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  for (int k = 0; k < most_tries; ++k) try {
      parameters given;
      const nlohmann::json drawn = random_parameters(*entry.law, step, draw);
      for (const auto& [name, value] : drawn.items())
        if (value.is_string() || value.is_number())
          given.set(*entry.law, name, value.is_string() ? value.get<std::string>() : value.dump());
      given.give(setup);
      return interface(*entry.library, entry.law->id, setup);
    } catch (const error&) {
    }
  return {};
}

std::string fault_of(const MadeAudit& found) {
  constexpr double most_off = 1e-8, rounding = 1e-9;
  if (found.residual > most_off) return formatted("contacts are off by %.1e", found.residual);
  if (found.momentum > rounding) return formatted("velocities are off by %.1e of momentum", found.momentum);
  return found.work > rounding ? formatted("the work is off by %.1e", found.work) : "";
}

}  // namespace

std::optional<std::string> stress_coupled(const LawBook::Entry& law, std::uint64_t seed, StressRow& row) {
  constexpr double well_posed = 1e-9;
  if (!(law.law->dimensions & ILAW_DIMENSION_3)) return {};
  Draw draw(seed);
  const ilaw_delassus_form form = random_form(*law.law, draw);
  const MadeSetup setup = random_setup(form, draw);
  const std::optional<interface> made = random_interface(law, form, setup.step, draw);
  if (!made) return {};
  MadeProblem problem({&*made}, form, setup, draw);
  if (!(problem.audit_of_solution().residual <= well_posed))
    return {};  // the law's answer is not known better
  coupled solver;
  ilaw_coupled_report report{};
  try {
    report = problem.solve(solver, {});
  } catch (const error&) {
    return {};  // an input that coupled contacts do not have, or an axis without freedom
  }
  if (report.bad_count > 0) return {};  // the law has no single answer at this H and step
  ++row.made;
  if (report.message) {
    ++row.unsolved;
    return {};
  }
  const std::string fault = fault_of(problem.audit(report));
  if (fault.empty()) return {};
  return formatted(
      "%d coupled contacts of %d bodies, made from their solution, are called solved: %s of the "
      "largest velocity of the problem",
      problem.contact_count(), problem.body_count(), fault.c_str());
}

}  // namespace ilaw::host
