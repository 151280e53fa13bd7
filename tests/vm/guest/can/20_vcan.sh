#!/bin/sh
# The driver against the kernel's CAN: a virtual interface, classic and FD.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

# frame <check> <what is sent> <what is heard>
frame() {
  listen vcan0 "$scratch/heard"
  cansend vcan0 "$2"
  if heard "$scratch/heard" "$3"; then
    ok "$1" "$2"
  else
    failed "$1" "$2 was not heard"
    tell "$scratch/heard"
  fi
}

vcan_up vcan0
frame vcan_classic 0A1#1122334455667788 '0A1#1122334455667788'
if cansend vcan0 '0A1##11122334455667788AABBCCDD' > /dev/null 2>&1; then
  failed vcan_mtu "an FD frame went out on a classic interface"
else
  ok vcan_mtu "a classic interface refuses FD frames"
fi
vcan_up vcan0 fd
# Heard with 4 among the flags: the kernel marks what came as FD.
frame vcan_fd '0A2##11122334455667788AABBCCDD' '0A2##51122334455667788AABBCCDD'

run_gtest can_kernel_test can_kernel_test '-Pair.*'
