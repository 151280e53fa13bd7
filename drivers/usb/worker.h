// What the device's own thread does: finds the device, sets it up, exchanges samples and commands with it, and begins anew
// when it has gone. On every way out of a connection it tries to leave the device without force.
//
//   looking -> setting up -> up -> (lost: zero force, close) -> looking ...
//
// A command goes out when the loop has given a new one, or when the device has to hear something. No force goes out that
// rests on readings of another connection, or that is older than the watchdog's time.
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "drivers/usb/exchange.h"
#include "drivers/usb/host.h"
#include "drivers/usb/protocol.h"

namespace hapticd::usb {

class Worker final : private Words {
 public:
  Worker(const DeviceOptions& options, Host& host, Protocol& protocol, Exchange& exchange);

  /// The thread's body: until end().
  void run();
  /// Any thread.
  void end() noexcept;

  /// What came of looking for the device for the first time. Any thread; nothing: not known yet.
  struct Outcome {
    std::optional<Identity> found{};  ///< it is up
    NotOpened why{};
  };
  const Outcome* first() const noexcept {
    return known_.load(std::memory_order_acquire) ? &first_ : nullptr;
  }

 private:
  void say(std::string_view text) override;
  bool abandoned() const noexcept override { return ending_.load(std::memory_order_relaxed); }

  Opened<Identity> open();
  void came_of_looking(const Opened<Identity>& opened);
  void connect(const Identity& identity);
  void exchange();
  bool tell_if_due();
  Command command_now(std::int64_t now_ns);
  bool hear(const Arrival& arrival);
  bool speaks();
  bool takes_commands();
  bool lost(std::string_view why, std::int64_t milliseconds = -1);
  bool lost(Status status);
  void disconnect();
  void count();

  const DeviceOptions& options_;
  Host& host_;
  Protocol& protocol_;
  Exchange& exchange_;
  std::atomic<bool> ending_{false}, known_{false};
  Outcome first_;

  // of the connection
  std::uint32_t link_ = 0;
  Identity identity_;
  Reading reading_{};
  Command command_{};
  std::uint64_t told_ = 0;  ///< how many commands the loop had given when one was told last
  std::int64_t next_tell_ns_ = 0;
  std::int64_t heard_ns_ = 0;  ///< when the last sample came

  // of all connections
  std::uint64_t replaced_before_ = 0, skipped_before_ = 0;
  std::int64_t worst_send_ns_ = 0;
};

}  // namespace hapticd::usb
