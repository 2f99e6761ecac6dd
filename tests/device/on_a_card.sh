#!/usr/bin/env bash
# Kernels of laws on the card of this machine: bits beside the libraries, then ns per node beside the card's triad.
# Says so, and ends with 77, where there is none. Usage: tests/device/on_a_card.sh [build folder] [nodes]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build/release} nodes=${2:-10000000}
if [ ! -x "$build/bin/device_test" ] || [ ! -x "$build/bin/device_bench" ]; then
  echo "on_a_card: no $build/bin/device_test: build the targets device_test and device_bench, with clang 14 or later" >&2
  exit 2
fi
for driver in cuda opencl; do
  echo "== $driver"
  bench=$("$build/bin/device_bench" $driver 1000 none 2>&1) || { echo "$bench"; continue; }
  found=yes
  ILAW_TEST_DRIVER=$driver "$build/bin/device_test" --gtest_brief=1
  "$build/bin/device_bench" $driver "$nodes"
done
[ -n "${found:-}" ] || { echo "on_a_card: no device here"; exit 77; }
