#!/bin/sh
# Two emulated SJA1000 controllers on one bus: the kernel's real driver, with bit rate, queue, states and counters.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

for interface in can0 can1; do
  $ip link set "$interface" type can bitrate 1000000 restart-ms 100
  $ip link set "$interface" up
done
# The kernel tells a carrier up to a second late.
carrier() {
  $ip link > "$scratch/links"
  ! grep -q NO-CARRIER "$scratch/links"
}
wait_for 20 carrier || true
for interface in can0 can1; do
  $ip -details -statistics link show "$interface" > "$scratch/link"
  wrong=
  for word in 'state ERROR-ACTIVE' 'restart-ms 100' 'bitrate 1000000' 'qlen 10' 'berr-counter tx 0 rx 0' '<NOARP,UP,LOWER_UP,ECHO>'; do
    grep -q "$word" "$scratch/link" || wrong="$wrong; no $word"
  done
  if [ -z "$wrong" ]; then
    ok "$interface" "ERROR-ACTIVE, 1 Mbit/s, restart after 100 ms, queue of 10"
  else
    failed "$interface" "${wrong#; }"
    tell "$scratch/link"
  fi
done

# across <from> <to> <frame>
across() {
  listen "$2" "$scratch/heard"
  cansend "$1" "$3"
  if heard "$scratch/heard" "$3"; then
    ok "$1_to_$2" "$3"
  else
    failed "$1_to_$2" "$3 was not heard"
    tell "$scratch/heard"
  fi
}
across can0 can1 0A1#1122334455667788
across can1 can0 0A2#8877665544332211

run_gtest can_kernel_pair can_kernel_test 'Pair.*'
