#!/bin/sh
# The servo thread makes no USB call, whatever the device: all that it asks of the kernel is to be woken.
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
  hapticd --config "/vm/configs/$1.yaml" > "$scratch/summary" 2> "$scratch/log" &
  daemon=$!
  wait_for 150 enabled || true
  thread=$(servo_thread "$daemon")
  timeout -s INT 1 strace -o "$scratch/calls" -p "${thread:-0}" 2> "$scratch/strace" || true
  kill -TERM "$daemon"
  wait "$daemon" || true
  emulated || true
  woken=$(grep -c '^clock_nanosleep(' "$scratch/calls" || true)
  others=$(sed -n 's/^\([a-z_0-9]*\)(.*/\1/p' "$scratch/calls" | grep -vxE 'clock_nanosleep|restart_syscall' | sort | uniq -c | tr '\n' ' ' || true)
  if [ "$woken" -ge 100 ] && [ -z "$others" ]; then
    ok "servo_calls_$1" "$woken times woken, no other call"
  else
    failed "servo_calls_$1" "thread ${thread:-not found}, $woken times woken; others: ${others:-none}"
    tell "$scratch/strace" "$scratch/log" "$scratch/emulate.log"
  fi
}

calls usb_falcon
calls usb_report
calls usb_report_libusb
calls usb_openffboard
