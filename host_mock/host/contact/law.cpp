// SPDX-License-Identifier: BSD-3-Clause
#include "contact/law.hpp"

#include "base/running_call.hpp"

#include <ilaw/floating_control.hpp>

#include <cxxabi.h>

#include <algorithm>
#include <exception>

namespace ilaw::host {
namespace {

ilaw::library open_library(const std::string& library, const std::string& law) {
  const RunningCall running({law.c_str(), library.c_str()});
  return library.find('/') == std::string::npos ? ilaw::library::named(library) : ilaw::library(library);
}

ilaw::interface create_named(const std::string& law, const Arguments& arguments, const Vector& tangent,
                             const ilaw::library& library, int dimension, std::uint32_t delassus_form) {
  const RunningCall running({law.c_str(), ilaw_library_path(library.get())});
  return create_law(law, arguments, tangent, library, dimension, delassus_form);
}

// The text stays until the thread's next call of a law.
Answer broken(const std::string& what) {
  static thread_local std::string text;
  text = what;
  Answer answer{ILAW_BAD_LIBRARY, {}};
  answer.report.first_bad_node = -1;
  answer.report.reason = text.c_str();
  return answer;
}

bool is_in(const ilaw_batch& batch, std::int64_t node) {
  if (!batch.index) return node >= 0 && node < batch.node_count;
  return std::find(batch.index, batch.index + batch.node_count, node) != batch.index + batch.node_count;
}

}  // namespace

Law::Law(const std::string& library, const std::string& law, const Arguments& arguments,
         const Vector& tangent, int dimension, const std::string& interface, std::uint32_t delassus_form)
    : library_(open_library(library, law)),
      interface_(create_named(law, arguments, tangent, library_, dimension, delassus_form)),
      info_(interface_.info()),
      outputs_(library_.law(law)->outputs),
      id_(library_.law(law)->id),
      interface_name_(interface.c_str()) {}

std::vector<std::size_t> Law::axes() const {
  std::vector<std::size_t> axes;
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < info_.state_variable_count; at += info_.state_variables[i++]->count)
    if (info_.state_variables[i]->kind == ILAW_KIND_AXIS) axes.push_back(at);
  return axes;
}

// A call of a library's code; no exception and no mode of the processor that it leaves goes further.
Answer Law::answer_of(Call call, const ilaw_batch& batch) const {
  const RunningCall running(
      {id_, ilaw_library_path(library_.get()), interface_name_, batch.time, batch.position_step});
  Answer answer{ILAW_OK, {}};
  answer.report.struct_size = sizeof(ilaw_report);
  const ilaw::floating_control before = ilaw::floating_control::now();
  try {
    answer.code = call(interface_.get(), &batch, &answer.report);
  } catch (const abi::__forced_unwind&) {
    throw;
  } catch (const std::exception& error) {
    return broken(std::string("it threw an exception: ") + error.what());
  } catch (...) {
    return broken("it threw an exception");
  }
  if (ilaw::floating_control::now() != before) {
    before.restore();
    return broken("it changed how the processor rounds, traps or flushes, expected all as it was");
  }
  // NaN is smaller than no step: it would pass for no limit at all.
  if (const double step = answer.report.stable_velocity_step; !(step >= 0.0))
    return broken("it reported the stable step " + std::to_string(step) + " s, expected none below 0");
  if (answer.code == ILAW_OK) return answer;
  if (answer.code > ILAW_BAD_NODES || answer.code < ILAW_OUT_OF_MEMORY)
    return broken("it returned the code " + std::to_string(answer.code) + ", which ABI 1 does not know");
  const std::int64_t first = answer.report.first_bad_node;
  if (answer.code == ILAW_BAD_NODES && !is_in(batch, first))
    return broken("it named node " + std::to_string(first) +
                  ", which is none of the batch, as the first bad one");
  return answer;
}

}  // namespace ilaw::host
