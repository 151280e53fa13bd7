// Cable and host controller: carries the transfers of a host to an emulated device, frame by frame, with what befalls them.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <random>
#include <span>
#include <vector>

#include "sim/usb/device.h"

namespace hapticd::sim::usb {

/// Shares are of the transfers of bulk and interrupt endpoints, by lot.
struct WireOptions {
  /// An interrupt endpoint is served once in so long, times its interval; bulk in every frame. Of full speed: at high
  /// speed an eighth of it.
  double frame_s = 1e-3;
  double jitter_s = 0;  ///< a completion comes up to so much later
  /// IN: the device has sent it, the host gets nothing. OUT: complete, and the device never saw it.
  double drop = 0;
  double duplicate = 0;  ///< IN: comes twice. OUT: the device sees it twice
  double runt = 0;       ///< IN: a random part of its end is missing
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

  /// The device's configuration says which endpoints there are.
  Wire(Device& device, const WireOptions& options);

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
  void hang(std::int64_t until_ns);           ///< the device answers nothing until then
  void stall(std::uint8_t endpoint_address);  ///< until the host clears the halt
  void set(const WireOptions& options);       ///< but for the seed
  Device& device() { return device_; }

  std::uint64_t carried() const { return carried_; }    ///< transfers that completed well
  std::uint64_t befallen() const { return befallen_; }  ///< that were dropped, doubled or cut

 private:
  struct Transfer {
    std::uint64_t id = 0;
    std::int64_t since_ns = 0;
    std::size_t most_bytes = 0;         ///< of IN
    std::size_t sent_bytes = 0;         ///< of OUT
    std::vector<std::uint8_t> bytes{};  ///< all of OUT, what has come of IN
  };
  struct Endpoint {
    std::uint8_t address = 0;
    bool bulk = false;
    std::size_t packet_bytes = 0;
    std::int64_t every_frames = 1;
    bool halted = false;
    std::deque<Transfer> waiting{};
    std::vector<std::uint8_t> again{};  ///< the packet that comes twice
    bool comes_again = false;
    std::int64_t last_done_ns = 0;
  };
  enum class Served : std::uint8_t { later, packet, done, stalled };

  void read_endpoints();
  Endpoint* find(std::uint8_t address);
  const Endpoint* find(std::uint8_t address) const;
  void submit(std::uint8_t address, Transfer transfer);
  void serve_frame(std::int64_t frame, std::int64_t at_ns);
  void serve(Endpoint& endpoint, std::int64_t at_ns);
  Served give(Endpoint& endpoint, Transfer& transfer, std::int64_t at_ns);
  Served fetch(Endpoint& endpoint, Transfer& transfer, std::int64_t at_ns);
  void befall(Endpoint& endpoint, std::vector<std::uint8_t>& packet);
  void complete(Endpoint& endpoint, End end, std::int64_t at_ns);
  void finish(Done one);

  Answer standard(const Setup& setup);
  Answer descriptor(const Setup& setup) const;
  Answer hid_descriptor(const Setup& setup) const;
  Answer string(int index) const;
  Answer status(const Setup& setup) const;
  bool halt(const Setup& setup, bool halted);
  bool interface_is_there(const Setup& setup) const;

  bool befalls(double share);
  double lot();  ///< uniform in [0, 1)
  std::int64_t frame_ns() const;
  std::int64_t first_frame(std::int64_t at_ns) const;
  std::int64_t service_ns(const Endpoint& endpoint) const;
  std::int64_t next_service_ns() const;

  Device& device_;
  WireOptions options_;
  std::mt19937_64 engine_;
  std::vector<std::uint8_t> configuration_;  ///< descriptor
  std::vector<Endpoint> endpoints_;
  std::array<std::int8_t, 32> by_address_{};
  std::deque<Done> done_;  ///< in order of time
  std::uint8_t configured_ = 0;
  bool plugged_ = true;
  std::int64_t now_ns_ = 0, hangs_until_ns_ = INT64_MIN;
  std::int64_t next_frame_ = 0;
  std::uint64_t carried_ = 0, befallen_ = 0;
};

}  // namespace hapticd::sim::usb
