#include "drivers/can/cia402_codec.h"

#include <cmath>
#include <map>
#include <random>

#include "tests/unit/can/vectors.h"

namespace hapticd::can::cia402 {
namespace {

std::string snake(std::string_view words) {
  std::string text(words);
  for (char& c : text) c = c == ' ' ? '_' : c;
  return text;
}

Frame received(const Json& vector, const char* id, const char* data) {
  return frame_of(Json{{"can_id", vector[id]}, {"data", vector[data]}});
}

TEST(Cia402Codec, NetworkCommandsOfEveryVector) {
  const std::map<std::string, Nmt> words{{"start", Nmt::start},
                                         {"stop", Nmt::stop},
                                         {"pre-operational", Nmt::pre_operational},
                                         {"reset node", Nmt::reset_node},
                                         {"reset communication", Nmt::reset_communication}};
  for (const Json& vector : vectors()["cia402"]["nmt"])
    expect_frame(nmt(words.at(vector["command"]), vector["node"]), vector);
  for (const Json& vector : vectors()["cia402"]["sync"]) expect_frame(sync(), vector);
}

TEST(Cia402Codec, ObjectsAreWrittenAsInEveryVector) {
  int seen = 0;
  for (const Json& vector : vectors()["cia402"]["sdo_configure_cst"]) {
    SCOPED_TRACE(vector.dump());
    const Object object{vector["index"], vector["sub"]};
    const auto frame = sdo_write(vector["node"], object, vector["value"], vector["size"]);
    ASSERT_TRUE(frame);
    expect_frame(*frame, vector);
    const Decoded reply = decode(received(vector, "reply_can_id", "reply_ok"), vector["node"]);
    ASSERT_TRUE(reply.sdo);
    EXPECT_EQ(reply.sdo->kind, SdoReply::Kind::written);
    EXPECT_EQ(reply.sdo->object.index, object.index);
    EXPECT_EQ(reply.sdo->object.sub, object.sub);
    ++seen;
  }
  EXPECT_GE(seen, 30);
}

TEST(Cia402Codec, ObjectsAreReadAsInEveryVector) {
  for (const Json& vector : vectors()["cia402"]["sdo_upload"]) {
    SCOPED_TRACE(vector.dump());
    const Frame request = sdo_read(vector["node"], {vector["index"], vector["sub"]});
    EXPECT_EQ(request.id, vector["request_can_id"].get<std::uint32_t>());
    EXPECT_EQ(hex(request.payload()), vector["request"].get<std::string>());
    const Decoded reply = decode(received(vector, "reply_can_id", "reply"), vector["node"]);
    ASSERT_TRUE(reply.sdo);
    EXPECT_EQ(reply.sdo->kind, SdoReply::Kind::read);
    EXPECT_EQ(reply.sdo->value, vector["value"].get<std::uint32_t>());
    EXPECT_EQ(reply.sdo->size, vector["size"].get<int>());
  }
  for (const Json& vector : vectors()["cia402"]["sdo_abort"]) {
    const Decoded reply = decode(frame_of(vector), vector["node"]);
    ASSERT_TRUE(reply.sdo);
    EXPECT_EQ(reply.sdo->kind, SdoReply::Kind::aborted);
    EXPECT_EQ(reply.sdo->object.index, vector["expect"]["abort_index"].get<int>());
    EXPECT_EQ(reply.sdo->object.sub, vector["expect"]["abort_sub"].get<int>());
    EXPECT_EQ(reply.sdo->value, vector["expect"]["abort_code"].get<std::uint32_t>());
  }
}

TEST(Cia402Codec, AnObjectThatDoesNotFitIsNotWritten) {
  EXPECT_FALSE(sdo_write(1, {0x6060, 0}, 256, 1));
  EXPECT_FALSE(sdo_write(1, {0x6060, 0}, -129, 1));
  EXPECT_TRUE(sdo_write(1, {0x6060, 0}, -128, 1));
  EXPECT_FALSE(sdo_write(1, {0x6060, 0}, 1, 5));
  EXPECT_FALSE(sdo_write(1, {0x6060, 0}, 1, 0));
}

TEST(Cia402Codec, StatusWordsOfEveryVector) {
  for (const Json& vector : vectors()["cia402"]["statusword"]) {
    SCOPED_TRACE(vector.dump());
    const std::uint16_t status = vector["statusword"];
    EXPECT_EQ(snake(word_of(state_of(status))), vector["state"].get<std::string>());
    EXPECT_EQ(towards_enabled(state_of(status)),
              vector["next_controlword_towards_operation_enabled"].get<int>());
    const StatusBits bits = bits_of(status);
    EXPECT_EQ(bits.voltage_enabled, flag(vector, "voltage_enabled"));
    EXPECT_EQ(bits.warning, flag(vector, "warning"));
    EXPECT_EQ(bits.remote, flag(vector, "remote"));
    EXPECT_EQ(bits.internal_limit, flag(vector, "internal_limit_active"));
    EXPECT_EQ(bits.target_followed, flag(vector, "cst_target_followed"));
  }
}

TEST(Cia402Codec, ProcessDataOfEveryVector) {
  for (const Json& vector : vectors()["cia402"]["rpdo1"]) {
    SCOPED_TRACE(vector.dump());
    const auto raw =
        torque_raw(vector["torque_Nm"], 1e-3 * vector["rated_torque_mNm"].get<double>());
    ASSERT_TRUE(raw);
    EXPECT_EQ(*raw, vector["target_torque_raw"].get<int>());
    expect_frame(rpdo1(vector["node"], vector["controlword"], *raw), vector);
  }
  for (const Json& vector : vectors()["cia402"]["tpdo1"]) {
    SCOPED_TRACE(vector.dump());
    const Decoded decoded = decode(frame_of(vector), vector["node"]);
    ASSERT_TRUE(decoded.tpdo1);
    EXPECT_EQ(decoded.tpdo1->status, vector["expect"]["statusword"].get<int>());
    EXPECT_EQ(decoded.tpdo1->position, vector["expect"]["position_raw"].get<int>());
    EXPECT_EQ(decoded.tpdo1->torque, vector["expect"]["torque_raw"].get<int>());
  }
  for (const Json& vector : vectors()["cia402"]["tpdo2"]) {
    const Decoded decoded = decode(frame_of(vector), vector["node"]);
    ASSERT_TRUE(decoded.tpdo2);
    EXPECT_EQ(decoded.tpdo2->velocity, vector["expect"]["velocity_raw"].get<int>());
    EXPECT_EQ(decoded.tpdo2->error, vector["expect"]["error_code"].get<int>());
    EXPECT_EQ(decoded.tpdo2->mode, vector["expect"]["mode_display"].get<int>());
  }
}

TEST(Cia402Codec, HeartbeatsAndEmergenciesOfEveryVector) {
  for (const Json& vector : vectors()["cia402"]["heartbeat"]) {
    const Decoded decoded = decode(frame_of(vector), vector["node"]);
    ASSERT_TRUE(decoded.guard);
    EXPECT_EQ(word_of(decoded.guard->state), vector["expect"]["nmt_state"].get<std::string>());
  }
  for (const Json& vector : vectors()["cia402"]["emcy"]) {
    const Decoded decoded = decode(frame_of(vector), vector["node"]);
    ASSERT_TRUE(decoded.emergency);
    EXPECT_EQ(decoded.emergency->code, vector["expect"]["code"].get<int>());
    EXPECT_EQ(decoded.emergency->error_register, vector["expect"]["error_register"].get<int>());
    EXPECT_EQ(hex(decoded.emergency->vendor), vector["expect"]["manufacturer"].get<std::string>());
    EXPECT_EQ(decoded.emergency->code == 0, vector["expect"]["is_reset"].get<bool>());
  }
}

TEST(Cia402Codec, TorqueIsRoundedSaturatedAndNeverNonsense) {
  EXPECT_EQ(torque_raw(1e6, 0.5), 32767);
  EXPECT_EQ(torque_raw(-1e6, 0.5), -32768);
  EXPECT_EQ(torque_raw(0.0012, 1), 1);
  for (const double torque : {std::nan(""), double{INFINITY}})
    EXPECT_FALSE(torque_raw(torque, 0.5));
  EXPECT_FALSE(torque_raw(1, 0));
  EXPECT_FALSE(torque_raw(1, std::nan("")));
}

TEST(Cia402Codec, EveryShortFrameOfANodeIsMalformedOrIgnored) {
  std::mt19937 random(5);
  for (int i = 0; i < 200'000; ++i) {
    Frame frame{.id = static_cast<std::uint32_t>((random() & 0x780) | 5),
                .size = static_cast<std::uint8_t>(random() % 9)};
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    const Decoded d = decode(frame, 5);
    EXPECT_EQ(d.received == Received::ok, d.tpdo1 || d.tpdo2 || d.emergency || d.guard || d.sdo);
    if (d.tpdo1) {
      EXPECT_EQ(frame.size, 8);
    }
  }
}

}  // namespace
}  // namespace hapticd::can::cia402
