// The register protocol of moteus over CAN FD, as the servo sees it: ids, subframes, scaling.
//   id = prefix << 16 | (reply wanted ? 0x8000 : 0) | source << 8 | destination
// A frame is a row of subframes; values are physical (rev, rev/s, N m, V, degC, s), NaN where the
// wire has its code for it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/can/frame.h"

namespace hapticd::sim::can {

struct MoteusId {
  std::uint16_t prefix = 0;
  bool reply = false;
  std::uint8_t source = 0;
  std::uint8_t destination = 0;
};

inline constexpr std::uint8_t kMoteusBroadcast = 0x7f;

MoteusId moteus_id(std::uint32_t id);
/// With CAN_EFF_FLAG, where the firmware uses an extended frame (id >= 2048).
std::uint32_t moteus_can_id(const MoteusId& id);
/// Of the servo's answer to `query`.
std::uint32_t moteus_reply_can_id(const MoteusId& query, std::uint8_t servo);

enum class MoteusType : std::uint8_t { int8, int16, int32, float32 };
std::size_t moteus_size(MoteusType type);

/// One subframe: `count` registers of one type, from `first` on.
struct MoteusBlock {
  enum class Kind : std::uint8_t { write, read, reply, write_error, read_error };
  Kind kind{};
  MoteusType type{};
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::vector<double> values{};  ///< of write and reply; of an error its code
};

struct MoteusSubframes {
  std::vector<MoteusBlock> blocks{};
  bool broken = false;  ///< what followed the last block made no sense, or was cut off
};
MoteusSubframes moteus_subframes(std::span<const std::uint8_t> data);

/// One value on the wire. Encoding truncates towards zero and saturates at the largest integer;
/// what is not finite becomes the code for NaN.
double moteus_decode(std::uint32_t reg, MoteusType type, std::span<const std::uint8_t> bytes);
void moteus_encode(std::uint32_t reg, MoteusType type, double value,
                   std::vector<std::uint8_t>& out);

/// Appends a reply subframe.
void moteus_append_reply(const MoteusBlock& reply, std::vector<std::uint8_t>& out);
/// Appends 0x30 or 0x31.
void moteus_append_error(MoteusBlock::Kind kind, std::uint32_t reg, std::uint8_t code,
                         std::vector<std::uint8_t>& out);

/// FD, padded to a legal length; classic without padding. `bytes`: up to 64, or 8.
Frame moteus_frame(std::uint32_t can_id, std::span<const std::uint8_t> bytes, std::uint8_t flags);

}  // namespace hapticd::sim::can
