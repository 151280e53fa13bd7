#include "sim/can/moteus_wire.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/can/moteus_scale.h"

namespace hapticd::sim::can {
namespace {

constexpr std::uint8_t kMoteusNop = 0x50;
constexpr double kMoteusNaN = std::numeric_limits<double>::quiet_NaN();

// The bytes of a frame from front to back.
class MoteusReader {
 public:
  explicit MoteusReader(std::span<const std::uint8_t> data) : left_(data) {}
  bool done() const { return left_.empty(); }

  std::optional<std::span<const std::uint8_t>> take(std::size_t bytes) {
    if (left_.size() < bytes) return std::nullopt;
    const auto taken = left_.first(bytes);
    left_ = left_.subspan(bytes);
    return taken;
  }
  // Seven bits a byte, the lowest first; the top bit says that more follow.
  std::optional<std::uint32_t> varuint() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const auto byte = take(1);
      if (!byte) break;
      value |= static_cast<std::uint32_t>((*byte)[0] & 0x7f) << shift;
      if (((*byte)[0] & 0x80) == 0) return value;
    }
    return std::nullopt;
  }

 private:
  std::span<const std::uint8_t> left_;
};

bool read_values(MoteusReader& reader, MoteusBlock& block) {
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const auto bytes = reader.take(moteus_size(block.type));
    if (!bytes) return false;
    block.values.push_back(moteus_decode(block.first + i, block.type, *bytes));
  }
  return true;
}

bool read_registers(MoteusReader& reader, std::uint8_t code, MoteusBlock& block) {
  constexpr std::uint32_t kMostRegisters = 128;
  block.kind = static_cast<MoteusBlock::Kind>(code >> 4);
  block.type = static_cast<MoteusType>((code >> 2) & 3);
  const std::optional<std::uint32_t> count =
      (code & 3) != 0 ? std::uint32_t{code} & 3U : reader.varuint();
  const std::optional<std::uint32_t> first = count ? reader.varuint() : std::nullopt;
  if (!first || *count > kMostRegisters) return false;
  block.first = *first;
  block.count = *count;
  return block.kind == MoteusBlock::Kind::read || read_values(reader, block);
}

bool read_error(MoteusReader& reader, std::uint8_t code, MoteusBlock& block) {
  block.kind = code == 0x30 ? MoteusBlock::Kind::write_error : MoteusBlock::Kind::read_error;
  const std::optional<std::uint32_t> reg = reader.varuint();
  const std::optional<std::uint32_t> why = reg ? reader.varuint() : std::nullopt;
  if (!why) return false;
  block.first = *reg;
  block.count = 1;
  block.values = {static_cast<double>(*why)};
  return true;
}

bool read_block(MoteusReader& reader, std::uint8_t code, MoteusBlock& block) {
  if (code < 0x30) return read_registers(reader, code, block);
  return code <= 0x31 && read_error(reader, code, block);
}

void append_varuint(std::uint32_t value, std::vector<std::uint8_t>& out) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
}

void append_le(std::uint32_t bits, std::size_t bytes, std::vector<std::uint8_t>& out) {
  for (std::size_t i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
}

// A quotient a rounding error below a whole number is that number.
double whole_steps(double value, double step) {
  constexpr double kRounding = 1 + 1e-9;
  return std::trunc(value / step * kRounding);
}

}  // namespace

MoteusId moteus_id(std::uint32_t id) {
  return {.prefix = static_cast<std::uint16_t>(id >> 16),
          .reply = (id & 0x8000) != 0,
          .source = static_cast<std::uint8_t>((id >> 8) & 0x7f),
          .destination = static_cast<std::uint8_t>(id & 0x7f)};
}

std::uint32_t moteus_can_id(const MoteusId& id) {
  const std::uint32_t bits = std::uint32_t{id.prefix} << 16 | (id.reply ? 0x8000U : 0U) |
                             std::uint32_t{id.source} << 8 | id.destination;
  return bits >= 2048 ? bits | CAN_EFF_FLAG : bits;
}

std::uint32_t moteus_reply_can_id(const MoteusId& query, std::uint8_t servo) {
  return moteus_can_id(
      {.prefix = query.prefix, .reply = false, .source = servo, .destination = query.source});
}

std::size_t moteus_size(MoteusType type) {
  if (type == MoteusType::int8) return 1;
  return type == MoteusType::int16 ? 2 : 4;
}

MoteusSubframes moteus_subframes(std::span<const std::uint8_t> data) {
  MoteusReader reader(data);
  MoteusSubframes found;
  while (!reader.done()) {
    const std::uint8_t code = (*reader.take(1))[0];
    if (code == kMoteusNop) continue;
    MoteusBlock block;
    if (!read_block(reader, code, block)) {
      found.broken = true;
      break;
    }
    found.blocks.push_back(std::move(block));
  }
  return found;
}

double moteus_decode(std::uint32_t reg, MoteusType type, std::span<const std::uint8_t> bytes) {
  if (type == MoteusType::float32) return get<float>(bytes, 0);
  double raw = 0;
  if (type == MoteusType::int8) raw = get<std::int8_t>(bytes, 0);
  if (type == MoteusType::int16) raw = get<std::int16_t>(bytes, 0);
  if (type == MoteusType::int32) raw = get<std::int32_t>(bytes, 0);
  const bool whole = moteus_unit(reg) <= MoteusUnit::counter;
  if (!whole && raw < -moteus_largest(type)) return kMoteusNaN;
  return raw * moteus_step(reg, type);
}

void moteus_encode(std::uint32_t reg, MoteusType type, double value,
                   std::vector<std::uint8_t>& out) {
  if (type == MoteusType::float32) {
    return append_le(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4, out);
  }
  const double largest = moteus_largest(type);
  double steps = -largest - 1;
  if (moteus_unit(reg) == MoteusUnit::counter) {
    steps = value;
  } else if (std::isfinite(value)) {
    steps = std::clamp(whole_steps(value, moteus_step(reg, type)), -largest, largest);
  }
  const auto bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(steps));
  append_le(static_cast<std::uint32_t>(bits), moteus_size(type), out);
}

void moteus_append_reply(const MoteusBlock& reply, std::vector<std::uint8_t>& out) {
  const auto count = static_cast<std::uint32_t>(reply.values.size());
  const auto code = static_cast<unsigned>(0x20U | static_cast<unsigned>(reply.type) << 2);
  if (count == 0) return;
  out.push_back(static_cast<std::uint8_t>(count <= 3 ? code | count : code));
  if (count > 3) append_varuint(count, out);
  append_varuint(reply.first, out);
  for (std::uint32_t i = 0; i < count; ++i)
    moteus_encode(reply.first + i, reply.type, reply.values[i], out);
}

void moteus_append_error(MoteusBlock::Kind kind, std::uint32_t reg, std::uint8_t code,
                         std::vector<std::uint8_t>& out) {
  out.push_back(kind == MoteusBlock::Kind::write_error ? 0x30 : 0x31);
  append_varuint(reg, out);
  append_varuint(code, out);
}

Frame moteus_frame(std::uint32_t can_id, std::span<const std::uint8_t> bytes, std::uint8_t flags) {
  constexpr std::array<std::uint8_t, 7> kLong{12, 16, 20, 24, 32, 48, 64};
  Frame frame{};
  frame.can_id = can_id;
  frame.flags = flags;
  frame.len = static_cast<std::uint8_t>(bytes.size());
  if (frame.len > 8) frame.len = *std::ranges::lower_bound(kLong, frame.len);
  std::fill_n(frame.data, frame.len, kMoteusNop);
  std::copy(bytes.begin(), bytes.end(), frame.data);
  return frame;
}

}  // namespace hapticd::sim::can
