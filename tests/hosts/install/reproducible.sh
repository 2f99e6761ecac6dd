#!/usr/bin/env bash
# The same sources give the same bytes in every folder: builds targets in another one, with the options of BUILD, and
# compares the files with those of BUILD. With `whole` it builds everything and compares what is installed.
# Usage: reproducible.sh BUILD SOURCE whole|TARGET...
set -euo pipefail
build=$1 source=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
other=$work/a_folder_with_a_longer_name/sources

for pattern in __DATE__ __TIME__ __TIMESTAMP__; do
  ! grep -rnw "$pattern" "$source"/{api,plugins,host_mock} || { echo "the time of a build is no part of it"; exit 1; }
done

mkdir -p "$other/docs"
cp -r "$source"/{CMakeLists.txt,LICENSE,api,plugins,host_mock} "$other"
cp -r "$source"/docs/{man,template_repository} "$other/docs"
options=(-DILAW_TESTS=OFF)
[ "$1" = whole ] || options+=(-DILAW_HOST=OFF -DILAW_LAMMPS=OFF)
while read -r option; do options+=("-D$option"); done < <(
  grep -E '^(CMAKE_BUILD_TYPE|CMAKE_CXX?_COMPILER|ILAW_(UNITY|WERROR|KERNELS|SANITIZE)):' "$build/CMakeCache.txt")

export SOURCE_DATE_EPOCH=0  # the list of parts has a date
# The build folder is as deep as that of the presets: ccache makes names of sources relative to it.
# ccache may give what a run of this test compiled, but nothing that was compiled for BUILD.
export CCACHE_NAMESPACE=ilaw_other_folder CCACHE_BASEDIR=$other CCACHE_NOHASHDIR=1
targets=()
[ "$1" = whole ] || targets=(--target "$@")
{ cmake -S "$other" -B "$other/build/release" -G Ninja "${options[@]}" &&
    cmake --build "$other/build/release" "${targets[@]}"; } >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }

compared=0 different=()
compare() {
  local file
  while read -r file; do
    compared=$((compared + 1))
    cmp -s "$1/$file" "$2/$file" || different+=("$file")
  done < <(cd "$1" && find "${@:3}" -type f)
}
if [ "$1" = whole ]; then
  rm -f "$build/ilaw.spdx.json"
  cmake --build "$build" --target ilaw_sbom >/dev/null
  cmake --install "$build" --prefix "$work/first" >/dev/null
  cmake --install "$other/build/release" --prefix "$work/second" >/dev/null
  diff <(cd "$work/first" && find . | sort) <(cd "$work/second" && find . | sort)
  compare "$work/first" "$work/second" .
else
  compare "$other/build/release" "$build" lib bin
fi
echo "$compared files compared, ${#different[@]} differ: ${different[*]:-}"
[ "$compared" -gt 0 ] && [ ${#different[@]} -eq 0 ]
