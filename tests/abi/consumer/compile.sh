#!/bin/sh
# Compiles a host and a law once, for good, as users' codes are: against the header of version 1.0. Their objects are
# kept in the tree and never compiled again (docs/stability.md); this is how they were made, for x86-64.
# Usage: tests/abi/consumer/compile.sh FOLDER
set -eu
into=$(cd "$1" && pwd)
cd "$(dirname "$0")/../../.."
for each in host:tests/hosts/protocols/protocol.c law:plugins/template_c/template_c.c; do
  ${CC:-cc} -std=c99 -O2 -g0 -fPIC -fno-ident -ffp-contract=off -fno-asynchronous-unwind-tables \
    -Itests/abi/frozen/1.0 -Iapi/include -c "${each#*:}" -o "$into/${each%%:*}.o"
done
strip --strip-unneeded "$into/host.o" "$into/law.o"
