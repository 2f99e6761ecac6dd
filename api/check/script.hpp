// script.hpp - inputs of random nodes, step by step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/inputs.hpp"

#include <cstddef>
#include <vector>

namespace ilaw::check {

using Script = std::vector<Inputs>;

struct ScriptSize {
  std::size_t nodes = 13, steps = 5;
  bool may_shrink = false;  // the rule judges any part of it
};
// The nodes and steps that are kept of scripts that may shrink; empty: all.
struct Part {
  std::vector<std::size_t> nodes, steps;
};
void keep_part(const Part& part);  // of all scripts that this process draws

// Random nodes with motions and gaps of one size, most of them near contact. In every second script
// velocities stay or turn back, and normals of the host turn. A law that asks for v_smooth is given it in no,
// every or every second step. H is a multiple of the identity where "isotropic" says so, or the law can be
// given no other. Parameters per node differ from node to node.
Script draw_script(const Trial& trial, Draw& draw, const ScriptSize& size = {13, 5, true},
                   bool isotropic = false);

// Any v_smooth that impulses of other contacts can make: v_free, the velocity before the step, or another
// one.
void draw_smooth(Inputs& in, Draw& draw);

// The parameters of the trial with those of one node as constants.
Values constants_of(const Trial& trial, const Inputs& in, std::size_t node);

// A normal at an angle of at most half a right angle to this one.
Vector draw_turned(const Vector& normal, std::size_t dimension, Draw& draw);

// Axes of a node, right-handed but in 1D.
Matrix draw_axes(std::size_t dimension, Draw& draw);

}  // namespace ilaw::check
