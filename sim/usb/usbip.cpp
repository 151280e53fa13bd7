#include "sim/usb/usbip.h"

#include <algorithm>

namespace hapticd::sim::usb::usbip {
namespace {

// Of the import request: version 1.1.1, the operation, no status.
constexpr std::array<std::uint8_t, 8> kImport{0x01, 0x11, 0x80, 0x03, 0, 0, 0, 0};
constexpr std::uint32_t kNoPackets = 0xffffffff;

void put(Header& header, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i)
    header[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

std::uint32_t get(std::span<const std::uint8_t, kHeaderBytes> header, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | header[at + i];
  return value;
}

}  // namespace

Header encode(const Request& request) {
  Header header{};
  put(header, 0, static_cast<std::uint32_t>(request.command));
  put(header, 4, request.number);
  put(header, 8, request.device);
  put(header, 12, request.in ? 1 : 0);
  put(header, 16, request.endpoint);
  if (request.command == Command::unlink) {
    put(header, 20, request.unlinked);
    return header;
  }
  put(header, 20, request.flags);
  put(header, 24, request.length);
  put(header, 32, kNoPackets);
  put(header, 36, request.interval);
  std::ranges::copy(encode(request.setup), header.begin() + 40);
  return header;
}

std::optional<Request> decode_request(std::span<const std::uint8_t, kHeaderBytes> header) {
  const std::uint32_t command = get(header, 0), direction = get(header, 12),
                      endpoint = get(header, 16);
  if (direction > 1 || endpoint > 15) return std::nullopt;
  Request request{.command = static_cast<Command>(command),
                  .number = get(header, 4),
                  .device = get(header, 8),
                  .in = direction == 1,
                  .endpoint = static_cast<std::uint8_t>(endpoint)};
  if (request.command == Command::unlink) {
    request.unlinked = get(header, 20);
    return request;
  }
  if (request.command != Command::submit) return std::nullopt;
  request.flags = get(header, 20);
  request.length = get(header, 24);
  request.interval = get(header, 36);
  request.setup = decode_setup(header.last<8>());
  // Linux sends 0 packets where its document says -1.
  const std::uint32_t packets = get(header, 32);
  if (request.length > kMostBytes || (packets != kNoPackets && packets != 0)) return std::nullopt;
  return request;
}

Header encode(const Reply& reply) {
  Header header{};
  put(header, 0, static_cast<std::uint32_t>(reply.command));
  put(header, 4, reply.number);
  put(header, 20, static_cast<std::uint32_t>(reply.status));
  if (reply.command == Command::submitted) {
    put(header, 24, reply.length);
    put(header, 32, kNoPackets);
  }
  return header;
}

std::optional<Reply> decode_reply(std::span<const std::uint8_t, kHeaderBytes> header) {
  Reply reply{.command = static_cast<Command>(get(header, 0)),
              .number = get(header, 4),
              .status = static_cast<std::int32_t>(get(header, 20))};
  if (reply.command == Command::unlinked) return reply;
  if (reply.command != Command::submitted) return std::nullopt;
  reply.length = get(header, 24);
  if (reply.length > kMostBytes) return std::nullopt;
  return reply;
}

std::array<std::uint8_t, 8> encode(const Setup& setup) {
  const auto low = [](std::uint16_t value) { return static_cast<std::uint8_t>(value & 0xff); };
  const auto high = [](std::uint16_t value) { return static_cast<std::uint8_t>(value >> 8); };
  return {setup.request_type, setup.request,     low(setup.value),  high(setup.value),
          low(setup.index),   high(setup.index), low(setup.length), high(setup.length)};
}

Setup decode_setup(std::span<const std::uint8_t, 8> bytes) {
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
  };
  return {.request_type = bytes[0],
          .request = bytes[1],
          .value = word(2),
          .index = word(4),
          .length = word(6)};
}

std::optional<std::array<std::uint8_t, kImportBytes>> encode_import(const std::string& bus_id) {
  std::array<std::uint8_t, kImportBytes> bytes{};
  if (bus_id.size() >= kImportBytes - kImport.size()) return std::nullopt;
  std::ranges::copy(kImport, bytes.begin());
  std::ranges::copy(bus_id, bytes.begin() + kImport.size());
  return bytes;
}

std::optional<std::string> decode_import(std::span<const std::uint8_t, kImportBytes> bytes) {
  if (!std::ranges::equal(bytes.first<kImport.size()>(), kImport)) return std::nullopt;
  const auto id = bytes.subspan<kImport.size()>();
  const auto end = std::ranges::find(id, 0);
  if (end == id.end()) return std::nullopt;
  return std::string(id.begin(), end);
}

}  // namespace hapticd::sim::usb::usbip
