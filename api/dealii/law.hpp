// law.hpp - the laws of the examples, with their parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/loader.hpp>

#include <string>

inline ilaw::interface create_law(const std::string& law) {
  ilaw::parameters parameters;
  if (law != "contact") parameters.number("friction", 0.3);
  if (law == "rccm") {
    parameters.number("normal_stiffness", 1000.0).number("tangential_stiffness", 500.0);
    parameters.number("adhesion_energy", 0.01).number("viscosity", 2e-4);
  }
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  parameters.give(setup);
  return {ilaw::library::named(law), "", setup};
}
