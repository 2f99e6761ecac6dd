// dynamic.hpp - dlopen and its kin by their first versions, so that a loader built here runs on an older
// glibc: 2.34 moved them from libdl to libc and gave them new ones.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dlfcn.h>

#if defined(__GLIBC__) && defined(__x86_64__)
#define ILAW_FIRST_VERSION "GLIBC_2.2.5"
#elif defined(__GLIBC__) && defined(__aarch64__)
#define ILAW_FIRST_VERSION "GLIBC_2.17"
#endif

#if defined(ILAW_FIRST_VERSION)
__asm__(".symver dlopen,dlopen@" ILAW_FIRST_VERSION);
__asm__(".symver dlsym,dlsym@" ILAW_FIRST_VERSION);
__asm__(".symver dlclose,dlclose@" ILAW_FIRST_VERSION);
__asm__(".symver dladdr,dladdr@" ILAW_FIRST_VERSION);
__asm__(".symver dlerror,dlerror@" ILAW_FIRST_VERSION);
#endif
