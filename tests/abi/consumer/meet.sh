#!/bin/sh
# Hosts and laws that were compiled once and those of today meet each other: the numbers that both printed when they were
# compiled. Usage: meet.sh STORED_HOST TODAYS_HOST STORED_LAW TODAYS_LAW
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d) && trap 'rm -rf "$folder"' EXIT
for host in "$1" "$2"; do
  for law in "$3" "$4"; do
    cp "$law" "$folder/template_c.so"
    ILAW_PATH=$folder "$host" "$here/protocol.txt" >"$folder/found"
    diff "$here/expected.txt" "$folder/found" || { echo "other numbers: $host with $law"; exit 1; }
  done
done
