// Simulated devices that share a hand, driven without a loop as the loop drives them.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "sim/shared_hand.h"
#include "sim/sim_device.h"

namespace hapticd::sim {

inline DeviceOptions one_axis(const char* name, double mass_kg, double delay_s = 0) {
  DeviceOptions options;
  options.name = name;
  options.axes = {{.mass_kg = mass_kg, .delay_s = delay_s, .max_effort_N = 100}};
  return options;
}

/// Devices that are armed, driven together as the loop drives them; each has one effort.
class SharedBench {
 public:
  explicit SharedBench(const std::vector<DeviceOptions>& options) {
    for (const DeviceOptions& device : options)
      devices.push_back(std::make_unique<SimDevice>(device));
    connect();
  }
  SharedBench(const SharedHandOptions& hand, const std::vector<DeviceOptions>& options) {
    const auto shared = std::make_shared<SharedHand>(hand, options);
    for (std::size_t i = 0; i < options.size(); ++i)
      devices.push_back(std::make_unique<SimDevice>(shared, i));
    connect();
  }
  void connect() {
    for (const auto& device : devices) {
      const auto connected = device->connect();
      if (!connected) throw std::invalid_argument(connected.error().text);
      device->set_armed(true);
    }
    tick = -1;
    read();
  }
  void read(std::int64_t missed = 0) {
    tick += 1 + missed;
    const drivers::TickTime time{tick, tick * 1'000'000, tick * 1'000'000};
    for (std::size_t i = 0; i < devices.size(); ++i)
      devices[backwards ? devices.size() - 1 - i : i]->request(time);
    for (const auto& device : devices)
      device->collect(std::span(samples).first(device->options().axes.size()), aux);
  }
  void command(std::size_t device, double effort_N) {
    const std::array<double, 2> efforts{effort_N, effort_N};
    const std::size_t axes = devices[device]->options().axes.size();
    devices[device]->command(std::span(efforts).first(axes), std::span(delivered).first(axes));
  }
  const Truth& truth(std::size_t device, std::size_t axis = 0) const {
    return devices[device]->truth(axis);
  }

  std::vector<std::unique_ptr<SimDevice>> devices;
  bool backwards = false;
  std::int64_t tick = -1;
  std::array<AxisSample, 2> samples{};
  std::array<double, 2> delivered{};
  Aux aux;
};

/// Efforts of no pattern, the same in every run: between -2 and 2 N.
inline double effort_N(std::int64_t tick, std::size_t device) {
  return 2 * std::sin(0.37 * static_cast<double>(tick * tick) + 1.9 * static_cast<double>(device));
}

inline void run(SharedBench& bench, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    for (std::size_t device = 0; device < bench.devices.size(); ++device)
      bench.command(device, effort_N(bench.tick, device));
    bench.read();
  }
}

/// Couples everything with everything.
inline SharedHandOptions dense_hand() {
  return {.axes = {{.device = 0, .velocity_m_s = 0.1}, {.device = 1}},
          .states = 2,
          .A = {-3, 20, -25, -4},
          .B = {1, 0.5, -0.25, 2},
          .C = {30, 4, -7, 50},
          .D = {2, 0.5, 0.25, 1}};
}

inline std::vector<DeviceOptions> two_devices() {
  std::vector<DeviceOptions> devices{one_axis("left", 0.2, 0.3e-3), one_axis("right", 0.3)};
  devices[1].seed = 2;
  for (DeviceOptions& device : devices) device.axes[0].noise_counts = 3;
  return devices;
}

}  // namespace hapticd::sim
