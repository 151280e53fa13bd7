// What the service manager is told (sd_notify(3)). Without $NOTIFY_SOCKET every call does nothing.
#pragma once
#include <chrono>
#include <optional>
#include <string>

namespace hapticd::daemon {

class ServiceNotify {
 public:
  ServiceNotify();
  void ready(const std::string& status);
  void reloading();
  void stopping();
  void status(const std::string& text);
  void feed_watchdog();
  /// How often the manager wants to hear of us at the least; none: no watchdog is set.
  std::optional<std::chrono::microseconds> watchdog() const { return watchdog_; }

 private:
  std::optional<std::chrono::microseconds> watchdog_;
};

}  // namespace hapticd::daemon
