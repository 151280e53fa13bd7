# shellcheck shell=bash
# What has to be installed to build, test and check hapticd on Debian 12, and how. Sourced by quickstart.sh and
# tests/run.sh; the one place that names packages.

# shellcheck disable=SC2034  # used by the scripts that source this file
{
  packages_build=(g++ cmake ninja-build pkg-config libeigen3-dev libexpected-dev libyaml-cpp-dev libspdlog-dev
    libcli11-dev nlohmann-json3-dev libusb-1.0-0-dev libhidapi-dev libsystemd-dev libmd-dev libdsdp-dev scdoc)
  # Not needed to run hapticd: gnuplot-nox draws the pictures of `hapticctl plot`, which says so where it is missing.
  packages_optional=(gnuplot-nox)
  packages_tests=(libgtest-dev libgmock-dev librapidcheck-dev umockdev libumockdev-dev systemd man-db shellcheck
    clang-format-14 "${packages_optional[@]}")
  packages_clang=(clang-14 libclang-rt-14-dev)
  packages_rtsan=(clang-22 libclang-rt-22-dev)
  packages_bench=(libbenchmark-dev)
  packages_vm=(qemu-system-x86 busybox-static cpio kmod iproute2 can-utils rt-tests python3 strace udev)
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo > /dev/null; then
    sudo "$@"
  else
    echo "needs root, or sudo, to run: $*" >&2
    return 77
  fi
}

# missing_packages <package>...: those that are not installed, one a line.
missing_packages() {
  local package
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2> /dev/null)" = installed ] || echo "$package"
  done
}

# install_packages <package>...: installs what is missing; touches neither network nor apt when nothing is.
install_packages() {
  if ! command -v apt-get > /dev/null || ! command -v dpkg-query > /dev/null; then
    echo "this is not Debian; what is needed, by Debian's names: $*" >&2
    echo "install them, then run the cmake commands of README.md" >&2
    return 69
  fi
  local missing
  mapfile -t missing < <(missing_packages "$@")
  [ "${#missing[@]}" -gt 0 ] || return 0
  echo "installing: ${missing[*]}"
  as_root apt-get -q -o Acquire::Retries=3 update < /dev/null || return
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Acquire::Retries=3 --no-install-recommends install \
    "${missing[@]}" < /dev/null
}
