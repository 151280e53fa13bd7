#include "drivers/can/host.h"

#include <poll.h>
#include <time.h>

namespace hapticd::can {
namespace {

class ThisHost final : public Host {
 public:
  std::int64_t now_ns() noexcept override {
    timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
  }
  void wait(int descriptor, std::int64_t until_ns) override {
    const std::int64_t left_ns = until_ns - now_ns();
    if (left_ns <= 0) return;
    pollfd waiting{.fd = descriptor, .events = POLLIN, .revents = 0};
    const timespec timeout{.tv_sec = static_cast<time_t>(left_ns / 1'000'000'000),
                           .tv_nsec = static_cast<long>(left_ns % 1'000'000'000)};
    (void)ppoll(&waiting, 1, &timeout, nullptr);
  }
  Result<Socket> open(const SocketOptions& options) override { return Socket::open(options); }
};

}  // namespace

Host& this_host() noexcept {
  static ThisHost host;
  return host;
}

}  // namespace hapticd::can
