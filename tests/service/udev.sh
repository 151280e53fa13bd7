#!/usr/bin/env bash
# udev.sh <rules file>: each rule is made of comma-separated KEY OP "value" with keys and operators that udev has, and
# gives the group hapticd. udev itself is on no build machine, so its grammar is held here as far as the file uses it.
# shellcheck source=../lint/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lint/common.sh"

check() {
  local match='(KERNELS?|SUBSYSTEM|ENV\{[A-Z_]+\}|ATTRS?\{[A-Za-z]+\})=="[^"]*"'
  local set='(ATTR\{power/control\}|ENV\{ID_MM_DEVICE_IGNORE\})="[^"]*"'
  grep -vE '^(#.*)?$' "$1" > "$scratch/lines" || return 1
  ! grep -vE "^$match(, $match)*, GROUP=\"hapticd\", MODE=\"0660\"(, $set)*\$" "$scratch/lines"
}

# digits <rules file>: numbers as sysfs writes them, lower case in attributes, upper case in the names of HID devices.
digits() {
  ! grep -E 'ATTR\{id(Vendor|Product)\}=="' "$1" | grep -vE 'idVendor\}=="[0-9a-f]{4}", ATTR\{idProduct\}=="[0-9a-f]{4}"' &&
    ! grep 'KERNELS==' "$1" | grep -vE 'KERNELS=="0003:[0-9A-F]{4}:[0-9A-F]{4}\.\*"'
}

# has <rules file> <vendor> <product>: the node for libusb, and, but for a Falcon, that of hidraw.
has() {
  grep -q "^SUBSYSTEM==\"usb\", .*ATTR{idVendor}==\"$2\", ATTR{idProduct}==\"$3\", .*ATTR{power/control}=\"on\"" "$1" &&
    { [ "$2" = 0403 ] || grep -q "^SUBSYSTEM==\"hidraw\", KERNELS==\"0003:${2^^}:${3^^}\.\*\"" "$1"; }
}

check "$1" || fail "the lines above"
digits "$1" || fail "the digits above"
# The form that is given for other devices must be right too.
sed -n 's/^#   //p' "$1" > "$scratch/forms.rules"
check "$scratch/forms.rules" || fail "the forms in the comments"
digits "$scratch/forms.rules" || fail "the digits in the forms"
grep -q 'KERNEL=="cpu_dma_latency"' "$1" || fail "no rule for cpu_dma_latency"
for product in 0403:cb48 1209:ffb0 1234:0006 16c0:0486; do
  has "$1" "${product%:*}" "${product#*:}" || fail "no rules for $product"
done
echo 'KERNEL="cpu_dma_latency", GROUP="hapticd", MODE="0660"' > "$scratch/bad.rules"
must_fail "an assignment in place of a comparison" check "$scratch/bad.rules"
echo 'SUBSYSTEM=="usb", ATTR{idVendor}=="12AB", ATTR{idProduct}=="0001", GROUP="hapticd", MODE="0660"' > "$scratch/bad.rules"
must_fail "an attribute with upper case, which no device has" digits "$scratch/bad.rules"
echo 'SUBSYSTEM=="hidraw", KERNELS=="0003:1209:ffb0.*", GROUP="hapticd", MODE="0660"' > "$scratch/bad.rules"
must_fail "a HID device's name with lower case" digits "$scratch/bad.rules"
must_fail "a product without rules" has "$1" 1209 0001
