// Transfers on their way: several IN, so that no chance of the endpoint is missed while one is handled; one OUT, and behind
// it the newest that waits. Callbacks come from LibusbSession::pump() and control transfers, in the device's own thread.
//
// IN and OUT have no time limit: one that ends may lose what arrives in that moment.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "drivers/usb/arrival_queue.h"
#include "drivers/usb/last_look.h"
#include "drivers/usb/libusb_session.h"
#include "drivers/usb/port.h"

namespace hapticd::usb {

struct FreeTransfer {
  void operator()(libusb_transfer* transfer) const noexcept { libusb_free_transfer(transfer); }
};
using TransferPointer = std::unique_ptr<libusb_transfer, FreeTransfer>;

/// The worse of two, of what has to be told.
Status worse(Status one, Status other) noexcept;

class Reads {
 public:
  /// `transfer_bytes`: whole packets, so that no packet is too long.
  Reads(LibusbSession& session, const Endpoint& endpoint, std::size_t transfer_bytes, int count,
        ArrivalQueue& queue);
  Reads(const Reads&) = delete;
  Reads& operator=(const Reads&) = delete;

  /// All that are not on their way. After a stall the halt is cleared first.
  void begin() noexcept;
  void cancel() noexcept;
  bool idle() const noexcept { return under_way_ == 0; }
  /// After all that had come was handed over.
  void looked(std::int64_t before_ns) noexcept { last_look_.looked(before_ns); }
  /// What ended a transfer; it stays ended until begin(). ok: nothing did.
  Status failure() const noexcept { return failure_; }

 private:
  struct Read {
    Reads* owner = nullptr;
    TransferPointer transfer{};
    std::vector<std::uint8_t> bytes{};
    bool under_way = false;
  };
  void submit(Read& read) noexcept;
  void completed(Read& read) noexcept;
  void cancel_all() noexcept;

  LibusbSession& session_;
  const Endpoint endpoint_;
  ArrivalQueue& queue_;
  std::vector<Read> reads_;
  LastLook last_look_{};
  int under_way_ = 0;
  bool ending_ = false;
  Status failure_ = Status::ok;
};

/// How a report gets out where there is no OUT endpoint: HID's SET_REPORT.
struct WriteTo {
  Endpoint endpoint{};  ///< address 0: none
  bool numbered = false;
};

class Writes {
 public:
  Writes(LibusbSession& session, const WriteTo& to, std::size_t most_bytes);
  Writes(const Writes&) = delete;
  Writes& operator=(const Writes&) = delete;

  /// What failed before is told, once, though this is sent all the same: it may be a zero force.
  Status send(std::span<const std::uint8_t> bytes) noexcept;
  void cancel() noexcept;
  bool idle() const noexcept { return !under_way_; }
  /// What has failed since the last time somebody was told.
  Status take_failure() noexcept;
  const Outgoing& outgoing() const noexcept { return outgoing_; }

 private:
  struct Message {
    std::vector<std::uint8_t> bytes{};
    std::size_t size = 0;
    void set(std::span<const std::uint8_t> from) noexcept;
  };
  Status begin(std::span<const std::uint8_t> bytes) noexcept;
  void completed() noexcept;
  void count() noexcept;

  LibusbSession& session_;
  const WriteTo to_;
  TransferPointer transfer_;
  std::vector<std::uint8_t> sent_;  ///< with the set-up packet, if any
  int length_ = 0;                  ///< without it
  Message waiting_{};               ///< size 0: nothing waits
  bool under_way_ = false, ending_ = false;
  Status failure_ = Status::ok;
  Outgoing outgoing_{};
};

}  // namespace hapticd::usb
