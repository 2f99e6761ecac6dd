// kit.hpp - the authoring kit: write a law as one struct, get a law library. See docs/first_law.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/friction.hpp>
#include <ilaw/kit/plugin.hpp>
