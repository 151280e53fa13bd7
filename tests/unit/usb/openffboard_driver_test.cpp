// What is sent, and therefore pulls: until when, and what no report may do.
#include <random>

#include "tests/unit/usb/openffboard_rig.h"

namespace hapticd::hid {
namespace {

using namespace test;

TEST(OpenFfboardDriver, PullsTheAxisThatIsMeantTheWayThatIsMeant) {
  for (const double sign : {1.0, -1.0}) {
    BoardRig rig({.axes = 2}, board_options(2, sign * 65536 * 360 / 900));
    ASSERT_TRUE(rig.open());
    rig.arm();
    const auto way = static_cast<int>(sign);
    rig.ticks(10, true, {2, 0});
    EXPECT_EQ(rig.board.torque(0), way * kHalf);
    EXPECT_EQ(rig.board.torque(1), 0);
    rig.ticks(10, true, {0, -2});
    EXPECT_EQ(rig.board.torque(0), 0);
    EXPECT_EQ(rig.board.torque(1), -way * kHalf);
  }
}

TEST(OpenFfboardDriver, OneAxisOfABoardWithTwoPullsToo) {
  BoardRig rig({.axes = 2}, board_options(1));
  ASSERT_TRUE(rig.open()) << rig.why();
  rig.arm();
  rig.ticks(10, true, {2, 0});
  EXPECT_EQ(rig.board.torque(0), kHalf);
  EXPECT_EQ(rig.board.torque(1), 0);
}

TEST(OpenFfboardDriver, CarriesWhatTheBoardGets) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  rig.arm();
  for (const double effort_Nm : {0.0, 1e-5, -1.2345, 3.999999, 4.0, -4.0, 7.0}) {
    rig.ticks(5, true, {effort_Nm, 0});
    EXPECT_NEAR(rig.protocol->carried(0, effort_Nm), rig.board.torque(0) * kFull_Nm / 32767, 1e-12);
    EXPECT_LE(std::abs(rig.protocol->carried(0, effort_Nm) - std::clamp(effort_Nm, -4.0, 4.0)),
              0.5 * kFull_Nm / 32767 * (1 + 1e-9));
  }
}

TEST(OpenFfboardDriver, AForceComesOnlyOnceTheBoardSaysThatItIsOn) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  rig.wait_for_position();
  rig.board.log.clear();
  rig.board.every_frame = [&] {
    if (!rig.reading.armed) {
      EXPECT_EQ(rig.board.torque(0), 0);
    }
  };
  rig.ticks(40, true, {2, 0});
  EXPECT_TRUE(rig.reading.armed);
  EXPECT_EQ(rig.board.torque(0), kHalf);
  EXPECT_LT(rig.first("05010000"), rig.first("0a0101")) << "magnitude 0, then the start";
  EXPECT_LT(rig.first("0c01"), rig.first("0a0101"));
}

TEST(OpenFfboardDriver, WithoutAnyConfirmationThereIsNoForce) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  rig.wait_for_position();
  rig.board.mute = rig.board.stateless = true;
  rig.board.every_frame = [&] { EXPECT_EQ(rig.board.torque(0), 0); };
  rig.ticks(80, true, {2, 0});
  EXPECT_FALSE(rig.reading.armed);
  rig.board.every_frame = [] {};
  rig.board.mute = rig.board.stateless = false;
  rig.ticks(20, true, {2, 0});
  EXPECT_TRUE(rig.reading.armed);
  EXPECT_EQ(rig.board.torque(0), kHalf);
}

TEST(OpenFfboardDriver, AnswersFromBeforeItWasSwitchedOnMeanNothing) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  rig.wait_for_position();
  rig.board.answer_delay_ns = 20 * kFrame_ns;
  rig.ticks(60, false);
  rig.ticks(60, true, {2, 0});
  EXPECT_EQ(rig.faults, 0) << rig.protocol->fault_text();
  EXPECT_TRUE(rig.reading.armed);
}

TEST(OpenFfboardDriver, TheForceHasNoGapAndNoKick) {
  for (const std::size_t axes : {1U, 2U}) {
    BoardRig rig({.axes = static_cast<int>(axes)}, board_options(axes));
    ASSERT_TRUE(rig.open());
    rig.arm();
    rig.ticks(10, true, {2, 2});
    rig.board.log.clear();
    int frames = 0;
    rig.board.every_frame = [&] {
      ++frames;
      for (std::size_t i = 0; i < axes; ++i)
        EXPECT_EQ(rig.board.torque(static_cast<int>(i)), kHalf);
    };
    rig.ticks(3000, true, {2, 2});
    EXPECT_GE(frames, 3000);
    std::int64_t longest_ns = 0, last_ns = rig.board.log.front().at_ns;
    for (const auto& sent : rig.board.log) {
      if (!usb::hex(sent.report).starts_with("0a0101")) continue;
      longest_ns = std::max(longest_ns, sent.at_ns - last_ns);
      last_ns = sent.at_ns;
    }
    EXPECT_GT(last_ns, rig.board.now_ns - 40 * kFrame_ns);
    EXPECT_LE(longest_ns, 37 * kFrame_ns) << "a third of the effect's time, and a report";
    EXPECT_EQ(rig.count("0a0101ff"), 0);
  }
}

TEST(OpenFfboardDriver, WhatCountsIsNeverReplaced) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> effort(-4, 4);
  BoardRig rig({.axes = 2}, board_options(2));
  ASSERT_TRUE(rig.open());
  rig.arm();
  for (int i = 0; i < 3000; ++i) {
    rig.board.position[0] = i % 3 == 0 ? i : 0;
    rig.tick(i % 701 < 650, {effort(random), effort(random)});
    if (random() % 4 == 0) rig.protocol->tell({.armed = true}, rig.board.now_ns);
  }
  EXPECT_GT(rig.count("05"), 1000);
  for (const Report& report : rig.board.replaced) EXPECT_EQ(report[0], 0x05);
}

TEST(OpenFfboardDriver, NeitherAxisWaitsForTheOther) {
  BoardRig rig({.axes = 2}, board_options(2));
  ASSERT_TRUE(rig.open());
  rig.arm();
  int behind = 0;
  for (int i = 0; i < 400; ++i) {
    rig.board.position[0] = i;
    const double first = 4.0 * (i % 7) / 7, second = i < 200 ? 0.001 : 2;
    rig.tick(true, {first, second});
    behind = i < 200 || rig.board.torque(1) == kHalf ? 0 : behind + 1;
    ASSERT_LE(behind, 5) << i;
  }
}

TEST(OpenFfboardDriver, ForcesDoNotWaitForSlowAnswers) {
  BoardRig rig({.axes = 2}, board_options(2));
  ASSERT_TRUE(rig.open());
  rig.arm();
  rig.board.answer_delay_ns = 15 * kFrame_ns;
  int behind = 0;
  for (int i = 0; i < 300; ++i) {
    const double second = i % 20 < 10 ? 1 : -1;
    rig.tick(true, {0.01 * i, second});
    behind = rig.board.torque(1) * second > 0 ? 0 : behind + 1;
    ASSERT_LE(behind, 6) << i;
  }
}

TEST(OpenFfboardDriver, AnUntoldForceEndsByItself) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  rig.arm();
  rig.ticks(10, true, {2, 0});
  ASSERT_EQ(rig.board.torque(0), kHalf);
  rig.host.wait(rig.board.now_ns + 102 * kFrame_ns);
  EXPECT_EQ(rig.board.torque(0), 0);
}

TEST(OpenFfboardDriver, AfterAPauseAnEndedForceBeginsAtZero) {
  for (int pause = 1; pause < 300; pause += 3) {
    BoardRig rig;
    ASSERT_TRUE(rig.open());
    rig.arm();
    rig.ticks(33, true, {2, 0});
    rig.host.wait(rig.board.now_ns + pause * kFrame_ns);
    bool ended = rig.board.torque(0) == 0;
    rig.board.every_frame = [&] {
      ended = ended || rig.board.torque(0) == 0;
      if (ended) {
        EXPECT_NE(rig.board.torque(0), kHalf) << "the force from before, after " << pause << " ms";
      }
    };
    rig.ticks(60, true, {-1, 0});
    EXPECT_EQ(rig.board.torque(0), -8192) << pause;
    EXPECT_EQ(rig.faults, 0);
  }
}

TEST(OpenFfboardDriver, DisarmingEndsTheForceAtOnceAndStaysOff) {
  BoardRig rig({.axes = 2}, board_options(2));
  ASSERT_TRUE(rig.open());
  rig.arm();
  rig.ticks(20, true, {2, 2});
  rig.board.log.clear();
  rig.ticks(4, false);
  EXPECT_EQ(rig.board.torque(0), 0);
  EXPECT_EQ(rig.board.torque(1), 0);
  rig.ticks(300, false);
  EXPECT_EQ(rig.count("0501"), 1);
  EXPECT_EQ(rig.count("0a0103"), 1);
  EXPECT_EQ(rig.count("0a0203"), 1);
  EXPECT_EQ(rig.count("0c02"), 1);
  EXPECT_LT(rig.first("05020000"), rig.first("0a0103"));
  EXPECT_LT(rig.first("0a0203"), rig.first("0c02"));
  EXPECT_FALSE(rig.board.active);
  EXPECT_FALSE(rig.reading.armed);
  EXPECT_EQ(rig.faults, 0);
  rig.arm();
}

TEST(OpenFfboardDriver, KeepsAliveInTime) {
  for (const double dead_man_s : {kDeadMan_s, 0.012}) {
    auto options = board_options();
    options.openffboard.dead_man_s = dead_man_s;
    BoardRig rig({}, options);
    ASSERT_TRUE(rig.open());
    const std::int64_t now_ns = rig.board.now_ns;
    EXPECT_GT(rig.protocol->tell_again_ns(now_ns), now_ns);
    EXPECT_LE(rig.protocol->tell_again_ns(now_ns), now_ns + std::llround(1e9 * dead_man_s / 3));
  }
}

/// It tells its position when that changes; else its answers say that it has not. Told as by the device's thread.
TEST(OpenFfboardDriver, SamplesAreYoungEnoughHoweverItMoves) {
  struct Case {
    double age_s;
    std::int64_t loop_ns;
  };
  for (const bool armed : {false, true})
    for (const auto& [age_s, loop_ns] :
         {Case{0.0065, 10 * kFrame_ns}, Case{0.008, kFrame_ns}, Case{0.012, kFrame_ns}}) {
      auto options = board_options();
      options.worst_sample_age_s = age_s;
      BoardRig rig({}, options);
      ASSERT_TRUE(rig.open()) << rig.why();
      armed ? rig.arm() : rig.wait_for_position();
      std::int64_t last_ns = rig.sample_ns, most_ns = 0, loop_at_ns = 0;
      usb::Command command{.armed = armed};
      for (int i = 0; i < 6000; ++i) {
        if (i % 197 == 0 || i % 1009 < 40) ++rig.board.position[0];
        const std::int64_t now_ns = rig.board.now_ns;
        if (now_ns >= loop_at_ns) {
          loop_at_ns = now_ns + loop_ns;
          command.effort[0] = armed ? 0.001 * (i % 1000) : 0;
          command.at_ns = now_ns;
        }
        ASSERT_EQ(rig.protocol->tell(command, now_ns), usb::Status::ok);
        rig.hear(std::min(loop_at_ns, rig.protocol->tell_again_ns(now_ns)));
        if (rig.sample_ns == last_ns) continue;
        most_ns = std::max(most_ns, rig.sample_ns - last_ns);
        last_ns = rig.sample_ns;
      }
      EXPECT_LE(most_ns, std::llround(1e9 * (age_s - options.arrival_age_s)))
          << age_s << (armed ? ", with forces" : "");
      EXPECT_EQ(rig.faults, 0);
    }
}

/// The newest magnitude is with the board within `send_s`: what it waits for is one report on its way and one other.
TEST(OpenFfboardDriver, ForceIsWithTheBoardInTimeWhateverElseIsAsked) {
  for (const std::size_t axes : {1U, 2U}) {
    BoardRig rig({.axes = static_cast<int>(axes)}, board_options(axes));
    ASSERT_TRUE(rig.open()) << rig.why();
    rig.arm();
    const std::int64_t most_ns = (2 + static_cast<std::int64_t>(axes)) * kFrame_ns;
    usb::Command command{.armed = true};
    for (int i = 1; i < 1000; ++i) {
      for (std::size_t a = 0; a < axes; ++a) command.effort[a] = 0.002 * (i % 500) + 0.1 * (i % 2);
      command.at_ns = rig.board.now_ns;
      std::array<int, 2> wanted{};
      for (std::size_t a = 0; a < axes; ++a)
        wanted[a] = static_cast<int>(
            std::lround(rig.protocol->carried(a, command.effort[a]) * 32767 / kFull_Nm));
      const auto is_there = [&] {
        for (std::size_t a = 0; a < axes; ++a)
          if (rig.board.torque(static_cast<int>(a)) != wanted[a]) return false;
        return true;
      };
      while (!is_there()) {
        const std::int64_t now_ns = rig.board.now_ns;
        ASSERT_LE(now_ns - command.at_ns, most_ns) << axes << " axes, command " << i;
        ASSERT_EQ(rig.protocol->tell(command, now_ns), usb::Status::ok);
        rig.hear(rig.protocol->tell_again_ns(now_ns));
      }
      if (i % 7 == 0) rig.hear(rig.board.now_ns + i % 3 * kFrame_ns / 2);
    }
    EXPECT_EQ(rig.faults, 0);
  }
}

/// It is asked meanwhile, and what it answers then is no longer true.
TEST(OpenFfboardDriver, AnswersFromWhileItWasSwitchedOnMeanNothing) {
  auto options = board_options(2);
  options.worst_sample_age_s = 0.02;
  BoardRig rig({.axes = 2}, options);
  rig.board.answer_delay_ns = 8 * kFrame_ns;
  ASSERT_TRUE(rig.open()) << rig.why();
  rig.wait_for_position();
  for (int i = 0; i < 10; ++i) {
    rig.ticks(30, false);
    rig.ticks(60 + i, true);
    EXPECT_TRUE(rig.reading.armed) << i;
    EXPECT_EQ(rig.faults, 0) << i;
  }
}

TEST(OpenFfboardDriver, AnswersThatAreLostNowAndThenMakeNoPause) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  rig.wait_for_position();
  std::int64_t oldest_ns = 0;
  for (int i = 0; i < 3000; ++i) {
    rig.board.mute = i % 50 == 0;
    rig.tick(false);
    if (i % 50 > 10) oldest_ns = std::max(oldest_ns, rig.board.now_ns - rig.sample_ns);
  }
  EXPECT_LE(oldest_ns, 6 * kFrame_ns);
}

TEST(OpenFfboardDriver, BoardThatAnswersTooSlowlyForTheAgeOfItsSamplesIsRefused) {
  BoardRig rig;
  rig.board.answer_delay_ns = 6 * kFrame_ns;
  EXPECT_FALSE(rig.open());
  EXPECT_NE(rig.why().find("raise usb.max_age_s"), std::string::npos) << rig.why();
  EXPECT_FALSE(rig.board.opened);
}

}  // namespace
}  // namespace hapticd::hid
