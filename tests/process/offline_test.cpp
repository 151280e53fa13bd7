// The verbs that need no daemon: check, simulate, export.
#include <signal.h>

#include <filesystem>

#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

using Offline = DaemonTest;

TEST_F(Offline, HelpListsTheVerbsThatWork) {
  EXPECT_EQ(ctl({"--help"}), 0);
  for (const char* verb :
       {"status", "enable", "disable", "estop", "reload", "check", "simulate", "export", "why"}) {
    EXPECT_THAT(ctl_out_, HasSubstr(verb));
  }
}

TEST_F(Offline, WithoutADaemonVerbsEndWith69) {
  for (const char* verb : {"status", "enable", "disable", "estop", "reload"}) {
    EXPECT_EQ(ctl({verb}), 69);
    EXPECT_THAT(ctl_err_, AllOf(HasSubstr("no hapticd answers"), HasSubstr("HAPTICD_SOCKET")));
    EXPECT_EQ(ctl({verb, "--json"}), 69);
    EXPECT_EQ(daemon::Json::parse(ctl_out_, nullptr, false)["code"], 69);
  }
}

TEST_F(Offline, CheckPrintsThePlanAndTheProof) {
  write_config({});
  EXPECT_EQ(ctl({"check", config_}), 0) << ctl_err_;
  EXPECT_THAT(ctl_out_, AllOf(HasSubstr("wall"), HasSubstr("left: passive, proved")));
  EXPECT_EQ(ctl({"check", config_, "--json"}), 0);
  const auto json = daemon::Json::parse(ctl_out_, nullptr, false);
  ASSERT_TRUE(json.is_object()) << ctl_out_;
  EXPECT_EQ(json["stability"]["proved"], true);
  Process same({HAPTICD_BINARY, "--config", config_, "--check"}, dir_.file("same"));
  EXPECT_EQ(same.wait(), 0);
  EXPECT_THAT(same.out(), HasSubstr("left: passive, proved"));
}

TEST_F(Offline, CheckSaysNoWhereTheDaemonWouldKeepForcesOff) {
  write_config({.stiffness_N_m = 50'000});
  EXPECT_EQ(ctl({"check", config_}), 1);
  EXPECT_THAT(ctl_out_, AllOf(HasSubstr("forces stay off"), HasSubstr("left: not proved")));
}

TEST_F(Offline, TheSameSimulationGivesTheSameFileToTheBit) {
  write_config({});
  for (const char* name : {"a", "b"}) {
    ASSERT_EQ(ctl({"simulate", config_, "--duration", "2", "-o", dir_.file(name)}), 0) << ctl_err_;
    EXPECT_THAT(ctl_out_, AllOf(HasSubstr("2000 ticks"), HasSubstr("x real time")));
  }
  EXPECT_EQ(read_text(dir_.file("a")), read_text(dir_.file("b")));
  const auto recording = daemon::read_recording(dir_.file("a"));
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->size(), 2000u);
}

TEST_F(Offline, SimulateKeepsForcesOffWhereTheDaemonWould) {
  write_config({.stiffness_N_m = 50'000});
  EXPECT_EQ(ctl({"simulate", config_, "--duration", "1", "-o", dir_.file("a"), "--json"}), 1);
  auto json = daemon::Json::parse(ctl_out_, nullptr, false);
  EXPECT_EQ(json["forces"], false);
  EXPECT_EQ(json["largest_force_N"], 0.0);
  (void)ctl({"simulate", config_, "--duration", "1", "-o", dir_.file("a"), "--json", "--unproven"});
  json = daemon::Json::parse(ctl_out_, nullptr, false);
  EXPECT_EQ(json["forces"], true);
  EXPECT_GT(json["largest_force_N"].get<double>(), 0);
}

TEST_F(Offline, SimulateTellsOfAFault) {
  write_config({.failures = "{kind: nan, at_s: 0.5}"});
  EXPECT_EQ(ctl({"simulate", config_, "--duration", "1", "-o", dir_.file("a")}), 1);
  EXPECT_THAT(ctl_out_, HasSubstr("input_not_finite"));
}

TEST_F(Offline, AnInterruptedSimulationLeavesAReadableFile) {
  write_config({});
  const std::string file = dir_.file("long");
  Process simulation({HAPTICCTL_BINARY, "simulate", config_, "--duration", "1e8", "-o", file},
                     dir_.file("simulate"));
  std::error_code none;
  ASSERT_TRUE(eventually([&] {
    return std::filesystem::exists(file, none) && std::filesystem::file_size(file, none) > 100'000;
  }));
  simulation.signal(SIGINT);
  EXPECT_EQ(simulation.wait(), 0) << simulation.err();
  EXPECT_THAT(simulation.out(), HasSubstr("interrupted"));
  const auto recording = daemon::read_recording(file);
  ASSERT_TRUE(recording) << recording.error().text;
  EXPECT_GT(recording->size(), 100u);
  EXPECT_EQ(recording->torn_bytes, 0u);
}

TEST_F(Offline, SimulateToAPlaceThatCannotBeWrittenSaysWhich) {
  write_config({});
  EXPECT_NE(ctl({"simulate", config_, "--duration", "1", "-o", dir_.file("none/a")}), 0);
  EXPECT_THAT(ctl_err_, HasSubstr("none/a"));
  EXPECT_NE(ctl({"simulate", config_, "--duration", "20", "-o", "/dev/full"}), 0);
  EXPECT_THAT(ctl_err_, HasSubstr("/dev/full"));
}

TEST_F(Offline, ExportWritesCsvBesideOrWhereTold) {
  write_config({});
  ASSERT_EQ(ctl({"simulate", config_, "--duration", "0.01", "-o", dir_.file("a")}), 0);
  EXPECT_EQ(ctl({"export", dir_.file("a"), "--csv"}), 0) << ctl_err_;
  const std::string csv = read_text(dir_.file("a.csv"));
  EXPECT_THAT(csv, StartsWith("tick,"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 11);
  EXPECT_EQ(ctl({"export", dir_.file("a"), "--csv", "-o", "-"}), 0);
  EXPECT_EQ(ctl_out_, csv);
  EXPECT_EQ(ctl({"export", dir_.file("none"), "--csv"}), 66);
  EXPECT_EQ(ctl({"export", config_, "--csv"}), 65);
  EXPECT_EQ(ctl({"export", dir_.file("a")}), 64);
}

}  // namespace
}  // namespace hapticd::test
