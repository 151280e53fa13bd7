#!/usr/bin/env bash
# pack.sh <kernel directory> <initramfs> <program>...: everything that the guest has, in one archive; not compressed, as
# the emulator would take longer to undo that. The same input makes the same bytes: the guest's times depend on them.
# Programs lie in /usr/bin of the guest, with the libraries that they need.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
PATH=$PATH:/sbin:/usr/sbin

readonly modules=(can can-raw can-dev vcan vxcan sja1000 kvaser_pci sch_netem)
# Loaded by the checks that need them: controllers without devices take time, too.
readonly modules_of_usb=(usbcore uhci-hcd vhci-hcd hid-generic usbhid uhid usbserial ftdi_sio)
readonly kernel_directory=$1 initramfs=$2
shift 2

root=$(mktemp -d build/vm/root.XXXXXX)
trap 'rm -rf "$root"' EXIT
chmod 755 "$root"
mkdir -p "$root"/{bin,dev,etc,lib64,proc,root,run,sys,tmp,usr/bin,usr/sbin,vm} "$root/etc/udev/rules.d"

# add <program> <directory in the guest>: libraries keep their places, as the loader looks for them there.
add() {
  [ -x "$1" ] || { echo "vm: no program $1" >&2 && return 1; }
  cp -L "$1" "$root/$2/"
  local needed library
  needed=$(ldd "$1" 2>&1) || { grep -q 'not a dynamic' <<< "$needed" || return 1; }
  ! grep 'not found' <<< "$needed" >&2 || return 1
  while read -r library; do
    [ -e "$root$library" ] || install -D "$library" "$root$library"
  done < <(awk '$2 == "=>" {print $3} $1 ~ /^\// {print $1}' <<< "$needed")
}

add "$(command -v busybox)" bin
for applet in $("$root/bin/busybox" --list); do
  [ "$applet" = busybox ] || ln -s busybox "$root/bin/$applet"
done
for program in ip tc; do add "$(command -v "$program")" usr/sbin; done
for program in candump cansend cyclictest strace udevadm; do add "$(command -v "$program")" usr/bin; done
for program in "$@"; do add "$program" usr/bin; done
ln -s udevadm "$root/usr/bin/systemd-udevd" # by that name it is the daemon
cp /lib/udev/rules.d/50-udev-default.rules systemd/60-hapticd.rules "$root/etc/udev/rules.d/"
printf 'root:x:0:0:root:/root:/bin/sh\nhapticd:x:990:990::/:/bin/sh\n' > "$root/etc/passwd"
printf 'root:x:0:\nhapticd:x:990:\n' > "$root/etc/group"

# Only the modules that are named, and those they need.
kernel=$(basename "$kernel_directory"/lib/modules/*)
mkdir -p "$root/lib/modules/$kernel"
cp "$kernel_directory/lib/modules/$kernel"/modules.{order,builtin,builtin.modinfo} "$root/lib/modules/$kernel/"
for module in "${modules[@]}" "${modules_of_usb[@]}"; do
  modprobe -d "$kernel_directory" -S "$kernel" --show-depends "$module"
done | awk '$1 == "insmod" {print $2}' | sort -u | while read -r file; do
  install -D -m 644 "$file" "$root/lib/modules/${file#*/lib/modules/}"
done
depmod -b "$root" "$kernel"
# Without echo vcan hands a frame to its listeners before the queue: netem would delay and lose nothing.
printf '%s\n' "${modules[@]}" | sed 's/^vcan$/vcan echo=1/' > "$root/etc/modules"

cp tests/vm/init.sh "$root/init"
chmod 755 "$root/init"
cp -r tests/vm/guest tests/vm/configs build/vm/falcon.bin "$root/vm/"
find "$root" -exec touch -h -d @0 {} +
(cd "$root" && find . -print0 | LC_ALL=C sort -z | cpio -0 -o -H newc --reproducible -R 0:0 --quiet) > "$initramfs"
