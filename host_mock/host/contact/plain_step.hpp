// plain_step.hpp - the step of contacts of which no two share a node, contact by contact: the text that
// block_step.cpp is fused from. Tests compare their bits; `Interface::step_plainly` chooses it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/block_step.hpp"

namespace ilaw::host {

// As solve_chunk.
void plain_step(const BlockStep& step, const NearContacts& contacts, ChunkOutcome& outcome);

}  // namespace ilaw::host
