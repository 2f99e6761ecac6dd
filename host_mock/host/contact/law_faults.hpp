// law_faults.hpp - impossible results that a law returns with the code ILAW_OK. Faults of summed values
// show in the sums, at no cost per contact; the contact is sought once something is wrong.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/contact_sums.hpp"
#include "contact/refusal.hpp"

#include <ilaw/ilaw.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ilaw::host {

// Whether one of the contacts added up may have such an answer.
bool show_fault(const ContactSums& sums);

// The error in the answer for a contact; null where there is none. The text stays until the
// thread's next call. energy has ILAW_ENERGY_COUNT values.
const char* fault_of(const double* impulse, int dimension, const double* energy, int status);

// The refusal of a law that wrote to the named input.
Refusal overwriting(const char* input);

// Inputs of a batch as they were, to see whether a law writes to them.
class InputCopy {
 public:
  // Watched are the start, the first step and every thousandth after them. A law that writes to
  // its inputs does so at once; `ilaw check` looks at every call.
  static bool is_due(std::int64_t step) { return step % 1000 <= 1; }

  InputCopy(const ilaw_batch& batch, std::size_t dimension, const ilaw_instance_info& info);
  // The name of the first input that changed; null where none did.
  const char* changed() const;

 private:
  struct Input {
    const char* name;
    ilaw_input from;
    std::size_t components;
    std::vector<double> values;
  };
  std::vector<double> read(const ilaw_input& from, std::size_t components) const;

  std::vector<std::size_t> entries_;
  std::vector<Input> inputs_;
};

}  // namespace ilaw::host
