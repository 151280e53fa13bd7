// An opened USB device as its one thread uses it. Transports: libusb, hidapi; tests have their own, in virtual time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hapticd::usb {

/// How an exchange ended.
enum class Status : std::uint8_t {
  ok,
  nothing,  ///< the time was over, or somebody woke the thread
  gone,     ///< the device is unplugged; nothing else will come of this port
  stalled,  ///< the device refuses the request, or the endpoint has halted
  failed,   ///< all else
};

struct Arrival {
  Status status = Status::nothing;
  std::span<const std::uint8_t> bytes{};  ///< where `ok`: until the next call
  std::int64_t stamp_ns = 0;              ///< when it was complete on the host
};

/// What goes out. Never a queue: of what waits only the newest goes.
struct Outgoing {
  std::uint64_t sent = 0;      ///< completed
  std::uint64_t replaced = 0;  ///< by newer ones, before they went
  std::int64_t since_ns = 0;   ///< what is on its way now began then; 0: nothing is
  bool waits = false;          ///< something newer waits behind it
  std::int64_t last_took_ns = 0, worst_took_ns = 0;  ///< from begin to end
};

class Port {
 public:
  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  /// Gives the device back; ends what is under way.
  virtual ~Port() = default;

  /// The next transfer or report, in order; waits until then, or until Host::wake(). A HID report is as hidapi reads it:
  /// with its id where reports have ids.
  virtual Arrival receive(std::int64_t until_ns) = 0;
  /// Begins to send; while one is on its way, this waits in place of what waits already. A HID report has its id, or begins
  /// with its data. `ok`: taken.
  virtual Status send(std::span<const std::uint8_t> bytes) = 0;
  /// Waits until all is out. `nothing`: the time is over.
  virtual Status flush(std::int64_t until_ns) = 0;
  virtual const Outgoing& outgoing() const noexcept = 0;
  /// Reports that came and were thrown away because newer ones had come behind them.
  virtual std::uint64_t skipped() const noexcept { return 0; }
};

/// Bulk endpoints and vendor requests.
class BulkPort : public Port {
 public:
  /// A control transfer without data, to the device. Waits.
  virtual Status request(std::uint8_t request_type, std::uint8_t request, std::uint16_t value) = 0;
};

class HidPort : public Port {
 public:
  /// `report`: with its id; 0 before one without.
  virtual Status set_feature(std::span<const std::uint8_t> report) = 0;
  /// `report[0]`: the id. Returns how many bytes came, with the id; 0: none.
  virtual std::size_t get_feature(std::span<std::uint8_t> report) = 0;
  /// As the device sent it.
  virtual const std::vector<std::uint8_t>& report_descriptor() const noexcept = 0;
};

}  // namespace hapticd::usb
