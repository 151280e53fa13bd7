#!/bin/sh
# USB without hapticd: emulated devices appear at the kernel, and udev gives their nodes to the group that the service has.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

usb_up
cp /vm/falcon.bin /run/falcon.bin
chmod 600 /run/falcon.bin

# owned <check> <node>: by hapticd's group, nobody else.
owned() {
  if [ -z "$2" ]; then
    failed "$1" "there is no node"
    return
  fi
  udevadm settle --timeout=10
  owner=$(stat -c '%G %a' "$2")
  if [ "$owner" = 'hapticd 660' ]; then ok "$1" "$2 is $owner"; else failed "$1" "$2 is $owner"; fi
}
# appears <config> <vendor:product> <option>...
appears() {
  config=$1
  id=$2
  shift 2
  emulate "/vm/configs/$config.yaml" "$@"
  wait_for 50 usb_node "$id" > "$scratch/node" || tell "$scratch/emulate.log"
}

appears usb_falcon 0403:cb48
owned usb_falcon_node "$(cat "$scratch/node")"
befall unplug:falcon
no_falcon() { ! usb_node 0403:cb48 > /dev/null; }
if wait_for 20 no_falcon; then ok usb_unplug "gone"; else failed usb_unplug "still there"; fi
befall plug:falcon
if wait_for 50 usb_node 0403:cb48 > /dev/null; then ok usb_plug "there again"; else failed usb_plug "not there"; fi
if emulated && wait_for 20 no_falcon; then ok usb_end "gone with its emulator"; else failed usb_end "still there"; fi

appears usb_report 1234:0006
owned usb_report_node "$(cat "$scratch/node")"
wait_for 50 hidraw_node 00001234:00000006 > "$scratch/node" || true
owned usb_report_hidraw "$(cat "$scratch/node")"
emulated || true

appears usb_openffboard 1209:ffb0
owned usb_openffboard_node "$(cat "$scratch/node")"
wait_for 50 hidraw_node 00001209:0000FFB0 > "$scratch/node" || true
owned usb_openffboard_hidraw "$(cat "$scratch/node")"
emulated || true

emulate /vm/configs/usb_report.yaml --uhid
wait_for 50 hidraw_node 00001234:00000006 > "$scratch/node" || true
owned uhid_report_hidraw "$(cat "$scratch/node")"
befall unplug:board
no_board() { ! hidraw_node 00001234:00000006 > /dev/null; }
if wait_for 20 no_board; then ok uhid_unplug "gone"; else failed uhid_unplug "still there"; fi
emulated || true
