#!/usr/bin/env bash
# Installs what the project needs and this machine lacks (Debian 12). Does nothing, and needs no network, when all is
# there. Usage: host_mock/setup.sh [tests|ci|results|site|dealii] [with-solvers]; without arguments for host_mock/demo.sh.
set -euo pipefail

packages=(g++ cmake ninja-build libeigen3-dev nlohmann-json3-dev libcli11-dev libtinyxml2-dev
          libvtk9-dev zlib1g-dev python3-numpy python3-matplotlib python3-vtk9 libjs-three)
for_tests=(gfortran binutils libgtest-dev libgmock-dev libbenchmark-dev libsiconos-numerics-dev libfclib-dev qemu-user
           dpkg-dev pkgconf python3-pytest python3-setuptools python3-wheel python3-pip python3-venv
           python3-pycparser python3-yaml)
# Foreign solvers in which the laws are tested, and MPI. They are large: 1 GB with their dependencies.
solvers=(lammps liblammps-dev libopenmpi-dev openmpi-bin python3-dolfinx python3-mpi4py yade libmujoco-dev calculix-ccx)
dealii=(libdeal.ii-dev libopenmpi-dev openmpi-bin)  # 1.4 GB, so neither ci nor with-solvers has it
documents=(pandoc mandoc man-db python3-jsonschema python3-license-expression)  # manual pages, the list of parts
site=(doxygen python3-breathe python3-myst-parser furo libjs-katex)  # docs/site/build.sh
[ "${2:-}" != with-solvers ] || for_tests+=("${solvers[@]}")
case ${1:-} in
  tests) packages+=("${for_tests[@]}") ;;
  ci) packages+=("${for_tests[@]}" "${solvers[@]}" "${site[@]}" "${documents[@]}" clang-format clang-tidy clang libclang-rt-14-dev libomp-dev ccache chromium
                  llvm-14 llvm-spirv-14 pocl-opencl-icd ocl-icd-opencl-dev python3-nbconvert python3-ipykernel python3-scipy) ;;
  site) packages=("${site[@]}") ;;
  dealii) packages+=("${for_tests[@]}" "${dealii[@]}") ;;
  results) packages+=("${for_tests[@]}" jq) ;;
esac

missing=()
here="^installed (all|$(dpkg --print-architecture))\$"  # a package may be there for other processors, too
for package in "${packages[@]}"; do
  dpkg-query --show --showformat='${db:Status-Status} ${Architecture}\n' "$package" 2>/dev/null | grep -qE "$here" ||
    missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "set-up: all packages are there"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  # A password can be asked for on a terminal only.
  if ! command -v sudo >/dev/null || ! { sudo -n true 2>/dev/null || { [ -t 0 ] && sudo -v; }; }; then
    echo "set-up: these packages are missing and only an administrator can install them; ask for:" >&2
    echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 2
  fi
  as_root=(sudo)
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
