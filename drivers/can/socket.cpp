#include "drivers/can/socket.h"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <ctime>
#include <utility>

namespace hapticd::can {
namespace {

constexpr std::size_t kControlBytes = 128;

tl::unexpected<Error> unavailable(std::string text) {
  return fail(ExitCode::unavailable, std::move(text));
}

ifreq request_of(const std::string& interface) {
  ifreq request{};
  interface.copy(request.ifr_name, sizeof(request.ifr_name) - 1);
  return request;
}

/// What the interface must be before a drive is spoken to; empty: all is well.
std::string problem_of(int descriptor, const SocketOptions& options) {
  const std::string& name = options.interface;
  ifreq request = request_of(name);
  if (name.size() >= sizeof(request.ifr_name) || ::ioctl(descriptor, SIOCGIFHWADDR, &request) != 0)
    return "there is no interface " + name + " on this machine (`ip link` lists them)";
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN) return name + " is no CAN interface";
  if (::ioctl(descriptor, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) == 0)
    return name + " is switched off; switch it on: ip link set " + name +
           " up type can bitrate 1000000";
  if (options.fd && ::ioctl(descriptor, SIOCGIFMTU, &request) == 0 &&
      request.ifr_mtu < static_cast<int>(CANFD_MTU))
    return name + " carries classic frames only and these drives speak CAN FD: ip link set " +
           name + " down, then up type can bitrate 1000000 dbitrate 5000000 fd on";
  const auto frames = static_cast<int>(options.frames_per_tick);
  if (::ioctl(descriptor, SIOCGIFTXQLEN, &request) != 0 || request.ifr_qlen == 0) return {};
  // A virtual interface has a length and no queue.
  const bool real = ::access(("/sys/class/net/" + name + "/device").c_str(), F_OK) == 0;
  const int most = real ? std::max(20, 4 * frames) : INT_MAX;
  if (request.ifr_qlen < frames || request.ifr_qlen > most)
    return name + " queues " + std::to_string(request.ifr_qlen) + " frames, expected " +
           std::to_string(frames) + " to " + std::to_string(std::max(20, 4 * frames)) +
           ": less loses frames, more keeps old torques when the bus stands; ip link set " + name +
           " txqueuelen " + std::to_string(std::max(10, 2 * frames));
  return {};
}

void set_filters(int descriptor, const SocketOptions& options) {
  std::vector<can_filter> filters;
  for (const Filter& filter : options.filters) {
    const canid_t kind = filter.extended ? CAN_EFF_FLAG : 0;
    filters.push_back(
        {.can_id = filter.id | kind, .can_mask = filter.mask | CAN_EFF_FLAG | CAN_RTR_FLAG});
  }
  ::setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
               static_cast<socklen_t>(filters.size() * sizeof(can_filter)));
  const can_err_mask_t errors =
      CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | CAN_ERR_ACK | CAN_ERR_TX_TIMEOUT;
  ::setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors);
  const int on = 1;
  ::setsockopt(descriptor, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  const int stamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE |
                     SOF_TIMESTAMPING_RX_HARDWARE | SOF_TIMESTAMPING_RAW_HARDWARE;
  ::setsockopt(descriptor, SOL_SOCKET, SO_TIMESTAMPING, &stamps, sizeof stamps);
}

std::size_t to_kernel(const Frame& frame, canfd_frame& out) noexcept {
  out = {};
  out.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0) | (frame.remote ? CAN_RTR_FLAG : 0);
  out.len = frame.size;
  std::copy_n(frame.data.begin(), frame.remote ? 0 : frame.size, out.data);
  if (!frame.fd) return CAN_MTU;
  out.flags = CANFD_FDF | (frame.fast ? CANFD_BRS : 0);
  return CANFD_MTU;
}

void from_kernel(const canfd_frame& in, std::size_t bytes, Frame& frame) noexcept {
  frame.extended = (in.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (in.can_id & CAN_RTR_FLAG) != 0;
  frame.error = (in.can_id & CAN_ERR_FLAG) != 0;
  frame.id = in.can_id & (frame.extended || frame.error ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.fd = bytes == CANFD_MTU;
  frame.fast = frame.fd && (in.flags & CANFD_BRS) != 0;
  frame.size = std::min<std::uint8_t>(in.len, frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  // The codecs look at no more than `size` bytes.
  std::memcpy(frame.data.data(), in.data, frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
}

std::int64_t ns_of(const timespec& time) noexcept {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// The kernel stamps with the clock of the day, which may be set at any time.
std::int64_t day_ahead_ns() noexcept {
  timespec day, loop;
  ::clock_gettime(CLOCK_REALTIME, &day);
  ::clock_gettime(CLOCK_MONOTONIC, &loop);
  return ns_of(day) - ns_of(loop);
}

}  // namespace

Result<Socket> Socket::open(const SocketOptions& options) {
  Socket socket(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW));
  const int descriptor = socket.descriptor_;
  if (descriptor < 0) {
    if (errno == EPERM || errno == EACCES)
      return fail(ExitCode::no_permission,
                  "no CAN socket for this process: " + std::string(std::strerror(errno)));
    return unavailable("this kernel has no CAN sockets (" + std::string(std::strerror(errno)) +
                       "); load them: modprobe can-raw");
  }
  if (const std::string problem = problem_of(descriptor, options); !problem.empty())
    return unavailable(problem);
  const int on = 1;
  if (options.fd && ::setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on) != 0)
    return unavailable("this kernel's CAN sockets know no FD frames");
  set_filters(descriptor, options);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(options.interface.c_str()));
  if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return unavailable(options.interface + ": " + std::strerror(errno));
  return socket;
}

Socket::Socket(Socket&& other) noexcept {
  *this = std::move(other);
}

Socket& Socket::operator=(Socket&& other) noexcept {
  if (this == &other) return *this;
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = std::exchange(other.descriptor_, -1);
  trouble_ = other.trouble_;
  counters_ = other.counters_;
  return *this;
}

Socket::~Socket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::size_t Socket::send(std::span<const Frame> frames) noexcept {
  std::array<canfd_frame, kMost> kernel;
  std::array<iovec, kMost> parts;
  std::array<mmsghdr, kMost> messages;
  const std::size_t count = std::min(frames.size(), kMost);
  if (count == 0) return 0;
  for (std::size_t i = 0; i < count; ++i) {
    parts[i] = {.iov_base = &kernel[i], .iov_len = to_kernel(frames[i], kernel[i])};
    messages[i] = {};
    messages[i].msg_hdr.msg_iov = &parts[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
  const int sent = ::sendmmsg(descriptor_, messages.data(), static_cast<unsigned>(count),
                              MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent < 0) note(errno);
  const auto done = static_cast<std::size_t>(std::max(sent, 0));
  counters_.sent += done;
  counters_.not_sent += frames.size() - done;
  return done;
}

std::span<const Received> Socket::receive(std::int64_t now_ns) noexcept {
  std::array<canfd_frame, kMost> kernel;
  std::array<iovec, kMost> parts;
  std::array<mmsghdr, kMost> messages;
  alignas(cmsghdr) std::array<std::array<std::byte, kControlBytes>, kMost> control;
  for (std::size_t i = 0; i < kMost; ++i) {
    parts[i] = {.iov_base = &kernel[i], .iov_len = sizeof(canfd_frame)};
    messages[i] = {};
    messages[i].msg_hdr.msg_iov = &parts[i];
    messages[i].msg_hdr.msg_iovlen = 1;
    messages[i].msg_hdr.msg_control = control[i].data();
    messages[i].msg_hdr.msg_controllen = kControlBytes;
  }
  const int got = ::recvmmsg(descriptor_, messages.data(), kMost, MSG_DONTWAIT, nullptr);
  more_ = got == static_cast<int>(kMost);
  if (got < 0) {
    note(errno);
    return {};
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(got); ++i) {
    const std::size_t bytes = messages[i].msg_len;
    if (bytes == 0) {  // the other end of a test's pair was closed
      worsen(Trouble::gone);
      more_ = false;
      break;
    }
    if (bytes != CAN_MTU && bytes != CANFD_MTU) continue;
    Received& received = received_[count];
    from_kernel(kernel[i], bytes, received.frame);
    received.local = (messages[i].msg_hdr.msg_flags & MSG_DONTROUTE) != 0;
    received.stamp_ns = now_ns;
    read_control(messages[i].msg_hdr, received);
    if (received.frame.error) {
      note_controller(received.frame);
    } else {
      ++count;
    }
  }
  counters_.received += count;
  if (count > 0) restarted_ = true;
  return {received_.data(), count};
}

/// Stamps, and what the kernel lost before this frame.
void Socket::read_control(msghdr& header, Received& received) noexcept {
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr; part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t lost = 0;
      std::memcpy(&lost, CMSG_DATA(part), sizeof lost);
      counters_.lost += lost - kernel_lost_;
      kernel_lost_ = lost;
    } else if (part->cmsg_type == SCM_TIMESTAMPING) {
      scm_timestamping stamps{};
      std::memcpy(&stamps, CMSG_DATA(part), sizeof stamps);
      if (const std::int64_t hardware_ns = ns_of(stamps.ts[2]); hardware_ns != 0)
        received.stamp_ns = hardware_.bring(hardware_ns, received.stamp_ns);
      else if (const std::int64_t software_ns = ns_of(stamps.ts[0]); software_ns != 0)
        // Not before the frame that came before, though the clock of the day may have been set between.
        received.stamp_ns =
            std::clamp(software_ns - day_ahead_ns(), std::min(last_stamp_ns_, received.stamp_ns),
                       received.stamp_ns);
      last_stamp_ns_ = received.stamp_ns;
    }
  }
}

void Socket::note(int error) noexcept {
  switch (error) {
    case EAGAIN:
    case ENOBUFS:  // the queue is full: counted as not sent
    case EINTR:
      return;
    case ENETDOWN:
      hardware_ = {};  // an adapter's clock may begin anew
      return worsen(Trouble::down);
    case ENXIO:
    case ENODEV:
    case EPIPE:
    case ECONNRESET:
      return worsen(Trouble::gone);
    default:  // ENOMEM and the like: counted as not sent
      return;
  }
}

void Socket::note_controller(const Frame& frame) noexcept {
  if ((frame.id & (CAN_ERR_ACK | CAN_ERR_TX_TIMEOUT)) != 0) worsen(Trouble::unacknowledged);
  if ((frame.id & CAN_ERR_BUSOFF) != 0) {
    restarted_ = false;
    worsen(Trouble::bus_off);
  }
  if ((frame.id & CAN_ERR_RESTARTED) != 0) restarted_ = true;
}

void Socket::worsen(Trouble trouble) noexcept {
  trouble_ = std::max(trouble_, trouble);
}

void Socket::clear_trouble() noexcept {
  if (trouble_ == Trouble::gone) return;
  if (trouble_ == Trouble::bus_off && !restarted_) return;
  trouble_ = Trouble::none;
}

std::string_view word_of(Trouble trouble) noexcept {
  switch (trouble) {
    case Trouble::none:
      return "no trouble";
    case Trouble::unacknowledged:
      return "nobody acknowledges what is sent: check power, cable and bit rate of the drives";
    case Trouble::bus_off:
      return "the controller went bus-off: check wiring and termination, then restart it "
             "(ip link set DEV type can restart)";
    case Trouble::down:
      return "the interface was switched off: switch it on again (ip link set DEV up)";
    case Trouble::gone:
      return "the interface is gone: plug it in again and restart hapticd";
  }
  return {};
}

}  // namespace hapticd::can
