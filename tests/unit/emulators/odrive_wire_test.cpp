// ODrive: every vector, from the drive's side.
#include "sim/can/odrive_wire.h"

#include <gtest/gtest.h>

#include "tests/unit/emulators/vectors.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;

struct OdriveMeaning {
  const Json& args;
  double of(const char* name) const { return number_of(args.at(name)); }

  void operator()(const OdriveSetAxisState& o) const { EXPECT_EQ(o.state, of("state")); }
  void operator()(const OdriveSetControllerMode& o) const {
    EXPECT_EQ(o.control, of("control_mode"));
    EXPECT_EQ(o.input, of("input_mode"));
  }
  void operator()(const OdriveSetInputPos& o) const {
    EXPECT_FLOAT_EQ(static_cast<float>(o.turns), static_cast<float>(of("pos")));
    EXPECT_NEAR(o.turns_s, of("vel_ff"), 0.00101);
    EXPECT_NEAR(o.torque_Nm, of("torque_ff"), 0.00101);
  }
  void operator()(const OdriveSetInputVel& o) const {
    EXPECT_NEAR(o.turns_s, of("vel"), 1e-8);
    EXPECT_NEAR(o.torque_Nm, of("torque_ff"), 1e-8);
  }
  void operator()(const OdriveSetInputTorque& o) const { EXPECT_EQ(o.torque_Nm, of("torque")); }
  void operator()(const OdriveSetLimits& o) const {
    EXPECT_EQ(o.velocity_turns_s, of("velocity_limit"));
    EXPECT_EQ(o.current_A, of("current_limit"));
  }
  void operator()(const OdriveClearErrors& o) const { EXPECT_EQ(o.identify, of("identify")); }
  void operator()(const OdriveEstop&) const { EXPECT_TRUE(args.empty()); }
  void operator()(const OdriveReboot& o) const { EXPECT_EQ(o.action, of("action")); }
  void operator()(const OdriveSetAddress& o) const { EXPECT_EQ(o.node, of("node")); }
  void operator()(const OdriveAsk&) const { ADD_FAILURE() << "a command, not a request"; }
};

// Name of the message that an order came in.
std::string name_of(const OdriveOrder& order) {
  constexpr const char* kNames[] = {
      "Set_Axis_State", "Set_Controller_Mode", "Set_Input_Pos", "Set_Input_Vel", "Set_Input_Torque",
      "Set_Limits",     "Clear_Errors",        "Estop",         "Reboot",        "Address",
      "request"};
  return kNames[order.index()];
}

void check_order(const Json& vector, const Frame& frame) {
  SCOPED_TRACE(vector.dump());
  EXPECT_EQ(odrive_node(frame), vector.at("node_id"));
  const auto order = odrive_order(frame);
  ASSERT_TRUE(order);
  const std::string msg = vector.at("msg");
  if (!vector.contains("args")) {
    ASSERT_TRUE(std::holds_alternative<OdriveAsk>(*order));
    const bool estimates = msg == "request Get_Encoder_Estimates";
    EXPECT_EQ(std::get<OdriveAsk>(*order).what, estimates ? OdriveCommand::get_encoder_estimates
                                                          : OdriveCommand::get_bus_voltage_current);
    return;
  }
  ASSERT_EQ(name_of(*order), msg);
  std::visit(OdriveMeaning{vector.at("args")}, *order);
}

TEST(OdriveWire, HostCommandsOfTheVectorsMeanWhatTheySay) {
  const Json& all = vectors().at("odrive_cansimple").at("encode");
  ASSERT_GE(all.size(), 13U);
  for (const Json& vector : all) {
    check_order(vector, frame_of(vector));
    if (vector.contains("also_accept_len_4"))
      check_order(vector, frame_of(vector, vector.at("also_accept_len_4")));
  }
}

Frame drive_message(const Json& vector) {
  const auto node = vector.at("node_id").get<std::uint8_t>();
  const Json& e = vector.at("expect");
  const std::string msg = vector.at("msg");
  const auto floats = [&](OdriveCommand what, const char* first, const char* second) {
    return odrive_floats(node, what, e.at(first), e.at(second));
  };
  if (msg == "Heartbeat")
    return odrive_heartbeat(node, {e.at("axis_error"), e.at("axis_state"), e.at("procedure_result"),
                                   e.at("trajectory_done") == 1});
  if (msg == "Get_Error") return odrive_error(node, e.at("active_errors"), e.at("disarm_reason"));
  if (msg == "Get_Encoder_Estimates")
    return floats(OdriveCommand::get_encoder_estimates, "pos", "vel");
  if (msg == "Get_Bus_Voltage_Current")
    return floats(OdriveCommand::get_bus_voltage_current, "bus_voltage", "bus_current");
  if (msg == "Get_Torques")
    return floats(OdriveCommand::get_torques, "torque_target", "torque_estimate");
  if (msg == "Get_Iq") return floats(OdriveCommand::get_iq, "iq_setpoint", "iq_measured");
  EXPECT_EQ(msg, "Get_Temperature");
  return floats(OdriveCommand::get_temperature, "fet_temperature", "motor_temperature");
}

TEST(OdriveWire, DriveMessagesHaveTheBytesOfTheVectors) {
  const Json& all = vectors().at("odrive_cansimple").at("decode");
  ASSERT_GE(all.size(), 9U);
  for (const Json& vector : all) {
    SCOPED_TRACE(vector.dump());
    const Frame frame = drive_message(vector);
    EXPECT_EQ(frame.can_id, vector.at("can_id"));
    EXPECT_EQ(hex_of(frame), vector.at("data"));
  }
}

TEST(OdriveWire, VersionAndAddressAreLaidOutAsInTheHeader) {
  const Frame version = odrive_version(
      3, {.protocol = 2, .hardware = {4, 5, 6}, .firmware = {0, 6, 11}, .unreleased = 1});
  EXPECT_EQ(version.can_id, 3U << 5);
  EXPECT_EQ(hex_of(version), "0204050600060b01");
  const Frame address = odrive_address(3, 0x665544332211);
  EXPECT_EQ(address.can_id, 3U << 5 | 6U);
  EXPECT_EQ(hex_of(address).substr(0, 14), "03112233445566");
  const auto order = odrive_order(address);
  ASSERT_TRUE(order);
  EXPECT_EQ(std::get<OdriveSetAddress>(*order).serial, 0x665544332211U);
}

TEST(OdriveWire, ExtendedShortAndFdFramesAreNoOrders) {
  Frame torque = odrive_floats(1, OdriveCommand::set_input_torque, 1, 0);
  EXPECT_TRUE(odrive_order(torque));
  torque.can_id |= CAN_EFF_FLAG;
  EXPECT_FALSE(odrive_order(torque));
  torque.can_id &= CAN_SFF_MASK;
  torque.flags = CANFD_FDF;
  EXPECT_FALSE(odrive_order(torque));
  torque.flags = 0;
  torque.len = 3;
  EXPECT_FALSE(odrive_order(torque));
}

}  // namespace
}  // namespace hapticd::test::emulator
