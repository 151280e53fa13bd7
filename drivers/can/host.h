// What a device of CAN drives needs of the machine: a clock, a way to wait, sockets. Tests have their own, in virtual
// time.
#pragma once
#include <cstdint>

#include "control/core/result.h"
#include "drivers/can/socket.h"

namespace hapticd::can {

class Host {
 public:
  virtual ~Host() = default;
  /// CLOCK_MONOTONIC, or what stands for it.
  virtual std::int64_t now_ns() noexcept = 0;
  /// Until the descriptor is readable, at most until then. Set-up only.
  virtual void wait(int descriptor, std::int64_t until_ns) = 0;
  virtual Result<Socket> open(const SocketOptions& options) = 0;
};

/// This machine.
Host& this_host() noexcept;

}  // namespace hapticd::can
