#!/bin/sh
# First process of the guest: mounts, loads modules, runs the scripts of a suite in order and tells the verdict twice, in the
# last line and to isa-debug-exit. Whatever ends before that is a failure: a panic or a power-off end QEMU with 0.
# It must not end by itself, so no `set -e`.
export PATH=/usr/sbin:/usr/bin:/bin HOME=/root LC_ALL=C
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs devtmpfs /dev
mount -t tmpfs tmpfs /run
mkdir /dev/shm
mount -t tmpfs tmpfs /dev/shm
exec < /dev/null > /dev/console 2>&1

passed=0
failed=0
# busy: hundredths of a second that the processor has worked; the rest of guest time costs the host nothing.
busy() { awk '/^cpu / { print $2 + $3 + $4 + $7 + $8 }' /proc/stat; }

# run_check <script>: its lines, counted. A script that says nothing, or ends badly without saying so, has failed.
run_check() {
  name=${1##*/}
  name=${name%.sh}
  started=$(cut -d' ' -f1 /proc/uptime)
  worked=$(busy)
  timeout 120 sh "$1" > /run/output 2>&1
  code=$?
  cat /run/output
  ok=$(grep -c '^ok ' /run/output)
  bad=$(grep -c '^FAILED ' /run/output)
  if [ "$bad" -eq 0 ] && { [ "$code" -ne 0 ] || [ "$ok" -eq 0 ]; }; then
    echo "FAILED $name ended with $code after $ok checks"
    bad=1
  fi
  passed=$((passed + ok))
  failed=$((failed + bad))
  echo "# $name from $started to $(cut -d' ' -f1 /proc/uptime) s, at work for 0.01 x $(($(busy) - worked)) s"
}

ip link set lo up
echo # the firmware has not ended its line
while read -r module; do
  # shellcheck disable=SC2086  # a name and its parameters
  if ! modprobe $module; then
    echo "FAILED module $module"
    failed=$((failed + 1))
  fi
done < /etc/modules
only=$(sed -n 's/.*vm_only=\([^ ]*\).*/\1/p' /proc/cmdline)
suite=$(sed -n 's/.*vm_suite=\([^ ]*\).*/\1/p' /proc/cmdline)
for script in "/vm/guest/$suite"/[0-9]*.sh; do
  case $script in *"$only"*) run_check "$script" ;; esac
done

if [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]; then
  echo "hapticd-vm: passed, $passed checks"
  verdict=020 # QEMU exits with 2 n + 1 = 33
else
  echo "hapticd-vm: failed, $failed of $((passed + failed)) checks"
  verdict=021 # 35
fi
sleep 1 # the serial port still has letters to send
printf "%b" "\\0$verdict" | dd of=/dev/port bs=1 seek=244 count=1 2> /dev/null
sleep 10
poweroff -f
