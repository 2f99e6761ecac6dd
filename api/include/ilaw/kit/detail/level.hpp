// level.hpp - instruction-set levels. ilaw_add_plugin compiles a law's source once per level, with the
// compiler's -march. Each level lives in an inline namespace of its own, so that the linker never mixes their
// code. All levels give the same bits: they do the same IEEE operations in the same order.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#ifndef ILAW_KIT_LEVEL
#define ILAW_KIT_LEVEL baseline
#endif

// Whether better levels are compiled beside this one. It then serves processors older than 2013 and must give
// the bits, not the speed: all its nodes go the careful way, and the fast loops are not compiled.
#ifdef ILAW_KIT_OTHER_LEVELS
#define ILAW_KIT_IS_SPARE true
#else
#define ILAW_KIT_IS_SPARE false
#endif

#ifdef __FAST_MATH__
#error "the kit needs IEEE arithmetic: compile without -ffast-math"
#endif

// Small functions of packs: a call would pass their registers through memory.
#define ILAW_KIT_INLINE [[gnu::always_inline]] inline
#define ILAW_KIT_LAMBDA __attribute__((always_inline))

// Functions that a loop over packs rarely needs. On a device a call would put the node into memory.
#if defined(ILAW_KIT_DEVICE)
#define ILAW_KIT_APART ILAW_KIT_INLINE
#else
#define ILAW_KIT_APART [[gnu::noinline]]
#endif

// A value that is kept in a vector register: compilers would else read parts of it from memory again.
#if defined(__SSE2__)
#define ILAW_KIT_IN_REGISTER(value) asm("" : "+v"(value))
#else
#define ILAW_KIT_IN_REGISTER(value) static_cast<void>(value)
#endif
