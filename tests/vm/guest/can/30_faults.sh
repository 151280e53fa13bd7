#!/bin/sh
# What goes wrong on a bus, made on a virtual one. First that each fault really is made: a test of how the driver takes a
# fault is worth nothing otherwise.
# shellcheck source=../lib.sh
. "${0%/*}/../lib.sh"

# 40 frames as quickly as the shell can; how many were heard and how many could not be sent.
burst() {
  timeout 3 candump -L -T 500 vcan0 > "$scratch/heard" 2> /dev/null &
  listener=$!
  sleep 0.2
  unsent=0
  : > "$scratch/error"
  for frame in $(seq 100 139); do
    cansend vcan0 "$frame#0102030405060708" 2>> "$scratch/error" || unsent=$((unsent + 1))
  done
  wait "$listener" || true
  received=$(wc -l < "$scratch/heard")
}

vcan_up vcan0
listen vcan0 "$scratch/heard"
inject_bus_off vcan0
if heard "$scratch/heard" '20000040#'; then ok bus_off "injected and heard"; else failed bus_off "no error frame was heard"; fi

burst
if [ "$received" -eq 40 ] && [ "$unsent" -eq 0 ]; then
  ok burst "$received of 40 heard"
else
  failed burst "$received of 40 heard, $unsent not sent"
fi

netem_loss vcan0 50
burst
if [ "$received" -gt 5 ] && [ "$received" -lt 35 ]; then
  ok netem_loss "$received of 40 heard at 50 %"
else
  failed netem_loss "$received of 40 heard at 50 %"
fi

# At 5 kbit/s a frame takes 25.6 ms: netem counts the 16 bytes of a can_frame, whatever is in it.
netem_rate vcan0 5kbit 10
burst
if [ "$unsent" -gt 0 ] && grep -q 'No buffer space' "$scratch/error"; then
  ok netem_queue "full $unsent times"
else
  failed netem_queue "never full"
fi
apart=$(sed 's/^(\(.*\)).*/\1/' "$scratch/heard" | awk '
  NR > 1 {d = 1000 * ($1 - last); if (NR == 2 || d < least) least = d}
  {last = $1}
  END {print least + 0}')
if holds "$apart > 25.5 && $apart < 25.9"; then
  ok netem_rate "frames are $apart ms apart or more"
else
  failed netem_rate "frames are $apart ms apart or more"
fi
netem_off vcan0

interface_down vcan0
if cansend vcan0 0A1#00 2> "$scratch/error" || ! grep -qi 'down' "$scratch/error"; then
  failed interface_down "$(cat "$scratch/error")"
else
  ok interface_down "$(head -n 1 "$scratch/error")"
fi
interface_up vcan0
if cansend vcan0 0A1#00; then ok interface_up "sends again"; else failed interface_up "does not send"; fi
interface_remove vcan0
if cansend vcan0 0A1#00 2> /dev/null; then failed interface_remove "still sends"; else ok interface_remove "gone"; fi
