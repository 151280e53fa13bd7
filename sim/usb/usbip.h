// Messages of USB/IP between a host controller and whoever has the device: bytes and their meaning, pure. Numbers are big
// endian. Layout: Linux, Documentation/usb/usbip_protocol.rst.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "sim/usb/device.h"

namespace hapticd::sim::usb::usbip {

inline constexpr std::size_t kHeaderBytes = 48;
using Header = std::array<std::uint8_t, kHeaderBytes>;
/// More is refused, so that a wrong length does not make one wait for what never comes.
inline constexpr std::uint32_t kMostBytes = 1 << 20;

enum class Command : std::uint32_t { submit = 1, unlink = 2, submitted = 3, unlinked = 4 };

/// From the host. What a message does not have is 0.
struct Request {
  Command command = Command::submit;
  std::uint32_t number = 0;  ///< of this message: the answer has it
  std::uint32_t device = 0;  ///< as named on attaching
  bool in = false;
  std::uint8_t endpoint = 0;  ///< without direction
  // -- submit
  std::uint32_t flags = 0;   ///< of the URB
  std::uint32_t length = 0;  ///< of what follows, or of what may come
  std::uint32_t interval = 0;
  Setup setup{};
  // -- unlink
  std::uint32_t unlinked = 0;  ///< number of the submit that is taken back

  /// That follow the header.
  std::size_t payload_bytes() const { return command == Command::submit && !in ? length : 0; }
};
Header encode(const Request& request);
/// Nothing: no request, or one that no device here can be sent: isochronous, too long, endpoint or direction amiss.
std::optional<Request> decode_request(std::span<const std::uint8_t, kHeaderBytes> header);

/// To the host.
struct Reply {
  Command command = Command::submitted;
  std::uint32_t number = 0;
  std::int32_t status = 0;  ///< 0 or a negative errno
  std::uint32_t length =
      0;  ///< of a submit: what was transferred; follows where the request was IN
  bool operator==(const Reply&) const = default;
};
Header encode(const Reply& reply);
std::optional<Reply> decode_reply(std::span<const std::uint8_t, kHeaderBytes> header);

/// An eight-byte set-up packet; its own numbers are little endian.
std::array<std::uint8_t, 8> encode(const Setup& setup);
Setup decode_setup(std::span<const std::uint8_t, 8> bytes);

/// Over TCP a host first asks for a device by its bus id, such as "1-1".
inline constexpr std::size_t kImportBytes = 40;
/// Nothing: the id has more than 31 bytes.
std::optional<std::array<std::uint8_t, kImportBytes>> encode_import(const std::string& bus_id);
std::optional<std::string> decode_import(std::span<const std::uint8_t, kImportBytes> bytes);

}  // namespace hapticd::sim::usb::usbip
