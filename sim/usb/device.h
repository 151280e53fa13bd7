// A device on an emulated USB, as its firmware behaves towards the host. Who carries its transfers is wire.h.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/motor.h"

namespace hapticd::sim::usb {

/// Time of what does not happen.
inline constexpr std::int64_t kNever = INT64_MAX;

struct Setup {
  std::uint8_t request_type = 0, request = 0;
  std::uint16_t value = 0, index = 0, length = 0;
};

/// What an endpoint answers to a transfer.
struct Answer {
  enum class Kind : std::uint8_t {
    ack,    ///< taken, or here are the bytes
    nak,    ///< not yet: the host asks again
    stall,  ///< no
  };
  Kind kind = Kind::ack;
  std::vector<std::uint8_t> bytes{};
};

/// As UTF-8; empty: there is none.
struct Names {
  std::string manufacturer{}, product{}, serial{};
};

enum class Speed : std::uint8_t { full, high };

/// Time is the host's [ns].
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  // -- what it is
  virtual Speed speed() const { return Speed::full; }
  virtual std::vector<std::uint8_t> device_descriptor() const = 0;  ///< 18 bytes
  virtual std::vector<std::uint8_t> configuration_descriptor()
      const = 0;  ///< with all that belongs to it
  virtual Names names() const = 0;
  /// Of a HID interface; empty: it is none, or has no such one.
  virtual std::vector<std::uint8_t> report_descriptor(int interface) const = 0;

  // -- transfers. Those of endpoints come packet by packet: `in` ends a transfer with one that is not full.
  /// Class and vendor requests, and GET_DESCRIPTOR of a report is not among them. `data`: of one to the device.
  virtual Answer control(const Setup& setup, std::span<const std::uint8_t> data,
                         std::int64_t now_ns) = 0;
  /// `endpoint`: number without direction.
  virtual Answer out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                     std::int64_t now_ns) = 0;
  virtual Answer in(std::uint8_t endpoint, std::size_t most_bytes, std::int64_t now_ns) = 0;

  // -- time
  /// Its own timers up to now.
  virtual void advance(std::int64_t now_ns) = 0;
  virtual std::int64_t next_ns() const = 0;  ///< of its next timer; kNever: it has none
  /// Unplugged and plugged in again. `power_lost`: all is as after boot.
  virtual void replug(bool power_lost, std::int64_t now_ns) = 0;

  // -- mechanics
  virtual std::size_t motors() const = 0;
  virtual Motor& motor(std::size_t i) = 0;
};

}  // namespace hapticd::sim::usb
