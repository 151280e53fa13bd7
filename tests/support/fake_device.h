// A device in memory: what it reports is what the test put there, what it was told is there to be
// looked at.
#pragma once
#include <algorithm>
#include <atomic>
#include <vector>

#include "drivers/device.h"

namespace hapticd::test {

class FakeDevice final : public drivers::Device {
 public:
  explicit FakeDevice(std::size_t axes) : raw(axes, 0.0), effort(axes, 0.0) {}

  Result<drivers::DeviceInfo> connect() override { return drivers::DeviceInfo{.model = "fake"}; }
  void disconnect() noexcept override {}
  void request(const drivers::TickTime& time) noexcept override { last_request = time; }
  drivers::Collected collect(std::span<AxisSample> axes, Aux& aux) noexcept override {
    aux.armed = armed;
    aux.faulted = faulted;
    if (silent) return drivers::Collected::waiting;
    for (std::size_t i = 0; i < axes.size(); ++i)
      axes[i] = {.raw = raw[i], .freshness = Freshness::fresh};
    return drivers::Collected::complete;
  }
  int wait_fd() const noexcept override { return fd; }
  void command(std::span<const double> wanted, std::span<double> delivered) noexcept override {
    std::copy(wanted.begin(), wanted.end(), effort.begin());
    std::copy(wanted.begin(), wanted.end(), delivered.begin());
    ++commands;
  }
  void set_armed(bool wanted) noexcept override { armed = wanted && !refuses_to_arm; }
  void stop() noexcept override {
    std::fill(effort.begin(), effort.end(), 0.0);
    ++stops;
  }

  std::vector<double> raw, effort;
  drivers::TickTime last_request;
  bool armed = false, faulted = false, silent = false, refuses_to_arm = false;
  int fd = -1;
  int commands = 0, stops = 0;
};

}  // namespace hapticd::test
