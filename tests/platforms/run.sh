#!/usr/bin/env bash
# Laws, loader, coupled solver and host without VTK for another processor: compiles them with Debian's cross compiler,
# runs shipped scenes under qemu-user, and compares their states with those of tests/host/state_hashes.csv.
#   tests/platforms/run.sh aarch64|ppc64le [SCENE.json...]
# On Debian it needs qemu-user, and g++-aarch64-linux-gnu with zlib1g-dev:arm64, or g++-powerpc64le-linux-gnu with
# zlib1g-dev:ppc64el.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER:-}
processor=$1
shift
triplet=${processor/#ppc64le/powerpc64le}-linux-gnu
build=build/$processor
mkdir -p "$build"
scenes=("$@")
[ $# -gt 0 ] || mapfile -t scenes < <(git ls-files 'host_mock/scenes/*.json' 'plugins/*/*.json')

cmake -G Ninja -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_SYSTEM_NAME=Linux \
  -DCMAKE_SYSTEM_PROCESSOR="$processor" -DCMAKE_C_COMPILER="$triplet-gcc" -DCMAKE_CXX_COMPILER="$triplet-g++" \
  -DILAW_HOST=OFF -DILAW_TESTS=OFF -DILAW_LAMMPS=OFF -DILAW_SOLVERS=OFF >"$build.log"
cmake --build "$build" -- --quiet

# The host, its sources in two pieces beside those that the host's own build keeps apart.
mkdir -p "$build/host"
python3 - >"$build/host/schema.cpp" <<'PYTHON'
import pathlib
host = pathlib.Path("host_mock")
text = (host / "host/scene/schema_text.cpp.in").read_text()
print(text.replace("@ILAW_SCENE_SCHEMA@", (host / "schema/scene.schema.json").read_text()))
PYTHON
include() { printf '#include "%s"\n' "${@/#/$PWD/}"; }
include host_mock/host/{base,mortar,model,step,contact}/*.cpp >"$build/host/step.cpp"
include $(ls host_mock/host/scene/*.cpp | grep -vE '/(mesh_file|validation).cpp') host_mock/host/results/state_hash.cpp \
  tests/platforms/state_hashes.cpp >"$build/host/scene.cpp"
include host_mock/host/scene/validation.cpp >"$build/host/validation.cpp"
for piece in step scene validation schema; do
  echo "$CMAKE_CXX_COMPILER_LAUNCHER $triplet-g++ -std=c++20 -O1 -ffp-contract=off -U__ARM_FEATURE_FMA -fopenmp -isystem /usr/include/eigen3" \
    "-Ihost_mock/host -Iapi/include -DILAW_VERSION='\"1.0.0\"' -c $build/host/$piece.cpp -o $build/host/$piece.o"
done | xargs -P 2 -d '\n' -n 1 sh -c
"$triplet-g++" -fopenmp "$build"/host/*.o -o "$build/state_hashes" "$build"/lib/libilaw_{coupled,search,loader}.a -lz -ldl

export ILAW_PATH=$PWD/$build/lib/ilaw
printf "%s\n" "${scenes[@]}" | xargs -P 2 -n 1 "qemu-$processor" -L "/usr/$triplet" "$build/state_hashes" >"$build/state_hashes.csv" || true
python3 tests/host/state_hash_test.py --column "$processor" "$build/state_hashes.csv"
