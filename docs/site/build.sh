#!/usr/bin/env bash
# Builds the site into build/site: all pages, the headers, a search. A warning is an error.
# Needs the packages of `host_mock/setup.sh site`. Arguments go to sphinx-build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

mkdir -p build/site_doxygen
doxygen docs/site/Doxyfile
# Debian's Python: another one does not know Debian's packages.
PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -m sphinx -q -W --keep-going -b html -c docs/site \
  -d build/site_doctrees . build/site "$@"
echo '<meta http-equiv="refresh" content="0; url=README.html">' >build/site/index.html
echo "site: build/site/index.html"
