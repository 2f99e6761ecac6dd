// law_setup.hpp - laws made for batches of any form of H, in any axes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/law_arguments.hpp"

namespace ilaw::host {

// Creates the law for a setup that has no arguments yet. Throws as create_law of law_arguments.hpp.
ilaw::interface create_law(const std::string& law, const Arguments& given, ilaw_setup setup,
                           const ilaw::library& library);

}  // namespace ilaw::host
