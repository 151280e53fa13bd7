#!/usr/bin/env bash
# Instructions per tick, by callgrind: the difference of a long and a short run, so that set-up cancels out.
#   tests/bench/count_instructions.sh [BUILD_DIR] [DEVICES AXES PLANES OBSERVED]
set -euo pipefail
build=${1:-build}
scene=("${@:2}")
(( ${#scene[@]} )) || scene=(1 3 0 0)
loop=$build/tests/bench/tick_loop
[[ -x $loop ]] || { echo "count_instructions: no $loop; build with -DHAPTICD_BUILD_BENCH=ON" >&2; exit 66; }
command -v valgrind >/dev/null || { echo "count_instructions: valgrind is not installed" >&2; exit 69; }

count() {  # TICKS -> instructions of the whole program
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$loop" "$1" "${scene[@]}" 2>&1 |
    sed -n 's/.*Collected : \([0-9]*\).*/\1/p'
}
few=$(count 1000)
many=$(count 11000)
echo "${scene[0]} device(s) x ${scene[1]} axes, ${scene[2]} plane(s) each, ${scene[3]:-0} observed: $(( (many - few) / 10000 )) instructions per tick"
