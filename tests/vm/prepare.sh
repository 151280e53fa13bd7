#!/usr/bin/env bash
# prepare.sh: Debian's PREEMPT_RT kernel, downloaded and unpacked below build/vm/, never installed. Prints the directory
# that has it: vmlinux and lib/modules. Does nothing when it is there. Exit: 0, 69 not to be downloaded, 1 all else.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
PATH=$PATH:/sbin:/usr/sbin
export LC_ALL=C # what apt says is read
# shellcheck source=daemon/packages.sh
. daemon/packages.sh

# What is unpacked; pack.sh chooses among it.
readonly wanted=('./boot/vmlinuz-*' './lib/modules/*/modules.*' './lib/modules/*/kernel/drivers/net/can'
  './lib/modules/*/kernel/net/can' './lib/modules/*/kernel/net/sched/sch_netem.ko'
  './lib/modules/*/kernel/drivers/usb' './lib/modules/*/kernel/drivers/hid')

say() { echo "vm: $*" >&2; }
environment() {
  say "environment: $*"
  exit 69
}

# The versioned package that the meta package stands for today, and that package's version.
find_kernel() {
  package=$(apt-cache depends linux-image-rt-amd64 2> /dev/null | awk '/Depends: linux-image-[0-9]/ {print $2; exit}')
  [ -n "$package" ] || return 1
  version=$(apt-cache show --no-all-versions "$package" 2> /dev/null | awk '/^Version:/ {print $2; exit}')
  [ -n "$version" ] || return 1
}
# Root lets apt write as root: its own user has no way into the directory.
download() { (cd "$new" && apt-get -q -o Acquire::Retries=3 -o APT::Sandbox::User=root download "$package=$version" >&2); }
renew_lists() { as_root apt-get -q -o Acquire::Retries=3 update < /dev/null >&2; }

command -v apt-get > /dev/null || environment "this is not Debian"
mkdir -p build/vm
find_kernel || { renew_lists && find_kernel; } || environment "apt knows no linux-image-rt-amd64"
kernel=${package#linux-image-}
to=build/vm/${kernel}_$version
if [ -e "$to/prepared" ] && [ "$(cat "$to/prepared")" = "${wanted[*]}" ]; then
  echo "$to"
  exit
fi

new=$(mktemp -d build/vm/new.XXXXXX)
trap 'rm -rf "$new"' EXIT
# Old lists name packages that the archive no longer has.
if ! download; then
  { renew_lists && find_kernel && download; } || environment "$package $version cannot be downloaded"
  kernel=${package#linux-image-}
  to=build/vm/${kernel}_$version
fi
say "unpacking $package $version"
dpkg-deb --fsys-tarfile "$new/$package"_*.deb | tar -x -C "$new" --wildcards "${wanted[@]}"
python3 tests/vm/extract_vmlinux.py "$new/boot/vmlinuz-$kernel" "$new/vmlinux"
depmod -b "$new" "$kernel"
rm -r "${new:?}/boot" "${new:?}/$package"_*.deb
echo "${wanted[*]}" > "$new/prepared"
rm -rf "$to"
mv "$new" "$to"
echo "$to"
