#!/usr/bin/env bash
# sysusers.sh <hapticd.sysusers>: systemd-sysusers makes user and group of it.
# shellcheck source=../lint/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lint/common.sh"
need systemd-sysusers
mkdir -p "$scratch/root/etc"

make_users() { systemd-sysusers --root="$scratch/root" "$1"; }

make_users "$(realpath "$1")" || fail "systemd-sysusers"
grep -qE '^hapticd:x:[0-9]+:[0-9]+:Haptic servo daemon:/var/lib/hapticd:' "$scratch/root/etc/passwd" || fail "no user"
grep -qE '^hapticd:' "$scratch/root/etc/group" || fail "no group"
echo 'q hapticd' > "$scratch/bad.conf"
must_fail "an unknown type of line" make_users "$scratch/bad.conf"
