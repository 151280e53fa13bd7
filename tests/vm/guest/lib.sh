#!/bin/sh
# What the checks share. iproute2 is called by its path: busybox has an ip of its own that knows no CAN.
# shellcheck disable=SC3040  # busybox has pipefail
set -euo pipefail
ip=/usr/sbin/ip
tc=/usr/sbin/tc
scratch=$(mktemp -d /run/check.XXXXXX)
# What a check started does not outlive it.
# shellcheck disable=SC2046  # a list of processes
trap 'kill -9 $(jobs -p) 2> /dev/null || true' EXIT

# ok <name> <figures>, failed <name> <why>: one line a check. A failed one does not keep the next from running.
ok() { echo "ok $*"; }
failed() { echo "FAILED $*"; }
# tell <file>...: what explains a failure.
tell() { sed 's/^/# /' "$@"; }

# holds <awk condition>: for numbers with a fraction.
holds() { awk "BEGIN {exit !($1)}"; }

# wait_for <tenths of a second> <command>...
wait_for() {
  tenths=$1
  shift
  until "$@"; do
    tenths=$((tenths - 1))
    [ "$tenths" -gt 0 ] || return 1
    sleep 0.1
  done
}

# vcan_up <interface> [fd]: new, or as new.
vcan_up() {
  $ip link delete "$1" 2> /dev/null || true
  $ip link add dev "$1" type vcan
  if [ "${2:-}" = fd ]; then $ip link set "$1" mtu 72; else $ip link set "$1" mtu 16; fi
  $ip link set "$1" up
}
interface_up() { $ip link set "$1" up; }
interface_down() { $ip link set "$1" down; }
interface_remove() { $ip link delete "$1"; }

# netem_rate <interface> <rate, as 1mbit> [frames of queue]: frames take their time, and the queue can be full.
netem_rate() { $tc qdisc replace dev "$1" root netem rate "$2" limit "${3:-10}"; }
# netem_loss <interface> <per cent>
netem_loss() { $tc qdisc replace dev "$1" root netem loss "$2%"; }
netem_delay() { $tc qdisc replace dev "$1" root netem delay "$2"; }
netem_off() { $tc qdisc delete dev "$1" root 2> /dev/null || true; }

# inject_error <interface> <class, 8 hex digits with CAN_ERR_FLAG> <data>: an error frame as a controller would report it.
# Only sockets with an error filter see it.
inject_error() { cansend "$1" "$2#$3"; }
inject_bus_off() { inject_error "$1" 20000040 0000000000000000; }
inject_restarted() { inject_error "$1" 20000100 0000000000000000; }
inject_passive() { inject_error "$1" 20000004 0030000000000000; }

# listen <interface> <file>: in the background, until a frame has come or 5 s have gone by. Hears error frames, too.
listen() {
  timeout 5 candump -L -n 1 "$1,0:0,#FFFFFFFF" > "$2" 2>&1 &
  listener=$!
  sleep 0.2
}
# heard <file> <text>: what the listener heard is this.
heard() {
  wait "$listener" || true
  grep -q "$2" "$1"
}

# run_gtest <check> <program> <filter>: all tests of it, and none skipped: here they have all they need.
run_gtest() {
  if ! command -v "$2" > /dev/null; then
    failed "$1" "the guest has no $2"
    return
  fi
  code=0
  "$2" "--gtest_filter=$3" --gtest_color=no > "$scratch/gtest" 2>&1 || code=$?
  number=$(sed -n 's/^\[  PASSED  \] \([0-9]*\) test.*/\1/p' "$scratch/gtest")
  if [ "$code" -ne 0 ]; then
    failed "$1" "$2 ended with $code"
  elif grep -q '^\[  SKIPPED \]' "$scratch/gtest"; then
    failed "$1" "$2 skipped tests"
  elif [ "${number:-0}" -eq 0 ]; then
    failed "$1" "$2 ran no test"
  else
    ok "$1" "$number tests"
    return
  fi
  tell "$scratch/gtest"
}

# json <file, of one line> <key>: the number or text of that name.
json() { sed -n "s/.*\"$2\":\"\{0,1\}\([^,\"}]*\).*/\1/p" "$1"; }
# summary_line <file> <label>: what follows the label in hapticd's summary.
summary_line() { sed -n "/^  *$2 /{s/^  *$2  *//p;q}" "$1"; }

# -- USB

# usb_up: modules and udevd, which the checks of USB share.
usb_up() {
  mkdir -p /run/lock
  for module in uhci-hcd vhci-hcd hid-generic usbhid uhid; do modprobe "$module"; done
  pidof systemd-udevd > /dev/null && return
  systemd-udevd --daemon 2> "$scratch/udevd"
  udevadm trigger --action=add
  udevadm settle --timeout=20
}

# emulate <config> [option]...: in the background; takes faults by `befall KIND:NAME[@SECONDS]`. Ends with `emulated`.
emulate() {
  rm -f "$scratch/faults"
  mkfifo "$scratch/faults"
  hapticctl emulate "$@" --json --fault - < "$scratch/faults" > "$scratch/emulated" 2> "$scratch/emulate.log" &
  emulator=$!
  exec 3> "$scratch/faults"
}
befall() { echo "$1" >&3; }
# emulated: ends it. 0: it ran to here, and $scratch/emulated says what the motors did.
emulated() {
  exec 3>&-
  kill -TERM "$emulator" 2> /dev/null || return 1
  wait "$emulator"
}
# phase <since> <key> [number]: what the motors did since that befell the device, of several the last or that one.
phase() {
  sed 's/{"since"/\n&/g' "$scratch/emulated" | grep "^{\"since\":\"$1\"" | sed -n "${3:-\$}s/.*\"$2\":\([^,}]*\).*/\1/p"
}

# usb_node <vendor:product>: the device's node; fails where there is none.
usb_node() {
  for device in /sys/bus/usb/devices/*; do
    [ -e "$device/idVendor" ] || continue
    [ "$(cat "$device/idVendor"):$(cat "$device/idProduct")" = "$1" ] || continue
    sed -n 's/^DEVNAME=/\/dev\//p' "$device/uevent"
    return
  done
  return 1
}
# hidraw_node <VENDOR:PRODUCT, 8 digits each, in capitals>
hidraw_node() {
  for node in /sys/class/hidraw/*; do
    [ -e "$node" ] || continue
    grep -q ":$1\$" "$node/device/uevent" || continue
    echo "/dev/${node##*/}"
    return
  done
  return 1
}
