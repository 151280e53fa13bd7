#!/bin/sh
# A Falcon whose USB bridge is QEMU's own: hapticd takes it from the kernel's driver, loads its firmware, homes it, renders, and
# goes on after it was pulled out. Its board is a program beside QEMU (host/falcon_line.cpp), so this runs by the host's clock.
# Who sources it has set `config` and, for what is not proved, `enable`.
# shellcheck disable=SC2154  # scratch is lib.sh's
# shellcheck source=lib.sh
. "${0%/*}/../lib.sh"

usb_up
modprobe ftdi_sio
cp /vm/falcon.bin /run/falcon.bin
chmod 600 /run/falcon.bin
export HAPTICD_SOCKET=/run/serial.sock

# What hapticd does is read in its log: here hapticctl takes a second to start.
log=$scratch/log
said() { grep -q -e "$1" "$log"; }
claimed() { [ -e /dev/ttyUSB0 ]; }

if wait_for 100 usb_node 0403:6001 > "$scratch/node"; then ok bridge "$(cat "$scratch/node")"; else failed bridge "no 0403:6001"; fi
if wait_for 50 claimed; then ok bridge_claimed "by ftdi_sio"; else failed bridge_claimed "not by ftdi_sio"; fi

hapticd --config "$config" --socket "$HAPTICD_SOCKET" > "$scratch/summary" 2> "$log" &
daemon=$!
# expect <check> <tenths of a second> <words of the log>
expect() {
  if wait_for "$2" said "$3"; then ok "$1" "$3"; else
    failed "$1" "no '$3'"
    tell "$log"
    exit
  fi
}
expect bridge_ready 300 'connecting -> ready'
on() { hapticctl enable ${enable:+"$enable"} > "$scratch/enable" 2>&1; }
on || true
expect bridge_enabled 100 'ready -> enabled'
# Its board is pulled out a second after its motors first make torque, and is back a second later.
expect bridge_unplugged 200 'enabled -> fault'
if wait_for 30 on; then ok bridge_again "enabled, in the same hapticd"; else
  failed bridge_again "$(cat "$scratch/enable")"
  tell "$log"
fi
kill -TERM "$daemon"
wait "$daemon" || true
expect bridge_end 10 '-> off (signal)'
