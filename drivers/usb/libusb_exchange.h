// Both directions of a claimed interface: what the ports on libusb have in common.
#pragma once
#include <memory>

#include "drivers/usb/libusb_transfers.h"

namespace hapticd::usb {

struct ExchangeOptions {
  Endpoint in{};
  std::size_t in_bytes = 64;  ///< of a transfer
  int reads = 2;
  WriteTo out{};
  std::size_t out_bytes = 64;  ///< at most, of a transfer
  Superseding superseding{};
};

class LibusbExchange {
 public:
  LibusbExchange(std::unique_ptr<LibusbSession> session, const ExchangeOptions& options);
  /// Ends what is under way, for at most 1 s, and gives the interface back.
  ~LibusbExchange();

  LibusbSession& session() noexcept { return *session_; }
  Arrival receive(std::int64_t until_ns) noexcept;
  Status send(std::span<const std::uint8_t> bytes) noexcept;
  Status flush(std::int64_t until_ns) noexcept;
  const Outgoing& outgoing() const noexcept { return writes_.outgoing(); }
  std::uint64_t skipped() const noexcept { return queue_.skipped(); }

 private:
  void pump() noexcept;

  std::unique_ptr<LibusbSession> session_;
  ArrivalQueue queue_;
  Reads reads_;
  Writes writes_;
};

}  // namespace hapticd::usb
