#include "drivers/can/odrive_codec.h"

#include <cmath>
#include <random>

#include "tests/unit/can/vectors.h"

namespace hapticd::can::odrive {
namespace {

std::optional<Frame> encoded(const std::string& what, std::uint8_t node, const Json& a) {
  const auto of = [&](const char* key) { return number(a.at(key)); };
  const auto whole = [&](const char* key) { return a.at(key).get<std::uint32_t>(); };
  if (what == "Set_Controller_Mode")
    return set_controller_mode(node, static_cast<ControlMode>(whole("control_mode")),
                               static_cast<InputMode>(whole("input_mode")));
  if (what == "Set_Axis_State") return set_axis_state(node, static_cast<AxisState>(whole("state")));
  if (what == "Set_Input_Torque") return set_input_torque(node, of("torque"));
  if (what == "Set_Limits") return set_limits(node, of("velocity_limit"), of("current_limit"));
  if (what == "Clear_Errors") return clear_errors(node);
  if (what == "Estop") return estop(node);
  if (what == "Set_Input_Pos") return set_input_pos(node, of("pos"), of("vel_ff"), of("torque_ff"));
  if (what == "Set_Input_Vel") return set_input_vel(node, of("vel"), of("torque_ff"));
  if (what == "Reboot") return reboot(node);
  if (what == "request Get_Encoder_Estimates") return request(node, Command::get_encoder_estimates);
  if (what == "request Get_Bus_Voltage_Current")
    return request(node, Command::get_bus_voltage_current);
  return std::nullopt;
}

/// What was decoded, by the names that the vectors have.
Json named(const Message& message) {
  struct Names {
    Json operator()(std::monostate) const { return {}; }
    Json operator()(const Version& m) const { return {{"protocol", m.protocol}}; }
    Json operator()(const Heartbeat& m) const {
      return {{"axis_error", m.error},
              {"axis_state", m.state},
              {"procedure_result", m.procedure_result},
              {"trajectory_done", m.trajectory_done ? 1 : 0}};
    }
    Json operator()(const Errors& m) const {
      return {{"active_errors", m.active}, {"disarm_reason", m.disarm_reason}};
    }
    Json operator()(const Estimates& m) const {
      return {{"pos", m.position_turns}, {"vel", m.velocity_turns_s}};
    }
    Json operator()(const Currents& m) const {
      return {{"iq_setpoint", m.setpoint_A}, {"iq_measured", m.measured_A}};
    }
    Json operator()(const Temperatures& m) const {
      return {{"fet_temperature", m.fet_C}, {"motor_temperature", m.motor_C}};
    }
    Json operator()(const Supply& m) const {
      return {{"bus_voltage", m.voltage_V}, {"bus_current", m.current_A}};
    }
    Json operator()(const Torques& m) const {
      return {{"torque_target", m.target_Nm}, {"torque_estimate", m.estimate_Nm}};
    }
  };
  return std::visit(Names{}, message);
}

Received class_of(const std::string& word) {
  if (word == "ok") return Received::ok;
  if (word == "malformed") return Received::malformed;
  if (word == "non_finite") return Received::non_finite;
  if (word == "other_master") return Received::other_master;
  if (word == "error_frame") return Received::error_frame;
  return Received::ignore;
}

TEST(OdriveCodec, EncodesEveryVector) {
  int seen = 0;
  for (const Json& vector : vectors()["odrive_cansimple"]["encode"]) {
    SCOPED_TRACE(vector.dump());
    const auto frame =
        encoded(vector["msg"], vector["node_id"], vector.value("args", Json::object()));
    if (vector.value("must_refuse", false)) {
      EXPECT_FALSE(frame);
    } else {
      ASSERT_TRUE(frame);
      expect_frame(*frame, vector);
    }
    ++seen;
  }
  EXPECT_GE(seen, 13);
}

TEST(OdriveCodec, DecodesEveryVector) {
  int seen = 0;
  for (const Json& vector : vectors()["odrive_cansimple"]["decode"]) {
    SCOPED_TRACE(vector.dump());
    const Decoded decoded = decode(frame_of(vector), vector["node_id"]);
    EXPECT_EQ(decoded.received, class_of(vector["class"]));
    const Json found = named(decoded.message);
    for (const auto& [key, value] : vector["expect"].items())
      EXPECT_EQ(found.at(key), value) << key;
    ++seen;
  }
  EXPECT_GE(seen, 9);
}

TEST(OdriveCodec, ClassifiesEveryVector) {
  for (const Json& vector : vectors()["odrive_cansimple"]["classify"]) {
    SCOPED_TRACE(vector.dump());
    EXPECT_EQ(decode(frame_of(vector), vector["configured_node"]).received,
              class_of(vector["class"]));
  }
}

TEST(OdriveCodec, RefusesATorqueThatIsNoNumber) {
  for (const double torque : {std::nan(""), double{INFINITY}, -double{INFINITY}, 1e39})
    EXPECT_FALSE(set_input_torque(1, torque));
  EXPECT_FALSE(set_limits(1, INFINITY, 1));
  EXPECT_FALSE(set_input_pos(1, 0, 0, std::nan("")));
}

TEST(OdriveCodec, EstimatesThatAreNoNumbersAreNoSample) {
  for (const char* data : {"0000c07f00000000", "000000000000807f"}) {
    const Json vector{{"can_id", 0x29}, {"data", data}, {"len", 8}};
    EXPECT_EQ(decode(frame_of(vector), 1).received, Received::non_finite) << data;
  }
}

TEST(OdriveCodec, NothingOfAnyFrameIsNonsense) {
  std::mt19937 random(7);
  for (int i = 0; i < 200'000; ++i) {
    Frame frame{.id = static_cast<std::uint32_t>(random() & 0x7ff),
                .size = static_cast<std::uint8_t>(random() % 9)};
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    const Decoded decoded = decode(frame, static_cast<std::uint8_t>(frame.id >> 5));
    if (const auto* e = std::get_if<Estimates>(&decoded.message)) {
      EXPECT_TRUE(std::isfinite(e->position_turns) && std::isfinite(e->velocity_turns_s));
    }
    EXPECT_EQ(decoded.received == Received::ok, decoded.message.index() != 0);
  }
}

}  // namespace
}  // namespace hapticd::can::odrive
