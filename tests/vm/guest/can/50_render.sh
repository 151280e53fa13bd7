#!/bin/sh
# A certified wall over CAN: hapticd against three drives that hapticctl emulates on virtual buses.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

config=/vm/configs/three_odrives.yaml
if [ ! -e "$config" ]; then
  failed render "there is no $config"
  exit
fi
hapticctl --help > "$scratch/help"
if ! grep -q '^  emulate ' "$scratch/help"; then
  failed render "hapticctl has no emulate"
  exit
fi

mkdir -p /run/lock
for bus in vcan0 vcan1 vcan2; do vcan_up "$bus"; done
hapticctl emulate "$config" > "$scratch/emulate" 2>&1 &
emulator=$!
sleep 0.5
hapticctl devices --seconds 0.3 > "$scratch/devices" 2>&1 || true
code=0
hapticd --config "$config" --duration 4 --require-realtime --socket /run/render.sock > "$scratch/summary" 2> "$scratch/log" || code=$?
alive=0
kill -TERM "$emulator" 2> /dev/null && alive=1
wait "$emulator" || true

largest=$(summary_line "$scratch/summary" 'largest force' | cut -d' ' -f1)
faults=$(summary_line "$scratch/summary" faults)
missed=$(summary_line "$scratch/summary" 'missed ticks' | cut -d' ' -f1)
held=$(summary_line "$scratch/summary" 'samples held')
bad=0
# check <name> <verdict 0 or 1> <figures>
check() { if [ "$2" -eq 1 ]; then ok "$1" "$3"; else failed "$1" "$3" && bad=1; fi; }
truth() { if "$@"; then echo 1; else echo 0; fi; }
check render_end "$(truth [ "$code" -eq 0 ])" "hapticd ended with $code, faults: $faults"
check render_emulator "$alive" "hapticctl emulate $([ "$alive" -eq 1 ] && echo "ran to the end" || echo "ended early")"
check render_ticks "$(truth [ "$missed" = 0 ])" "$missed missed, samples held: $held"
check render_devices "$(truth [ "$(grep -c 'ODrive, firmware 0.6' "$scratch/devices")" = 3 ])" "hapticctl devices found $(grep -c ODrive "$scratch/devices") drives"

# The hand presses with 0.5 N against the floor: so much is the force in the end, and so much do the motors get.
hapticctl export --csv -o "$scratch/ticks.csv" /run/render.hrec > /dev/null
# column <name>: of the last tick with forces on in full
column() {
  awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; ++i) { sub(/\[.*/, "", $i); if ($i == name) c = i; if ($i == "mode") m = i; if ($i == "ramp") r = i } }
    NR > 1 && c && $m == 1 && $r == 1 { last = $c } END { print last }' "$scratch/ticks.csv"
}
force=$(column arm.x.force)
delivered=$(column arm.x.delivered)
check render_force "$(truth holds "${force:-0} > 0.48 && ${force:-0} < 0.52")" "${force:-?} N, largest ${largest:-?}"
check render_delivered "$(truth holds "${delivered:-0} > 0.48 && ${delivered:-0} < 0.52")" "${delivered:-?} N"
[ "$bad" -eq 0 ] || tell "$scratch/log" "$scratch/summary" "$scratch/emulate" "$scratch/devices"
