// Cable and host controller: carries the transfers of a host to an emulated device, frame by frame, with what befalls them.
#pragma once
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "sim/noise.h"
#include "sim/usb/device.h"

namespace hapticd::sim::usb {

/// Shares are of the transfers of bulk and interrupt endpoints, by lot.
struct WireOptions {
  double frame_s = 1e-3;    ///< an interrupt endpoint is served once in so long, times its interval; bulk in every frame
  double jitter_s = 0;      ///< a completion comes up to so much later
  double drop = 0;          ///< IN: the device has sent it, the host gets nothing. OUT: complete, and the device never saw it
  double duplicate = 0;     ///< IN: comes twice. OUT: the device sees it twice
  double runt = 0;          ///< IN: a random part of its end is missing
  std::uint64_t seed = 1;
};

/// How a transfer ended, as USB/IP numbers it.
enum class End : std::int32_t { ok = 0, stalled = -32, gone = -108, unlinked = -104 };

class Wire {
 public:
  struct Done {
    std::uint64_t id = 0;
    End end = End::ok;
    std::vector<std::uint8_t> bytes{};  ///< of an IN transfer
    std::int64_t at_ns = 0;
  };

  Wire(Device& device, const WireOptions& options) : device_(device), options_(options) {}

  // -- host: transfers wait in order of their endpoint; `id` is the host's own
  void submit_out(std::uint64_t id, std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                  std::int64_t now_ns);
  void submit_in(std::uint64_t id, std::uint8_t endpoint, std::size_t most_bytes,
                 std::int64_t now_ns);
  /// False: it has completed already. Else it never will.
  bool cancel(std::uint64_t id);
  /// Standard requests are answered here (descriptors, configuration, interface, status, halt), all else by the device.
  Answer control(const Setup& setup, std::span<const std::uint8_t> data, std::int64_t now_ns);

  /// Runs device and endpoints up to now. Completed transfers, in order of time.
  std::vector<Done> advance(std::int64_t now_ns);
  std::int64_t next_ns() const;  ///< when something may happen

  // -- what befalls it
  void unplug();  ///< all that waits ends with `gone`, as does what is submitted
  void plug(bool power_lost, std::int64_t now_ns);
  bool plugged() const { return plugged_; }
  void hang(std::int64_t until_ns);               ///< the device answers nothing until then
  void stall(std::uint8_t endpoint_address);      ///< until the host clears the halt
  void set(const WireOptions& options) { options_ = options; }
  Device& device() { return device_; }

  std::uint64_t carried() const { return carried_; }    ///< transfers that completed well
  std::uint64_t befallen() const { return befallen_; }  ///< that were dropped, doubled or cut

 private:
  // the helper who writes wire.cpp chooses
  Device& device_;
  WireOptions options_;
  bool plugged_ = true;
  std::uint64_t carried_ = 0, befallen_ = 0;
};

}  // namespace hapticd::sim::usb
