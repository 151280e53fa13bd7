#!/usr/bin/env bash
# udev.sh <rules file>: each rule is made of comma-separated KEY OP "value" with keys and operators that udev has, and
# gives the group hapticd. udev itself is on no build machine, so its grammar is held here as far as the file uses it.
# shellcheck source=../lint/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lint/common.sh"

check() {
  local item='(KERNEL|SUBSYSTEM|ENV\{[A-Z_]+\}|ATTRS?\{[A-Za-z]+\})=="[^"]*"'
  grep -vE '^(#.*)?$' "$1" > "$scratch/lines" || return 1
  ! grep -vE "^$item(, $item)*, GROUP=\"hapticd\", MODE=\"0660\"\$" "$scratch/lines"
}

check "$1" || fail "the lines above"
# The form that is given for devices to come must be right too.
sed -n 's/^#   //p' "$1" > "$scratch/forms.rules"
check "$scratch/forms.rules" || fail "the forms in the comments"
grep -q 'KERNEL=="cpu_dma_latency"' "$1" || fail "no rule for cpu_dma_latency"
echo 'KERNEL="cpu_dma_latency", GROUP="hapticd", MODE="0660"' > "$scratch/bad.rules"
must_fail "an assignment in place of a comparison" check "$scratch/bad.rules"
