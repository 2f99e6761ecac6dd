#!/usr/bin/env bash
# A law in a repository of its own: docs/template_repository is copied by the very commands of template_law's page,
# and the step of its workflow builds, checks and runs the law against an ilaw elsewhere.
# Usage: template_repository.sh SOURCE PREFIX, the latter installed or a build folder.
set -euo pipefail
source=$1
export PREFIX=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cd "$source"
awk '/^```sh$/ { ++block; next } /^```$/ { if (block == 2) exit } block == 2' plugins/template_law/template_law.md |
  sed "s|^repository=.*|repository=$work/my_law|" >"$work/copy.sh"
bash -euo pipefail "$work/copy.sh"
cd "$work/my_law"
if grep -r template_law .; then
  echo "the copy still names the template" >&2
  exit 1
fi
for file in CMakeLists.txt LICENSE README.md my_law.cpp my_law.json my_law_test.cpp; do test -s "$file"; done

# The commands of the step, which are indented further than its name. One instruction set, to be built in less time.
awk '/- name: Check the law/ { inside = 1; next } inside && /^      - / { exit } inside && /^          /' \
  .github/workflows/check.yml | sed 's/=Release/=Debug/' >"$work/check.sh"
bash -euo pipefail "$work/check.sh" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
grep -q '100% tests passed, 0 tests failed out of 3' "$work/log"
grep -q '<testcase' build/check.xml
test -s results/history.csv

# Its closed forms see a fault in the law.
sed -i 's/-contact.excess/-2.0 * contact.excess/' my_law.cpp
cmake --build build >"$work/log" 2>&1
if build/my_law_test build/lib/ilaw/my_law.so >"$work/log"; then
  echo "the closed forms pass a wrong law" >&2
  exit 1
fi
grep -q '^approach: found' "$work/log"
