#!/bin/sh
# A certified wall on devices on USB, by every way into the kernel: hapticd against devices that hapticctl emulates.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

usb_up
cp /vm/falcon.bin /run/falcon.bin
chmod 600 /run/falcon.bin

# column <field>: of the last tick with forces on in full
column() {
  awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; ++i) { sub(/\[.*/, "", $i); if ($i == name) c = i; if ($i == "mode") m = i; if ($i == "ramp") r = i } }
    NR > 1 && c && $m == 1 && $r == 1 { last = $c } END { print last }' "$scratch/ticks.csv"
}
# render <check> <config> <seconds> <field> <least> <most> <emulate's option>...
render() {
  check=$1
  config=/vm/configs/$2.yaml
  seconds=$3
  field=$4
  least=$5
  most=$6
  shift 6
  rm -f /run/usb.hrec
  emulate "$config" "$@"
  sleep 0.3
  code=0
  hapticd --config "$config" --duration "$seconds" --require-realtime --socket /run/usb.sock > "$scratch/summary" 2> "$scratch/log" || code=$?
  alive=1
  emulated || alive=0
  hapticctl export --csv -o "$scratch/ticks.csv" /run/usb.hrec > /dev/null 2>&1 || true
  force=$(column "$field")
  missed=$(summary_line "$scratch/summary" 'missed ticks' | cut -d' ' -f1)
  held=$(summary_line "$scratch/summary" 'samples held')
  figures="$field ${force:-?}, missed ticks ${missed:-?}, samples held: ${held:-?}, ended with $code"
  if [ "$alive" -eq 1 ] && [ "$code" -eq 0 ] && [ "$missed" = 0 ] && [ "$held" = 0 ] && holds "${force:-0} > $least && ${force:-0} < $most"; then
    ok "$check" "$figures"
  else
    failed "$check" "$figures"
    tell "$scratch/log" "$scratch/summary" "$scratch/emulate.log" "$scratch/emulated"
  fi
}

# The hand presses with 0.5 N, and the wall bears it; the wheel's rim is 0.1 m from its axis.
render usb_report_hidapi usb_report 1.5 board.x.force 0.48 0.52
render usb_report_libusb usb_report_libusb 1.5 board.x.force 0.48 0.52
render uhid_report usb_report 1.5 board.x.force 0.48 0.52 --uhid
render usb_openffboard usb_openffboard 3 wheel.turn.delivered 0.047 0.053
# The hand's 200 N/m from 20 mm and the coupling's 60 N/m from 10 mm on are in balance at 17.69 mm, with 0.46 N.
render usb_falcon usb_falcon 9 falcon.z.force 0.44 0.48
