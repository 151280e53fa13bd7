// The daemon started, asked, stopped and killed.
#include <fmt/format.h>
#include <signal.h>

#include <cmath>

#include "control/core/fault.h"
#include "control/state.h"
#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using testing::HasSubstr;

/// Values of one field, record by record.
std::vector<double> column(const daemon::Recording& recording, const std::string& name) {
  std::vector<double> values;
  const daemon::Field* field = recording.find(name);
  EXPECT_NE(field, nullptr) << name;
  for (std::size_t i = 0; field != nullptr && i < recording.size(); ++i)
    values.push_back(recording.value(i, *field));
  return values;
}

using Lifecycle = DaemonTest;

TEST_F(Lifecycle, RunsForItsDurationAndEndsWithASummary) {
  start({}, {"--duration", "1"});
  EXPECT_EQ(hapticd_->wait(), 0) << hapticd_->err();
  const std::string out = hapticd_->out();
  for (const char* part :
       {"summary", "ticks", "p99.9", "largest force", "faults", "servo thread", "kernel"}) {
    EXPECT_THAT(out, HasSubstr(part));
  }
  EXPECT_THAT(hapticd_->err(), HasSubstr("ready -> enabled (start.enable: when_ready)"));
}

TEST_F(Lifecycle, ADurationThatEndsInAFaultExitsOne) {
  start({.failures = "{kind: fault, at_s: 0.1}"}, {"--duration", "1"});
  EXPECT_EQ(hapticd_->wait(), 1) << hapticd_->err();
}

TEST_F(Lifecycle, WaitsForEnableUnlessToldOtherwise) {
  start({.enable = "on_command"});
  ASSERT_TRUE(reaches("ready")) << hapticd_->err();
  EXPECT_EQ(ctl({"enable"}), 0) << ctl_err_;
  EXPECT_THAT(ctl_out_, HasSubstr("forces are on"));
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_EQ(ctl({"disable"}), 0);
  EXPECT_TRUE(reaches("ready"));
  EXPECT_EQ(ctl({"status"}), 0);
  EXPECT_THAT(ctl_out_, HasSubstr("state           ready"));
  EXPECT_EQ(stop(), 0) << hapticd_->err();
}

TEST_F(Lifecycle, EstopIsZeroForceInTheVeryTickThatSeesIt) {
  start({});
  ASSERT_TRUE(presses()) << hapticd_->err();
  ASSERT_EQ(ctl({"estop"}), 0);
  ASSERT_TRUE(reaches("fault"));
  EXPECT_EQ(status()["fault"]["name"], "estop");
  EXPECT_EQ(ctl({"enable"}), 0) << ctl_err_;
  EXPECT_EQ(status()["state"], "enabled");
  ASSERT_EQ(stop(), 0);

  const auto recorded = recording();
  const auto fault = column(recorded, "fault"), effort = column(recorded, "left.x.effort");
  std::size_t first = 0;
  while (first < fault.size() && fault[first] != static_cast<double>(Fault::estop)) ++first;
  ASSERT_LT(first, fault.size());
  ASSERT_GT(first, 0u);
  EXPECT_GT(std::abs(effort[first - 1]), 1.0);
  for (std::size_t i = first; i < fault.size() && fault[i] != 0; ++i)
    ASSERT_EQ(effort[i], 0.0) << i;
}

TEST_F(Lifecycle, EstopWorksBeforeForcesAreOn) {
  start({.enable = "on_command"});
  ASSERT_TRUE(reaches("ready"));
  ASSERT_EQ(ctl({"estop"}), 0);
  EXPECT_TRUE(reaches("fault"));
  EXPECT_EQ(stop(), 0);
}

TEST_F(Lifecycle, SigtermRampsOutAndEndsWithoutForce) {
  start({});
  ASSERT_TRUE(presses()) << hapticd_->err();
  ASSERT_EQ(stop(), 0);
  const auto recorded = recording();
  const auto effort = column(recorded, "left.x.effort"), ramp = column(recorded, "ramp");
  ASSERT_FALSE(effort.empty());
  EXPECT_EQ(effort.back(), 0.0);
  EXPECT_EQ(ramp.back(), 0.0);
  EXPECT_THAT(hapticd_->err(), HasSubstr("enabled -> off (signal)"));
}

TEST_F(Lifecycle, ASecondSignalSkipsTheRamp) {
  start({.ramp_s = 60});
  ASSERT_TRUE(reaches("enabled"));
  hapticd_->signal(SIGINT);
  ASSERT_TRUE(logs("SIGINT: stopping"));
  hapticd_->signal(SIGINT);
  EXPECT_EQ(hapticd_->wait(), 0);
  EXPECT_EQ(column(recording(), "fault").back(), static_cast<double>(Fault::estop));
}

TEST_F(Lifecycle, Sigusr1PrintsTheSummaryAndGoesOn) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  hapticd_->signal(SIGUSR1);
  EXPECT_TRUE(output_has("summary"));
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

TEST_F(Lifecycle, ASecondInstanceEndsWith75AndTheFirstGoesOn) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  Process second({HAPTICD_BINARY, "--config", config_}, dir_.file("second"));
  EXPECT_EQ(second.wait(), 75);
  EXPECT_THAT(
      second.err(),
      HasSubstr(fmt::format("another hapticd (pid {}) holds the control socket", hapticd_->pid())));
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

TEST_F(Lifecycle, StartsAgainAfterSigkill) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  hapticd_->signal(SIGKILL);
  EXPECT_EQ(hapticd_->wait(), 128 + SIGKILL);
  EXPECT_EQ(ctl({"status"}), 69);
  EXPECT_THAT(ctl_err_, HasSubstr("no hapticd answers"));
  start({});
  EXPECT_TRUE(reaches("enabled")) << hapticd_->err();
  EXPECT_EQ(stop(), 0);
}

TEST_F(Lifecycle, AnUnprovedWallKeepsForcesOffAndSaysWhy) {
  start({.stiffness_N_m = 50'000});
  ASSERT_TRUE(reaches("ready"));
  EXPECT_THAT(hapticd_->err(), HasSubstr("left: not proved"));
  EXPECT_EQ(ctl({"enable"}), 1);
  EXPECT_THAT(ctl_err_, HasSubstr("left: not proved"));
  EXPECT_EQ(ctl({"enable", "--unproven"}), 1);
  EXPECT_EQ(status()["state"], "ready");
  EXPECT_EQ(status()["summary"]["largest_force_N"], 0.0);
  EXPECT_EQ(stop(), 0);
}

TEST_F(Lifecycle, RequireNoneIsEnoughForSimulatedDevices) {
  start({.require = "none", .stiffness_N_m = 5'000});
  EXPECT_TRUE(reaches("enabled")) << hapticd_->err();
  EXPECT_EQ(stop(), 0);
}

TEST_F(Lifecycle, TheSocketCanBeNamedOnTheCommandLine) {
  socket_ = dir_.file("config.sock");
  write_config({});
  const std::string other = dir_.file("other.sock");
  start({}, {"--socket", other});
  socket_ = other;
  EXPECT_TRUE(reaches("enabled"));
  EXPECT_EQ(stop(), 0);
}

}  // namespace
}  // namespace hapticd::test
