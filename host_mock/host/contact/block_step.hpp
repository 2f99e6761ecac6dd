// block_step.hpp - the step of contacts of which no two share a node, from gaps to new velocities, in blocks
// that stay in the cache. Where the contacts of a block and their nodes follow each other, the law reads and
// writes the host's own arrays; else the block gathers what the law asks for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/contact_arrays.hpp"
#include "contact/contact_heat.hpp"
#include "contact/contact_search.hpp"
#include "contact/contact_sums.hpp"
#include "contact/law.hpp"
#include "contact/obstacle_motion.hpp"

namespace ilaw::host {

// A step of an interface, the same for all its blocks.
struct BlockStep {
  const InterfaceSetup& setup;
  const Model& model;
  const double* inverse_mass;  // as impulses meet it, per degree of freedom
  const Law& law;
  ContactArrays& contacts;
  const StepView& step;
  const ObstacleMotion& obstacle;
  const std::vector<std::size_t>& axes;  // where they begin in the state
  Dofs& v;                               // v_free, then what the impulses make of it
  bool gets_energies, gets_amounts;
  ContactHeat* heat;  // null: no temperatures
  bool one_by_one;    // each contact is gathered alone: same bits, more work
};

// The result of the contacts of a chunk.
struct ChunkOutcome {
  ContactSums sums;
  Refusal refusal;
};

// Adds what becomes of the contacts to outcome.
using ChunkStep = void (*)(const BlockStep& step, NearContacts contacts, ChunkOutcome& outcome);
// The one for the dimension and the counterpart of an interface.
ChunkStep chunk_step_of(const BlockStep& step);

}  // namespace ilaw::host
