#!/usr/bin/env bash
# Fuzzes what reads files, descriptions and scenes of strangers, for some seconds each (default 30), from the kept corpus.
# What is found lands in build/fuzz/found. Usage: tests/fuzz/run.sh [SECONDS]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

seconds=${1:-30}
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target elf_fuzz description_fuzz scene_fuzz -- --quiet
mkdir -p build/fuzz/found
for subject in elf description scene; do
  echo "fuzz: $subject, $seconds s"
  mkdir -p "build/fuzz/corpus/$subject"
  log=build/fuzz/$subject.log
  words=()
  if [[ -f tests/fuzz/$subject.dict ]]; then words=(-dict="tests/fuzz/$subject.dict"); fi
  if ! "build/fuzz/bin/${subject}_fuzz" -max_total_time="$seconds" -max_len=65536 -timeout=10 -rss_limit_mb=2048 \
      "${words[@]}" -artifact_prefix=build/fuzz/found/ "build/fuzz/corpus/$subject" "tests/fuzz/corpus/$subject" >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    exit 1
  fi
  grep -E '^(Done|DONE|#[0-9]+.*DONE)' "$log" | tail -n 1
done
