// SIGHUP and `hapticctl reload`.
#include <signal.h>

#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

using Reload = DaemonTest;

TEST_F(Reload, ASofterWallIsAdoptedWhileEnabled) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  const auto before = status()["config"]["digest"];
  write_config({.stiffness_N_m = 500});
  EXPECT_EQ(ctl({"reload"}), 0) << ctl_err_;
  EXPECT_TRUE(logs("the loop runs on the new config"));
  const auto now = status();
  EXPECT_NE(now["config"]["digest"], before);
  EXPECT_EQ(now["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

TEST_F(Reload, SighupDoesTheSame) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  write_config({.stiffness_N_m = 500});
  hapticd_->signal(SIGHUP);
  EXPECT_TRUE(logs("the loop runs on the new config"));
  EXPECT_EQ(stop(), 0);
}

TEST_F(Reload, ManyInARowLoseNothing) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  for (int i = 0; i < 20; ++i) {
    write_config({.stiffness_N_m = 500 + 10.0 * i});
    const bool adopted = eventually([&] {
      const int code = ctl({"reload"});
      return code != 75;  // the one before is still under way
    });
    ASSERT_TRUE(adopted);
    ASSERT_EQ(ctl_err_, "");
  }
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

TEST_F(Reload, AConfigThatDoesNotCompileLeavesTheOldOneRunning) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  const auto before = status()["config"]["digest"];
  write_file("config.yaml", "version: 1\nlop: {rate_Hz: 1000}\n");
  EXPECT_EQ(ctl({"reload"}), 65);
  EXPECT_THAT(ctl_err_, AllOf(HasSubstr("lop"), HasSubstr("devices"), HasSubstr("config.yaml:2")));
  EXPECT_EQ(status()["config"]["digest"], before);
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

TEST_F(Reload, AChangedRateIsRefusedNamingTheKey) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  write_config({.rate_Hz = 500});
  EXPECT_EQ(ctl({"reload"}), 1);
  EXPECT_THAT(ctl_err_, AllOf(HasSubstr("loop.rate_Hz"), HasSubstr("disable first")));
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

TEST_F(Reload, AnUnprovedSceneIsRefusedWhileForcesAreOnAndKeptOffAfterwards) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  write_config({.stiffness_N_m = 50'000});
  EXPECT_EQ(ctl({"reload"}), 1);
  EXPECT_THAT(ctl_err_, AllOf(HasSubstr("disable first"), HasSubstr("left: not proved")));
  EXPECT_EQ(ctl({"disable"}), 0);
  ASSERT_TRUE(reaches("ready"));
  EXPECT_EQ(ctl({"reload"}), 0) << ctl_err_;
  EXPECT_EQ(ctl({"enable"}), 1);
  EXPECT_EQ(stop(), 0);
}

/// Springs at the ends of the travel are a term of force, so records are longer from then on.
TEST_F(Reload, ANewTermOfForceIsAdoptedWhileEnabledAndRecordedFromThenOn) {
  start({});
  ASSERT_TRUE(presses()) << hapticd_->err();
  write_config(
      {.axis = "        travel: {min_m: -1, max_m: 1, stiffness_N_m: 10, margin_m: 0.1}\n"});
  ASSERT_EQ(ctl({"reload"}), 0) << ctl_err_;
  ASSERT_TRUE(logs("the loop runs on the new config")) << hapticd_->err();
  ASSERT_TRUE(stays_enabled(300));
  ASSERT_EQ(ctl({"estop"}), 0);
  ASSERT_TRUE(logs("flight recording:")) << hapticd_->err();
  ASSERT_EQ(stop(), 0);

  const auto before = recording();
  EXPECT_EQ(before.find("left.x.travel"), nullptr);
  const auto after = daemon::read_recording(flight(dir_.file("flight"))).value();
  ASSERT_NE(after.find("left.x.travel"), nullptr);
  ASSERT_GT(after.size(), 200u);
  for (const daemon::Recording* file : {&before, &after}) {
    const daemon::Field* sequence = file->find("sequence");
    for (std::size_t i = 1; i < file->size(); ++i)
      ASSERT_EQ(file->value(i, *sequence), file->value(i - 1, *sequence) + 1) << i;
  }
  EXPECT_GT(after.value(0, *after.find("sequence")),
            before.value(before.size() - 1, *before.find("sequence")));
}

TEST_F(Reload, AChangedReferenceOfAnAxisIsRefused) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  write_config({.axis = "        homing: {by: device}\n"});
  EXPECT_EQ(ctl({"reload"}), 1);
  EXPECT_THAT(ctl_err_, AllOf(HasSubstr("axes[0].homing"), HasSubstr("disable first")));
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

TEST_F(Reload, AnotherFlightDirectoryIsUsedFromThenOn) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  write_config({.flight_dir = dir_.file("elsewhere")});
  ASSERT_EQ(ctl({"reload"}), 0) << ctl_err_;
  ASSERT_EQ(ctl({"estop"}), 0);
  EXPECT_TRUE(logs(dir_.file("elsewhere") + "/flight-")) << hapticd_->err();
  EXPECT_EQ(stop(), 0);
}

}  // namespace
}  // namespace hapticd::test
