#!/bin/sh
# A scene rendered over CAN: hapticd against drives that hapticctl emulates on the same virtual bus.
# shellcheck source=lib.sh
. "${0%/*}/lib.sh"

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

vcan_up vcan0
hapticctl emulate --bus vcan0 "$config" > "$scratch/emulate" 2>&1 &
emulator=$!
sleep 0.5
code=0
hapticd --config "$config" --duration 3 --require-realtime --socket /run/render.sock > "$scratch/summary" 2> "$scratch/log" || code=$?
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
check render_force "$(truth holds "${largest:-0} > 0.1 && ${largest:-0} < 50")" "largest ${largest:-?} N"
[ "$bad" -eq 0 ] || tell "$scratch/log" "$scratch/summary" "$scratch/emulate"
