#include "sim/can/bus_socket.h"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace hapticd::sim::can {

Result<int> open_bus(const std::string& interface) {
  const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
  if (fd < 0)
    return fail(ExitCode::unavailable, "this kernel has no CAN sockets (" +
                                           std::string(std::strerror(errno)) +
                                           "); load them: modprobe can-raw vcan");
  const int on = 1;
  ::setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
  if (address.can_ifindex == 0 ||
      ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(fd);
    return fail(ExitCode::unavailable, "there is no CAN interface " + interface +
                                           "; make a virtual one: ip link add " + interface +
                                           " type vcan; ip link set " + interface + " mtu 72 up");
  }
  return fd;
}

}  // namespace hapticd::sim::can
