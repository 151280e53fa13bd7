#!/bin/sh
# For the checks that pull devices out: it is a fault within a tick, no force is made afterwards, and once they are plugged in
# again `hapticctl enable` goes on, in the same hapticd. What that does is read in its log: hapticctl takes long to start here.
# shellcheck disable=SC2154  # scratch is lib.sh's
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

usb_up
cp /vm/falcon.bin /run/falcon.bin
chmod 600 /run/falcon.bin
config=$scratch/config.yaml
log=$scratch/log
export HAPTICD_SOCKET=/run/unplug.sock

# said <tenths of a second> <pattern of case>: waits until a new line of the log has it.
said() {
  tries=$(($1 * 5))
  while [ "$tries" -gt 0 ]; do
    while read -r line <&4; do
      # shellcheck disable=SC2254  # it is a pattern
      case $line in $2) return ;; esac
    done
    sleep 0.02
    tries=$((tries - 1))
  done
  return 1
}
state() { sed -n 's/.* info: [a-z]* -> \([a-z]*\) (.*/\1/p' "$log" | tail -n 1; }
unplugged() { grep -q "^unplug $device" "$scratch/emulate.log"; }

# late: how long after it was pulled out the first tick of the recording is a fault, in ms; "none": none is.
late() {
  hapticctl export --csv -o "$scratch/ticks.csv" /run/usb.hrec > /dev/null 2>&1 || return 0
  awk -F, -v at="$(phase unplug time_ns)" 'NR == 1 { for (i = 1; i <= NF; ++i) { sub(/\[.*/, "", $i); if ($i == "time_ns") t = i; if ($i == "mode") m = i } }
    NR > 1 && $t > at && $m == 2 { printf "%.3f", ($t - at) / 1e6; found = 1; exit } END { if (!found) print "none" }' "$scratch/ticks.csv"
}

# pull_out <when>: at that stage; `why` says what did not come to that.
pull_out() {
  case $1 in
    *%) wait_for 100 unplugged || why="was not pulled out" ;;
    # Its grip is pulled out and pushed in within 0.3 s.
    homing) said 150 '*falcon.one is not homed*' || why="never homed" ;;
    set_up)
      said 150 '*off -> connecting*' || why="never looked for it"
      sleep 0.05
      ;;
    *)
      said 150 "*-> $1 (*" || why="never $1"
      sleep 0.3
      ;;
  esac
  case $1 in *%) ;; *) befall "unplug:$device" ;; esac
  wait_for 20 unplugged || why="$why; was not pulled out"
  [ "$1" != set_up ] || ! grep -q 'connecting ->' "$log" || why="$why; it was set up already"
}

# pulled <check> <config> <device> <when: a share of the firmware, set_up, homing, ready, enabled> [a tick, in ms]
pulled() {
  check=$1
  device=$3
  when=$4
  tick_ms=${5:-}
  why=
  rm -f /run/usb.hrec
  : > "$scratch/enable"
  # Where it is to be pulled out while it is ready, nobody enables it.
  if [ "$when" = ready ]; then grep -v '^start:' "/vm/configs/$2.yaml" > "$config"; else cp "/vm/configs/$2.yaml" "$config"; fi
  emulate "$config"
  : > "$log"
  sleep 0.3
  case $when in *%) befall "unplug:$device@$when" ;; esac
  hapticd --config "$config" --socket "$HAPTICD_SOCKET" > "$scratch/summary" 2>> "$log" &
  daemon=$!
  exec 4< "$log"
  pull_out "$when"
  sleep 0.3
  after=$(state)
  case $after in connecting | ready | homing | fault) ;; *) why="$why; still '$after'" ;; esac
  befall "plug:$device"
  case $when in
    homing | ready | enabled)
      # Nobody has told it to make a force: until then there is none.
      sleep 0.7
      befall "mark:$device"
      sleep 0.2
      case $(state) in ready | homing | fault) ;; *) why="$why; enabled by itself" ;; esac
      befall "mark:$device"
      while read -r line <&4; do :; done
      hapticctl enable > "$scratch/enable" 2>&1 || true
      ;;
  esac
  # What was pulled out before it was ready goes on by itself.
  said 100 '*-> enabled (*' || why="$why; not enabled in the end"
  sleep 0.2
  kill -TERM "$daemon"
  code=0
  wait "$daemon" || code=$?
  exec 4<&-
  [ "$code" -eq 0 ] || why="$why; hapticd ended with $code"
  emulated || why="$why; the emulator ended early"
  figures="$after 0.3 s later"
  case $when in
    homing | ready | enabled)
      force=$(phase mark largest_torque 1)
      figures="$figures, largest torque before it was enabled again $force N m"
      holds "${force:-1} == 0" || why="$why; force that nobody asked for"
      # An OpenFFBoard has a spring of its own until it is set up.
      [ "$device" = wheel ] || holds "$(phase plug largest_torque) == 0" || why="$why; force after it was plugged in"
      ;;
  esac
  if [ "$when" = enabled ]; then
    late=$(late)
    figures="$figures, first tick of the fault after $late ms, a tick is $tick_ms ms"
    { [ "$late" != none ] && holds "${late:-99} < $tick_ms + 0.5"; } || why="$why; the fault is late"
  else
    [ "$device" = wheel ] || holds "$(phase unplug largest_torque) == 0" || why="$why; force before it was ready"
  fi
  if [ -z "$why" ]; then ok "$check" "$figures"; else
    failed "$check" "${why#; }; $figures"
    tell "$log" "$scratch/summary" "$scratch/emulate.log" "$scratch/emulated" "$scratch/enable"
  fi
}
