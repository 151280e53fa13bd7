#!/bin/sh
# A Falcon that is pulled out at every stage: it is a fault within a tick, no force is made afterwards, and once it is plugged
# in again `hapticctl enable` goes on, in the same hapticd.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

usb_up
cp /vm/falcon.bin /run/falcon.bin
chmod 600 /run/falcon.bin
original=/vm/configs/usb_falcon.yaml
config=$scratch/usb_falcon.yaml
export HAPTICD_SOCKET=/run/unplug.sock

ctl_status() { hapticctl status --json > "$scratch/status" 2> /dev/null; }
# state_is <state>...: one of them.
state_is() {
  ctl_status || return 1
  for wanted in "$@"; do [ "$(json "$scratch/status" state)" != "$wanted" ] || return 0; done
  return 1
}
unplugged() { grep -q '^unplug falcon' "$scratch/emulate.log"; }

# A tick is 6.7 ms.
# A tick is 6.7 ms.
# late: how long after it was pulled out the first tick of the recording is a fault, in ms; "none": none is.
late() {
  hapticctl export --csv -o "$scratch/ticks.csv" /run/usb.hrec > /dev/null 2>&1 || return 0
  awk -F, -v at="$(phase unplug time_ns)" 'NR == 1 { for (i = 1; i <= NF; ++i) { sub(/\[.*/, "", $i); if ($i == "time_ns") t = i; if ($i == "mode") m = i } }
    NR > 1 && $t > at && $m == 2 { printf "%.3f", ($t - at) / 1e6; found = 1; exit } END { if (!found) print "none" }' "$scratch/ticks.csv"
}

# pulled <check> <when: a share of the firmware, or a state to wait for>
pulled() {
  check=$1
  why=
  rm -f /run/usb.hrec
  : > "$scratch/enable"
  # Where it is to be pulled out while it is ready, nobody enables it.
  if [ "$2" = ready ]; then grep -v '^start:' "$original" > "$config"; else cp "$original" "$config"; fi
  emulate "$config"
  sleep 0.5
  case $2 in *%) befall "unplug:falcon@$2" ;; esac
  hapticd --config "$config" --socket /run/unplug.sock > "$scratch/summary" 2> "$scratch/log" &
  daemon=$!
  case $2 in
    *%) wait_for 100 unplugged || why="was not pulled out" ;;
    homing)
      # Its grip is pulled out and pushed in within 0.3 s.
      timeout 15 sh -c "until grep -q 'falcon.one is not homed' $scratch/log; do sleep 0.02; done" || why="never homed"
      befall unplug:falcon
      ;;
    *)
      wait_for 150 state_is "$2" || why="never $2"
      sleep 0.5
      befall unplug:falcon
      ;;
  esac
  sleep 0.5
  ctl_status || why="$why; hapticd says nothing"
  after=$(json "$scratch/status" state)
  [ "$after" != enabled ] || why="$why; still enabled"
  befall plug:falcon
  case $2 in
    homing | ready | enabled)
      # Nobody has told it to make a force: until then there is none.
      sleep 1
      befall mark:falcon
      sleep 0.3
      ! state_is enabled || why="$why; enabled by itself"
      befall mark:falcon
      hapticctl enable > "$scratch/enable" 2>&1 || true
      ;;
  esac
  # What was pulled out before it was ready goes on by itself.
  wait_for 100 state_is enabled || why="$why; not enabled in the end"
  sleep 0.3
  kill -TERM "$daemon"
  code=0
  wait "$daemon" || code=$?
  emulated || why="$why; the emulator ended early"
  figures="$after half a second later"
  case $2 in
    homing | ready | enabled)
      force=$(phase mark largest_torque 1)
      figures="$figures, largest torque before it was enabled again $force N m"
      holds "${force:-1} == 0" || why="$why; force that nobody asked for"
      ;;
  esac
  if [ "$2" = enabled ]; then
    late=$(late)
    figures="$figures, first tick of the fault after $late ms"
    { [ "$late" != none ] && holds "${late:-99} < 8"; } || why="$why; the fault is late"
  else
    holds "$(phase unplug largest_torque) == 0" || why="$why; force before it was ready"
  fi
  if [ -z "$why" ]; then ok "$check" "$figures"; else
    failed "$check" "${why#; }; $figures"
    tell "$scratch/log" "$scratch/summary" "$scratch/emulate.log" "$scratch/emulated" "$scratch/status" "$scratch/enable"
  fi
}

pulled unplug_firmware_0 0%
pulled unplug_firmware_50 50%
pulled unplug_firmware_99 99%
pulled unplug_homing homing
pulled unplug_ready ready
pulled unplug_enabled enabled
