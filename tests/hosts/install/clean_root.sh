#!/usr/bin/env bash
# The Debian packages as a user of Debian has them: installed by dpkg, their dependencies checked, in a copy of this
# system that is thrown away and does not show the tree; used; purged, after which no file of them is left.
# The copy is an overlay, for which one must be root. Exit code 77: not possible here.
# Usage: clean_root.sh PACKAGES HOSTS HIDDEN... (folders: the .deb files, sources of hosts, what the copy must not show)
set -euo pipefail
if [ "${1:-}" != --inside ]; then
  unshare --mount true 2>/dev/null || { echo "no mounts here: packages are not installed"; exit 77; }
  top=$(mktemp -d)
  unshare --mount "$0" --inside "$top" "$@" && status=0 || status=$?
  rmdir "$top"
  exit "$status"
fi
top=$2 packages=$3 hosts=$4
shift 4

mount -t tmpfs tmpfs "$top"  # gone with this process, as all mounts below
mkdir "$top/changes" "$top/work" "$top/root"
root=$top/root
mount -t overlay overlay -o "lowerdir=/,upperdir=$top/changes,workdir=$top/work" "$root" ||
  { echo "no overlays here: packages are not installed"; exit 77; }
for folder in dev proc; do mount --rbind "/$folder" "$root/$folder"; done
mount -t tmpfs tmpfs "$root/mnt"
cp -r "$packages" "$root/mnt/packages"
cp -r "$hosts" "$root/mnt/hosts"
for folder in "$@"; do [ ! -d "$root$folder" ] || mount -t tmpfs tmpfs "$root$folder"; done
inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/mnt TMPDIR=/mnt LC_ALL=C chroot "$root" bash -euc "$1"; }

echo "== install"
inside 'dpkg --install /mnt/packages/*.deb' >"$top/log" 2>&1 || { cat "$top/log"; exit 1; }
names=$(inside 'for file in /mnt/packages/*.deb; do dpkg-deb --field "$file" Package; done' | tr '\n' ' ')
inside 'ldconfig -p' | grep 'libilaw_loader.so.1 .* /\(usr/\)\?lib/libilaw_loader.so.1$' >/dev/null

echo "== the programs"
inside 'cd /mnt
  ilaw run /usr/share/ilaw/scenes/sliding_block.json --out results >/dev/null && [ -s results/history.csv ]
  ilaw list | grep -q "^coulomb .* /usr/lib/ilaw/coulomb.so$"
  ilaw describe coulomb | grep -q friction
  ilaw-check tie --only library-opens >/dev/null'

echo "== find_package by version, and a host"
inside 'mkdir /mnt/project && cd /mnt/project && cp /mnt/hosts/blocks.cpp . && cat >CMakeLists.txt <<"EOF"
cmake_minimum_required(VERSION 3.22)
project(outside LANGUAGES CXX)
foreach(version IN ITEMS 1 1.0 1.0.0 1.0...1.9 0.9 1.1 2.0 1.9.9)
  set(ilaw_FOUND "")
  find_package(ilaw ${version} QUIET)
  message(STATUS "ilaw ${version}: ${ilaw_FOUND}")
endforeach()
find_package(ilaw 1.0 REQUIRED)
add_executable(blocks blocks.cpp)
target_link_libraries(blocks PRIVATE ilaw::loader)
EOF
cmake -S . -B out -DCMAKE_BUILD_TYPE=Debug && cmake --build out' >"$top/log" 2>&1 || { cat "$top/log"; exit 1; }
# The same major version, and none above this one.
wanted='1: 1, 1.0: 1, 1.0.0: 1, 1.0...1.9: 1, 0.9: 0, 1.1: 0, 2.0: 0, 1.9.9: 0'
found=$(sed -n 's/^-- ilaw //p' "$top/log" | paste -sd, | sed 's/,/, /g')
[ "$found" = "$wanted" ] || { echo "find_package: found $found; expected $wanted"; exit 1; }
inside 'cd /mnt && project/out/blocks coulomb' >/dev/null

echo "== purge"
inside "dpkg --purge $names" >"$top/log" 2>&1 || { cat "$top/log"; exit 1; }
# dpkg, ldconfig and man-db keep notes, packages or not.
notes='^/(var/lib/dpkg|var/log/(dpkg\.log|alternatives\.log)|etc/ld\.so\.cache|var/cache/(ldconfig|man)|mnt|dev|proc)(/|$)'
left=$(cd "$top/changes" && find . -mindepth 1 | sed 's/^\.//' | grep -Ev "$notes" |
         while read -r name; do [ -d "$root$name" ] && [ -d "$name" ] || echo "$name"; done)
[ -z "$left" ] || { echo "left after the purge: $left"; exit 1; }
for name in $names; do
  if inside "dpkg-query --show $name" >/dev/null 2>&1; then echo "$name is still known to dpkg"; exit 1; fi
done
