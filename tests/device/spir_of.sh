#!/usr/bin/env bash
# SPIR of a law's SPIR-V for Debian's pocl, which takes no SPIR-V and is wrong where a kernel calls functions: all are
# inlined. Called as llvm-spirv is: spir_of.sh -r --spirv-target-env=CL1.2 FROM -o TO
set -euo pipefail
from=$3 to=$5
tool() { command -v "$1-14" || command -v "$1"; }
"$(tool llvm-spirv)" "$1" "$2" "$from" -o "$to.called"
"$(tool llvm-dis)" "$to.called" -o - |
  sed -E 's/^(define (internal )?spir_func .*\)) (.*)\{$/\1 alwaysinline \3{/; s/^(attributes .*)\bnoinline\b/\1/' |
  "$(tool opt)" -passes='always-inline,globaldce' -o "$to" -
