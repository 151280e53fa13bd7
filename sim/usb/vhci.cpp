#include "sim/usb/vhci.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>

namespace hapticd::sim::usb {
namespace {

// enum usb_device_speed and the state "not attached" of the kernel.
constexpr int kFullSpeed = 2, kHighSpeed = 3;
constexpr int kFree = 4;

/// The kernel reads the whole of it in one write. 0, or an errno.
int write_to(const std::string& path, const std::string& text) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) return errno;
  const ssize_t written = ::write(fd, text.data(), text.size());
  const int why = written < 0 ? errno : 0;
  ::close(fd);
  return why;
}

std::string error_words(int error) {
  return std::strerror(error);
}

tl::unexpected<Error> not_attached(const std::string& path, int error) {
  if (error == EACCES || error == EPERM)
    return fail(ExitCode::no_permission, "plugging in an emulated USB device needs root: " + path +
                                             ": " + error_words(error));
  return fail(ExitCode::unavailable, "cannot plug in an emulated USB device: " + path + ": " +
                                         error_words(error) +
                                         "; load the driver: modprobe vhci-hcd");
}

}  // namespace

std::vector<int> free_ports(std::string_view status) {
  std::vector<int> ports;
  std::istringstream lines{std::string(status)};
  std::string line, hub;
  while (std::getline(lines, line)) {
    std::istringstream words_of(line);
    int port = 0, state = 0;
    if (words_of >> hub >> std::dec >> port >> state && hub == "hs" && port >= 0 && state == kFree)
      ports.push_back(port);
  }
  return ports;
}

Result<Vhci::Attached> Vhci::attach(Speed speed) const {
  const std::string status_path = controller_ + "/status", attach_path = controller_ + "/attach";
  std::ifstream file(status_path);
  if (!file)
    return fail(ExitCode::unavailable,
                "there is no virtual USB host controller: load its driver: modprobe vhci-hcd (" +
                    status_path + ": " + error_words(errno) + ")");
  const std::string status{std::istreambuf_iterator<char>(file), {}};
  std::array<int, 2> ends{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return fail(ExitCode::unavailable, "no pair of sockets: " + error_words(errno));
  int why = EBUSY;
  Attached attached{.fd = ends[0]};
  // Somebody else may take a port between our reading and our asking.
  for (const int port : free_ports(status)) {
    attached.port = port;
    attached.device = 1U << 16 | static_cast<std::uint32_t>(port + 1);
    why = write_to(attach_path, std::to_string(port) + " " + std::to_string(ends[1]) + " " +
                                    std::to_string(attached.device) + " " +
                                    std::to_string(speed == Speed::high ? kHighSpeed : kFullSpeed));
    if (why != EBUSY) break;
  }
  ::close(ends[1]);
  if (why == 0 && ::fcntl(ends[0], F_SETFL, O_NONBLOCK) == 0) return attached;
  ::close(ends[0]);
  if (why == EBUSY)
    return fail(ExitCode::try_again,
                "no port of the virtual USB host controller is free: " + status_path);
  return not_attached(attach_path, why);
}

void Vhci::detach(int port) const {
  (void)write_to(controller_ + "/detach", std::to_string(port));
}

}  // namespace hapticd::sim::usb
