#!/usr/bin/env bash
# Builds the program and the laws in Release, runs the shipped scenes, and makes a page of them that moves.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bash host_mock/setup.sh
echo "build: build/release"
# Where nothing is built yet, laws for this processor and, slower, for all others; tests/run.sh adds the rest.
levels=()
[ -e build/release ] || levels=(-DILAW_LEVELS="$(grep -q ' avx512vl ' /proc/cpuinfo && echo v4 || echo v3)")
cmake --preset release -DILAW_TESTS=OFF "${levels[@]}" >/dev/null
quiet=()
[ -t 1 ] || quiet=(-- --quiet)  # on a terminal ninja shows how far it is
cmake --build --preset release "${quiet[@]}"

# As many at once as there are processors; what each says comes together.
printf '%s\n' host_mock/scenes/*.json plugins/*/*.json | xargs -P "$(nproc)" -I{} sh -c '
  said=$(build/release/bin/ilaw run "$1" --threads 1 --out build/release/demo/"$(basename "$1" .json)") && echo "$said"' _ {}
echo "pictures: build/release/demo"
/usr/bin/python3 host_mock/demo_page.py build/release/demo
