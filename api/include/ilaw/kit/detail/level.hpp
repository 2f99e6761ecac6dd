// level.hpp - instruction-set levels. ilaw_add_plugin compiles a law's source once per level, with the
// compiler's -march; each level lives in an inline namespace of its own, so that the linker never mixes their
// code. All levels give the same bits, since they do the same IEEE operations in the same order.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#ifndef ILAW_KIT_LEVEL
#define ILAW_KIT_LEVEL baseline
#endif
