# Sourced by run and night: stages with their seconds and verdicts, and what both need.

export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
# Files that two builds compile alike, in whichever folder, are compiled once.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros

# Tests of .ci/night alone: they build or pack parts of the tree a second time, or need a browser or a foreign code for
# what other tests judge on their own.
night_tests='^(installed\.(packages|reproducible)|new_law\.needs_no_edit_elsewhere|template_repository|pages\.site|view\.(browser|notebooks)|protocols|migration)$'

# Scenes that take over ten seconds under sanitizers.
long='block_impact|dcb_peel|half_model|mixed_mode_bar|pedestal|postit_3d|settled_stack|stopper|two_blocks|tyre_block'

rows=() failed=0

# stage NAME COMMAND...: the command may be a function, which ends at the first part that fails.
stage() {
  local began=$SECONDS code
  echo "== $1"
  set +e
  (set -e; "${@:2}")
  code=$?
  ended "$1" $code $((SECONDS - began))
}

ended() {  # NAME CODE SECONDS
  local verdict=passed
  case $2 in
    0) ;;
    77) verdict="judged nothing" ;;  # for want of time, or of what it judges
    *) verdict="FAILED ($2)" failed=1 ;;
  esac
  rows+=("$(printf '%-66s %6d s  %s' "$1" "$3" "$verdict")")
  echo "== $1 took $3 s: $verdict"
}

# As stage, for programs of one process: they run at once until `together`, which prints what they said. The shell has
# children in the background ignore an interrupt, which some of them test.
names=() logs=()
beside() {
  local log
  log=$(mktemp)
  names+=("$1") logs+=("$log")
  (
    set +e
    began=$SECONDS
    env --default-signal=INT,QUIT "${@:2}" >"$log" 2>&1
    echo "$? $((SECONDS - began))" >"$log.end"
  ) &
}
together() {
  local k code took
  wait
  for k in "${!names[@]}"; do
    echo "== ${names[k]}"
    cat "${logs[k]}"
    code=1 took=0  # as where the disk was full
    read -r code took <"${logs[k]}.end" || code=1
    ended "${names[k]}" "$code" "$took"
    rm "${logs[k]}" "${logs[k]}.end"
  done
  names=() logs=()
}

summary() {
  printf '%s\n' "== stages" "${rows[@]}" "$(printf '%-66s %6d s' all $SECONDS)"
}
