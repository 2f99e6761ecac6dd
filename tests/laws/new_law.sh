#!/usr/bin/env bash
# A new law touches folders of its own alone: in a copy of the tree, template_law is copied by the very commands
# of its page, and the copy builds, is described, run, tested and timed without another edit.
# Usage: new_law.sh SOURCE CMAKE C++ PROGRAMS, the last being the folder of ilaw, kit_test, laws_test.
set -euo pipefail
source=$1 cmake=$2 compiler=$3 programs=$4
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
cp -r "$source"/{CMakeLists.txt,LICENSE,README.md,api,docs,host_mock,plugins,tests} "$tree"
cd "$tree"

awk '/^```sh$/ { inside = 1; next } /^```$/ { if (inside) exit } inside' plugins/template_law/template_law.md >copy.sh
bash -euo pipefail copy.sh
if grep -r template_law plugins/my_law tests/laws/my_law; then
  echo "the copy still names the template" >&2
  exit 1
fi

# Text that an earlier run compiled need not be compiled again, though the folder has another name.
if command -v ccache >/dev/null; then
  export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR=$tree
fi
quietly() { "$@" >log 2>&1 || { cat log >&2; exit 1; }; }
quietly "$cmake" -S . -B build -G Ninja -DILAW_TESTS=ON -DILAW_LAMMPS=OFF -DILAW_SOLVERS=OFF \
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_CXX_COMPILER="$compiler"
quietly "$cmake" --build build --target my_law ilaw_loader_shared

export ILAW_PATH=$tree/build/lib/ilaw ILAW_TEST_TREE=$tree ILAW_TEST_PLUGINS=$tree/build/lib/ilaw
"$programs/ilaw" describe my_law
quietly "$programs/ilaw" run plugins/my_law/my_law.json --out results
test -s results/history.csv
"$programs/ilaw" check build/lib/ilaw/my_law.so

# Its own tests and the check of its library; then what the tests of all laws say of it.
quietly ctest --test-dir build --output-on-failure --no-tests=error -R '^(rows[.]my_law|plugin_is_portable[.]my_law)'
for program in kit_test laws_test; do
  count=$("$programs/$program" --gtest_list_tests --gtest_filter='*/my_law*' | grep -c 'my_law')
  quietly "$programs/$program" --gtest_brief=1 --gtest_filter='*/my_law*:EveryLaw.*'
  echo "$program: $count tests of my_law"
done
"$programs/ilaw" bench --cases tests/laws/my_law/cases.json --nodes 1000 --repetitions 1 | grep my_law
