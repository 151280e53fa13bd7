#include "drivers/can/scan.h"

#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "drivers/can/cia402_codec.h"
#include "drivers/can/moteus_codec.h"
#include "drivers/can/odrive_codec.h"

namespace hapticd::can {
namespace {

constexpr double kAnswer_s = 0.03;

using Nodes = std::set<int>;

/// Frames that only this protocol has: a heartbeat of 8 bytes beside estimates, a heartbeat of 1 byte.
struct HeardNodes {
  Nodes odrive_heartbeats, odrive_estimates, canopen;
  Nodes odrives() const {
    Nodes both;
    for (const int node : odrive_heartbeats)
      if (odrive_estimates.contains(node) || canopen.empty()) both.insert(node);
    return both;
  }
};

void note(const Frame& frame, HeardNodes& heard) {
  if (frame.extended || frame.remote || frame.error || frame.fd) return;
  const auto id = static_cast<int>(frame.id);
  if (id > 0x700 && frame.size == 1) heard.canopen.insert(id - 0x700);
  if (frame.size != 8) return;
  if ((id & 0x1f) == 0x01) heard.odrive_heartbeats.insert(id >> 5);
  if ((id & 0x1f) == 0x09) heard.odrive_estimates.insert(id >> 5);
}

HeardNodes listen(Conversation& conversation, double duration_s) {
  HeardNodes heard;
  const std::int64_t until_ns = conversation.now_ns() + std::llround(1e9 * duration_s);
  while (conversation.now_ns() < until_ns) {
    const auto frame =
        conversation.next(1e-9 * static_cast<double>(until_ns - conversation.now_ns()));
    if (frame) note(*frame, heard);
  }
  return heard;
}

/// The first answer that `read` makes something of.
template <class Read>
auto answer(Conversation& conversation, const Frame& question, Read read)
    -> decltype(read(std::declval<const Frame&>())) {
  conversation.send(question);
  const std::int64_t until_ns = conversation.now_ns() + std::llround(1e9 * kAnswer_s);
  while (conversation.now_ns() < until_ns) {
    const auto frame = conversation.next(kAnswer_s);
    if (!frame) break;
    if (auto found = read(*frame)) return found;
  }
  return {};
}

std::string dotted(const std::uint8_t (&parts)[3]) {
  return std::to_string(parts[0]) + "." + std::to_string(parts[1]) + "." + std::to_string(parts[2]);
}

std::optional<FoundDrive> ask_odrive(Conversation& conversation, int node) {
  const auto id = static_cast<std::uint8_t>(node);
  const auto version = answer(conversation, odrive::request(id, odrive::Command::get_version),
                              [&](const Frame& frame) -> std::optional<odrive::Version> {
                                const odrive::Decoded decoded = odrive::decode(frame, id);
                                const auto* found = std::get_if<odrive::Version>(&decoded.message);
                                return found != nullptr ? std::optional(*found) : std::nullopt;
                              });
  if (!version) return {};
  const bool known = version->firmware[0] == 0 && version->firmware[1] == 6;
  return FoundDrive{
      .protocol = Protocol::odrive,
      .node = node,
      .what = "ODrive, firmware " + dotted(version->firmware),
      .refused = known ? "" : "its firmware is not 0.6: other error bits and messages; update it"};
}

std::optional<FoundDrive> ask_moteus(Conversation& conversation, int node) {
  const moteus::Address address{.servo = static_cast<std::uint8_t>(node)};
  const auto version = answer(conversation, moteus::ask_identity(address), [&](const Frame& frame) {
    if (!moteus::is_reply(frame, address)) return std::optional<std::int32_t>{};
    return moteus::decode(frame.payload()).reply.register_map_version;
  });
  if (!version) return {};
  const bool known = *version == moteus::kRegisterMapVersion;
  return FoundDrive{.protocol = Protocol::moteus,
                    .node = node,
                    .what = "moteus, register map " + std::to_string(*version),
                    .refused = known ? "" : "expected register map 5: update its firmware"};
}

std::optional<std::uint32_t> read_object(Conversation& conversation, std::uint8_t node,
                                         cia402::Object object) {
  const auto reply = answer(conversation, cia402::sdo_read(node, object),
                            [&](const Frame& frame) -> std::optional<cia402::SdoReply> {
                              const cia402::Decoded decoded = cia402::decode(frame, node);
                              if (!decoded.sdo || decoded.sdo->object.index != object.index)
                                return {};
                              return decoded.sdo;
                            });
  if (!reply || reply->kind != cia402::SdoReply::Kind::read) return {};
  return reply->value;
}

std::optional<FoundDrive> ask_cia402(Conversation& conversation, int node) {
  const auto id = static_cast<std::uint8_t>(node);
  const auto type = read_object(conversation, id, {0x1000, 0});
  if (!type) return {};
  FoundDrive found{.protocol = Protocol::cia402, .node = node, .what = "CiA 402 drive"};
  if ((*type & 0xffff) != 402) {
    found.what = "CANopen device of profile " + std::to_string(*type & 0xffff);
    found.refused = "expected profile 402, a drive";
    return found;
  }
  const auto modes = read_object(conversation, id, {0x6502, 0});
  if (!modes || (*modes >> 9 & 1U) == 0)
    found.refused = "it has no cyclic synchronous torque mode (6502:0, bit 9)";
  return found;
}

std::optional<FoundDrive> ask(Conversation& conversation, Protocol protocol, int node) {
  switch (protocol) {
    case Protocol::odrive:
      return ask_odrive(conversation, node);
    case Protocol::moteus:
      return ask_moteus(conversation, node);
    case Protocol::cia402:
      return ask_cia402(conversation, node);
  }
  return {};
}

Nodes all_nodes(Protocol protocol) {
  const int first = protocol == Protocol::odrive ? 0 : 1;
  const int last = protocol == Protocol::odrive ? 62 : protocol == Protocol::moteus ? 126 : 127;
  Nodes nodes;
  for (int node = first; node <= last; ++node) nodes.insert(node);
  return nodes;
}

}  // namespace

std::vector<FoundDrive> scan(Conversation& conversation, const ScanOptions& options) {
  const HeardNodes heard = listen(conversation, options.listen_s);
  std::map<Protocol, Nodes> candidates{{Protocol::odrive, heard.odrives()},
                                       {Protocol::cia402, heard.canopen}};
  if (options.questions)
    for (const Protocol protocol : options.ask) candidates[protocol].merge(all_nodes(protocol));
  std::vector<FoundDrive> found;
  for (const auto& [protocol, nodes] : candidates) {
    const Nodes& sure = protocol == Protocol::odrive ? heard.odrive_heartbeats : heard.canopen;
    for (const int node : nodes) {
      auto drive = options.questions ? ask(conversation, protocol, node) : std::nullopt;
      if (!drive && sure.contains(node) && protocol != Protocol::moteus)
        drive = FoundDrive{.protocol = protocol,
                           .node = node,
                           .what = std::string(word_of(protocol)) + " by its heartbeat",
                           .refused = options.questions ? "it does not answer" : ""};
      if (drive) found.push_back(std::move(*drive));
    }
  }
  return found;
}

std::string_view word_of(Protocol protocol) noexcept {
  switch (protocol) {
    case Protocol::odrive:
      return "odrive";
    case Protocol::moteus:
      return "moteus";
    case Protocol::cia402:
      return "cia402";
  }
  return {};
}

}  // namespace hapticd::can
