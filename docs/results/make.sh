#!/usr/bin/env bash
# Measures everything that docs/results shows: builds in Release, runs the cases, writes tables/*.csv and img/*.png, and
# puts the tables into the pages. A quarter of an hour on two quiet cores, after the build. With names of parts (orders,
# study, impacts, long, share) it measures these alone.
# Usage: docs/results/make.sh [BUILD_FOLDER] [PART...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build/release}
parts=${*:2}
here=docs/results
work=$build/results
mkdir -p "$work" "$here/tables" "$here/img"

bash host_mock/setup.sh results
echo "build: $build"
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DILAW_TESTS=ON >/dev/null
cmake --build "$build" --target ilaw contact coulomb penalty postit tie -- --quiet
export ILAW_PATH=$PWD/$build/lib/ilaw
ilaw=$build/bin/ilaw

# variant NAME SCENE SED_EXPRESSION...: a scene that differs from another by what the expressions change.
variant() {
  local name=$1 scene=$2
  shift 2
  sed "${@/#/-e}" "$scene" >"$work/$name.json"
  if cmp --silent "$scene" "$work/$name.json"; then
    echo "make.sh: $name: no expression changes $scene" >&2
    exit 1
  fi
  echo "$work/$name.json"
}

# value FILE FILTER: of a JSON file, empty where it is null.
value() { jq --raw-output "$2 | if . == null then \"\" else . end" "$1"; }

# wanted PART: whether it is to be measured.
wanted() { [ -z "$parts" ] || [[ " $parts " == *" $1 "* ]]; }

# ---- convergence
orders=$here/tables/orders.csv
scenes=host_mock/scenes
measure_order() {
  local name=$1 scene=$2 out=$work/$1
  echo "converge: $name"
  "$ilaw" converge "$scene" --out "$out" "${@:3}" >/dev/null 2>&1
  cut --delimiter=, --fields=1,2,4- "$out/converge.csv" >"$here/tables/$name.csv"  # bare seconds mean nothing elsewhere
  # Two decimals, without the sign of a zero.
  awk -v name="$name" -v found="$(value "$out/converge.json" .reference)" -v orders="$(value "$out/converge.json" \
    '[.orders | .u_L2, .u_max, .v_L1, .instant | if . then (. * 100 | round) / 100 + 0 else . end] | @csv')" -F, '
    { error = $4 } END { print name "," found "," error "," orders }' "$out/converge.csv" >>"$orders"
}

measure_orders() {
  echo "case,reference,u_L2 at smallest h,order u_L2,order u_max,order v_L1,order instant" >"$orders"
  for test in postit_test1 postit_test2; do measure_order $test $scenes/$test.json; done
  measure_order postit_test3 plugins/postit/postit_test3.json
  for ball in bouncing_ball_e08 bouncing_ball_e1; do measure_order $ball $here/scenes/$ball.json; done
  for bar in bar_on_wall two_bars glued_bar; do
    measure_order $bar $scenes/$bar.json
    measure_order ${bar}_cfl1 "$(variant ${bar}_cfl1 $scenes/$bar.json 's/"cfl": 0.9/"cfl": 1.0/' \
      's/"title": "\(.*\)"/"title": "\1, at the critical step"/')"
  done
  measure_order postit_3d $scenes/postit_3d.json --threads "$(nproc)"
}
if wanted orders; then measure_orders; fi

# ---- laws side by side
# Cost of errors of displacement for each law: steps, and in brackets steps and time over the first law's.
study_table() {
  jq --raw-output '.laws[] | [.name, .largest_stable_step / .largest_step_tried] | @tsv' "$1/study.json" | awk -F'\t' -v needed="$1/study_needed.csv" '
    function short(x) { return x == "" ? "-" : sprintf("%.2g", x) }
    BEGIN { head = "law,largest stable step / tried"
            while ((getline line < needed) > 0) {
              split(line, c, ",")
              if (c[2] != "u_L2") continue
              if (!first) first = c[1]
              if (!(c[3] in known)) { known[c[3]] = 1; errors[++count] = c[3]; head = head "," c[3] }
              cell[c[1], c[3]] = c[4] == "" ? "-" : c[4] (c[6] == "" || !first || first == c[1] ? "" : " (" short(c[6]) "; " short(c[7]) ")") }
            print head }
    { row = $1 "," short($2)
      for (k = 1; k <= count; ++k) row = row "," cell[$1, errors[k]]
      print row }'
}

# Steps of the best explicit and of the best implicit penalty over those of contact (the first law), per kind of error
# that any law reaches.
penalty_rows() {
  awk -F, -v name="$1" '
    NR == 1 || $2 == "u_max" || $2 == "instant" { next }
    $4 != "" && !($2 in has) { has[$2] = 1; norms[++count] = $2 }
    !($3 in known) { known[$3] = 1; errors[++many] = $3 }
    !first { first = $1 }
    $1 == first { contact[$2, $3] = $4 }
    { kind = $1 ~ /^explicit/ ? "explicit" : $1 ~ /^implicit/ ? "implicit" : "" }
    kind && $4 != "" && (!((kind, $2, $3) in best) || $4 < best[kind, $2, $3]) { best[kind, $2, $3] = $4 }
    END { split("explicit implicit", kinds, " ")
          for (n = 1; n <= count; ++n) for (k = 1; k <= 2; ++k) {
            row = name "," norms[n] "," kinds[k]
            for (e = 1; e <= many; ++e) {
              c = contact[norms[n], errors[e]]; p = best[kinds[k], norms[n], errors[e]]
              row = row "," (c == "" ? (p == "" ? "-" : "only " p) : p == "" ? "never" : sprintf("%.2g", p / c)) }
            print row } }' "$2/study_needed.csv"
}

# Each run: steps, run time over that of the first law's finest run, error of displacement.
study_runs() {
  awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    !first { first = $1 }
    $1 == first { finest = $column["seconds"] }
    { law[NR] = $1; steps[NR] = $column["steps"]; time[NR] = $column["seconds"]; error[NR] = $column["u_L2"] }
    END { print "law,steps,time,u_L2"
          for (i = 2; i <= NR; ++i) printf "%s,%d,%.3g,%.3g\n", law[i], steps[i], time[i] / finest, error[i] }' "$1/study.csv"
}

penalties=$here/tables/study_penalty.csv
measure_study() {
  local name=$1 scene=$2 out=$work/study_$1
  echo "study: $name"
  "$ilaw" study "$scene" --out "$out" "${@:3}" >"$work/study_$name.txt" 2>&1
  study_table "$out" >"$here/tables/study_$name.csv"
  study_runs "$out" >"$here/tables/study_runs_$name.csv"
  "$ilaw" plot "$out" >/dev/null
  cp "$out/study.png" "$here/img/study_$name.png"
  if grep --quiet '^explicit' "$out/study.csv"; then penalty_rows "$name" "$out" >>"$penalties"; fi
}

measure_studies() {
  echo "scene,error of,penalty,1e-1,3e-2,1e-2,3e-3,1e-3,3e-4,1e-4" >"$penalties"
  measure_study bouncing_ball $here/scenes/bouncing_ball_e08.json
  for scene in oblique_impact bar_on_wall held_rod block_impact glued_bar; do measure_study $scene $scenes/$scene.json; done
  measure_study postit_3d $scenes/postit_3d.json
}
if wanted study; then measure_studies; fi

# ---- impacts at their instants
if wanted impacts; then /usr/bin/python3 $here/impacts.py "$ilaw"; fi

# ---- a million steps
long=$here/tables/million_steps.csv
run_long() {
  local name=$1 scene=$2 out=$work/$1
  echo "run: $name"
  "$ilaw" run "$scene" --out "$out" >/dev/null 2>&1
  local seconds
  seconds=$(value "$out/summary.json" .seconds.total)
  # Works and energies are relative to the energy of the first row.
  awk -F, -v name="$name" -v steps="$(value "$out/summary.json" .steps)" -v seconds="$seconds" -v contact="${3:-$seconds}" '
    function size(x) { return x < 0 ? -x : x }
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    { held[NR] = $column["balance.kinetic"] + $column["balance.potential"]
      given = $column["balance.interface_work"]
      momentum = ("balance.angular_momentum0" in column) ? $column["balance.angular_momentum0"] : 0
      error = $column["balance.error"] > error ? $column["balance.error"] : error }
    NR == 2 { energy0 = held[NR] - given; momentum0 = momentum }
    { turn = momentum0 ? size(momentum / momentum0 - 1) : 0; turned = turn > turned ? turn : turned }
    END { tenth = int((NR - 1) / 10)
          for (k = 0; k < tenth; ++k) { first += held[2 + k]; last += held[NR - k] }
          # Half steps and whole steps of the bar are too far apart for a sum to mean something.
          drift = momentum0 ? sprintf("%.1e,%.1e", last / first - 1, turned) : ","
          printf "%s,%d,%.2f,%.1e,%s,%.1e\n", name, steps, seconds / contact, error, drift, given / energy0 }' "$out/history.csv" >>"$long"
}
spring=$here/scenes/rotating_spring.json
measure_long() {
  echo "case,steps,run time / contact's,largest balance error,kinetic + potential last tenth / first - 1,drift of angular momentum,energy from the interface" >"$long"
  run_long bar_between_walls $here/scenes/bar_between_walls.json
  run_long rotating_spring $spring
  for stiffness in 1e4 1e5 1e6; do
    for integration in explicit implicit; do
      name=rotating_spring_penalty_${integration}_$stiffness
      # Contact again, beside it: machines drift.
      "$ilaw" run $spring --out "$work/beside" >/dev/null 2>&1
      run_long $name "$(variant $name $spring 's/"law": "contact"/"law": "penalty"/' \
        's/"restitution": 1.0, "activation": "moreau"/"stiffness": '$stiffness', "integration": "'$integration'"/')" "$(value "$work/beside/summary.json" .seconds.total)"
    done
  done
}
if wanted long; then measure_long; fi

# ---- share of the interface phase
share=$here/tables/interface_share.csv
measure_share() {
  echo "run,hexahedra-steps,interface nodes,share,bytes per interface node" >"$share"
  for repetition in 1 2 3 4 5; do
    "$ilaw" run $here/scenes/block_share.json --out "$work/block_share" >/dev/null 2>&1
    summary=$work/block_share/summary.json
    echo "$repetition,$((8000 * $(value "$summary" .steps))),$(value "$summary" '.interfaces[0].nodes'),$(
      value "$summary" .execution.interface_share),$(value "$summary" '.interfaces[0].bytes_per_node')" >>"$share"
  done
}
if wanted share; then measure_share; fi

# ---- the tables into the pages: <!-- table: NAME [CELL] --> ... <!-- end -->, all rows or those with a cell;
# numbers in three digits, - where there is none
put_tables() {
  awk -v tables="$here/tables" '
    function shown(x) { return x ~ /^[-+]?[0-9.]+(e[-+]?[0-9]+)?$/ ? sprintf("%.3g", x) : x }
    function row(line, n, cell, k, text) {
      n = split(line, cell, ",")
      for (k = 1; k <= n; ++k) text = text "| " (cell[k] == "" ? "-" : shown(cell[k])) " "
      return text "|"
    }
    /^<!-- end -->/ { skip = 0 }
    !skip { print }
    /^<!-- table: / {
      file = tables "/" $3 ".csv"; first = 1; skip = 1; only = $4 == "-->" ? "" : "," $4 ","
      while ((getline line < file) > 0) {
        if (first || only == "" || index(line, only)) print row(line)
        if (first) { gsub(/[^,]+/, "---", line); gsub(/,/, " | ", line); print "| " line " |"; first = 0 }
      }
      close(file)
    }' "$1" >"$work/page.md"
  cp "$work/page.md" "$1"
}
for page in $here/README.md $here/study.md; do put_tables "$page"; done
docs/make_pictures.py "$ilaw"
echo "done: $here"
