#!/usr/bin/env bash
# The kernels of a law's SPIR-V as a shared library for this processor: back to LLVM's IR, whose address spaces and
# calling conventions are dropped, and compiled without fused operations. Usage: kernels_here.sh FROM.spirv TO.so CC
set -euo pipefail
from=$1 to=$2 compiler=$3
tool() { command -v "$1-14" || command -v "$1"; }
"$(tool llvm-spirv)" -r "$from" -o "$to.bc"
"$(tool llvm-dis)" "$to.bc" -o - |
  sed -E 's/spir_(kernel|func) //g; s/ byval\([^)]*\)//g; /^target /d; s/addrspace\([0-9]+\)//g; s/addrspacecast (.*) to /bitcast \1 to /' |
  "$(tool llc)" -mtriple=x86_64-linux-gnu -relocation-model=pic -fp-contract=off -O2 -filetype=obj -o "$to.o" -
cat > "$to.c" <<'C'
#include <stddef.h>
size_t ilaw_kernel_thread; /* which thread runs */
size_t _Z13get_global_idj(unsigned dimension) { return dimension == 0 ? ilaw_kernel_thread : 0; }
double _Z4sqrtd(double x) { return __builtin_sqrt(x); }
double _Z4fabsd(double x) { return __builtin_fabs(x); }
C
"$compiler" -O2 -fno-math-errno -fPIC -shared "$to.c" "$to.o" -o "$to"
