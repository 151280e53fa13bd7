#include "daemon/summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <memory>

namespace hapticd::daemon {
namespace {

using testing::HasSubstr;

TEST(ThreadUse, IsReadBehindAnyThreadName) {
  const std::string stat = "7 (a) 9 ) odd) S 1 2 3 4 5 4194560 120 0 3 0 10 20 0 0";
  const std::string status =
      "Name:\ta\nvoluntary_ctxt_switches:\t55\nnonvoluntary_ctxt_switches:\t6\n";
  const auto use = parse_thread_use(stat, status);
  ASSERT_TRUE(use);
  EXPECT_EQ(use->minor_faults, 120u);
  EXPECT_EQ(use->major_faults, 3u);
  EXPECT_EQ(use->voluntary_switches, 55u);
  EXPECT_EQ(use->involuntary_switches, 6u);
}

TEST(ThreadUse, IsNotMadeUpWhereTheKernelDoesNotTell) {
  EXPECT_FALSE(parse_thread_use("", ""));
  EXPECT_FALSE(parse_thread_use("7 (a) S 1 2",
                                "voluntary_ctxt_switches: 1\nnonvoluntary_ctxt_switches: 1\n"));
  EXPECT_FALSE(parse_thread_use("7 (a) S 1 2 3 4 5 6 1 0 2", "Name: a\n"));
}

TEST(ThreadUse, OfALivingThreadIsKnown) {
  const auto use = read_thread_use(::gettid());
  ASSERT_TRUE(use);
  EXPECT_GT(use->minor_faults, 0u);
  EXPECT_FALSE(read_thread_use(0));
}

TEST(Summary, TakesWhatTheServoThreadCounted) {
  const auto counters = std::make_unique<ServoCounters>();
  counters->ticks = 1000;
  counters->missed_ticks = 4;
  counters->gaps = 2;
  counters->missed_by[static_cast<std::size_t>(Phase::collect)] = 4;
  counters->largest_force_N = 5.25;
  for (int i = 0; i < 1000; ++i) counters->times[0].add(10'000);
  Summary summary;
  take_counters(*counters, summary);
  EXPECT_EQ(summary.ticks, 1000u);
  EXPECT_NEAR(summary.times[0].p50_us, 10, 0.4);
  const std::string table = to_table(summary);
  EXPECT_THAT(table, HasSubstr("4 in 2 gaps (wake 0, collect 4, step 0, command 0)"));
  EXPECT_THAT(table, HasSubstr("5.250 N"));
}

TEST(Summary, SaysWhatIsNotAvailable) {
  const std::string table = to_table({});
  EXPECT_THAT(table, HasSubstr("times               not available"));
  EXPECT_THAT(table, HasSubstr("page faults and context switches not available"));
  EXPECT_THAT(table, HasSubstr("load average        not available"));
  const Json json = to_json({});
  EXPECT_TRUE(json["times_us"].is_null());
  EXPECT_TRUE(json["servo_thread"].is_null());
  EXPECT_TRUE(json["load_average"].is_null());
}

TEST(Summary, TellsEveryFaultWithItsCount) {
  Summary summary;
  summary.faults = {{Fault::velocity, 2, "left.x too fast", 1.5}};
  EXPECT_THAT(to_table(summary), HasSubstr("2 x velocity, last at 1.500 s: left.x too fast"));
  EXPECT_EQ(to_json(summary)["faults"][0]["count"], 2);
}

build::ProgramSpec one_device() {
  build::ProgramSpec spec;
  spec.devices = {{.axes = 2, .coordinates = 2}};
  spec.device_names = {"left"};
  spec.axis_names = {"left.x", "left.y"};
  return spec;
}

TEST(Summary, TellsEachDeviceAndHowOftenEachLimitBit) {
  LiveView live{.known = true, .homed = {true, false}, .work_J = {0.125}, .fade = {0.5}};
  live.limit_ticks[1] = 7;
  Summary summary;
  take_records(one_device(), live, summary);
  const std::string table = to_table(summary);
  EXPECT_THAT(table, HasSubstr("force in 7 ticks"));
  EXPECT_THAT(table, HasSubstr("did 0.125 J of work; fade 0.5; not homed: left.y"));
  const Json json = to_json(summary);
  EXPECT_EQ(json["limits"], (Json{{"force", 7}}));
  EXPECT_EQ(json["devices"][0]["work_J"], 0.125);
  EXPECT_EQ(json["devices"][0]["fade"], 0.5);
  EXPECT_EQ(json["devices"][0]["homed"], (Json{{"left.x", true}, {"left.y", false}}));
}

TEST(Summary, BeforeTheFirstRecordItKnowsNoDevice) {
  Summary summary;
  take_records(one_device(), {}, summary);
  EXPECT_TRUE(to_json(summary)["devices"].empty());
  EXPECT_THAT(to_table(summary), HasSubstr("limits              none"));
}

TEST(Summary, NamesForcesWithoutAProof) {
  Summary summary;
  summary.unproven = true;
  EXPECT_THAT(to_table(summary), HasSubstr("without a proof of stability"));
}

}  // namespace
}  // namespace hapticd::daemon
