#!/usr/bin/env bash
# Runs the cases in an OpenRadioss and compares them with closed forms: slide, impact, two bars, peel; drop, bond and
# its continued run by the user library, which ILAW_RADIOSS_LIBRARY names where it is not in lib of this PREFIX.
#   OPENRADIOSS=/path/of/OpenRadioss THREADS=1 api/openradioss/examples/run.sh [FOLDER]
# OPENRADIOSS has exec/starter_* and exec/engine_*. ilaw must be installed for the Python that RAD_PYTHON_PATH names;
# PYTHONPATH, ILAW_LOADER and ILAW_PATH are passed on. SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
: "${OPENRADIOSS:?found no OPENRADIOSS, expected the folder of an OpenRadioss}"
programs=("$OPENRADIOSS"/exec/starter_* "$OPENRADIOSS"/exec/engine_*)
[ -x "${programs[0]}" ] || { echo "${programs[0]}: no program, expected OPENRADIOSS/exec/starter_*" >&2; exit 2; }
starter=${STARTER:-$(ls "$OPENRADIOSS"/exec/starter_* | head -1)} engine=${ENGINE:-$(ls "$OPENRADIOSS"/exec/engine_* | head -1)}
folder=$(realpath "${1:-$(mktemp -d)}")
export RAD_CFG_PATH=${RAD_CFG_PATH:-$OPENRADIOSS/hm_cfg_files}
export RAD_PYTHON_PATH=${RAD_PYTHON_PATH:-$(python3 -c 'import sysconfig as s; print(s.get_config_var("LIBDIR") + "/" + s.get_config_var("INSTSONAME"))')}
# Whatever RAD_PYTHON_PATH names, OpenRadioss then goes on to the first of libpython3.12.so, 3.11, ... that loads.
mkdir -p "$folder/python" && ln -sf "$RAD_PYTHON_PATH" "$folder/python/libpython3.12.so"
export LD_LIBRARY_PATH=$folder/python:${LD_LIBRARY_PATH:-}
export PYTHONPATH=$here/..:${PYTHONPATH:-}
library=${ILAW_RADIOSS_LIBRARY:-$here/../../../../lib/libilaw_openradioss.so}
cases="slide impact two_bars peel" dylib=()
if [ -e "$library" ]; then
  cases="$cases drop bond continued" dylib=(-dylib "$(realpath "$library")")
else
  echo "$library: not there, the cases of the user library are left out"
fi
failed=0
for case in $cases; do
  python3 "$here/cases.py" write "$case" "$folder/$case"
  (
    cd "$folder/$case"
    deck=$(basename ./*_0000.rad _0000.rad)
    rm -f history.csv engine.log
    "$starter" -i "${deck}_0000.rad" -nt 1 -python "${dylib[@]}" >starter.log 2>&1 || exit 1
    for part in "${deck}"_000[1-9].rad; do
      "$engine" -i "$part" -nt "${THREADS:-1}" "${dylib[@]}" >>engine.log 2>&1 || exit 1
    done
  ) || { echo "$case: the run failed, see $folder/$case"; failed=1; continue; }
  python3 "$here/cases.py" judge "$case" "$folder/$case" || failed=1
done
exit $failed
