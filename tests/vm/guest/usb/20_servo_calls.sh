#!/bin/sh
# The servo thread makes no USB call, whatever the device: it asks the kernel to be woken, and wakes the device's own thread.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

usb_up
cp /vm/falcon.bin /run/falcon.bin
chmod 600 /run/falcon.bin
export HAPTICD_SOCKET=/run/calls.sock

enabled() { hapticctl status --json > "$scratch/status" 2> /dev/null && [ "$(json "$scratch/status" state)" = enabled ]; }
# servo_thread <process>: the one with the loop's priority, 80; the 40th of its figures.
servo_thread() { awk '$40 == 80 {print $1}' /proc/"$1"/task/*/stat; }

# calls <config>
calls() {
  emulate "/vm/configs/$1.yaml"
  sleep 0.5
  hapticd --config "/vm/configs/$1.yaml" --socket "$HAPTICD_SOCKET" > "$scratch/summary" 2> "$scratch/log" &
  daemon=$!
  wait_for 150 enabled || true
  thread=$(servo_thread "$daemon")
  timeout -s INT 1 strace -y -o "$scratch/calls" -p "${thread:-0}" 2> "$scratch/strace" || true
  kill -TERM "$daemon"
  wait "$daemon" || true
  emulated || true
  woken=$(grep -c '^clock_nanosleep(' "$scratch/calls" || true)
  others=$(grep -vE '^(clock_nanosleep|restart_syscall)\(|^write\([0-9]*<anon_inode:\[eventfd\]>|^(strace|---|[+]{3})' "$scratch/calls" | sed 's/[(].*//' | sort | uniq -c | tr '\n' ' ' || true)
  if [ "$woken" -ge 90 ] && [ -z "$others" ]; then
    ok "servo_calls_$1" "$woken times woken, no call but that of a wake-up"
  else
    failed "servo_calls_$1" "thread ${thread:-not found}, $woken times woken; others: ${others:-none}"
    tell "$scratch/strace" "$scratch/log" "$scratch/emulate.log"
  fi
}

calls usb_falcon
calls usb_report
calls usb_report_libusb
calls usb_openffboard
