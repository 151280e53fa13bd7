// CiA 402: what the drive does.
#include "sim/can/cia402_drive.h"

#include <gtest/gtest.h>

#include "tests/unit/emulators/host_end.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;

struct TestedCia402 {
  Cia402Drive drive;
  std::int64_t now_ns = 0;
  explicit TestedCia402(const Cia402Options& options = {}) : drive(options, 0) {}

  void hear(std::uint32_t id, const std::string& hex) {
    drive.receive(data_frame(id, hex), now_ns);
  }
  void sync() { hear(0x80, ""); }
  void run_to(std::int64_t at_ns) {
    now_ns = at_ns;
    drive.advance(now_ns);
  }
  std::string sdo(const std::string& hex) {
    drive.take_sent();
    hear(0x601, hex);
    const auto sent = sent_by(drive);
    if (sent.empty() || sent.back().can_id != 0x581) return "";
    return hex_of(sent.back());
  }
  // Everything that the vectors write, in their order.
  void configure() {
    for (const Json& vector : vectors().at("cia402").at("sdo_configure_cst"))
      ASSERT_EQ(sdo(vector.at("data")), vector.at("reply_ok")) << vector.dump();
  }
  void rpdo(std::uint16_t control, std::int16_t torque) {
    hear(0x201, hex_le(control) + hex_le(torque));
  }
  // Leaves the drive in operation enabled, RPDO of type 1.
  void enable() {
    configure();
    hear(0, "0101");
    for (const char* word : {"06000000", "07000000", "0f000000"}) {
      hear(0x201, word);
      sync();
    }
    drive.take_sent();
  }
  std::string tpdo(std::uint32_t id) {
    for (const Frame& frame : sent_by(drive))
      if (frame.can_id == id) return hex_of(frame);
    return "";
  }
};

TEST(Cia402Drive, SaysThatItBooted) {
  Cia402Drive drive({}, 5 * kMs);
  const auto sent = drive.take_sent();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].at_ns, 5 * kMs);
  EXPECT_EQ(sent[0].frame.can_id, 0x701U);
  EXPECT_EQ(hex_of(sent[0].frame), "00");
  EXPECT_EQ(drive.next_ns(), kNever);
  drive.reset(6 * kMs);
  EXPECT_EQ(hex_of(sent_by(drive).at(0)), "00");
}

TEST(Cia402Drive, TheVectorsConfigureIt) {
  TestedCia402 t;
  t.configure();
  const auto pdo = t.drive.objects().tpdo(0);
  EXPECT_TRUE(pdo.enabled);
  EXPECT_EQ(pdo.id, 0x181U);
  EXPECT_EQ(pdo.type, 1);
  EXPECT_EQ(pdo.bits(), 64U);
  EXPECT_EQ(t.sdo("4061600000000000"), "4f6160000a000000");
}

TEST(Cia402Drive, SdoAnswersComeOneAfterTheOther) {
  TestedCia402 t;
  t.drive.take_sent();
  t.hear(0x601, "4000100000000000");
  t.hear(0x601, "4000100000000000");
  const auto sent = t.drive.take_sent();
  ASSERT_EQ(sent.size(), 2U);
  EXPECT_EQ(sent[0].at_ns, 2 * kMs);
  EXPECT_EQ(sent[1].at_ns, 4 * kMs);
  EXPECT_EQ(hex_of(sent[0].frame), "4300100092010200");
}

TEST(Cia402Drive, TellsWhatItIs) {
  Cia402Options options;
  options.rated_torque_Nm = 0.5;
  TestedCia402 t(options);
  EXPECT_EQ(t.sdo("4076600000000000"), "43766000f4010000");
  EXPECT_EQ(t.sdo("408f600100000000"), "438f600100000100");
  EXPECT_EQ(t.sdo("408f600200000000"), "438f600201000000");
  EXPECT_EQ(t.sdo("4018100000000000"), "4f18100004000000");
  EXPECT_EQ(t.sdo("4018100100000000"), "43181001defa0000");
  EXPECT_EQ(t.sdo("4018100400000000"), "4318100467120000");
  EXPECT_EQ(t.sdo("4002650000000000"), "4302650005020000");
  EXPECT_EQ(t.sdo("40c2600200000000"), "4fc26002fd000000");
}

TEST(Cia402Drive, AbortsWhatCannotBe) {
  TestedCia402 t;
  EXPECT_EQ(t.sdo("4034120000000000"), "8034120000000206");  // no object
  EXPECT_EQ(t.sdo("4018100900000000"), "8018100911000906");  // no sub-index
  EXPECT_EQ(t.sdo("2f17100064000000"), "8017100013000706");  // too short
  EXPECT_EQ(t.sdo("2317100064000000"), "8017100012000706");  // too long
  EXPECT_EQ(t.sdo("2b41600064000000"), "8041600002000106");  // read only
  EXPECT_EQ(t.sdo("2117100064000000"), "8017100001000405");  // segmented
  EXPECT_EQ(t.sdo("2f60600063000000"), "8060600030000906");  // no such mode
  EXPECT_EQ(t.sdo("2b17100064000000"), "6017100000000000");
}

TEST(Cia402Drive, WithoutCstItSaysSo) {
  Cia402Options options;
  options.supports_cst = false;
  TestedCia402 t(options);
  EXPECT_EQ(t.sdo("4002650000000000"), "4302650005000000");
  EXPECT_EQ(t.sdo("2f6060000a000000"), "8060600030000906");
  EXPECT_EQ(t.sdo("4061600000000000"), "4f61600000000000");
}

TEST(Cia402Drive, AMappingCanOnlyBeChangedWhileThePdoIsOffAndEmpty) {
  TestedCia402 t;
  const std::string refused = "22000008";
  EXPECT_EQ(t.sdo("2f00160000000000").substr(8), refused);  // still on
  EXPECT_EQ(t.sdo("2300140102020000").substr(8), refused);  // another id while on
  EXPECT_EQ(t.sdo("2300140101020080").substr(0, 2), "60");
  EXPECT_EQ(t.sdo("2300160110004060").substr(8), refused);  // still counts entries
  EXPECT_EQ(t.sdo("2f00160000000000").substr(0, 2), "60");
  EXPECT_EQ(t.sdo("2300160110007360").substr(8), "00000206");  // no object
  EXPECT_EQ(t.sdo("2300160110004160").substr(8), "41000406");  // cannot be received
  EXPECT_EQ(t.sdo("2300160120007160").substr(8), "41000406");  // another size
  EXPECT_EQ(t.sdo("2300160110007160").substr(0, 2), "60");
  EXPECT_EQ(t.sdo("2f00160002000000").substr(8), "00000206");  // the second is not mapped
  EXPECT_EQ(t.sdo("2f00160001000000").substr(0, 2), "60");
}

TEST(Cia402Drive, AMappingIsAtMostEightBytes) {
  TestedCia402 t;
  t.sdo("2300180181010080");
  t.sdo("2f001a0000000000");
  t.sdo("23001a0120006460");
  t.sdo("23001a0220006c60");
  t.sdo("23001a0310004160");
  EXPECT_EQ(t.sdo("2f001a0003000000").substr(8), "42000406");
  EXPECT_EQ(t.sdo("2f001a0002000000").substr(0, 2), "60");
}

TEST(Cia402Drive, MakesTorqueOnlyEnabledOperationalAndInCst) {
  TestedCia402 t;
  t.enable();
  EXPECT_TRUE(t.drive.enabled());
  t.rpdo(0x0f, 250);
  t.sync();
  EXPECT_DOUBLE_EQ(t.drive.torque_Nm(), 0.25);
  t.sdo("2f60600003000000");
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.sdo("2f6060000a000000");
  EXPECT_DOUBLE_EQ(t.drive.torque_Nm(), 0.25);
  t.hear(0, "8000");
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.hear(0, "0100");
  EXPECT_EQ(t.drive.torque_Nm(), 0);  // switched off on the way
}

TEST(Cia402Drive, ASynchronousRpdoActsAtTheNextSync) {
  TestedCia402 t;
  t.enable();
  t.rpdo(0x0f, 100);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.rpdo(0x0f, -200);  // the newer one counts
  t.sync();
  EXPECT_DOUBLE_EQ(t.drive.torque_Nm(), -0.2);
}

TEST(Cia402Drive, AnRpdoOfType255ActsAtOnce) {
  TestedCia402 t;
  t.enable();
  t.sdo("2f001402ff000000");
  t.rpdo(0x0f, 100);
  EXPECT_DOUBLE_EQ(t.drive.torque_Nm(), 0.1);
}

TEST(Cia402Drive, TpdosAreMeasuredAtTheSync) {
  TestedCia402 t;
  t.enable();
  t.rpdo(0x0f, 500);
  t.sync();
  t.drive.take_sent();
  t.drive.move_to(0.0625, 0.5);
  t.sync();
  t.drive.move_to(9, 9);
  const auto sent = t.drive.take_sent();
  ASSERT_EQ(sent.size(), 2U);
  EXPECT_EQ(sent[0].at_ns, 100 * kUs);
  EXPECT_EQ(sent[0].frame.can_id, 0x181U);
  EXPECT_EQ(hex_of(sent[0].frame), "371200100000f401");
  EXPECT_EQ(sent[1].frame.can_id, 0x281U);
  EXPECT_EQ(hex_of(sent[1].frame), "0080000000000a");
  t.drive.move_to(-1e-6, 0);
  t.sync();
  EXPECT_EQ(t.tpdo(0x181).substr(4, 8), "ffffffff");
}

TEST(Cia402Drive, ATpdoOfTypeThreeComesEveryThirdSync) {
  TestedCia402 t;
  t.configure();
  t.sdo("2f01180203000000");
  t.hear(0, "0101");
  int fast = 0, slow = 0;
  for (int i = 0; i < 9; ++i) {
    t.drive.take_sent();
    t.sync();
    for (const Frame& frame : sent_by(t.drive)) ++(frame.can_id == 0x181 ? fast : slow);
  }
  EXPECT_EQ(fast, 9);
  EXPECT_EQ(slow, 3);
}

TEST(Cia402Drive, PdosAndSyncAreOfOperationalOnly) {
  TestedCia402 t;
  t.configure();
  t.rpdo(0x06, 0);
  t.sync();
  EXPECT_EQ(t.drive.state(), Cia402State::switch_on_disabled);
  EXPECT_EQ(t.tpdo(0x181), "");
  t.hear(0, "0201");
  EXPECT_EQ(t.sdo("4000100000000000"), "");  // stopped: no SDO either
}

TEST(Cia402Drive, ClipsTheTargetAndSaysSo) {
  TestedCia402 t;
  t.enable();
  t.rpdo(0x0f, -3500);
  t.sync();
  EXPECT_EQ(t.drive.torque_Nm(), -3);
  EXPECT_EQ(t.drive.statusword(), 0x1a37);
  t.rpdo(0x0f, 3000);
  t.sync();
  EXPECT_EQ(t.drive.torque_Nm(), 3);
  EXPECT_EQ(t.drive.statusword(), 0x1237);
  t.sdo("2b726000e8030000");  // max torque 1000 per mille
  EXPECT_EQ(t.drive.torque_Nm(), 1);
  EXPECT_EQ(t.drive.statusword(), 0x1a37);
}

TEST(Cia402Drive, AShortRpdoIsAnEmergencyAndNothingElse) {
  TestedCia402 t;
  t.enable();
  t.hear(0x201, "0600");
  EXPECT_EQ(hex_of(sent_by(t.drive).at(0)), "1082110000000000");
  t.sync();
  EXPECT_TRUE(t.drive.enabled());
}

TEST(Cia402Drive, HeartbeatsCountFromTheWriteOnItsOwnClock) {
  Cia402Options options;
  options.clock_drift = 0.25;
  TestedCia402 t(options);
  t.run_to(10 * kMs);
  t.sdo("2b17100064000000");
  t.drive.take_sent();
  EXPECT_EQ(t.drive.next_ns(), 90 * kMs);
  t.hear(0, "0101");
  t.run_to(170 * kMs);
  const auto sent = t.drive.take_sent();
  ASSERT_EQ(sent.size(), 2U);
  EXPECT_EQ(sent[1].at_ns, 170 * kMs);
  EXPECT_EQ(hex_of(sent[1].frame), "05");
  t.sdo("2b17100000000000");
  EXPECT_EQ(t.drive.next_ns(), kNever);
}

TEST(Cia402Drive, LossOfTheHostsHeartbeatIsAFault) {
  TestedCia402 t;
  t.enable();
  t.rpdo(0x0f, 100);
  t.sync();
  t.sdo("2b17100000000000");
  t.run_to(1000 * kMs);  // 0x1016 is set, but the host has not begun
  EXPECT_TRUE(t.drive.enabled());
  t.hear(0x77f, "05");
  EXPECT_EQ(t.drive.next_ns(), 1200 * kMs);
  t.run_to(1150 * kMs);
  t.hear(0x77f, "05");
  t.drive.take_sent();
  t.run_to(1350 * kMs - 1);
  EXPECT_TRUE(t.drive.enabled());
  t.run_to(1350 * kMs);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  EXPECT_EQ(t.drive.state(), Cia402State::fault);
  const Frame emergency = sent_by(t.drive).at(0);
  EXPECT_EQ(emergency.can_id, 0x81U);
  EXPECT_EQ(hex_of(emergency), "3081110000000000");
  EXPECT_EQ(t.sdo("403f600000000000"), "4b3f600030810000");
}

TEST(Cia402Drive, WithAbortOptionZeroTheMotorGoesOn) {
  TestedCia402 t;
  t.enable();
  t.sdo("2b07600000000000");
  t.hear(0x77f, "05");
  t.run_to(200 * kMs);
  EXPECT_TRUE(t.drive.enabled());
}

TEST(Cia402Drive, AFaultIsResetByARisingEdge) {
  TestedCia402 t;
  t.enable();
  t.drive.fail(0x3220, t.now_ns);
  EXPECT_EQ(hex_of(sent_by(t.drive).at(0)), "2032050000000000");
  EXPECT_EQ(t.drive.statusword(), 0x218);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.rpdo(0x0f, 0);
  t.sync();
  EXPECT_EQ(t.drive.state(), Cia402State::fault);
  t.rpdo(0x80, 0);
  t.sync();
  EXPECT_EQ(t.drive.state(), Cia402State::switch_on_disabled);
  std::string emergency;
  for (const Frame& frame : sent_by(t.drive))
    if (frame.can_id == 0x81) emergency = hex_of(frame);
  EXPECT_EQ(emergency, "0000000000000000");
  t.drive.fail(0x3220, t.now_ns);
  t.rpdo(0x80, 0);  // no edge: the bit was set before
  t.sync();
  EXPECT_EQ(t.drive.state(), Cia402State::fault);
}

TEST(Cia402Drive, ResetsBootAnew) {
  TestedCia402 t;
  t.enable();
  t.hear(0, "8101");
  EXPECT_EQ(t.drive.nmt(), NmtState::pre_operational);
  EXPECT_EQ(t.tpdo(0x701), "00");
  EXPECT_EQ(t.sdo("4061600000000000"), "4f61600000000000");
  t.configure();
  t.hear(0, "8201");
  EXPECT_EQ(t.tpdo(0x701), "00");
  EXPECT_EQ(t.sdo("4061600000000000"), "4f6160000a000000");
  EXPECT_EQ(t.sdo("4017100000000000"), "4b17100000000000");
}

}  // namespace
}  // namespace hapticd::test::emulator
