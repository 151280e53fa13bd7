#!/bin/sh
# A Falcon whose USB bridge is QEMU's own: hapticd takes it from the kernel's driver, loads its firmware, homes it, renders, and
# goes on after it was pulled out. Its board is a program beside QEMU (host/falcon_line.cpp), so nothing here is about times.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

usb_up
modprobe ftdi_sio
cp /vm/falcon.bin /run/falcon.bin
chmod 600 /run/falcon.bin
config=/vm/configs/usb_serial.yaml
export HAPTICD_SOCKET=/run/serial.sock

state_is() { hapticctl status --json > "$scratch/status" 2> /dev/null && [ "$(json "$scratch/status" state)" = "$1" ]; }
claimed() { [ -e /dev/ttyUSB0 ]; }

if wait_for 100 usb_node 0403:6001 > "$scratch/node"; then ok bridge "$(cat "$scratch/node")"; else failed bridge "no 0403:6001"; fi
if wait_for 50 claimed; then ok bridge_claimed "by ftdi_sio"; else failed bridge_claimed "not by ftdi_sio"; fi

hapticd --config "$config" > "$scratch/summary" 2> "$scratch/log" &
daemon=$!
if wait_for 600 state_is ready; then ok bridge_ready "firmware is loaded, and it is homed"; else
  failed bridge_ready "$(json "$scratch/status" state)"
  tell "$scratch/log" "$scratch/status"
fi
hapticctl enable --unproven > "$scratch/enable" 2>&1 || true
if wait_for 100 state_is enabled; then ok bridge_enabled "with forces"; else
  failed bridge_enabled "$(json "$scratch/status" state)"
  tell "$scratch/log" "$scratch/status"
fi
# Its board is pulled out a second after its motors first make torque.
if wait_for 200 state_is fault; then ok bridge_unplugged "a fault"; else failed bridge_unplugged "no fault"; fi
again() { hapticctl enable --unproven > "$scratch/enable" 2>&1 && state_is enabled; }
if wait_for 100 again; then ok bridge_again "enabled without restarting"; else
  failed bridge_again "$(cat "$scratch/enable")"
  tell "$scratch/log" "$scratch/status"
fi
kill -TERM "$daemon"
code=0
wait "$daemon" || code=$?
ok bridge_end "hapticd ended with $code"
