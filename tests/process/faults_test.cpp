// Devices that fail, a process that is starved, a disk that is full: forces go to zero, the process
// stays, people are told.
#include <fmt/format.h>
#include <signal.h>

#include <chrono>
#include <filesystem>

#include "control/core/fault.h"
#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using testing::HasSubstr;

struct DeviceFailure {
  const char* kind;
  const char* more;
  const char* fault;
};

class DeviceFailures : public DaemonTest, public testing::WithParamInterface<DeviceFailure> {};

TEST_P(DeviceFailures, EndForcesAndAreLeftByEnableOnceGone) {
  const DeviceFailure& failure = GetParam();
  start({.failures = fmt::format("{{kind: {}, at_s: 1, for_s: 0.5{}}}", failure.kind, failure.more),
         .stuck_s = "0.05"});
  ASSERT_TRUE(reaches("fault")) << hapticd_->err();
  const auto now = status();
  EXPECT_EQ(now["fault"]["name"], failure.fault);
  EXPECT_THAT(hapticd_->err(), HasSubstr("What to do:"));
  // As long as the cause stands enable fails, or the fault is back as soon as it can be seen again (a
  // stuck encoder: after stuck_s under force); once it is gone forces stay on.
  EXPECT_TRUE(eventually([&] { return ctl({"enable"}) == 0 && stays_enabled(300); })) << ctl_err_;
  ASSERT_EQ(stop(), 0);

  const auto recorded = recording();
  const daemon::Field* fault = recorded.find("fault");
  const daemon::Field* effort = recorded.find("left.x.effort");
  ASSERT_TRUE(fault != nullptr && effort != nullptr);
  std::size_t in_fault = 0;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (recorded.value(i, *fault) == 0) continue;
    ++in_fault;
    ASSERT_EQ(recorded.value(i, *effort), 0.0) << "record " << i;
  }
  EXPECT_GT(in_fault, 0u);
  EXPECT_FALSE(std::filesystem::is_empty(dir_.file("flight")));
}

INSTANTIATE_TEST_SUITE_P(Every, DeviceFailures,
                         testing::Values(DeviceFailure{"nan", "", "input_not_finite"},
                                         DeviceFailure{"stuck", "", "encoder_stuck"},
                                         DeviceFailure{"jump", ", size_m: 0.5", "encoder_jump"},
                                         DeviceFailure{"missing", "", "sample_missing"},
                                         DeviceFailure{"disarm", "", "disarmed"},
                                         DeviceFailure{"fault", "", "device"}),
                         [](const auto& tested) { return std::string(tested.param.kind); });

using Starved = DaemonTest;

TEST_F(Starved, StoppedForLongerThanTheLargestGapIsAFault) {
  start({.max_gap_ticks = 1000});
  ASSERT_TRUE(reaches("enabled"));
  hapticd_->signal(SIGSTOP);
  const auto stopped = std::chrono::steady_clock::now();
  eventually(
      [&] { return std::chrono::steady_clock::now() - stopped > std::chrono::milliseconds(2000); });
  hapticd_->signal(SIGCONT);
  ASSERT_TRUE(reaches("fault"));
  const auto now = status();
  EXPECT_EQ(now["fault"]["name"], "overrun");
  EXPECT_GT(now["fault"]["found"].get<double>(), 1000);
  EXPECT_EQ(now["fault"]["allowed"], 1000);
  EXPECT_GT(now["summary"]["missed_by"]["wake"].get<int>(), 1000);
  EXPECT_EQ(ctl({"enable"}), 0) << ctl_err_;
  EXPECT_EQ(stop(), 0);
}

TEST_F(Starved, ADeviceThatTakesTooLongIsBlamedByItsPhase) {
  start({.max_gap_ticks = 300, .failures = "{kind: slow, at_s: 0.5, for_s: 1}"});
  ASSERT_TRUE(reaches("fault"));
  const auto now = status();
  EXPECT_EQ(now["fault"]["name"], "overrun");
  EXPECT_GT(now["summary"]["missed_by"]["collect"].get<int>(), 300);
  EXPECT_GT(now["summary"]["overruns"].get<int>(), 0);
  EXPECT_EQ(stop(), 0);
}

TEST_F(Starved, TheKernelsCpuTimeWarningIsAFault) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  hapticd_->signal(SIGXCPU);
  ASSERT_TRUE(reaches("fault"));
  EXPECT_EQ(status()["fault"]["name"], "cpu_time");
  EXPECT_EQ(ctl({"enable"}), 0) << ctl_err_;
  EXPECT_EQ(stop(), 0);
}

TEST_F(Starved, ALoopThatNeverSleepsMeetsTheKernelsCpuTimeLimit) {
  start({.failures = "{kind: slow, at_s: 0.5, for_s: 1}"}, {},
        {"prlimit", "--rttime=100000:30000000"});
  ASSERT_TRUE(reaches("enabled")) << hapticd_->err();
  if (status()["summary"]["scheduling"] == "SCHED_OTHER") {
    GTEST_SKIP() << "the limit holds only for a thread that got SCHED_FIFO";
  }
  ASSERT_TRUE(reaches("fault"));
  EXPECT_EQ(status()["fault"]["name"], "cpu_time");
  EXPECT_EQ(stop(), 0);
}

using FullDisk = DaemonTest;

/// A file size limit makes write() fail as a full disk does, with EFBIG for ENOSPC, and needs no
/// rights.
TEST_F(FullDisk, FlightRecordingFailsAloudAndTheDaemonGoesOn) {
  start({.record = false}, {}, {"prlimit", "--fsize=32768"});
  ASSERT_TRUE(reaches("enabled")) << hapticd_->err();
  // Enough records for a file that is larger than the limit.
  ASSERT_TRUE(passes_tick(1000)) << hapticd_->err();
  ASSERT_EQ(ctl({"estop"}), 0);
  EXPECT_TRUE(logs("File too large")) << hapticd_->err();
  EXPECT_EQ(ctl({"enable"}), 0) << ctl_err_;
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

TEST_F(FullDisk, AFullRecordingFailsAloudAndKeepsWhatItHas) {
  start({}, {}, {"prlimit", "--fsize=65536"});
  EXPECT_TRUE(logs("File too large")) << hapticd_->err();
  EXPECT_TRUE(reaches("enabled"));
  EXPECT_EQ(stop(), 0);
  EXPECT_GT(recording().size(), 10u);
}

TEST_F(FullDisk, AFullFileSystemIsNamedSo) {
  const std::string mount = dir_.file("tiny");
  std::filesystem::create_directory(mount);
  Process mounting({"mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", mount}, dir_.file("mount"));
  if (mounting.wait() != 0) GTEST_SKIP() << "no right to mount a file system: " << mounting.err();
  start({.flight_dir = mount, .record = false});
  EXPECT_TRUE(reaches("enabled"));
  EXPECT_TRUE(passes_tick(1000));
  EXPECT_EQ(ctl({"estop"}), 0);
  EXPECT_TRUE(logs("No space left on device")) << hapticd_->err();
  EXPECT_EQ(stop(), 0);
  EXPECT_EQ(Process({"umount", mount}, dir_.file("umount")).wait(), 0);
}

TEST_F(FullDisk, WithoutAPlaceForRecordingsTheLoopStillRuns) {
  start({.flight_dir = "/proc/none", .record = false});
  ASSERT_TRUE(reaches("enabled")) << hapticd_->err();
  EXPECT_EQ(stop(), 0);
}

}  // namespace
}  // namespace hapticd::test
