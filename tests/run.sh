#!/usr/bin/env bash
# Sets up, builds in Release and runs the tests. Arguments go to ctest.
#
#   tests/run.sh                 all tests but those in foreign solvers
#   tests/run.sh -R postit       builds and runs only programs with a test of this name (a regular expression, as
#                                ctest -R reads it), told from the programs' names and the tests in their sources;
#                                everything where no name fits, as with parameters that programs make up;
#                                ctest then has an entry per test (ILAW_TEST_CASES), else one per program
#   tests/run.sh --with-solvers ...    also installs LAMMPS, dolfinx, Yade and MuJoCo (1 GB) and tests the laws in them
#   tests/run.sh --help          this text
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [ "${1:-}" = --help ]; then
  sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' tests/run.sh
  exit
fi

# Test names of sources as ctest has them, "Suite.Name", or "Prefix/Suite.Name/parameter" for each of the prefixes and
# of the parameters whose names are known before the build.
names_in() {
  local text prefixes parameters=('')
  text=$(cat "$@" | tr '\n' ' ')
  prefixes=$(grep -oE 'INSTANTIATE_TEST_SUITE_P\( *\w+, *\w+' <<<"$text" | sed -E 's/.*\( *(\w+), *(\w+)$/\2 \1/') || true
  if grep -q 'law_cases(' <<<"$text"; then
    parameters=($(ls plugins) $(grep -ohE '"name": "\w+"' tests/laws/*/cases.json | cut -d'"' -f4 | sort -u))
  elif grep -q 'scene_files::all()' <<<"$text"; then
    parameters=($(basename -s .json host_mock/scenes/*.json plugins/*/*.json))
  fi
  grep -oE '\bTEST(_F|_P)?\([A-Za-z0-9_]+, *[A-Za-z0-9_]+\)' <<<"$text" |
    sed -E 's/^(TEST(_F|_P)?)\((\w+), *(\w+)\)/\1 \3 \4/' |
    while read -r kind suite name; do
      if [ "$kind" != TEST_P ]; then echo "$suite.$name"; continue; fi
      while read -r of prefix; do
        [ "$of" != "$suite" ] || printf '%s\n' "${parameters[@]/#/$prefix/$suite.$name/}"
      done <<<"$prefixes"
    done
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

solvers=OFF with=
if [ "${1:-}" = --with-solvers ]; then
  solvers=ON with=with-solvers
  shift
fi
expression=
for ((i = 1; i < $#; ++i)); do
  case ${!i} in -R | --tests-regex) next=$((i + 1)) expression=${!next} ;; esac
done

bash host_mock/setup.sh tests $with
echo "build: build/release"
cmake --preset release -DILAW_TESTS=ON -DILAW_LEVELS="v3;v4" -DILAW_LAMMPS=$solvers -DILAW_SOLVERS=$solvers \
      -DILAW_WERROR="${ILAW_WERROR:-OFF}" -DILAW_UNITY="${ILAW_UNITY:-ON}" \
      -DILAW_KERNELS="${ILAW_KERNELS:-OFF}" >/dev/null
targets=()
if [ -n "$expression" ]; then
  export ILAW_TEST_CASES=1
  mapfile -t targets < <(targets_of "$expression" | tr ' ' '\n' | sort -u)
  if [ ${#targets[@]} -gt 0 ]; then
    echo "builds only: ${targets[*]}"
    targets=(--target "${targets[@]}")
  else
    echo "no test is known to be called $expression before the build: builds all"
  fi
fi
quiet=()
[ -t 1 ] || quiet=(-- --quiet)  # on a terminal ninja shows how far it is
cmake --build --preset release "${targets[@]}" "${quiet[@]}"
# Threads that wait for each other must not keep busy the processors that other tests run on.
export OMP_WAIT_POLICY=passive
exec ctest --test-dir build/release --no-tests=error --output-on-failure -j "$(nproc)" "$@"
