// SPDX-License-Identifier: BSD-3-Clause
#include "contact/law.hpp"

namespace ilaw::host {

Law::Law(const std::string& library, const std::string& law, const Arguments& arguments,
         const Vector& tangent, int dimension)
    : library_(library.find('/') == std::string::npos ? ilaw::library::named(library)
                                                      : ilaw::library(library)),
      interface_(create_law(law, arguments, tangent, library_, dimension)),
      info_(interface_.info()) {}

bool Law::carries_axes() const {
  for (std::uint32_t i = 0; i < info_.state_variable_count; ++i)
    if (info_.state_variables[i]->kind == ILAW_STATE_AXIS) return true;
  return false;
}

Answer Law::initialise(const ilaw_batch& batch) const {
  Answer answer{ILAW_OK, {}};
  answer.report.struct_size = sizeof(ilaw_report);
  answer.code = interface_.initialise(batch, &answer.report);
  return answer;
}

Answer Law::evaluate(const ilaw_batch& batch) const {
  Answer answer{ILAW_OK, {}};
  answer.report.struct_size = sizeof(ilaw_report);
  answer.code = interface_.evaluate(batch, &answer.report);
  return answer;
}

}  // namespace ilaw::host
