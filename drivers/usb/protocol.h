// What differs between devices on USB: how one is found and set up, what its bytes mean, how it is told a force. Runs in the
// device's own thread (worker.h), but for carried(), which is the servo thread's.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "control/core/capacity.h"
#include "control/core/sample.h"
#include "drivers/usb/host.h"
#include "drivers/usb/options.h"

namespace hapticd::usb {

/// What the device says. Trivially copyable.
struct Reading {
  std::int64_t stamp_ns = 0;  ///< when the newest sample arrived
  std::uint32_t link = 0;     ///< which connection it came by, from 1 on
  std::uint32_t drive_faults = 0;
  std::array<double, kMaxAxesPerDevice> counts{};
  std::uint32_t digital = 0;
  std::uint8_t homed = 0;      ///< a bit for each axis
  bool armed = false;          ///< power stage on: it follows forces
  std::uint32_t failures = 0;  ///< how often the device has said that it cannot go on
  std::array<double, 6> analogue{};
};

/// What the loop wants of it. Trivially copyable.
struct Command {
  std::array<double, kMaxAxesPerDevice> effort{};  ///< N, N m
  std::int64_t at_ns = 0;
  std::uint32_t link =
      0;               ///< of the readings that it rests on: no force goes to another connection
  bool armed = false;  ///< power stage on is wanted; without, efforts are 0
};

/// What it is, for people: "Novint Falcon" and its serial number.
struct Identity {
  std::string model{}, serial{};
};

/// What the device is about, for people, while it cannot be used: "loads firmware, 40 %". Set from its thread.
class Words {
 public:
  virtual ~Words() = default;
  virtual void say(std::string_view text) = 0;
  /// Nobody waits for the device any more: give up.
  virtual bool abandoned() const noexcept { return false; }
};

enum class Heard : std::uint8_t {
  nothing,    ///< of importance
  sample,     ///< `reading` has a new one
  malformed,  ///< what no sound device sends: counted
  fault,      ///< the device says that it cannot go on: fault_text()
  restarted,  ///< what was set up or counted is gone: to be opened anew; fault_text()
};

class Protocol {
 public:
  explicit Protocol(const DeviceOptions& options) : options_(options) {}
  Protocol(const Protocol&) = delete;
  Protocol& operator=(const Protocol&) = delete;
  virtual ~Protocol() = default;

  /// Of an axis: the effort that the wire carries for this one. Pure.
  virtual double carried(std::size_t axis, double effort) const noexcept = 0;

  // -- the device's thread
  /// Finds and opens the device and sets it up, without force. May take seconds. It is not opened afterwards where it fails.
  virtual Opened<Identity> open(Host& host, Words& words) = 0;
  virtual Port* port() noexcept = 0;  ///< while opened
  /// What receive() gave. Fills all of `reading` but link, stamp_ns and failures.
  virtual Heard take(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns,
                     Reading& reading) = 0;
  /// Sends what `command` wants, or the next step of switching the power stage on or off. Efforts are finite and within the
  /// axes' maxima.
  virtual Status tell(const Command& command, std::int64_t now_ns) = 0;
  /// When it wants to be told again after that, if the loop gives nothing new before.
  virtual std::int64_t tell_again_ns(std::int64_t now_ns) const noexcept = 0;
  /// Zero force and power off, as far as it can still be told within `until_ns`; then closed. Any time after open().
  virtual void close(Host& host, std::int64_t until_ns) noexcept = 0;
  virtual std::string_view fault_text() const noexcept { return {}; }
  /// Samples that the device has sent and that never came, as far as it numbers them.
  virtual std::uint64_t lost() const noexcept { return 0; }
  /// Of a question and its answer, or of the way out, as measured by open() [s]; 0: not measured.
  virtual double round_trip_s() const noexcept { return 0; }

 protected:
  const DeviceOptions& options_;
};

/// Sends a report without force, again where that failed, or where a failure before it is only told now: until it is out,
/// the device has gone or the time is over.
template <class Send>
void send_last(Host& host, Port& port, std::int64_t until_ns, Send&& send) {
  constexpr int kTries = 5;
  for (int i = 0; i < kTries; ++i) {
    const Status taken = send();
    const Status out = taken == Status::gone ? taken : port.flush(until_ns);
    const bool done = taken == Status::ok && out == Status::ok;
    if (done || out == Status::gone || host.now_ns() >= until_ns) return;
  }
}

std::unique_ptr<Protocol> make_protocol(const DeviceOptions& options);

}  // namespace hapticd::usb
