// What is said of machines that are made up of files, and of times that were measured.
#include "daemon/doctor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace hapticd::daemon {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class DoctorTest : public testing::Test {
 protected:
  DoctorTest() {
    root_ =
        fs::temp_directory_path() / ("doctor" + std::to_string(::getpid()) + "-" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(root_);
  }
  ~DoctorTest() override { fs::remove_all(root_); }

  void put(const std::string& path, const std::string& text) {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text << '\n';
  }
  Finding about(const std::string& topic, const Rights& rights = {.root = true},
                int priority = 80) const {
    for (const Finding& one : examine(KernelFiles(root_), rights, priority))
      if (one.topic == topic) return one;
    ADD_FAILURE() << "nothing about " << topic;
    return {};
  }
  Severity severity(const std::string& topic, const Rights& rights = {.root = true}) const {
    return about(topic, rights).severity;
  }

  fs::path root_;
};

TEST_F(DoctorTest, KernelIsFitWhereItSaysRealtime) {
  put("proc/sys/kernel/osrelease", "6.1.0-9-amd64");
  EXPECT_EQ(severity("kernel"), Severity::warning);
  EXPECT_THAT(about("kernel").found, HasSubstr("6.1.0-9-amd64"));
  EXPECT_THAT(about("kernel").fix, HasSubstr("linux-image-rt"));
  put("sys/kernel/realtime", "1");
  EXPECT_EQ(severity("kernel"), Severity::good);
}

TEST_F(DoctorTest, RightsAreJudgedByTheLoopsPriority) {
  const Rights poor{.rtprio = 79, .memlock = 8 << 20, .rttime_us = 200'000};
  EXPECT_EQ(severity("real-time priority", poor), Severity::bad);
  EXPECT_THAT(about("real-time priority", poor).found, HasSubstr("up to 79, the loop wants 80"));
  EXPECT_EQ(about("real-time priority", poor, 79).severity, Severity::good);
  EXPECT_EQ(severity("locked memory", poor), Severity::warning);
  EXPECT_EQ(severity("real-time limit", poor), Severity::note);
  EXPECT_EQ(severity("real-time priority"), Severity::good);
  EXPECT_EQ(severity("locked memory"), Severity::good);
}

TEST_F(DoctorTest, AControlGroupWithoutRealTimeIsBad) {
  EXPECT_EQ(severity("RT group scheduling"), Severity::good);
  put("sys/fs/cgroup/cpu/system.slice/cpu.rt_runtime_us", "0");
  EXPECT_EQ(severity("RT group scheduling"), Severity::bad);
  put("sys/fs/cgroup/cpu/system.slice/cpu.rt_runtime_us", "950000");
  EXPECT_EQ(severity("RT group scheduling"), Severity::good);
}

TEST_F(DoctorTest, ThrottlingIsToldAsAShare) {
  put("proc/sys/kernel/sched_rt_period_us", "1000000");
  put("proc/sys/kernel/sched_rt_runtime_us", "950000");
  EXPECT_THAT(about("throttling").found, HasSubstr("95 %"));
  put("proc/sys/kernel/sched_rt_runtime_us", "-1");
  EXPECT_EQ(severity("throttling"), Severity::good);
}

TEST_F(DoctorTest, GovernorsOtherThanPerformanceAreNamed) {
  EXPECT_EQ(severity("clock governor"), Severity::good);
  put("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
  EXPECT_EQ(severity("clock governor"), Severity::good);
  put("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave");
  EXPECT_EQ(severity("clock governor"), Severity::warning);
  EXPECT_THAT(about("clock governor").found, HasSubstr("powersave"));
}

TEST_F(DoctorTest, DeepSleepMattersWhereItCannotBeHeldOff) {
  put("sys/devices/system/cpu/cpu0/cpuidle/state1/latency", "2");
  EXPECT_EQ(severity("sleep states", {}), Severity::good);
  put("sys/devices/system/cpu/cpu0/cpuidle/state3/latency", "200");
  put("sys/devices/system/cpu/cpu0/cpuidle/state3/name", "C6");
  EXPECT_EQ(severity("sleep states", {}), Severity::warning);
  EXPECT_THAT(about("sleep states", {}).found, HasSubstr("C6 takes 200 us"));
  EXPECT_EQ(severity("sleep states", {.dma_latency = true}), Severity::good);
  put("sys/devices/system/cpu/cpu0/cpuidle/state3/disable", "1");
  EXPECT_EQ(severity("sleep states", {}), Severity::good);
}

TEST_F(DoctorTest, InterruptThreadsOfBusesBelongBeforeTheLoop) {
  EXPECT_THAT(about("interrupt threads").found, HasSubstr("no threads"));
  // Field 40 counted as in proc(5), behind a name with a blank and a bracket.
  const auto thread = [this](const std::string& pid, const std::string& name, int priority) {
    put("proc/" + pid + "/comm", name);
    std::string stat = pid + " (" + name + ") x) S";
    for (int field = 4; field < 40; ++field) stat += " 7";
    put("proc/" + pid + "/stat", stat + " " + std::to_string(priority) + " 1 0");
  };
  thread("41", "irq/30-xhci_hcd", 85);
  thread("42", "irq/31-nvme0q0", 50);
  EXPECT_EQ(severity("interrupt threads"), Severity::good);
  thread("43", "irq/32-can0", 50);
  const Finding found = about("interrupt threads");
  EXPECT_EQ(found.severity, Severity::warning);
  EXPECT_THAT(found.found, HasSubstr("irq/32-can0 (pid 43) at 50"));
  EXPECT_THAT(found.fix, HasSubstr("chrt -f -p 85"));
}

TEST_F(DoctorTest, SleepyUsbDevicesAndLongCanQueuesAreNamed) {
  put("sys/bus/usb/devices/usb1/power/control", "auto");
  EXPECT_EQ(severity("USB autosuspend"), Severity::good);
  put("sys/bus/usb/devices/1-2/power/control", "auto");
  put("sys/bus/usb/devices/1-2/product", "FALCON HAPTIC");
  EXPECT_THAT(about("USB autosuspend").found, HasSubstr("1-2 FALCON HAPTIC"));
  put("sys/class/net/eth0/type", "1");
  put("sys/class/net/can0/type", "280");
  put("sys/class/net/can0/tx_queue_len", "10");
  put("sys/class/net/can0/operstate", "up");
  EXPECT_EQ(severity("CAN can0"), Severity::good);
  put("sys/class/net/can0/tx_queue_len", "1000");
  EXPECT_EQ(severity("CAN can0"), Severity::warning);
  put("sys/class/net/can0/operstate", "down");
  EXPECT_THAT(about("CAN can0").fix, HasSubstr("ip link set can0 up"));
}

LoopTimes quiet() {
  return {.seconds = 5,
          .ticks = 5000,
          .wake_p50_s = 10e-6,
          .wake_p999_s = 40e-6,
          .wake_max_s = 60e-6,
          .collect_p50_s = 100e-6,
          .collect_p999_s = 150e-6,
          .collect_max_s = 200e-6,
          .answer_p999_s = 20e-6,
          .devices = {{.name = "left",
                       .p50_s = 120e-6,
                       .p999_s = 180e-6,
                       .max_s = 250e-6,
                       .seen = true,
                       .latency_s = 0.2e-3}}};
}

std::vector<Severity> severities(const LoopTimes& times) {
  std::vector<Severity> all;
  for (const Finding& one : judge(times)) all.push_back(one.severity);
  return all;
}

TEST(DoctorJudges, LatencyCoversTheHostsShare) {
  using enum Severity;
  EXPECT_EQ(severities(quiet()), (std::vector{good, good, good}));
  LoopTimes times = quiet();
  times.devices[0].latency_s = 0.199e-3;
  const auto findings = judge(times);
  EXPECT_EQ(findings[2].severity, bad);
  EXPECT_THAT(findings[2].fix, HasSubstr("latency_s: 0.000200 or more for left"));
}

TEST(DoctorJudges, WhoAnswersEarlyWaitsForTheOthers) {
  LoopTimes times = quiet();
  const double alone = needed_latency_s(times, times.devices[0]);
  times.devices.push_back(times.devices[0]);
  EXPECT_DOUBLE_EQ(needed_latency_s(times, times.devices[0]), alone + times.collect_p999_s);
}

TEST(DoctorJudges, ASimulatedDeviceIsHeldAgainstItsOwnDelay) {
  LoopTimes times = quiet();
  times.devices[0].simulated = true;
  times.devices[0].latency_s = 0;
  EXPECT_EQ(judge(times)[2].severity, Severity::good);
  times.devices[0].simulated_delay_s = 0.5e-3;
  EXPECT_EQ(judge(times)[2].severity, Severity::bad);
  times.devices[0].latency_s = 0.5e-3;
  EXPECT_EQ(judge(times)[2].severity, Severity::good);
}

TEST(DoctorJudges, MissedTicksLateWakesAndSlowAnswersAreTold) {
  LoopTimes times = quiet();
  times.missed = 1;
  EXPECT_EQ(judge(times)[0].severity, Severity::warning);
  times = quiet();
  times.wake_p999_s = 101e-6;
  EXPECT_EQ(judge(times)[0].severity, Severity::warning);
  times = quiet();
  times.collect_p999_s = 501e-6;
  EXPECT_EQ(judge(times)[1].severity, Severity::bad);
  times = quiet();
  times.ticks = 0;
  EXPECT_EQ(judge(times)[0].severity, Severity::bad);
  times = quiet();
  times.devices[0].seen = false;
  EXPECT_THAT(judge(times)[2].found, HasSubstr("not one sample"));
}

}  // namespace
}  // namespace hapticd::daemon
