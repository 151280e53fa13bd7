// What the benchmarks of the tick run: a device in memory that moves along a stored path, and the
// daemon's own Cycle with a record ring that is drained at once.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "control/build/filters.h"
#include "control/core/flush_denormals.h"
#include "daemon/cycle.h"

namespace hapticd::bench {

/// Every axis follows a sine of 5 mm about zero; 1e6 counts per metre.
class MemoryDevice final : public drivers::Device {
 public:
  MemoryDevice() {
    for (std::size_t i = 0; i < kPath; ++i) {
      path_[i] = std::floor(5000 * std::sin(2 * M_PI * static_cast<double>(i) / kPath)) + 1e6;
    }
  }
  Result<drivers::DeviceInfo> connect() override { return drivers::DeviceInfo{.model = "memory"}; }
  void disconnect() noexcept override {}
  void request(const drivers::TickTime& time) noexcept override {
    at_ = static_cast<std::size_t>(time.tick) % kPath;
  }
  drivers::Collected collect(std::span<AxisSample> axes, Aux& aux) noexcept override {
    aux.armed = true;
    for (AxisSample& axis : axes) axis = {.raw = path_[at_], .freshness = Freshness::fresh};
    return drivers::Collected::complete;
  }
  void command(std::span<const double> effort, std::span<double> delivered) noexcept override {
    for (std::size_t i = 0; i < effort.size(); ++i) delivered[i] = sent[i] = effort[i];
  }
  void set_armed(bool) noexcept override {}
  void stop() noexcept override { sent.fill(0); }

  std::array<double, kMaxAxesPerDevice> sent{};

 private:
  static constexpr std::size_t kPath = 1024;
  std::array<double, kPath> path_{};
  std::size_t at_ = 0;
};

/// `devices` of `axes` axes each, x = axis; `observed`: every axis has an order-2 observer and a
/// low-pass velocity.
inline build::ProgramSpec tick_spec(std::size_t devices, std::size_t axes,
                                    std::size_t planes_per_device, bool observed) {
  build::ProgramSpec spec;
  spec.axes.assign(devices * axes, {.unit_per_raw = 1e-6,
                                    .offset = -1,
                                    .modulus_raw = 4294967296.0,
                                    .max_effort = 12,
                                    .max_velocity = 2,
                                    .max_step = 0.02});
  for (std::size_t d = 0; d < devices; ++d) {
    const auto first = static_cast<std::uint16_t>(d * axes);
    const auto count = static_cast<std::uint16_t>(axes);
    spec.devices.push_back({.first_axis = first,
                            .axes = count,
                            .first_coordinate = first,
                            .coordinates = count,
                            .max_force = 10,
                            .max_slew = 5,
                            .ramp_per_tick = 0.01,
                            .max_stale_ticks = 3});
    for (std::size_t p = 0; p < planes_per_device; ++p) {
      spec.planes.push_back({.first_coordinate = first,
                             .coordinates = count,
                             .normal = {0.6, 0.8, 0},
                             .stiffness = 1000,
                             .damping = 0.5});
    }
  }
  for (std::uint16_t i = 0; observed && i < devices * axes; ++i) {
    spec.low_passes.push_back(build::low_pass(i, 200, spec.period_s));
    spec.axis_observers.push_back(build::observer(i, static_cast<std::uint16_t>(i / axes),
                                                  {.mode = build::ObserverMode::classic,
                                                   .nominal_mass_kg = 0.1,
                                                   .nominal_damping_Ns_m = 0.2,
                                                   .cutoff_Hz = 10,
                                                   .order = 2,
                                                   .max_output = 1},
                                                  spec.period_s));
  }
  return spec;
}

class TickRig {
 public:
  explicit TickRig(build::ProgramSpec spec)
      : program_(std::move(spec)),
        devices_(program_.plan().devices.size()),
        cycle_(pointers(), program_.plan()),
        storage_(64 * program_.plan().record.bytes),
        ring_(storage_, program_.plan().record.bytes) {
    input_.enable = true;
    for (int i = 0; i < 2000; ++i)
      tick([]() noexcept -> std::int64_t { return 0; });  // through the ramp, and warm
  }

  void tick(daemon::Now now) noexcept {
    cycle_.run(program_, input_, now, &ring_);
    ring_.front();
    ring_.pop();
    ++input_.time.tick;
  }
  double force() const noexcept { return devices_[0].sent[0]; }
  bool enabled() const noexcept { return cycle_.output().mode == control::Mode::enabled; }

 private:
  std::vector<drivers::Device*> pointers() {
    std::vector<drivers::Device*> result;
    for (MemoryDevice& device : devices_) result.push_back(&device);
    return result;
  }

  FlushDenormals flush_denormals_;  // as the servo thread has it
  build::Program program_;
  std::vector<MemoryDevice> devices_;  // never resized: devices do not move
  daemon::Cycle cycle_;
  std::vector<std::byte> storage_;
  rt::SpscRing ring_;
  daemon::CycleInput input_;
};

}  // namespace hapticd::bench
