// Set-up of an OpenFFBoard: reports that must not be lost, questions over its command channel, and the settings that would
// change a force or add one of their own: neutral while it is driven, as they were afterwards. The board keeps them in memory
// only; it saves none unless told.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/hid/openffboard_codec.h"
#include "drivers/usb/host.h"
#include "drivers/usb/protocol.h"

namespace hapticd::hid::openffboard {

tl::unexpected<usb::NotOpened> not_opened(std::string text);
/// Unplugged is absent.
tl::unexpected<usb::NotOpened> not_opened(usb::Status status, std::string_view when);

/// Of the board at a port, until a time.
class Talk {
 public:
  Talk(usb::HidPort& port, usb::Host& host, const usb::Words& words, std::int64_t until_ns)
      : port_(port), host_(host), words_(words), until_ns_(until_ns) {}

  /// Sends a report and waits until it is out.
  usb::Opened<void> tell(std::span<const std::uint8_t> report);
  /// Asks up to three times. Errors: no answer, or the board refuses. Nothing: it knows no such command.
  usb::Opened<std::optional<std::int64_t>> ask(const Command& question, std::string_view what);
  /// From question to answer of the last ask() [ns].
  std::int64_t took_ns() const noexcept { return took_ns_; }

  usb::HidPort& port() noexcept { return port_; }

 private:
  usb::Opened<std::optional<Command>> answer(const Command& question);
  usb::Opened<void> in_time() const;

  usb::HidPort& port_;
  usb::Host& host_;
  const usb::Words& words_;
  std::int64_t until_ns_;
  std::int64_t took_ns_ = 0;
};

class Settings {
 public:
  /// Reads those of so many axes and makes them neutral; those that the board does not have are left out.
  usb::Opened<void> neutralise(Talk& talk, std::size_t axes);
  /// As they were, as far as there is time. Nothing is done twice.
  void restore(usb::HidPort& port, usb::Host& host, std::int64_t until_ns);

 private:
  struct Changed {
    Command write{};  ///< that restores it
  };
  static constexpr std::size_t kMost = 13;
  std::array<Changed, kMost> changed_{};
  std::size_t count_ = 0;

  usb::Opened<void> neutralise(Talk& talk, std::size_t index, std::uint8_t axis);
};

}  // namespace hapticd::hid::openffboard
