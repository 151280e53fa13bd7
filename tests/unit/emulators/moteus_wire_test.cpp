// moteus: every vector, from the servo's side.
#include "sim/can/moteus_wire.h"

#include <gtest/gtest.h>

#include <map>

#include "sim/can/moteus_scale.h"
#include "tests/unit/emulators/vectors.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;

const std::map<std::string, std::uint32_t> kCommandRegisters{
    {"position", 0x020},         {"velocity", 0x021},    {"feedforward_torque", 0x022},
    {"kp_scale", 0x023},         {"kd_scale", 0x024},    {"maximum_torque", 0x025},
    {"watchdog_timeout", 0x027}, {"ilimit_scale", 0x02b}};
const std::map<std::string, std::uint32_t> kWithinRegisters{{"lower", 0x040},
                                                            {"upper", 0x041},
                                                            {"feedforward_torque", 0x042},
                                                            {"maximum_torque", 0x045},
                                                            {"watchdog_timeout", 0x046}};
const std::map<std::string, std::uint32_t> kQueryRegisters{
    {"mode", 0x000},    {"position", 0x001},    {"velocity", 0x002}, {"torque", 0x003},
    {"voltage", 0x00d}, {"temperature", 0x00e}, {"fault", 0x00f}};

MoteusType type_of(const std::string& name) {
  if (name == "int8") return MoteusType::int8;
  if (name == "int16") return MoteusType::int16;
  return name == "int32" ? MoteusType::int32 : MoteusType::float32;
}

struct Written {
  MoteusType type{};
  double value = 0;
};

struct Parsed {
  std::map<std::uint32_t, Written> writes;
  std::map<std::uint32_t, MoteusType> reads;
};

Parsed parse(const MoteusSubframes& frame) {
  Parsed parsed;
  for (const MoteusBlock& block : frame.blocks) {
    for (std::uint32_t i = 0; i < block.count; ++i) {
      const std::uint32_t reg = block.first + i;
      if (block.kind == MoteusBlock::Kind::write)
        parsed.writes[reg] = {block.type, block.values[i]};
      if (block.kind == MoteusBlock::Kind::read) parsed.reads[reg] = block.type;
    }
  }
  return parsed;
}

void check_reads(const Json& query, const Parsed& parsed) {
  std::map<std::uint32_t, MoteusType> expected;
  if (query.is_object()) {
    for (const auto& [name, format] : query.items())
      if (format != "ignore") expected[kQueryRegisters.at(name)] = type_of(format);
  }
  EXPECT_EQ(parsed.reads, expected);
}

double step_of(std::uint32_t reg, MoteusType type) {
  return type == MoteusType::float32 ? 1e-7 : moteus_step(reg, type) * 1.0001;
}

std::string mode_of(const std::string& op) {
  return op == "position" ? "a" : op == "stay_within_unbounded" ? "d" : op == "stop" ? "0" : "";
}

void check_writes(const Json& vector, const Parsed& parsed) {
  const std::string op = vector.at("op");
  const auto& registers = op == "position" ? kCommandRegisters : kWithinRegisters;
  std::size_t expected = op == "query" ? 0 : 1;
  if (expected == 1) {
    ASSERT_TRUE(parsed.writes.contains(0));
    EXPECT_EQ(parsed.writes.at(0).value, std::stoi(mode_of(op), nullptr, 16));
  }
  const Json command = vector.value("command", Json::object());
  for (const auto& [name, value] : command.items()) {
    const std::string format =
        vector.contains("format") ? vector.at("format").at(name) : vector.at("format_all");
    if (format == "ignore") continue;
    const std::uint32_t reg = registers.at(name);
    ASSERT_TRUE(parsed.writes.contains(reg)) << name;
    EXPECT_EQ(parsed.writes.at(reg).type, type_of(format)) << name;
    expect_near(parsed.writes.at(reg).value, number_of(value), step_of(reg, type_of(format)), name);
    ++expected;
  }
  EXPECT_EQ(parsed.writes.size(), expected);
}

TEST(MoteusWire, HostCommandsOfTheVectorsMeanWhatTheySay) {
  const Json& all = vectors().at("moteus").at("encode");
  ASSERT_GE(all.size(), 16U);
  for (const Json& vector : all) {
    SCOPED_TRACE(vector.dump());
    const Frame frame = frame_of(vector);
    const MoteusId id = moteus_id(id_of(frame));
    EXPECT_EQ(id.destination, vector.at("servo_id"));
    EXPECT_EQ(id.source, vector.at("source"));
    EXPECT_EQ(id.prefix, vector.at("prefix"));
    EXPECT_EQ(id.reply, vector.at("reply").get<bool>());
    const MoteusSubframes found = moteus_subframes(payload(frame));
    EXPECT_FALSE(found.broken);
    const Parsed parsed = parse(found);
    check_writes(vector, parsed);
    check_reads(vector.at("query"), parsed);
  }
}

TEST(MoteusWire, IdsAndTheirAnswersAreThoseOfTheVectors) {
  const auto with_flag = [](const Json& id, const Json& extended) {
    return id.get<std::uint32_t>() | (extended.get<bool>() ? CAN_EFF_FLAG : 0U);
  };
  const Json& all = vectors().at("moteus").at("id");
  ASSERT_GE(all.size(), 5U);
  for (const Json& vector : all) {
    SCOPED_TRACE(vector.dump());
    const MoteusId id{vector.at("prefix"), vector.at("reply"), vector.at("source"),
                      vector.at("servo_id")};
    EXPECT_EQ(moteus_can_id(id), with_flag(vector.at("can_id"), vector.at("extended")));
    EXPECT_EQ(moteus_reply_can_id(id, vector.at("servo_id")),
              with_flag(vector.at("reply_can_id"), vector.at("reply_extended")));
  }
}

// The vector's values, laid out in the vector's blocks.
std::vector<std::uint8_t> encoded_again(const Json& vector, const MoteusSubframes& layout) {
  std::map<std::uint32_t, double> values;
  for (const auto& [name, value] : vector.at("present").items())
    values[kQueryRegisters.at(name)] = number_of(value);
  std::vector<std::uint8_t> bytes;
  for (MoteusBlock block : layout.blocks) {
    for (std::uint32_t i = 0; i < block.count; ++i) {
      const double value = values.at(block.first + i);
      expect_near(block.values[i], value, 1e-6, "register " + std::to_string(block.first + i));
      block.values[i] = value;
    }
    moteus_append_reply(block, bytes);
  }
  return bytes;
}

TEST(MoteusWire, RepliesHaveTheBytesOfTheVectors) {
  int checked = 0;
  for (const Json& vector : vectors().at("moteus").at("decode")) {
    SCOPED_TRACE(vector.dump());
    if (vector.at("status") != "ok") continue;
    const auto data = bytes_of(vector.at("data"));
    const auto bytes = encoded_again(vector, moteus_subframes(data));
    ASSERT_LE(bytes.size(), data.size());
    EXPECT_EQ(hex_of(bytes), hex_of(data).substr(0, 2 * bytes.size()));
    for (std::size_t i = bytes.size(); i < data.size(); ++i) EXPECT_EQ(data[i], 0x50);
    ++checked;
  }
  EXPECT_GE(checked, 5);
}

TEST(MoteusWire, ErrorsAndNonsenseAreSeen) {
  std::vector<std::uint8_t> bytes;
  moteus_append_error(MoteusBlock::Kind::read_error, 0x0a, 2, bytes);
  EXPECT_EQ(hex_of(bytes), "310a02");
  EXPECT_FALSE(moteus_subframes(bytes_of("310a02")).broken);
  EXPECT_TRUE(moteus_subframes(bytes_of("2100006001")).broken);
  EXPECT_EQ(moteus_subframes(bytes_of("2100006001")).blocks.size(), 1U);
  EXPECT_TRUE(moteus_subframes(bytes_of("0c0620")).broken);        // values are missing
  EXPECT_TRUE(moteus_subframes(bytes_of("10ffffffffff")).broken);  // a count without end
}

TEST(MoteusWire, VaruintsHaveSevenBitsAByte) {
  const auto found = moteus_subframes(bytes_of("11820211f000"));
  ASSERT_EQ(found.blocks.size(), 2U);
  EXPECT_EQ(found.blocks[0].first, 0x102U);
  EXPECT_EQ(found.blocks[1].first, 0x70U);
  std::vector<std::uint8_t> bytes;
  moteus_append_reply({MoteusBlock::Kind::reply, MoteusType::int8, 0x102, 1, {5}}, bytes);
  EXPECT_EQ(hex_of(bytes), "21820205");
}

TEST(MoteusWire, NaNHasTheMostNegativeIntegerAndLargeValuesSaturate) {
  std::vector<std::uint8_t> bytes;
  moteus_encode(0x001, MoteusType::int16, std::nan(""), bytes);
  moteus_encode(0x001, MoteusType::int16, 1e9, bytes);
  moteus_encode(0x001, MoteusType::int16, -1e9, bytes);
  moteus_encode(0x003, MoteusType::int8, -std::numeric_limits<double>::infinity(), bytes);
  EXPECT_EQ(hex_of(bytes), "0080ff7f018080");
  EXPECT_TRUE(std::isnan(moteus_decode(0x020, MoteusType::int32, bytes_of("00000080"))));
}

TEST(MoteusWire, FdLengthsAreThoseOfTheVectors) {
  for (const Json& vector : vectors().at("fd_length_rounding")) {
    const std::vector<std::uint8_t> bytes(vector.at("size"), 0x11);
    const Frame frame = moteus_frame(0, bytes, CANFD_FDF);
    EXPECT_EQ(frame.len, vector.at("fd_len")) << vector.dump();
    for (std::size_t i = bytes.size(); i < frame.len; ++i) EXPECT_EQ(frame.data[i], 0x50);
  }
}

}  // namespace
}  // namespace hapticd::test::emulator
