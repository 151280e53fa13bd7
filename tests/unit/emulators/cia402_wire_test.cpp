// CANopen and CiA 402: every vector, from the drive's side.
#include "sim/can/cia402_wire.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/unit/emulators/vectors.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;

const Json& cia402(const char* section) {
  const Json& all = vectors().at("cia402").at(section);
  EXPECT_FALSE(all.empty()) << section;
  return all;
}

TEST(Cia402Wire, NmtCommandsOfTheVectorsAreHeardByTheirNodes) {
  for (const Json& vector : cia402("nmt")) {
    SCOPED_TRACE(vector.dump());
    const Frame frame = frame_of(vector);
    const NmtCommand expected =
        vector.at("command") == "start" ? NmtCommand::start : NmtCommand::pre_operational;
    EXPECT_EQ(nmt_command(frame, 1), expected);
    EXPECT_EQ(nmt_command(frame, 2).has_value(), vector.at("node") == 0);
  }
}

TEST(Cia402Wire, SyncIsAnEmptyFrame) {
  for (const Json& vector : cia402("sync")) EXPECT_EQ(vector.at("can_id"), kCanopenSync);
}

TEST(Cia402Wire, SdoWritesOfTheVectorsMeanWhatTheySayAndAreConfirmed) {
  for (const Json& vector : cia402("sdo_configure_cst")) {
    SCOPED_TRACE(vector.dump());
    const auto node = vector.at("node").get<std::uint8_t>();
    const auto request = sdo_request(frame_of(vector), node);
    ASSERT_TRUE(request);
    EXPECT_EQ(request->kind, SdoRequest::Kind::write);
    EXPECT_EQ(request->index, vector.at("index"));
    EXPECT_EQ(request->sub, vector.at("sub"));
    EXPECT_EQ(request->size, vector.at("size"));
    const auto value = static_cast<std::uint32_t>(vector.at("value").get<std::int64_t>());
    EXPECT_EQ(request->value, value & (0xffffffffU >> (32 - 8 * request->size)));
    const Frame reply = sdo_written(node, request->index, request->sub);
    EXPECT_EQ(reply.can_id, vector.at("reply_can_id"));
    EXPECT_EQ(hex_of(reply), vector.at("reply_ok"));
    EXPECT_FALSE(sdo_request(frame_of(vector), static_cast<std::uint8_t>(node + 1)));
  }
}

TEST(Cia402Wire, SdoReadsOfTheVectorsAreAnswered) {
  for (const Json& vector : cia402("sdo_upload")) {
    SCOPED_TRACE(vector.dump());
    const auto node = vector.at("node").get<std::uint8_t>();
    const Frame asked =
        frame_of({{"can_id", vector.at("request_can_id")}, {"data", vector.at("request")}});
    const auto request = sdo_request(asked, node);
    ASSERT_TRUE(request);
    EXPECT_EQ(request->kind, SdoRequest::Kind::read);
    EXPECT_EQ(request->index, vector.at("index"));
    const Frame reply =
        sdo_value(node, request->index, request->sub, vector.at("value"), vector.at("size"));
    EXPECT_EQ(reply.can_id, vector.at("reply_can_id"));
    EXPECT_EQ(hex_of(reply), vector.at("reply"));
  }
  for (const Json& vector : cia402("sdo_abort")) {
    const Json& e = vector.at("expect");
    const Frame reply =
        sdo_abort(vector.at("node"), e.at("abort_index"), e.at("abort_sub"), e.at("abort_code"));
    EXPECT_EQ(reply.can_id, vector.at("can_id"));
    EXPECT_EQ(hex_of(reply), vector.at("data"));
  }
  EXPECT_EQ(sdo::kNoObject, 0x06020000U);
}

const std::map<std::string, Cia402State> kCia402States{
    {"switch_on_disabled", Cia402State::switch_on_disabled},
    {"ready_to_switch_on", Cia402State::ready_to_switch_on},
    {"switched_on", Cia402State::switched_on},
    {"operation_enabled", Cia402State::operation_enabled},
    {"fault", Cia402State::fault}};

TEST(Cia402Wire, StatusWordsAreThoseOfTheVectorsAndTheirControlWordsLeadOn) {
  const std::map<Cia402State, Cia402State> next{
      {Cia402State::switch_on_disabled, Cia402State::ready_to_switch_on},
      {Cia402State::ready_to_switch_on, Cia402State::switched_on},
      {Cia402State::switched_on, Cia402State::operation_enabled},
      {Cia402State::operation_enabled, Cia402State::operation_enabled},
      {Cia402State::fault, Cia402State::switch_on_disabled}};
  constexpr unsigned kTargetReached = 0x400;  // in CST nothing is reached
  for (const Json& vector : cia402("statusword")) {
    SCOPED_TRACE(vector.dump());
    const Cia402State state = kCia402States.at(vector.at("state"));
    const std::uint16_t word =
        cia402_statusword({.state = state,
                           .internal_limit = vector.at("internal_limit_active"),
                           .target_followed = vector.at("cst_target_followed")});
    EXPECT_EQ(word, vector.at("statusword").get<unsigned>() & ~kTargetReached);
    EXPECT_EQ(cia402_next(state, vector.at("next_controlword_towards_operation_enabled"), 0),
              next.at(state));
  }
}

TEST(Cia402Wire, RpdosOfTheVectorsAreUnpacked) {
  for (const Json& vector : cia402("rpdo1")) {
    SCOPED_TRACE(vector.dump());
    const Frame frame = frame_of(vector);
    EXPECT_EQ(pdo_get(frame, 0, 16), vector.at("controlword"));
    const auto raw = static_cast<std::int16_t>(pdo_get(frame, 16, 16));
    EXPECT_EQ(raw, vector.at("target_torque_raw"));
    const double rated_Nm = 1e-3 * number_of(vector.at("rated_torque_mNm"));
    EXPECT_NEAR(1e-3 * raw * rated_Nm, number_of(vector.at("torque_Nm")), 1e-12);
  }
}

TEST(Cia402Wire, TpdosHaveTheBytesOfTheVectors) {
  for (const Json& vector : cia402("tpdo1")) {
    const Json& e = vector.at("expect");
    const double rated_Nm = 1e-3 * number_of(vector.at("rated_torque_mNm"));
    const std::int16_t torque = cia402_per_mille(number_of(e.at("torque_Nm")), rated_Nm);
    EXPECT_EQ(torque, e.at("torque_raw"));
    Frame frame{};
    std::size_t at = pdo_put(frame, 0, e.at("statusword"), 16);
    at = pdo_put(frame, at, static_cast<std::uint32_t>(e.at("position_raw").get<int>()), 32);
    pdo_put(frame, at, static_cast<std::uint32_t>(torque), 16);
    EXPECT_EQ(hex_of(frame), vector.at("data"));
  }
  for (const Json& vector : cia402("tpdo2")) {
    const Json& e = vector.at("expect");
    Frame frame{};
    std::size_t at = pdo_put(frame, 0, e.at("velocity_raw"), 32);
    at = pdo_put(frame, at, e.at("error_code"), 16);
    pdo_put(frame, at, e.at("mode_display"), 8);
    EXPECT_EQ(hex_of(frame), vector.at("data"));
  }
}

TEST(Cia402Wire, HeartbeatsAndEmergenciesHaveTheBytesOfTheVectors) {
  for (const Json& vector : cia402("heartbeat")) {
    const bool boots = vector.at("expect").at("nmt_state") == "boot-up";
    const Frame frame =
        canopen_heartbeat(vector.at("node"), boots ? NmtState::boot_up : NmtState::operational);
    EXPECT_EQ(frame.can_id, vector.at("can_id"));
    EXPECT_EQ(hex_of(frame), vector.at("data"));
  }
  for (const Json& vector : cia402("emcy")) {
    const Json& e = vector.at("expect");
    const Frame frame = canopen_emcy(vector.at("node"), e.at("code"), e.at("error_register"));
    EXPECT_EQ(frame.can_id, vector.at("can_id"));
    EXPECT_EQ(hex_of(frame), vector.at("data"));
  }
}

TEST(Cia402Wire, TheStateMachineGoesNoOtherWays) {
  using enum Cia402State;
  EXPECT_EQ(cia402_statusword({.state = operation_enabled, .internal_limit = true}), 0x0a37);
  EXPECT_EQ(cia402_next(switch_on_disabled, 0x0f, 0), switch_on_disabled);
  EXPECT_EQ(cia402_next(switch_on_disabled, 0x07, 0), switch_on_disabled);
  EXPECT_EQ(cia402_next(ready_to_switch_on, 0x0f, 0), switched_on);
  EXPECT_EQ(cia402_next(operation_enabled, 0x02, 0), quick_stop_active);
  EXPECT_EQ(cia402_next(quick_stop_active, 0x0f, 0), quick_stop_active);
  EXPECT_EQ(cia402_next(quick_stop_active, 0x00, 0), switch_on_disabled);
  EXPECT_EQ(cia402_next(operation_enabled, 0x00, 0), switch_on_disabled);
  EXPECT_EQ(cia402_next(operation_enabled, 0x06, 0), ready_to_switch_on);
  EXPECT_EQ(cia402_next(operation_enabled, 0x07, 0), switched_on);
  EXPECT_EQ(cia402_next(fault, 0x0f, 0), fault);
  EXPECT_EQ(cia402_next(fault, 0x80, 0x80), fault);
  EXPECT_EQ(cia402_next(fault, 0x80, 0x00), switch_on_disabled);
}

}  // namespace
}  // namespace hapticd::test::emulator
