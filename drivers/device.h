// The one interface between the loop and hardware. Simulated devices implement it too, so all above
// it is tested in the loop.
//
// Life of a device:
//   connect()                supervisor, before the loop runs: may block and allocate
//   request collect command  servo thread, every tick from `ready` on; zero effort until enabled
//   set_armed(true)          servo thread: power stage on, may take many ticks; force only once
//                            Aux::armed says so
//   stop()                   servo thread, on every way out and in every tick of a fault
//   disconnect()             supervisor, after the loop has ended
#pragma once
#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "control/core/result.h"
#include "control/core/sample.h"

namespace hapticd::drivers {

/// When a device measures, relative to the tick that uses the sample.
enum class Timing : std::uint8_t {
  in_phase,          ///< after request() of the same tick
  free_running,      ///< on the device's own clock
  reply_to_command,  ///< on the command of the tick before
};

/// Identity and timing, as found by connect().
struct DeviceInfo {
  std::string model{};   ///< for people
  std::string serial{};  ///< empty: the device has none
  Timing timing = Timing::in_phase;
  double worst_sample_age_s =
      0;  ///< older samples count as missing; part of the latency of every check
};

/// A tick as devices see it.
struct TickTime {
  std::int64_t tick = 0;         ///< number of the period
  std::int64_t start_ns = 0;     ///< of the period: CLOCK_MONOTONIC, or virtual time
  std::int64_t deadline_ns = 0;  ///< collect is given up at this time
};

/// What a bus did to a device since it was connected: counted by one thread, read by anyone.
struct Traffic {
  std::atomic<std::uint64_t> late{0};      ///< samples that came after their tick
  std::atomic<std::uint64_t> not_sent{0};  ///< frames that the kernel did not take
  std::atomic<std::uint64_t> lost{0};     ///< at least so many were dropped by it on their way here
  std::atomic<std::uint64_t> foreign{0};  ///< commands of others
  std::atomic<std::uint64_t> malformed{0};  ///< what no sound device sends
  // Of a device that may come and go:
  bool comes_and_goes = false;
  std::atomic<std::uint64_t> connections{0};   ///< how often it was set up
  std::atomic<std::int64_t> round_trip_ns{0};  ///< as measured when it was set up; 0: not measured
  std::atomic<std::int64_t> worst_send_ns{0};  ///< that a command took on its way out
};

enum class Collected : std::uint8_t { complete, waiting };

class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  /// Names of what is physical among all on this machine, one for each part that another program could drive: before
  /// connect() where the config says which it is, else after it. Empty: nothing to lock.
  virtual std::vector<std::string> lock_names() const { return {}; }

  // -- set-up, supervisor thread
  // -------------------------------------------------------------------------------------
  /// Opens, identifies and configures the device, power stage off. Errors name the device, what was
  /// expected and found.
  virtual Result<DeviceInfo> connect() = 0;
  /// Leaves the device without force and closes it.
  virtual void disconnect() noexcept = 0;

  // -- loop, servo thread: never allocates, throws, logs or waits
  // ----------------------------------------------------
  /// Starts this tick's exchange: sends a query, or nothing.
  virtual void request(const TickTime& time) noexcept = 0;
  /// Takes what has arrived. `waiting`: not all of it; call again when wait_fd() is readable, until
  /// the deadline, after which the axes without a value are `missing`. `axes` is as long as the
  /// device has axes.
  virtual Collected collect(std::span<AxisSample> axes, Aux& aux) noexcept = 0;
  /// Descriptor that becomes readable when collect() can go on; -1: there is none.
  virtual int wait_fd() const noexcept { return -1; }
  /// Sends efforts [N, N m]; writes what the wire could carry of them to `delivered`.
  virtual void command(std::span<const double> effort, std::span<double> delivered) noexcept = 0;
  /// Power stage on or off. Repeating a call is harmless; Aux::armed tells when it is done.
  virtual void set_armed(bool armed) noexcept = 0;
  /// Zero force now, by the shortest way that the device has. Callable at any time after connect().
  virtual void stop() noexcept = 0;

  // -- for people, any thread but the loop's
  /// Why Aux::faulted is set.
  virtual std::string fault_text() const { return {}; }
  /// What it is about while it gives no samples: "not plugged in".
  virtual std::string status_text() const { return {}; }
  /// nullptr: the device has no bus.
  virtual const Traffic* traffic() const noexcept { return nullptr; }
};

}  // namespace hapticd::drivers
