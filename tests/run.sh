#!/usr/bin/env bash
# Sets up, builds in Release and runs all tests. Arguments go to ctest.
#
#   tests/run.sh                 everything
#   tests/run.sh -R postit       builds and runs only programs with a test of this name (a regular expression, as
#                                ctest -R reads it), told from the programs' names and the tests in their sources
#   tests/run.sh --help          this text
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [ "${1:-}" = --help ]; then
  sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' tests/run.sh
  exit
fi

# Test names of sources, "Suite.Name"; for tests with parameters with each of these behind.
names_in() {
  local parameters=()
  if grep -q 'law_cases(' "$@"; then parameters+=($(ls plugins)); fi
  if grep -q 'scene_files::all()' "$@"; then parameters+=($(basename -s .json host_mock/scenes/*.json plugins/*/*.json)); fi
  cat "$@" | tr '\n' ' ' | grep -oE '\bTEST(_F|_P)?\([A-Za-z0-9_]+, *[A-Za-z0-9_]+\)' |
    sed -E 's/^TEST(_F|_P)?\((\w+), *(\w+)\)/\2.\3/' |
    while read -r name; do printf '%s\n' "$name" "${parameters[@]/#/$name/}"; done
}

# Targets that hold a test which the expression $1 matches.
targets_of() {
  local programs names sources
  while IFS='|' read -r programs names sources; do
    # shellcheck disable=SC2086  # lists of words
    if { printf '%s\n' $names; [ -z "$sources" ] || names_in $sources; } | grep -E -- "$1" >/dev/null; then
      echo "$programs"
    fi
  done <build/release/tests/programs.txt
}

expression=
for ((i = 1; i < $#; ++i)); do
  case ${!i} in -R | --tests-regex) next=$((i + 1)) expression=${!next} ;; esac
done

bash host_mock/setup.sh tests
echo "build: build/release"
cmake --preset release -DILAW_TESTS=ON -DILAW_WERROR="${ILAW_WERROR:-OFF}" >/dev/null
targets=()
if [ -n "$expression" ]; then
  mapfile -t targets < <(targets_of "$expression" | tr ' ' '\n' | sort -u)
  [ ${#targets[@]} -gt 0 ] || { echo "no test is called $expression" >&2; exit 1; }
  echo "builds only: ${targets[*]}"
  targets=(--target "${targets[@]}")
fi
cmake --build --preset release "${targets[@]}" -- --quiet
exec ctest --test-dir build/release --output-on-failure -j "$(nproc)" "$@"
