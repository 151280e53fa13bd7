// The servo thread: sleeps to absolute times and runs one Cycle a period. It allocates, locks, logs
// and throws nothing once it runs; all it has to say goes through ServoShared.
#pragma once
#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include "control/build/program.h"
#include "daemon/cycle.h"
#include "daemon/realtime.h"
#include "daemon/servo_shared.h"
#include "daemon/tick_schedule.h"

namespace hapticd::daemon {

struct ServoOptions {
  TickScheduleOptions schedule{};
  std::int64_t collect_ns = 500'000;  ///< samples are waited for so long, from the tick's start
  int priority = 80;
  std::optional<int> cpu{};
};

class ServoThread {
 public:
  /// Devices are connected; they, `program` and `shared` outlive the thread. After it has ended the
  /// program that it ran on is program().
  ServoThread(ServoOptions options, std::vector<drivers::Device*> devices, build::Program* program,
              ServoShared& shared);
  ~ServoThread();
  ServoThread(const ServoThread&) = delete;
  ServoThread& operator=(const ServoThread&) = delete;

  /// Starts the thread and returns once it is about to run its first tick; `report` is then
  /// complete.
  void start(RealtimeReport& report);
  /// Asks it to end: forces ramp out, a few zero-force stop cycles, then it joins.
  void stop();

  build::Program* program() const noexcept { return program_; }

 private:
  void loop() noexcept;
  void tick(const Wake& wake, bool ending) noexcept;
  void take_orders(CycleInput& input) noexcept;
  void adopt_plan() noexcept;
  void account(const Wake& wake) noexcept;
  void publish_status(std::int64_t tick) noexcept;

  ServoOptions options_;
  Cycle cycle_;
  TickSchedule schedule_;
  build::Program* program_;
  ServoShared& shared_;
  std::thread thread_;
  std::atomic<bool> running_{false};
  std::uint32_t clears_seen_ = 0;
};

}  // namespace hapticd::daemon
