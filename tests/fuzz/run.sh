#!/usr/bin/env bash
# Fuzzes what reads files, descriptions and scenes of strangers, all at once, for some seconds (default 30), from the
# kept corpus. Inputs that fail land in build/fuzz/found. Usage: tests/fuzz/run.sh [SECONDS]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

seconds=${1:-30}
subjects=(elf description description_file scene)

# One subject, from what is kept and what earlier runs here found; its end is its log's.
fuzz() {
  local subject=$1 words=()
  mkdir -p "build/fuzz/corpus/$subject"
  if [[ -f tests/fuzz/corpus/$subject.tar.gz ]]; then  # what long runs found, the least that reaches as much
    tar -xzf "tests/fuzz/corpus/$subject.tar.gz" -C "build/fuzz/corpus/$subject"
  fi
  if [[ -f tests/fuzz/$subject.dict ]]; then words=(-dict="tests/fuzz/$subject.dict"); fi
  "build/asan/bin/${subject}_fuzz" -max_total_time="$seconds" -max_len=65536 -timeout=10 -rss_limit_mb=2048 \
    "${words[@]}" -artifact_prefix=build/fuzz/found/ "build/fuzz/corpus/$subject" "tests/fuzz/corpus/$subject" \
    >"build/fuzz/$subject.log" 2>&1
}

cmake --preset asan >/dev/null
cmake --build --preset asan --target "${subjects[@]/%/_fuzz}" -- --quiet
mkdir -p build/fuzz/found
echo "fuzz: ${subjects[*]}, $seconds s"
declare -A runs
for subject in "${subjects[@]}"; do
  fuzz "$subject" &
  runs[$subject]=$!
done
failed=0
for subject in "${subjects[@]}"; do
  if wait "${runs[$subject]}"; then
    echo "$subject: $(grep -E '^(Done|DONE|#[0-9]+.*DONE)' "build/fuzz/$subject.log" | tail -n 1)"
  else
    echo "$subject:" >&2
    tail -n 40 "build/fuzz/$subject.log" >&2
    failed=1
  fi
done
exit "$failed"
