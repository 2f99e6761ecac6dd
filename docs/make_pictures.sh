#!/usr/bin/env bash
# Runs the commands of docs/from_question_to_picture.md and copies their pictures: each picture that the page shows is
# the only one in the folder of the same name.
# Usage: docs/make_pictures.sh [PROGRAM [FOLDER]]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=$(realpath "${1:-build/release/bin/ilaw}")
pictures=$(realpath "${2:-docs/img}")
page=docs/from_question_to_picture.md
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
ln -s "$PWD/tests" "$work/tests"
ilaw() { "$program" "$@"; }
commands=$(grep '^    ilaw ' "$page")
cd "$work"
mkdir results
while read -r command; do
  echo "$command"
  eval "$command" </dev/null
done <<<"$commands"
cd - >/dev/null
for picture in $(grep -o 'img/[a-z_]*\.png' "$page"); do
  name=$(basename "$picture" .png)
  cp "$work/results/$name/"*.png "$pictures/$name.png"
done
