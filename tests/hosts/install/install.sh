#!/usr/bin/env bash
# An ilaw as users get it, by `cmake --install`, from the archive and from the Debian packages: an outside project
# builds hosts against it, and they run. Laws are built by kit.first_law, against what cmake --install leaves: the
# other two ways must bring the same files. Packages are also installed and removed by dpkg (clean_root.sh).
# Usage: install.sh BUILD SOURCE C_COMPILER CXX_COMPILER install|archive|packages
set -euo pipefail
build=$1 source=$2 cc=$3 cxx=$4 way=$5
unset ILAW_PATH  # which comes before the folder of an installed program
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

case $way in
  install)
    cmake --install "$build" --prefix "$work/ilaw" >/dev/null
    prefix=$work/ilaw ;;
  archive)
    cpack --config "$build/CPackConfig.cmake" -G TGZ -B "$work/made" >cpack.log 2>&1 || { cat cpack.log; exit 1; }
    mkdir ilaw && tar -xzf made/*.tar.gz -C ilaw --strip-components=1
    prefix=$work/ilaw ;;
  packages)
    cpack --config "$build/CPackConfig.cmake" -G DEB -B "$work/made" >cpack.log 2>&1 || { cat cpack.log; exit 1; }
    for package in made/*.deb; do dpkg-deb -x "$package" root; done
    dpkg-deb --field made/ilaw_*.deb Depends | grep -q libstdc++6
    if [ -e "$build/lib/libilaw_lammps.so" ]; then
      dpkg-deb --field made/ilaw-lammps_*.deb Depends | grep -q 'ilaw (= .*lammps'
    fi
    dpkg-deb --field made/libilaw-dev_*.deb Depends | grep -q '^ilaw (= '
    prefix=$work/root/usr ;;
esac

echo "== files"
for file in bin/ilaw bin/ilaw-describe lib/ilaw/contact.so lib/ilaw/contact.json include/ilaw/ilaw.h include/ilaw/kit/detail/evaluate.hpp share/ilaw/device_kit/ilaw/device/kernel.hpp lib/libilaw_loader.a \
            lib/libilaw_loader.so lib/libilaw_loader.so.1 \
            lib/libilaw_coupled.a lib/libilaw_coupled.so lib/libilaw_coupled.so.1 include/ilaw/coupled.h lib/cmake/ilaw/ilawConfig.cmake lib/pkgconfig/ilaw.pc \
            lib/libilaw_search.a lib/libilaw_search.so lib/libilaw_search.so.1 include/ilaw/search.h lib/pkgconfig/ilaw_search.pc \
            lib/pkgconfig/ilaw_coupled.pc share/ilaw/fortran/ilaw.f90 share/ilaw/fortran/ilaw_coupled.f90 \
            lib/libilaw_openradioss.so share/ilaw/openradioss/ilaw_openradioss_window.py share/ilaw/openradioss/examples/run.sh \
            share/ilaw/yade/ilaw_yade.py share/ilaw/mujoco/ilaw_mujoco.hpp share/ilaw/mujoco/examples/gripper.xml share/ilaw/abaqus/vfric.f share/ilaw/dealii/CMakeLists.txt share/ilaw/template_repository/template_law.cpp share/ilaw/template_repository/.github/workflows/check.yml share/ilaw/python/examples/dolfinx/throw.py share/ilaw/python/ilaw/coupled.py share/ilaw/python/ilaw/plot.py share/ilaw/python/ilaw/view.html share/ilaw/python/ilaw/view.js \
            share/ilaw/python/pyproject.toml share/man/man1/ilaw.1 share/man/man1/ilaw-check.1 share/man/man1/ilaw-describe.1 share/doc/ilaw/copyright share/doc/libilaw-dev/copyright \
            share/ilaw/scenes/two_bars.json share/ilaw/scenes/bouncing_ball.json \
            share/bash-completion/completions/ilaw; do
  [ -e "$prefix/$file" ] || { echo "missing: $file"; exit 1; }
done
[ ! -e "$build/ilaw.spdx.json" ] || cmp "$build/ilaw.spdx.json" "$prefix/share/doc/ilaw/ilaw.spdx.json"
[ ! -e "$prefix/lib/ilaw/template_law.so" ]
if [ "$way" != install ]; then
  cmake --install "$build" --prefix "$work/installed" >/dev/null
  for folder in include lib/cmake lib/pkgconfig share; do
    diff -r "$work/installed/$folder" "$prefix/$folder"
  done
  [ "$(ls "$work/installed/lib/ilaw")" = "$(ls "$prefix/lib/ilaw")" ]
  for library in "$prefix"/lib/*.a; do cmp "$work/installed/lib/${library##*/}" "$library"; done
fi

echo "== the program, from where it lies"
"$prefix/bin/ilaw" list >laws
grep -q "^coulomb .*$prefix/lib/ilaw/coulomb.so" laws || { cat laws; exit 1; }
"$prefix/bin/ilaw" run "$prefix/share/ilaw/scenes/sliding_block.json" --out results

if [ -e "$build/lib/libilaw_lammps.so" ] && [ -x "$(command -v lmp)" ]; then
  echo "== the fixes in LAMMPS"
  [ -e "$prefix/lib/libilaw_lammps.so" ]
  if grep -rF "$build" "$prefix/share/ilaw/lammps"; then exit 1; fi
  sed 's/^run .*/run 2/' "$prefix/share/ilaw/lammps/examples/in.settle" >in.settle
  ILAW_PATH=$prefix/lib/ilaw lmp -in in.settle -var ilaw "$prefix/share/ilaw/lammps/ilaw.lmp" -log none >lammps.log ||
    { tail lammps.log; exit 1; }
fi

if [ "$way" = packages ]; then
  "$source/tests/hosts/install/clean_root.sh" made "$source/tests/hosts" "$source" "$build"
fi

# The other two ways bring the same files, with which the same can be built.
[ "$way" = install ] || exit 0

echo "== a project with CMake: hosts with the static and the shared loader"
cp "$prefix/share/ilaw/minimal/blocks.c" "$prefix/share/ilaw/minimal/grains.c" .
cat >CMakeLists.txt <<'EOF'
cmake_minimum_required(VERSION 3.22)
project(outside LANGUAGES C CXX)
set(CMAKE_C_STANDARD 99)
find_package(ilaw 1.0 REQUIRED)
add_executable(blocks_static blocks.c)
target_link_libraries(blocks_static PRIVATE ilaw::loader)
add_executable(blocks_shared blocks.c)
target_link_libraries(blocks_shared PRIVATE ilaw::loader_shared)
add_executable(grains_static grains.c)
target_link_libraries(grains_static PRIVATE ilaw::coupled ilaw::loader m)
add_executable(grains_shared grains.c)
target_link_libraries(grains_shared PRIVATE ilaw::coupled_shared ilaw::loader_shared m)
EOF
{ cmake -S . -B out -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" \
    -DCMAKE_CXX_COMPILER="$cxx" && cmake --build out; } >build.log 2>&1 || { cat build.log; exit 1; }
export ILAW_PATH=$prefix/lib/ilaw
out/blocks_static coulomb >wanted
out/blocks_shared coulomb | cmp - wanted
out/grains_static coulomb 20 20 10 >wanted_grains
grep -q "^overlap .* contacts [1-9]" wanted_grains
out/grains_shared coulomb 20 20 10 | cmp - wanted_grains

echo "== the minimal host, a project of its own"
minimal=$prefix/share/ilaw/minimal
{ cmake -S "$minimal" -B minimal -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" \
    -DCMAKE_CXX_COMPILER="$cxx" && cmake --build minimal; } >build.log 2>&1 || { cat build.log; exit 1; }
minimal/ilaw-minimal "$prefix/share/ilaw/scenes/sliding_block.json" own
"$prefix/bin/ilaw" run "$prefix/share/ilaw/scenes/sliding_block.json" --out reference
cmp own/history.csv reference/history.csv

echo "== by hand, with pkg-config"
export PKG_CONFIG_PATH=$prefix/lib/pkgconfig
flags=($(pkg-config --cflags --libs ilaw))
"$cc" -std=c99 blocks.c "${flags[@]}" -o by_hand
LD_LIBRARY_PATH=$prefix/lib ./by_hand coulomb | cmp - wanted
flags=($(pkg-config --cflags --libs ilaw_coupled))
"$cc" -std=c99 grains.c "${flags[@]}" -lm -o grains_by_hand
LD_LIBRARY_PATH=$prefix/lib ./grains_by_hand coulomb 20 20 10 | cmp - wanted_grains
[ "$(pkg-config --modversion ilaw)" = "$(sed -n 's/^project(ilaw VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")" ]

echo "== completion"
(
  PATH=$prefix/bin:$PATH
  source "$prefix/share/bash-completion/completions/ilaw"
  complete_line() { COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)); _ilaw; echo "${COMPREPLY[*]}"; }
  [ "$(complete_line ilaw desc)" = describe ]
  [ "$(complete_line ilaw describe coul)" = coulomb ]
  [ "$(complete_line ilaw run --res)" = --resume ]
)
