#!/usr/bin/env bash
# Installs what the project needs and this machine lacks (Debian 12). Does nothing, and needs no network, when all is
# there. Sourced or run; used by host_mock/demo.sh and tests/run.sh.
set -euo pipefail

packages=(g++ gfortran cmake ninja-build binutils libeigen3-dev nlohmann-json3-dev libvalijson-dev libcli11-dev
  gnuplot-nox libgtest-dev libvtk9-dev libsiconos-numerics-dev libbenchmark-dev)
case ${1:-} in
  ci) packages+=(clang-format clang-tidy) ;;  # for .ci/run
  results) packages+=(jq) ;;                  # for docs/results/make.sh
esac

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "set-up: all packages are there"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null || ! sudo -n true 2>/dev/null; then
    echo "set-up: these packages are missing and only an administrator can install them; ask for:" >&2
    echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 2
  fi
  as_root=(sudo -n)
fi
echo "set-up: installing ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { "${as_root[@]}" apt-get update &&
       "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends "${missing[@]}"; } \
     >"$log" 2>&1 </dev/null; then
  tail -n 20 "$log" >&2
  echo "set-up: apt-get failed, see above; by hand: apt-get install --no-install-recommends ${missing[*]}" >&2
  exit 2
fi
