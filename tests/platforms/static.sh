#!/usr/bin/env bash
# A host and a law in C in one static program, by each C compiler that is here: glibc and musl, and other processors under
# qemu-user. All must print the same line, at two levels of optimization.
#   tests/platforms/static.sh FOLDER          for its programs
# On Debian: musl-tools, gcc-aarch64-linux-gnu, gcc-powerpc64le-linux-gnu, gcc-riscv64-linux-gnu, qemu-user.
set -euo pipefail
folder=$(mkdir -p "$1" && cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
expected= failed=0
for compiler in gcc clang musl-gcc {aarch64,powerpc64le,riscv64,s390x}-linux-gnu-gcc; do
  command -v "$compiler" >/dev/null || continue
  emulator=
  case $compiler in
    powerpc64le-*) emulator=qemu-ppc64le ;;
    *-linux-gnu-gcc) emulator=qemu-${compiler%-linux-gnu-gcc} ;;
  esac
  [ -z "$emulator" ] || command -v "$emulator" >/dev/null || continue
  for level in -O0 -O2; do
    "$compiler" -std=c99 $level -ffp-contract=off -static -Iapi/include tests/platforms/static_host.c \
      plugins/template_c/template_c.c -lm -o "$folder/$compiler$level"
    line=$($emulator "$folder/$compiler$level")
    echo "$compiler $level: $line"
    [ "${expected:=$line}" = "$line" ] || failed=1
  done
done
exit $failed
