// kit.hpp - the authoring kit: write a law as one struct, get a law library. See docs/first_law.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/bond.hpp>
#include <ilaw/kit/common_parameters.hpp>
#include <ilaw/kit/contact.hpp>
#include <ilaw/kit/declare.hpp>
#include <ilaw/kit/friction.hpp>
#include <ilaw/kit/math.hpp>
#include <ilaw/kit/node.hpp>
#include <ilaw/kit/plugin.hpp>
#include <ilaw/kit/state.hpp>
