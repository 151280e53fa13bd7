#include "daemon/service_notify.h"

#include <fmt/format.h>
#include <systemd/sd-daemon.h>
#include <time.h>

#include <cstdint>

namespace hapticd::daemon {
namespace {

void notify(const std::string& message) {
  ::sd_notify(0, message.c_str());
}

std::int64_t monotonic_us() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1000;
}

}  // namespace

ServiceNotify::ServiceNotify() {
  std::uint64_t interval_us = 0;
  if (::sd_watchdog_enabled(0, &interval_us) > 0)
    watchdog_ = std::chrono::microseconds(interval_us);
}

void ServiceNotify::ready(const std::string& text) {
  notify("READY=1\nSTATUS=" + text);
}

void ServiceNotify::reloading() {
  // The time stamp lets the manager tell this reload's READY=1 from an earlier one's.
  notify(fmt::format("RELOADING=1\nMONOTONIC_USEC={}\nSTATUS=reloading", monotonic_us()));
}

void ServiceNotify::stopping() {
  notify("STOPPING=1\nSTATUS=stopping");
}

void ServiceNotify::status(const std::string& text) {
  notify("STATUS=" + text);
}

void ServiceNotify::feed_watchdog() {
  notify("WATCHDOG=1");
}

}  // namespace hapticd::daemon
