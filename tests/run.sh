#!/usr/bin/env bash
# Sets up, builds in Release and runs all tests. Arguments go to ctest, e.g. tests/run.sh -R postit
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bash host_mock/setup.sh tests
echo "build: build/release"
cmake --preset release -DILAW_TESTS=ON -DILAW_WERROR="${ILAW_WERROR:-OFF}" >/dev/null
cmake --build --preset release -- --quiet
exec ctest --test-dir build/release --output-on-failure -j "$(nproc)" "$@"
