// SPDX-License-Identifier: BSD-3-Clause
#include "contact/law.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

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

Answer Law::initialise(ilaw_batch batch, const std::vector<std::int32_t>& contacts) const {
  batch.index = contacts.data();
  batch.node_count = static_cast<std::int64_t>(contacts.size());
  Answer answer{ILAW_OK, {}};
  answer.report.struct_size = sizeof(ilaw_report);
  answer.code = interface_.initialise(batch, &answer.report);
  return answer;
}

Answer Law::evaluate(const ilaw_batch& batch, const std::vector<std::int32_t>& contacts) const {
  const auto count = static_cast<std::ptrdiff_t>(contacts.size());
  const std::ptrdiff_t chunks = (count + chunk - 1) / chunk;
  std::vector<Answer> answers(static_cast<std::size_t>(chunks), Answer{ILAW_OK, {}});
#pragma omp parallel for schedule(static) if (chunks > 1)
  for (std::ptrdiff_t c = 0; c < chunks; ++c) {
    Answer& answer = answers[static_cast<std::size_t>(c)];
    ilaw_batch part = batch;
    part.index = contacts.data() + c * chunk;
    part.node_count = std::min(std::ptrdiff_t{chunk}, count - c * chunk);
    answer.report.struct_size = sizeof(ilaw_report);
    answer.code = interface_.evaluate(part, &answer.report);
  }
  Answer all{ILAW_OK, {}};
  all.report.stable_velocity_step = std::numeric_limits<double>::infinity();
  for (const Answer& answer : answers) {
    if (answer.code != ILAW_OK) return answer;
    // 0: a library that does not say
    if (const double stable = answer.report.stable_velocity_step; stable > 0.0)
      all.report.stable_velocity_step = std::min(all.report.stable_velocity_step, stable);
  }
  return all;
}

}  // namespace ilaw::host
