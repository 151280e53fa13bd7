#!/usr/bin/env bash
# unit.sh <hapticd.service> <hapticd> <man dir>: systemd finds nothing wrong with the unit, and little to attack.
# shellcheck source=../lint/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lint/common.sh"
need systemd-analyze
need man
unit=$1 hapticd=$2
export MANPATH=$3

# The program and its pages are in the build tree, not where the unit will find them.
sed "s|^ExecStart=[^ ]*|ExecStart=$hapticd|" "$unit" > "$scratch/hapticd.service"
grep -q "^ExecStart=$hapticd " "$scratch/hapticd.service" || fail "no ExecStart in $unit"

verify() { systemd-analyze verify --recursive-errors=yes "$1"; }
exposure() { systemd-analyze security --offline=yes --threshold=20 --no-pager "$1" > "$scratch/exposure"; }

# broken <sed script> <what>: the unit with a mistake in it, which verify is to refuse.
broken() {
  mkdir -p "$scratch/broken"
  sed "$1" "$scratch/hapticd.service" > "$scratch/broken/hapticd.service"
  cmp -s "$scratch/hapticd.service" "$scratch/broken/hapticd.service" && fail "nothing was broken by $1"
  must_fail "$2" verify "$scratch/broken/hapticd.service"
}

verify "$scratch/hapticd.service" || fail "systemd-analyze verify"
broken 's/^WatchdogSec=/WatchdogSecs=/' "a misspelt key"
broken 's|^ExecStart=[^ ]*|ExecStart=/nowhere/hapticd|' "a program that is not there"
broken 's/man:hapticd(8)/man:hapticd(7)/' "a page that is not there"

exposure "$scratch/hapticd.service" || { tail -n 1 "$scratch/exposure" && fail "more exposed than 2.0"; }
tail -n 1 "$scratch/exposure"
grep -vE '^(Protect|Restrict|Capability|Private|NoNew|System|Device|Lock|Memory)' "$scratch/hapticd.service" \
  > "$scratch/open.service"
must_fail "a unit without protection" exposure "$scratch/open.service"

# What the loop needs and what the issue of restarting asks for must not be lost to more hardening.
for line in Type=notify User=hapticd LimitRTPRIO=95 LimitMEMLOCK=infinity WatchdogSec=2 Restart=on-failure \
  'RestartPreventExitStatus=64 65 77' DevicePolicy=closed 'DeviceAllow=/dev/cpu_dma_latency rw' CapabilityBoundingSet=; do
  grep -qxF "$line" "$unit" || fail "$unit lacks $line"
done
if grep -qE '^(RestrictRealtime|PrivateDevices|PrivateNetwork)=yes' "$unit"; then fail "the loop could not run"; fi
