// `hapticctl why`: what people are told of a fault that was provoked.
#include <fmt/format.h>

#include <filesystem>

#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Why : public DaemonTest {
 protected:
  /// Simulates two seconds with a failure in them; the recording's path.
  std::string simulate(const std::string& failure) {
    write_config({.failures = failure});
    const std::string file = dir_.file("a.hapticrec");
    EXPECT_EQ(ctl({"simulate", config_, "--duration", "2", "-o", file}), failure.empty() ? 0 : 1)
        << ctl_err_;
    return file;
  }
};

TEST_F(Why, AnEncoderJumpIsToldWithItsAxisItsFiguresAndWhatToDo) {
  const std::string file = simulate("{kind: jump, at_s: 1, for_s: 0.5, size_m: 0.5}");
  ASSERT_EQ(ctl({"why", file}), 0) << ctl_err_;
  EXPECT_THAT(
      ctl_out_,
      AllOf(HasSubstr("fault encoder_jump: an axis moved further in one tick"),
            HasSubstr("axis left.x: found 0.5 m, allowed 0.015 m"),
            HasSubstr("what to do: check encoder cable"), HasSubstr("when: tick 1000"),
            HasSubstr("0.999 s before the end of the recording"), HasSubstr("no tick was missed")));
  // The hand has been in the wall for half a second: the sentence about its force is that of the tick
  // before.
  const auto recording = daemon::read_recording(file).value();
  const double scene = recording.value(999, *recording.find("left.x.scene_force"));
  EXPECT_GT(scene, 1);
  EXPECT_THAT(ctl_out_, HasSubstr(fmt::format("scene {:.4g} N", scene)));
}

TEST_F(Why, ASpeedBeyondTheLimitIsToldAsASpeed) {
  const std::string file = simulate("{kind: jump, at_s: 1, for_s: 0.5, size_m: 0.01}");
  ASSERT_EQ(ctl({"why", file, "--json"}), 0) << ctl_err_;
  const auto json = daemon::Json::parse(ctl_out_, nullptr, false);
  ASSERT_TRUE(json.is_object()) << ctl_out_;
  const auto& fault = json["fault"];
  EXPECT_EQ(fault["name"], "velocity");
  EXPECT_EQ(fault["axis"], "left.x");
  EXPECT_EQ(fault["unit"], "m/s");
  EXPECT_NEAR(fault["found"].get<double>(), 10, 0.2);
  EXPECT_EQ(fault["allowed"], 1.5);
  EXPECT_EQ(fault["mode"], "enabled");
  EXPECT_EQ(fault["devices"]["left"]["device"]["work"]["unit"], "J");
}

TEST_F(Why, ACalmRecordingSaysSoAndExitsZero) {
  const std::string file = simulate("");
  EXPECT_EQ(ctl({"why", file}), 0) << ctl_err_;
  EXPECT_THAT(ctl_out_, AllOf(HasSubstr("no fault in this recording"),
                              HasSubstr("largest force of left"), Not(HasSubstr("what to do"))));
}

TEST_F(Why, AFileThatIsNoRecordingOrNotThereIsRefused) {
  write_config({});
  EXPECT_EQ(ctl({"why", config_}), 65);
  EXPECT_THAT(ctl_err_, HasSubstr("is not a hapticd recording"));
  EXPECT_EQ(ctl({"why", dir_.file("none")}), 66);
  EXPECT_EQ(ctl({"why"}), 64);
}

TEST_F(Why, ATornRecordingIsToldUpToItsLastWholeRecord) {
  const std::string file = simulate("{kind: nan, at_s: 1}");
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 3);
  EXPECT_EQ(ctl({"why", file}), 0) << ctl_err_;
  EXPECT_THAT(ctl_out_, AllOf(HasSubstr("cut short"), HasSubstr("fault input_not_finite")));
}

TEST_F(Why, AFlightRecordingOfTheDaemonTellsItsFault) {
  start({});
  ASSERT_TRUE(presses()) << hapticd_->err();
  ASSERT_EQ(ctl({"estop"}), 0);
  ASSERT_TRUE(logs("flight recording:")) << hapticd_->err();
  ASSERT_EQ(stop(), 0);
  ASSERT_EQ(ctl({"why", flight(dir_.file("flight"))}), 0) << ctl_err_;
  EXPECT_THAT(ctl_out_, AllOf(HasSubstr("fault estop: emergency stop was asked for"),
                              HasSubstr("the loop was in mode enabled"),
                              HasSubstr("device left just before the fault")));
}

}  // namespace
}  // namespace hapticd::test
