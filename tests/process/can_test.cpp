// CAN devices as an operator meets them on a machine without these interfaces: words, exit codes, no hang.
#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

std::string can_config() {
  return R"(version: 1
devices:
  - name: arm
    driver: odrive
    can: {interface: nocan9, watchdog_s: 0.02}
    latency_s: 0.003
    kinematics: {cartesian: {directions: [x]}}
    axes:
      - {name: x, encoder: {counts_per_m: 163840}, actuator: {max_force_N: 8},
         can: {node: 3, counts_per_turn: 8192}, model: {mass_kg: 0.05, damping_Ns_m: 1.37}}
stability: {require: none}
guard: {max_force_N: 6}
)";
}

using testing::AllOf;
using testing::HasSubstr;

using CanDaemon = DaemonTest;

TEST_F(CanDaemon, WithoutItsInterfaceItSaysWhatIsMissingAndEndsWith69) {
  write_file("config.yaml", can_config());
  run();
  EXPECT_EQ(hapticd_->wait(), 69);
  EXPECT_THAT(hapticd_->err(), AllOf(HasSubstr("device arm: "), HasSubstr("CAN")));
}

TEST_F(CanDaemon, CheckCountsWhatTheBusTakes) {
  write_file("config.yaml", can_config());
  EXPECT_EQ(ctl({"check", config_}), 0) << ctl_err_;
  EXPECT_THAT(
      ctl_out_,
      AllOf(HasSubstr("node 3 on nocan9; free_running, samples at most 1366 us old"),
            HasSubstr("bus nocan9: 23.1 % of its time at worst (at most 80 %), 1 axis, 3 fit")));
  EXPECT_EQ(ctl({"check", config_, "--json"}), 0);
  const auto json = daemon::Json::parse(ctl_out_, nullptr, false);
  ASSERT_TRUE(json.is_object()) << ctl_out_;
  EXPECT_EQ(json["plan"]["buses"][0]["axes_that_fit"], 3);
}

TEST_F(CanDaemon, EmulateAndDevicesEndWith69WhereThereIsNoBus) {
  write_file("config.yaml", can_config());
  EXPECT_EQ(ctl({"emulate", config_}), 69);
  EXPECT_THAT(ctl_err_, HasSubstr("CAN"));
  EXPECT_EQ(ctl({"devices", "--interface", "nocan9"}), 69);
  EXPECT_THAT(ctl_out_, HasSubstr("nocan9: "));
  EXPECT_EQ(ctl({"devices", "--interface", "nocan9", "--json"}), 69);
  EXPECT_TRUE(daemon::Json::parse(ctl_out_, nullptr, false)["can"][0]["problem"].is_string());
}

TEST_F(CanDaemon, DevicesListsBothKindsAndEndsWith69OnlyWhereNothingCanBeUsed) {
  const int code = ctl({"devices", "--seconds", "0.05", "--json"});
  const auto answer = daemon::Json::parse(ctl_out_, nullptr, false);
  ASSERT_TRUE(answer.is_object()) << ctl_out_ << ctl_err_;
  EXPECT_TRUE(answer["can"].is_array());
  EXPECT_TRUE(answer["usb"].is_array());
  EXPECT_EQ(code, answer["ok"] == true ? 0 : 69);
  EXPECT_EQ(ctl({"devices", "--seconds", "0.05"}), code);
  EXPECT_THAT(ctl_out_, HasSubstr("USB"));
}

TEST_F(CanDaemon, AFaultThatCannotBeReadIsRefusedWithItsForm) {
  write_file("config.yaml", can_config());
  EXPECT_EQ(ctl({"emulate", config_, "--bus", "elsewhere"}), 1);
  EXPECT_THAT(ctl_err_, HasSubstr("no device of this config has all its drives on elsewhere"));
  EXPECT_EQ(ctl({"emulate", config_, "--fault", "reset:arm.x"}), 64);
  EXPECT_THAT(ctl_err_, HasSubstr("KIND:AXIS@SECONDS"));
  EXPECT_EQ(ctl({"devices", "--ask", "vesc"}), 64);
  EXPECT_EQ(ctl({"emulate", config_, "--loss", "nan"}), 64);
}

}  // namespace
}  // namespace hapticd::test
