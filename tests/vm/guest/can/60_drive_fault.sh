#!/bin/sh
# A drive that fails under force: the fault names it and its cause, no force is left, and the daemon says so when it ends.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

mkdir -p /run/lock
for bus in vcan0 vcan1 vcan2; do vcan_up "$bus"; done
hapticctl emulate /vm/configs/three_odrives.yaml --fault fail:arm.y@3 --loss 0.0001 --jitter 0.00002 > "$scratch/emulate" 2>&1 &
emulator=$!
sleep 0.5
code=0
hapticd --config /vm/configs/three_odrives.yaml --duration 5 --require-realtime --socket /run/fault.sock > "$scratch/summary" 2> "$scratch/log" || code=$?
kill -TERM "$emulator" 2> /dev/null || true
wait "$emulator" || true
words='arm.y (node 2 on vcan1): the drive reports an error: motor over-temperature'
if [ "$code" -eq 1 ] && grep -qF "$words" "$scratch/log"; then
  ok drive_fault "$words"
else
  failed drive_fault "hapticd ended with $code"
  tell "$scratch/log" "$scratch/summary" "$scratch/emulate"
fi
