// SocketCAN as the loop uses it: whole batches in one system call each way, nothing waits, nothing is tried twice.
//
// A frame that the kernel does not take is dropped and counted: a torque that waits in a queue would be an old one. What
// the controller reports (error frames) and what the kernel says of the interface becomes `Trouble`.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "control/core/result.h"
#include "drivers/can/frame.h"
#include "drivers/can/stamp_clock.h"

struct msghdr;

namespace hapticd::can {

/// What is wrong with an interface, worst last.
enum class Trouble : std::uint8_t {
  none,
  unacknowledged,  ///< nobody hears what is sent
  bus_off,         ///< the controller gave up
  down,            ///< the interface is switched off
  gone,            ///< it is no longer there
};

/// Frames that a socket hears: id, and whether it is an extended one.
struct Filter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x7ff;
  bool extended = false;
};

struct SocketOptions {
  std::string interface {};
  bool fd = false;  ///< FD frames, too
  std::vector<Filter> filters{};
  std::size_t frames_per_tick = 1;  ///< that the queue of the interface has to hold
};

struct Received {
  Frame frame{};
  std::int64_t stamp_ns =
      0;               ///< when it came: by adapter or kernel if they stamp, else when it was taken
  bool local = false;  ///< sent by another program on this machine
};

struct SocketCounters {
  std::uint64_t sent = 0, received = 0;
  std::uint64_t not_sent = 0;  ///< dropped here: the kernel's queue was full, or the interface down
  std::uint64_t lost = 0;      ///< at least so many were dropped by the kernel on their way here
};

class Socket {
 public:
  /// Errors say what the machine lacks and how to mend it: no CAN in the kernel, no such interface, switched off, no FD,
  /// queue too short.
  static Result<Socket> open(const SocketOptions& options);
  /// Of a descriptor that carries Linux' can_frame and canfd_frame; owns it.
  static Socket of(int descriptor) noexcept { return Socket(descriptor); }
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&& other) noexcept;
  ~Socket();

  static constexpr std::size_t kMost = 32;  ///< frames in one call: six drives that are being armed

  /// In this order, up to kMost; how many the kernel took. The others are dropped.
  std::size_t send(std::span<const Frame> frames) noexcept;
  /// What has arrived, oldest first, at most kMost; error frames become trouble. Call again while `more()`.
  std::span<const Received> receive(std::int64_t now_ns) noexcept;
  bool more() const noexcept { return more_; }

  int descriptor() const noexcept { return descriptor_; }
  Trouble trouble() const noexcept { return trouble_; }
  /// The controller is back; whoever calls has let go of what it drove.
  void clear_trouble() noexcept;
  const SocketCounters& counters() const noexcept { return counters_; }

 private:
  explicit Socket(int descriptor) noexcept : descriptor_(descriptor) {}
  void note(int error) noexcept;
  void note_controller(const Frame& frame) noexcept;
  void read_control(msghdr& header, Received& received) noexcept;
  void worsen(Trouble trouble) noexcept;

  int descriptor_ = -1;
  bool more_ = false;
  bool restarted_ = false;
  Trouble trouble_ = Trouble::none;
  SocketCounters counters_{};
  std::uint32_t kernel_lost_ = 0;
  std::int64_t last_stamp_ns_ = 0;
  StampClock hardware_{};
  std::array<Received, kMost> received_{};
};

/// For people.
std::string_view word_of(Trouble trouble) noexcept;

}  // namespace hapticd::can
