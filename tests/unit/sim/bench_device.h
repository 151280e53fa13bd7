// A simulated device driven by hand, tick by tick, without a loop.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <utility>

#include "sim/sim_device.h"

namespace hapticd::sim {

class BenchDevice {
 public:
  explicit BenchDevice(DeviceOptions options) : device(std::move(options)) { connect(); }

  void connect() {
    const auto connected = device.connect();
    if (!connected) throw std::invalid_argument(connected.error().text);
    tick = -1;
  }
  /// Moves on to the next tick (after `missed` others) and reads.
  const AxisSample& read(std::int64_t missed = 0) {
    tick += 1 + missed;
    device.request({tick, tick * 1'000'000, tick * 1'000'000});
    device.collect(std::span(samples).first(axes()), aux);
    return samples[0];
  }
  double command(double effort_N) {
    efforts.fill(effort_N);
    device.command(std::span(efforts).first(axes()), std::span(delivered).first(axes()));
    return delivered[0];
  }
  /// Armed, at the start of a tick, at rest.
  void arm() {
    device.set_armed(true);
    read();
  }
  std::size_t axes() const { return device.options().axes.size(); }
  const Truth& truth(std::size_t axis = 0) const { return device.truth(axis); }

  SimDevice device;
  std::int64_t tick = -1;
  std::array<AxisSample, 4> samples{};
  std::array<double, 4> efforts{}, delivered{};
  Aux aux;
};

/// A free mass of 1 kg: velocity is force times time.
inline DeviceOptions free_mass() {
  DeviceOptions options;
  options.name = "bench";
  options.axes = {{.mass_kg = 1, .max_effort_N = 100}};
  return options;
}

}  // namespace hapticd::sim
