#!/usr/bin/env bash
# Laws, loader, coupled solver and host without VTK, built and run in another way than .ci/run does.
#   tests/platforms/run.sh aarch64|ppc64le [SCENE.json...]
#     by Debian's cross compiler and under qemu-user; compares states with those of tests/host/state_hashes.csv. On
#     Debian it needs qemu-user, and g++-aarch64-linux-gnu with zlib1g-dev:arm64, or g++-powerpc64le-linux-gnu with
#     zlib1g-dev:ppc64el.
#   tests/platforms/run.sh threads SCENE.json...
#     by clang under the thread sanitizer, with the smallest chunks (ILAW_HOSTILE), so that two threads share the work
#     of each loop; compares states with those of one thread. On Debian it needs clang and libomp-dev, whose libarcher
#     tells the sanitizer of OpenMP's barriers.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER:-}
way=$1
shift
build=build/$way
mkdir -p "$build"
scenes=("$@")
[ $# -gt 0 ] || mapfile -t scenes < <(git ls-files 'host_mock/scenes/*.json' 'plugins/*/*.json')

options=() run=()
# Scenes name the laws that they need.
targets=(ilaw_coupled ilaw_search ilaw_loader $(grep -ohE '"law": *"\w+"' "${scenes[@]}" | cut -d'"' -f4 | sort -u))
if [ "$way" = threads ]; then
  cc=clang cxx=clang++ flags="-g1 -fsanitize=thread -DILAW_HOSTILE"
  options=(-DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" -DILAW_SANITIZE=thread -DILAW_HOSTILE=ON)
else
  triplet=${way/#ppc64le/powerpc64le}-linux-gnu
  cc=$triplet-gcc cxx=$triplet-g++ flags="-U__ARM_FEATURE_FMA"
  options=(-DCMAKE_BUILD_TYPE=Release -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR="$way")
  run=("qemu-$way" -L "/usr/$triplet")
fi
cmake -G Ninja -S . -B "$build" -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" "${options[@]}" \
  -DILAW_HOST=OFF -DILAW_TESTS=OFF -DILAW_LAMMPS=OFF -DILAW_SOLVERS=OFF >"$build.log"
cmake --build "$build" --target "${targets[@]}" -- --quiet

# The host, its sources in two pieces beside those that the host's own build keeps apart.
mkdir -p "$build/host"
python3 - >"$build/host/schema.cpp" <<'PYTHON'
import pathlib
host = pathlib.Path("host_mock")
text = (host / "host/scene/schema_text.cpp.in").read_text()
print(text.replace("@ILAW_SCENE_SCHEMA@", (host / "schema/scene.schema.json").read_text()))
PYTHON
include() { printf '#include "%s"\n' "${@/#/$PWD/}"; }
include host_mock/host/{base,model,surface,step,contact}/*.cpp >"$build/host/step.cpp"
include $(ls host_mock/host/scene/*.cpp | grep -vE '/(mesh_file|validation).cpp') host_mock/host/results/state_hash.cpp \
  tests/platforms/state_hashes.cpp >"$build/host/scene.cpp"
include host_mock/host/scene/validation.cpp >"$build/host/validation.cpp"
for piece in step scene validation schema; do
  echo "$CMAKE_CXX_COMPILER_LAUNCHER $cxx -std=c++20 -O1 -ffp-contract=off $flags -fopenmp -isystem /usr/include/eigen3" \
    "-Ihost_mock/host -Iapi/include -DILAW_VERSION='\"1.0.0\"' -c $build/host/$piece.cpp -o $build/host/$piece.o"
done | xargs -P 2 -d '\n' -n 1 sh -c
# shellcheck disable=SC2086  # several flags
"$cxx" $flags -fopenmp "$build"/host/*.o -o "$build/state_hashes" "$build"/lib/libilaw_{coupled,search,loader}.a -lz -ldl

export ILAW_PATH=$PWD/$build/lib/ilaw
hashes() { printf "%s\n" "${scenes[@]}" | xargs -P 2 -n 1 "${run[@]}" "$build/state_hashes"; }
if [ "$way" = threads ]; then
  # Code that was compiled without the sanitizer, such as libomp, is not judged.
  export TSAN_OPTIONS="halt_on_error=1 ignore_noninstrumented_modules=1"
  OMP_NUM_THREADS=1 hashes | sort >"$build/one.csv"
  OMP_NUM_THREADS=2 hashes | sort >"$build/two.csv"
  [ "$(wc -l <"$build/two.csv")" -eq ${#scenes[@]} ]
  diff "$build/one.csv" "$build/two.csv"
else
  hashes >"$build/state_hashes.csv" || true
  python3 tests/host/state_hash_test.py --column "$way" "$build/state_hashes.csv"
fi
