// law_faults.hpp - impossible results that a law returns with the code ILAW_OK. Faults of summed values
// show in the sums, at no cost per contact; the contact is sought once something is wrong.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/contact_sums.hpp"

namespace ilaw::host {

// Whether one of the contacts added up may have such an answer.
bool show_fault(const ContactSums& sums);

// The error in the answer for a contact; null where there is none. The text stays until the
// thread's next call. energy has ILAW_ENERGY_COUNT values.
const char* fault_of(const double* impulse, int dimension, const double* energy, int status);

}  // namespace ilaw::host
