#!/bin/sh
# The servo loop on a real-time kernel: no missed tick, and as punctual as cyclictest in the same boot.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

case $(uname -v) in
  *PREEMPT_RT*) ok kernel "$(uname -r) PREEMPT_RT" ;;
  *) failed kernel "$(uname -rv) is not PREEMPT_RT" ;;
esac

# A table of whole microseconds and how often each was met. To busybox' awk a leading zero means octal.
cyclictest -m -p80 -i1000 -l3000 -q -h200 > "$scratch/cyclictest"
# shellcheck disable=SC2046  # three numbers
set -- $(sed -nE 's/^0*([0-9]+)[[:space:]]+0*([0-9]+)$/\1 \2/p' "$scratch/cyclictest" | awk '
  {us[NR] = $1; n[NR] = $2; all += $2; if ($2) max = $1}
  END {for (i = 1; i <= NR; i++) {sum += n[i]; if (sum >= 0.999 * all) {print all, us[i], max; exit}}}')
cycles=${1:-0}
reference=${2:-0}
if [ "$cycles" -eq 3000 ]; then
  ok cyclictest "late by at most $3 us, p99.9 $reference us in $cycles cycles"
else
  failed cyclictest "$cycles cycles of 3000 in its table"
  grep -v ' 000000$' "$scratch/cyclictest" | tell
fi

hapticd --config /vm/configs/loop.yaml --duration 4 --require-realtime --socket /run/loop.sock > "$scratch/summary" 2> "$scratch/log" &
daemon=$!
sleep 2
hapticctl status --json --socket /run/loop.sock > "$scratch/status" || true
code=0
wait "$daemon" || code=$?
if [ "$code" -ne 0 ]; then
  failed loop "hapticd ended with $code"
  tell "$scratch/log" "$scratch/summary"
  exit
fi

state=$(json "$scratch/status" state)
scheduling=$(json "$scratch/status" scheduling)
if [ "$state" = enabled ] && [ "$scheduling" = "SCHED_FIFO 80" ] && grep -q '"missing":\[\]' "$scratch/status"; then
  ok status "$state, $scheduling, no right missing"
else
  failed status "state '$state', scheduling '$scheduling'"
  tell "$scratch/status"
fi

missed=$(summary_line "$scratch/summary" 'missed ticks' | cut -d' ' -f1)
ticks=$(sed -n 's/.* Hz, \([0-9]*\) ticks$/\1/p' "$scratch/summary")
if [ "$missed" = 0 ] && [ "${ticks:-0}" -ge 3900 ]; then
  ok ticks "$ticks, none missed"
else
  failed ticks "'$ticks' ticks, '$missed' missed"
  tell "$scratch/summary"
fi

# Columns: p50, p99, p99.9, max.
# shellcheck disable=SC2046  # four numbers
set -- $(summary_line "$scratch/summary" 'wake-up late by')
if [ $# -ne 4 ]; then
  failed lateness "no such line in hapticd's summary"
  tell "$scratch/summary"
  exit
fi
if holds "$4 < 200"; then
  ok lateness "at most $4 us"
else
  failed lateness "$4 us; less than 200 us are asked for"
fi
if holds "$3 <= 1.1 * $reference + 2"; then
  ok against_cyclictest "p99.9 $3 us; cyclictest $reference us"
else
  failed against_cyclictest "p99.9 $3 us is more than 1.1 x cyclictest's $reference us + 2 us"
fi
