// kit_probe.hpp - the law with every kind of state, kit_probe.cpp, beside those of the tree.
#pragma once

#include "support/law_runner.hpp"

namespace ilaw::testing {

inline ilaw::interface make_tested_law(const std::string& law, const SetupBuilder& setup) {
  return {ilaw::library(law.ends_with("_probe") ? ILAW_KIT_PROBE : plugin_file(law)), law, setup.setup};
}

inline const Parameters probe_parameters{{{"viscosity", 2.0}}, {}};

inline ilaw::interface make_probe(std::uint32_t frame = ILAW_FRAME_LOCAL) {
  return make_tested_law("kit_probe", SetupBuilder(probe_parameters, 3, ILAW_DELASSUS_SCALAR, frame));
}

}  // namespace ilaw::testing
