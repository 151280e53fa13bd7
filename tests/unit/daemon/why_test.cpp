#include "daemon/why.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>

#include "daemon/ctl_why.h"
#include "tests/unit/daemon/recording_fixture.h"

namespace hapticd::daemon {
namespace {

using control::Mode;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A recording made record by record; fields are set by their names in the header.
class WhyTest : public RecordingTest {
 protected:
  WhyTest() { recording_.header = header(); }

  /// Appends the record of the next tick; what a test does not set is 0, the mode is enabled.
  std::size_t add(Fault fault = Fault::none) {
    const auto i = static_cast<std::uint32_t>(recording_.size());
    const auto bytes = record(i, fault);
    recording_.data.insert(recording_.data.end(), bytes.begin(), bytes.end());
    put(i, "mode", static_cast<std::uint8_t>(fault == Fault::none ? Mode::enabled : Mode::fault));
    put(i, "fault_axis", kNoIndex);
    put(i, "fault_device", kNoIndex);
    return i;
  }
  template <class T>
  void put(std::size_t i, const std::string& name, T value) {
    const Field* field = recording_.find(name);
    ASSERT_NE(field, nullptr) << name;
    ASSERT_EQ(field_bytes(field->type), sizeof value) << name;
    std::memcpy(recording_.data.data() + i * recording_.header.record_bytes + field->offset, &value,
                sizeof value);
  }
  /// `n` healthy ticks, then one in which left.y is too fast.
  std::size_t fail_after(int n) {
    for (int i = 0; i < n; ++i) add();
    const std::size_t onset = add(Fault::velocity);
    put(onset, "fault_axis", std::uint16_t{1});
    put(onset, "fault_found", 2.5);
    put(onset, "fault_allowed", 1.5);
    return onset;
  }
  FaultStory story() {
    const auto told = why(recording_);
    EXPECT_TRUE(told && told->fault);
    return told && told->fault ? *told->fault : FaultStory{};
  }
  std::string text() { return why_text(why(recording_).value()); }

  Recording recording_;
};

const Term* find(const std::vector<Term>& terms, std::string_view key) {
  for (const Term& term : terms) {
    if (term.key == key) return &term;
  }
  return nullptr;
}

TEST_F(WhyTest, NamesTheFaultTheAxisTheFiguresAndWhatToDo) {
  fail_after(3);
  const FaultStory fault = story();
  EXPECT_EQ(fault.axis, "left.y");
  EXPECT_EQ(fault.device, "left");
  EXPECT_EQ(fault.unit, "m/s");
  EXPECT_THAT(text(), AllOf(HasSubstr("fault velocity: an axis moved faster than "
                                      "guard.max_velocity; axis left.y: found 2.5 m/s, allowed "
                                      "1.5 m/s (set by: guard)"),
                            HasSubstr("what to do: let the device come to rest")));
}

TEST_F(WhyTest, ARotaryAxisHasItsOwnUnits) {
  for (Field& field : recording_.header.fields) {
    if (field.name == "left.y.q") field.unit = "rad";
    if (field.name == "left.y.effort") field.unit = "N*m";
  }
  const std::size_t onset = fail_after(1);
  put(onset - 1, "left.y.effort", 0.25);
  EXPECT_THAT(text(),
              AllOf(HasSubstr("found 2.5 rad/s"), HasSubstr("asked of the device 0.25 N m")));
}

TEST_F(WhyTest, TellsWhenItWasInTicksAndBeforeTheEnd) {
  const std::size_t onset = fail_after(7);
  put(onset, "time_ns", std::int64_t{12'345'678'000});
  for (int i = 0; i < 4; ++i) {
    put(add(Fault::velocity), "fault_axis", std::uint16_t{1});
    put(recording_.size() - 1, "fault_found", 2.5);
  }
  const FaultStory fault = story();
  EXPECT_EQ(fault.tick, 7);
  EXPECT_DOUBLE_EQ(fault.clock_s, 12.345678);
  EXPECT_DOUBLE_EQ(fault.before_end_s, 0.004);
  EXPECT_FALSE(fault.left_after_s);
  EXPECT_THAT(text(), HasSubstr("it stood until the end"));
  add();
  EXPECT_DOUBLE_EQ(story().left_after_s.value_or(-1), 0.005);
}

TEST_F(WhyTest, TellsTheLastOfSeveralFaults) {
  fail_after(3);
  for (int i = 0; i < 3; ++i) add();
  const std::size_t last = add(Fault::disarmed);
  put(last, "fault_device", std::uint16_t{1});
  const FaultStory fault = story();
  EXPECT_EQ(fault.row->code, Fault::disarmed);
  EXPECT_EQ(fault.device, "right");
  EXPECT_EQ(fault.earlier, 1u);
  EXPECT_EQ(fault.unit, "");
  EXPECT_THAT(text(), AllOf(HasSubstr("device right"), Not(HasSubstr("found"))));
}

TEST_F(WhyTest, AFaultWhoseFigureIsNotANumberIsOneFault) {
  for (int i = 0; i < 3; ++i) {
    const std::size_t at = add(Fault::input_not_finite);
    put(at, "fault_found", std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_EQ(story().earlier, 0u);
  EXPECT_EQ(story().tick, 0);
}

TEST_F(WhyTest, SaysForHowLongForcesWereOn) {
  for (int i = 0; i < 4; ++i) put(add(), "mode", static_cast<std::uint8_t>(Mode::idle));
  const std::size_t onset = fail_after(6);
  put(onset - 1, "flags", std::uint8_t{4});
  put(onset - 1, "ramp", 0.75);
  const FaultStory fault = story();
  EXPECT_EQ(fault.mode, "enabled");
  EXPECT_DOUBLE_EQ(fault.mode_s, 0.006);
  EXPECT_FALSE(fault.mode_from_start);
  EXPECT_TRUE(fault.unproven);
  EXPECT_EQ(fault.ramp, 0.75);
}

TEST_F(WhyTest, CountsEachLimitAndSaysFromWhenToWhen) {
  const std::size_t onset = fail_after(10);
  const auto limits = static_cast<std::uint32_t>(Limit::slew);
  for (const std::size_t i : {std::size_t{2}, std::size_t{3}, std::size_t{7}})
    put(i, "limits", limits);
  put(onset, "limits", static_cast<std::uint32_t>(Limit::power));
  const std::vector<LimitStory> told = story().limits.value();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].name, "slew");
  EXPECT_EQ(told[0].ticks, 3u);
  EXPECT_DOUBLE_EQ(told[0].first_s, 0.008);
  EXPECT_DOUBLE_EQ(told[0].last_s, 0.003);
  EXPECT_FALSE(told[0].at_fault);
  EXPECT_EQ(told[1].name, "power");
  EXPECT_EQ(told[1].ticks, 0u);
  EXPECT_TRUE(told[1].at_fault);
  EXPECT_THAT(text(), AllOf(HasSubstr("limit slew: in 3 of the 10 ticks before, from 0.008 s to "
                                      "0.003 s before the fault"),
                            HasSubstr("limit power: only in the tick of the fault")));
}

TEST_F(WhyTest, ForgetsWhatIsOlderThanASecond) {
  const std::size_t onset = fail_after(1500);
  put(499, "limits", static_cast<std::uint32_t>(Limit::force));
  EXPECT_THAT(story().limits.value(), IsEmpty());
  EXPECT_EQ(story().story_ticks, 1000u);
  put(500, "limits", static_cast<std::uint32_t>(Limit::force));
  const std::vector<LimitStory> told = story().limits.value();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_DOUBLE_EQ(told[0].first_s, 1.0);
  EXPECT_EQ(onset, 1500u);
}

TEST_F(WhyTest, BlamesThePhaseThatPassedTheEndOfItsPeriod) {
  const std::size_t onset = fail_after(4);
  put(onset - 1, "wake_ns", 100'000);
  put(onset - 1, "collect_ns", 5'200'000);
  put(onset, "tick", std::int64_t{9});
  put(onset, "missed_ticks", std::int64_t{5});
  put(2, "missed_ticks", std::int64_t{1});
  put(2, "wake_ns", 50'000);
  const MissedStory missed = story().missed.value();
  EXPECT_EQ(missed.ticks, 6);
  EXPECT_EQ(missed.gaps, 2);
  EXPECT_EQ(missed.by[static_cast<std::size_t>(Phase::collect)], 5);
  EXPECT_EQ(missed.by[static_cast<std::size_t>(Phase::wake)], 1);
  EXPECT_EQ(missed.late, Phase::collect);
  EXPECT_DOUBLE_EQ(missed.late_ms, 5.2);
  EXPECT_THAT(text(), HasSubstr("6 ticks missed in 2 gaps (late: wake 1, collect 5); the largest, "
                                "5 ticks, 0.000 s before the fault: collect took 5.200 ms"));
}

TEST_F(WhyTest, ALateWakeUpIsLateByWhatItMissed) {
  const std::size_t onset = fail_after(4);
  put(onset, "missed_ticks", std::int64_t{5});
  put(onset, "wake_ns", 250'000);
  const MissedStory missed = story().missed.value();
  EXPECT_EQ(missed.late, Phase::wake);
  EXPECT_DOUBLE_EQ(missed.late_ms, 5.25);
}

TEST_F(WhyTest, TellsTheForcesOfTheBlamedDeviceJustBefore) {
  const std::size_t onset = fail_after(3);
  put(onset - 1, "left.y.scene_force", -4.0);
  put(onset - 1, "left.y.limited", -1.0);
  put(onset - 1, "left.y.force", -3.0);
  put(onset - 1, "left.y.effort", -3.25);
  put(onset, "left.y.delivered", -3.2);
  put(onset - 2, "left.y.qd", -1.75);
  put(onset - 1, "left.y.qd", -1.25);
  put(onset, "left.y.qd", 500.0);
  const FaultStory fault = story();
  ASSERT_EQ(fault.devices.size(), 1u);
  const DeviceStory& left = fault.devices[0];
  ASSERT_EQ(left.axes.size(), 2u);
  const auto value = [](const std::vector<Term>& terms, std::string_view key) {
    const Term* term = find(terms, key);
    return term == nullptr ? std::nan("") : term->value;
  };
  EXPECT_EQ(value(left.coordinates[1].terms, "scene_force"), -4.0);
  EXPECT_EQ(value(left.coordinates[1].terms, "limited"), -1.0);
  EXPECT_EQ(value(left.coordinates[1].terms, "force"), -3.0);
  EXPECT_EQ(value(left.axes[1].terms, "effort"), -3.25);
  EXPECT_EQ(value(left.axes[1].terms, "delivered"), -3.2);
  EXPECT_EQ(value(left.axes[1].terms, "qd"), -1.25);
  EXPECT_EQ(value(left.axes[1].terms, "largest_speed"), 1.75);
  EXPECT_EQ(find(left.axes[1].terms, "observer"), nullptr) << "this plan has none";
}

TEST_F(WhyTest, NothingIsToldAsDeliveredWhenTheRecordBetweenIsLost) {
  const std::size_t onset = fail_after(3);
  put(onset, "sequence", std::uint32_t{9});
  const FaultStory fault = story();
  EXPECT_EQ(find(fault.devices[0].axes[1].terms, "delivered"), nullptr);
  EXPECT_EQ(fault.lost, 6u);
}

TEST_F(WhyTest, TellsTheOldestSampleAndTicksWithoutOne) {
  const std::size_t onset = fail_after(5);
  for (std::size_t i = 0; i <= onset; ++i)
    put(i, "left.y.freshness", static_cast<std::uint8_t>(Freshness::fresh));
  put(onset, "left.y.freshness", static_cast<std::uint8_t>(Freshness::repeated));
  put(2, "left.y.age_ns", std::int64_t{350'000});
  const std::vector<Term> terms = story().devices[0].axes[1].terms;
  EXPECT_DOUBLE_EQ(find(terms, "oldest_sample_ms")->value, 0.35);
  EXPECT_EQ(find(terms, "ticks_without_sample")->value, 1);
}

TEST_F(WhyTest, TellsTheEnergyThatWasBooked) {
  const std::size_t onset = fail_after(5);
  put(0, "left.work", 0.5);
  put(onset - 1, "left.work", 0.75);
  put(onset, "left.work", 9.0);  // of a position that may be wrong
  const std::vector<Term> terms = story().devices[0].terms;
  EXPECT_EQ(find(terms, "work")->value, 0.75);
  EXPECT_EQ(find(terms, "recent_work")->value, 0.25);
  EXPECT_EQ(find(terms, "work")->unit, "J");
}

TEST_F(WhyTest, WhereNobodyIsToBlameEveryDeviceIsTold) {
  add();
  add(Fault::estop);
  EXPECT_EQ(story().devices.size(), 2u);
}

TEST_F(WhyTest, ARecordingThatBeginsWithItsFaultSaysSo) {
  add(Fault::overrun);
  EXPECT_THAT(story().devices, IsEmpty());
  EXPECT_THAT(text(), HasSubstr("nothing from before the fault"));
}

TEST_F(WhyTest, AFaultOfANewerProgramIsNumberedNotInvented) {
  add();
  const std::size_t onset = add();
  put(onset, "fault", std::uint8_t{200});
  EXPECT_EQ(story().row, nullptr);
  EXPECT_THAT(text(), HasSubstr("fault number 200"));
  EXPECT_TRUE(why_json(why(recording_).value())["fault"]["name"].is_null());
}

TEST_F(WhyTest, WithoutAFaultItTellsTheLargestForceAndSpeed) {
  for (int i = 0; i < 10; ++i) add();
  put(4, "left.x.force", 3.0);
  put(4, "left.y.force", -4.0);
  put(6, "right.x.qd", -0.5);
  put(3, "limits", static_cast<std::uint32_t>(Limit::ramp));
  EXPECT_THAT(text(), AllOf(HasSubstr("no fault in this recording"),
                            HasSubstr("largest force of left: 5 N, 0.005 s before the end"),
                            HasSubstr("largest speed of right.x: 0.5 m/s, 0.003 s"),
                            HasSubstr("limit ramp: 1 tick"), HasSubstr("0 ticks missed")));
  EXPECT_TRUE(why_json(why(recording_).value())["fault"].is_null());
}

TEST_F(WhyTest, AnOlderFileTellsWhatItHas) {
  fail_after(3);
  std::erase_if(recording_.header.fields, [](const Field& field) {
    const std::string_view name = field.name;
    return name.ends_with(".limited") || name.ends_with(".work") || name.ends_with(".fade") ||
           name == "mode" || name == "missed_ticks" || name == "sequence" || name == "limits";
  });
  const FaultStory fault = story();
  EXPECT_FALSE(fault.missed);
  EXPECT_FALSE(fault.limits);
  EXPECT_EQ(fault.mode, "");
  EXPECT_THAT(fault.devices[0].terms, IsEmpty());
  EXPECT_NE(find(fault.devices[0].coordinates[0].terms, "scene_force"), nullptr);
  EXPECT_THAT(text(), AllOf(HasSubstr("left.y: found 2.5"), Not(HasSubstr("missed")),
                            Not(HasSubstr("limit"))));
}

TEST_F(WhyTest, AnotherProgramsRecordingIsRefusedByTheFieldItLacks) {
  std::erase_if(recording_.header.fields, [](const Field& f) { return f.name == "fault"; });
  const auto told = why(recording_);
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().code, ExitCode::bad_data);
  EXPECT_THAT(told.error().text, HasSubstr("no field 'fault'"));
}

TEST_F(WhyTest, AnEmptyRecordingIsNoFault) {
  EXPECT_THAT(text(), HasSubstr("the recording is empty"));
}

TEST_F(WhyTest, ATornRecordingSaysSo) {
  add();
  recording_.torn_bytes = 5;
  EXPECT_THAT(text(), HasSubstr("its last 5 bytes are no whole record"));
}

TEST_F(WhyTest, EveryFaultOfTheTableIsTold) {
  for (const FaultEntry& row : fault_table().subspan(1)) {
    recording_.data.clear();
    add();
    add(row.code);
    EXPECT_THAT(text(), AllOf(HasSubstr(std::string(row.meaning)),
                              HasSubstr("what to do: " + std::string(row.action))));
  }
}

}  // namespace
}  // namespace hapticd::daemon
