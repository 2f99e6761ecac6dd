#!/usr/bin/env bash
# Sets the paper: build/paper/paper.html, one file with its figures. Needs pandoc. A citation or a figure that is
# missing is an error.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
out=../../build/paper
mkdir -p "$out"
# The journal's own tools resolve \label and \autoref, pandoc does not.
sed -E 's/\\autoref\{(fig:[a-z]+)\}/[figure](#\1)/g; s/\\label\{(fig:[a-z]+)\}\]\((.*)\)/](\2){#\1}/' paper.md |
  pandoc --from=markdown --to=html5 --standalone --self-contained --citeproc --mathml --fail-if-warnings \
         --metadata=lang:en --output="$out/paper.html"
echo "paper: build/paper/paper.html"
