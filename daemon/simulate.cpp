#include "daemon/simulate.h"

#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "daemon/cycle.h"
#include "daemon/device_factory.h"
#include "daemon/engine.h"
#include "daemon/monotonic.h"
#include "daemon/recording.h"
#include "daemon/stability_gate.h"

namespace hapticd::daemon {
namespace {

/// Virtual time stands still within a tick. `Now` carries no context, so it lives here; one per
/// thread.
thread_local std::int64_t virtual_now_ns = 0;
std::int64_t virtual_now() noexcept {
  return virtual_now_ns;
}

Result<void> only_simulated(const config::Config& config) {
  for (const config::Device& device : config.devices) {
    if (device.driver != config::Driver::sim) {
      return fail(ExitCode::usage, "device " + device.name +
                                       " has a real driver; only devices with driver: sim can be "
                                       "simulated (drives on CAN are "
                                       "stood in for by `hapticctl emulate`)");
    }
  }
  return {};
}

/// Devices, loop and file of one simulation.
class Simulation {
 public:
  Simulation(config::Compiled& compiled, RecordingWriter writer)
      : program_(*compiled.program),
        period_ns_(servo_options(compiled).schedule.period_ns),
        devices_(make_devices(compiled)),
        writer_(std::move(writer)),
        slot_(program_.plan().record.bytes / sizeof(std::uint64_t)),
        ring_(std::as_writable_bytes(std::span(slot_)), program_.plan().record.bytes) {}

  Result<void> connect() {
    std::vector<drivers::Device*> devices;
    for (const auto& device : devices_) {
      auto info = device->connect();
      if (!info) return tl::unexpected(info.error());
      devices.push_back(device.get());
    }
    cycle_ = std::make_unique<Cycle>(std::move(devices), program_.plan());
    return {};
  }

  Result<void> tick(std::int64_t number, bool enable, bool unproven) {
    virtual_now_ns = number * period_ns_;
    const CycleInput input{
        .time = {.tick = number, .start_ns = virtual_now_ns, .deadline_ns = virtual_now_ns},
        .enable = enable,
        .unproven = unproven};
    cycle_->run(program_, input, virtual_now, &ring_);
    auto written = writer_.append(ring_.front());
    ring_.pop();
    return written;
  }

  Result<void> finish() {
    cycle_->stop();
    for (const auto& device : devices_) device->disconnect();
    return writer_.close();
  }

  std::int64_t period_ns() const noexcept { return period_ns_; }
  const build::Program& program() const noexcept { return program_; }
  const control::TickOutput& output() const noexcept { return cycle_->output(); }

 private:
  build::Program& program_;
  std::int64_t period_ns_;
  std::vector<std::unique_ptr<drivers::Device>> devices_;
  RecordingWriter writer_;
  std::vector<std::uint64_t> slot_;  // a ring of one record, emptied every tick
  rt::SpscRing ring_;
  std::unique_ptr<Cycle> cycle_;
};

}  // namespace

Result<SimulateResult> simulate(config::Compiled& compiled, const SimulateOptions& options,
                                const std::atomic<bool>& interrupt) {
  if (auto simulated = only_simulated(compiled.document.config); !simulated)
    return tl::unexpected(simulated.error());
  auto writer = RecordingWriter::create(
      options.output,
      recording_header(*compiled.program, compiled.document.digest, compiled.document.text));
  if (!writer) return tl::unexpected(writer.error());

  SimulateResult result;
  const bool permitted = stability_gate(compiled).permits(false);
  result.enabled = options.unproven || permitted;
  Simulation simulation(compiled, std::move(*writer));
  if (auto connected = simulation.connect(); !connected) return tl::unexpected(connected.error());
  const std::int64_t ticks =
      std::llround(options.duration_s * 1e9 / static_cast<double>(simulation.period_ns()));
  const std::int64_t began_ns = monotonic_ns();
  while (result.ticks < ticks && !interrupt.load(std::memory_order_relaxed)) {
    if (auto done = simulation.tick(result.ticks, result.enabled, !permitted); !done)
      return tl::unexpected(done.error());
    result.largest_force_N =
        std::fmax(result.largest_force_N, largest_contact_force_N(simulation.program()));
    ++result.ticks;
  }
  result.wall_s = static_cast<double>(monotonic_ns() - began_ns) * 1e-9;
  result.simulated_s = static_cast<double>(result.ticks * simulation.period_ns()) * 1e-9;
  result.interrupted = result.ticks < ticks;
  if (result.ticks > 0) result.fault = simulation.output().fault;
  if (auto finished = simulation.finish(); !finished) return tl::unexpected(finished.error());
  return result;
}

}  // namespace hapticd::daemon
