#!/usr/bin/env bash
# run.sh: boots a PREEMPT_RT kernel in QEMU's software emulation for each suite, which is a directory of guest/, and runs
# its scripts there. Prints one line a check.
# Exit: 0 all passed, 1 not so, 64 usage, 69 the kernel cannot be downloaded, 77 skipped: something is not installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

usage() {
  cat << 'END'
usage: tests/vm/run.sh [--suite can|usb|unplug|beside|certified] [--build DIR] [--only TEXT] [PROGRAM...]
  --suite can     CAN and the loop's punctuality, in guest time alone
  --suite usb     devices on USB, likewise
  --suite unplug  these pulled out and plugged in again, likewise
  --suite beside  a device of QEMU with a program beside it, in the host's time (without --suite: all so far)
  --suite certified  likewise with a certified wall: for a host that does nothing else
  --build DIR   where hapticd and hapticctl were built (build)
  --only TEXT   only the scripts of tests/vm/guest with TEXT in their name
  PROGRAM       further programs for the guest, into its /usr/bin
REQUIRE_VM=1 makes a failure of what would be a skip.
END
}

build=build
only=
suites=(can usb unplug beside)
programs=()
while [ $# -gt 0 ]; do
  case $1 in
    --suite | --build | --only)
      [ $# -ge 2 ] || { usage >&2 && exit 64; }
      case $1 in
        --suite)
          case $2 in
            can | usb | unplug | beside | certified) suites=("$2") ;;
            *) echo "tests/vm/run.sh: no suite $2" >&2 && exit 64 ;;
          esac
          ;;
        --build) build=$2 ;;
        --only) only=$2 ;;
      esac
      shift
      ;;
    --help) usage && exit 0 ;;
    -*) usage >&2 && exit 64 ;;
    *) programs+=("$1") ;;
  esac
  shift
done

missing=()
for tool in qemu-system-x86_64 busybox cpio modprobe depmod ip tc candump cansend cyclictest python3 strace udevadm; do
  PATH=$PATH:/sbin:/usr/sbin command -v "$tool" > /dev/null || missing+=("$tool")
done
if [ "${#missing[@]}" -gt 0 ]; then
  echo "SKIPPED: vm: not installed: ${missing[*]}"
  [ "${REQUIRE_VM:-}" != 1 ] || exit 1
  exit 77
fi

mkdir -p build/vm
kernel_directory=$(tests/vm/prepare.sh)
prepared=$SECONDS
# A firmware that no Falcon has.
python3 -c 'import random, sys; sys.stdout.buffer.write(random.Random(1).randbytes(7914))' > build/vm/falcon.bin
tests/vm/pack.sh "$kernel_directory" build/vm/initramfs "$build/daemon/hapticd" "$build/daemon/hapticctl" "${programs[@]}"
packed=$SECONDS

# passed <QEMU's exit code> <serial log>
passed() {
  [ "$1" -eq 33 ] && ! grep -aq '^FAILED ' "$2" && tail -n 1 "$2" | grep -aqE '^hapticd-vm: passed, [1-9][0-9]* checks'
}
# must_not_pass <code> <line>...: a verdict that cannot be bad would be none.
must_not_pass() {
  printf '%s\n' "${@:2}" > build/vm/bad.log
  ! passed "$1" build/vm/bad.log || { echo "vm: FAILED: took this for a pass: $*" && exit 1; }
}
good='hapticd-vm: passed, 2 checks'
must_not_pass 0 "$good"                    # panic, power-off
must_not_pass 124 "$good"                  # timeout
must_not_pass 35 "$good"                   # the guest's other word
must_not_pass 33 'ok a' 'ok b'             # no last line
must_not_pass 33 'FAILED a' "$good"
must_not_pass 33 "$good" 'and more'
must_not_pass 33 'hapticd-vm: passed, 0 checks'

# Why each option is there: README.md. Never KVM, not even as a choice.
boot() { # boot <suite> <option>...
  timeout 900 qemu-system-x86_64 -accel tcg,thread=single -cpu max -smp 1 -m 1024 -seed 1 -nographic -no-reboot -nodefaults \
    -serial stdio -monitor none -device isa-debug-exit,iobase=0xf4,iosize=0x04 "${@:2}" \
    -kernel "$kernel_directory/vmlinux" -initrd build/vm/initramfs \
    -append "console=ttyS0 panic=-1 quiet mitigations=off nokaslr vm_suite=$1${only:+ vm_only=$only}" < /dev/null > "build/vm/$1.log" 2>&1
}
readonly guest_time=(-icount "shift=0,sleep=off" -rtc "base=2026-01-01T00:00:00,clock=vm")
boot_can() {
  boot can "${guest_time[@]}" -object can-bus,id=cb -device kvaser_pci,canbus=cb -device kvaser_pci,canbus=cb
}
boot_usb() { boot usb "${guest_time[@]}"; }
boot_unplug() { boot unplug "${guest_time[@]}"; }
# A Falcon's board, to which QEMU's bridge has a line.
boot_beside() { boot_bridge beside tests/vm/configs/usb_serial.yaml; }
boot_certified() { boot_bridge certified tests/vm/configs/usb_serial_certified.yaml; }
boot_bridge() { # boot_bridge <suite> <config>
  local code=0 line=build/vm/line board
  [ -x "$build/tests/falcon_line" ] || { echo "vm: not built: $build/tests/falcon_line" >&2 && return 1; }
  rm -f "$line"
  "$build/tests/falcon_line" "$line" "$2" build/vm/falcon.bin > build/vm/falcon_line.json &
  board=$!
  boot "$1" -device piix3-usb-uhci -chardev "socket,id=line,path=$line,server=on,wait=off" \
    -device usb-serial,chardev=line || code=$?
  wait "$board" || true
  echo "falcon_line: $(cat build/vm/falcon_line.json)"
  return "$code"
}

# chosen <suite>: --only leaves some of it.
chosen() {
  local script
  for script in "tests/vm/guest/$1"/[0-9]*.sh; do
    case $script in *"$only"*) return ;; esac
  done
  return 1
}

# judge <suite>: boots it, prints its checks and its verdict.
judge() {
  local suite=$1 started=$SECONDS code=0 log=build/vm/$1.log why took
  "boot_$suite" || code=$?
  tr -d '\r' < "$log" | grep -aE '^(ok|FAILED|hapticd-vm:) ' || true
  took="$((SECONDS - started)) s"
  if passed "$code" "$log"; then
    echo "vm: $suite passed; $took"
    return
  fi
  case $code in
    35) why="checks failed" ;;
    124) why="not done after 900 s" ;;
    33) why="the exit code and the lines contradict each other" ;;
    *) why="QEMU ended with $code: a panic, a power-off or an option that it does not know" ;;
  esac
  # What the checks told of their failures, and what the kernel said.
  grep -avE '^ok ' "$log" | tail -n 60 >&2 || true
  echo "vm: FAILED: $suite: $why; $took; all that was said: $log"
  return 1
}

failed=0
running=()
for suite in "${suites[@]}"; do
  chosen "$suite" || continue
  # Guest time does not depend on what else runs: those suites run at once, and what runs by the host's clock afterwards.
  [ "$suite" != beside ] || for other in "${running[@]}"; do wait "${other%:*}" || true; done
  judge "$suite" > "build/vm/$suite.verdict" 2>&1 &
  running+=("$!:$suite")
done
[ "${#running[@]}" -gt 0 ] || { echo "tests/vm/run.sh: no script has $only in its name" >&2 && exit 64; }
for one in "${running[@]}"; do
  wait "${one%:*}" || failed=1
  cat "build/vm/${one#*:}.verdict"
done
[ "$failed" -eq 0 ] || exit 1
echo "vm: passed; $((packed - prepared)) s pack, $SECONDS s in all"
