#!/usr/bin/env bash
# Prints a table of lines of code (without blank lines and comments, by cloc), files, and pages of commits.
# Usage: tests/house/sizes.sh COMMIT...      needs cloc
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LC_ALL=C

# Files, lines of code and lines of comments below folders; of programming languages alone.
code() {
  cloc --quiet --csv --timeout=0 --exclude-lang=Markdown,JSON,Text,SVG,CSV,XML,HTML,YAML,TOML "$@" |
    awk -F, '$2 == "SUM" { print $1, $5, $4 }'
}
rest_of_api() { code api --fullpath --not-match-d=api/include/ilaw/kit; }
# Files, lines and words of Markdown.
words() {
  local files
  mapfile -t files < <(find . -name '*.md' "$@")
  read -r lines words < <(cat /dev/null "${files[@]}" | wc -lw)
  echo "${#files[@]} $lines $words"
}
head() {
  local columns=() rule=' --- |' commit
  for commit in "${commits[@]}"; do
    columns+=("$commit: files | $1 | $2 |")
    rule+=' --- | --- | --- |'
  done
  printf '| | %s\n|%s\n' "${columns[*]}" "$rule"
}
row() {
  local line="| $1 |" commit
  for commit in "${commits[@]}"; do
    files='' first='' second=''  # of a folder that the commit does not have
    read -r files first second < <(cd "$work/$commit" && "${@:2}" 2>/dev/null) || true
    line+=" ${files:-0} | ${first:-0} | ${second:-0} |"
  done
  echo "$line"
}

commits=("$@")
for commit in "${commits[@]}"; do
  mkdir -p "$work/$commit"
  git archive "$commit" | tar -x -C "$work/$commit"
done
head lines comments
row 'authoring kit' code api/include/ilaw/kit
row 'rest of api' rest_of_api
row plugins code plugins
row host_mock code host_mock
for room in host instruments cli; do row "- $room" code "host_mock/$room"; done
row tests code tests
echo
head lines words
row pages words -not -path './docs/log/*'
row logbooks words -path './docs/log/*'
