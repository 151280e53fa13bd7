// The clock of this machine, and waits that any thread may end: what a host has whatever its ports are.
#pragma once
#include <array>

#include "drivers/usb/host.h"
#include "drivers/usb/waker.h"

namespace hapticd::usb {

class WakerHost : public Host {
 public:
  std::int64_t now_ns() noexcept override { return monotonic_ns(); }
  void wait(std::int64_t until_ns) override {
    std::array waker{waker_.descriptor()};
    wait_for(waker, until_ns);
    (void)waker_.take();
  }
  void wake() noexcept override { waker_.wake(); }

 protected:
  Waker waker_;
};

}  // namespace hapticd::usb
