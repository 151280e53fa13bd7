// All that runs while hapticd runs: devices, ring, telemetry, servo thread. It decides nothing; the
// supervisor does.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "config/compile.h"
#include "control/core/result.h"
#include "daemon/live.h"
#include "daemon/lock_file.h"
#include "daemon/realtime.h"
#include "daemon/servo_shared.h"
#include "daemon/servo_thread.h"
#include "daemon/telemetry.h"
#include "drivers/device.h"

namespace hapticd::daemon {

class Engine {
 public:
  /// Takes the program out of `compiled`.
  Engine(config::Compiled& compiled, TelemetryEvents events);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Connects and locks every device; on an error none is left connected.
  Result<void> connect();
  /// Asks for the machine's rights, starts telemetry, then the loop. Forces are off. A telemetry
  /// that cannot start is told by its `failed` event: the loop needs no disk.
  void start();
  /// Ramps out, ends the loop, writes what is left, disconnects. Harmless when repeated.
  void stop();

  /// Offers a new program to the loop; false: the one before has not been adopted yet.
  bool swap(config::Compiled& fresh);
  /// True once, when the loop has adopted what swap() offered; the old program is then gone.
  bool swapped();

  ServoShared& shared() noexcept { return *shared_; }
  const ServoShared& shared() const noexcept { return *shared_; }
  const RealtimeReport& realtime() const noexcept { return realtime_; }
  /// The newest program; names in it hold for all, a reload cannot change them.
  const build::Program& program() const noexcept { return *program_; }
  const drivers::Device& device(std::size_t i) const noexcept { return *devices_[i]; }
  const std::vector<drivers::DeviceInfo>& devices() const noexcept { return infos_; }
  std::uint64_t records_lost() const noexcept;
  /// What the newest record says.
  LiveView live() const { return live_.view(); }
  bool offered() const noexcept { return retiring_ != nullptr; }

 private:
  Result<void> connect_one(std::size_t i, const std::string& name);
  void disconnect_all() noexcept;
  void start_telemetry();
  void restart_telemetry();

  std::unique_ptr<build::Program> program_, retiring_;
  config::Telemetry telemetry_config_;
  Live live_;
  TelemetryEvents events_;
  RecordingHeader header_;
  ServoOptions servo_options_;
  std::vector<std::unique_ptr<drivers::Device>> devices_;
  std::vector<drivers::DeviceInfo> infos_;
  std::vector<LockFile> locks_;
  std::vector<std::uint64_t> ring_storage_;
  std::unique_ptr<ServoShared> shared_;
  RealtimeReport realtime_;
  std::optional<ProcessRealtime> process_realtime_;
  std::unique_ptr<Telemetry> telemetry_;
  std::uint64_t lost_before_ = 0;  // by telemetries that a reload replaced
  std::unique_ptr<ServoThread> servo_;
};

/// The loop as the servo thread takes it.
ServoOptions servo_options(const config::Compiled& compiled);

}  // namespace hapticd::daemon
