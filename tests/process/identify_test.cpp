// hapticctl identify, as people run it: on simulated devices, interrupted, and where it must refuse.
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using testing::HasSubstr;

/// Two independent axes with friction, noise and a delay; the truth is not what the models say.
constexpr const char* kTable = R"(version: 1
devices:
  - name: table
    driver: sim
    sim:
      axes:
        - {mass_kg: 0.061, damping_Ns_m: 1.1, coulomb_N: 0.12, noise_counts: 0.5, delay_s: 0.00037}
        - {mass_kg: 0.05, damping_Ns_m: 1, coulomb_N: 0.05, noise_counts: 0.5}
HAND    kinematics: {cartesian: {directions: [x, y]}}
    latency_s: 0.001
SENSOR    axes:
      - name: x
        encoder: {counts_per_m: 163840, bits: 15}
        actuator: {max_force_N: 8}
        model: MODEL
      - name: y
        encoder: {counts_per_m: 163840, bits: 15}
        actuator: {max_force_N: 8}
        model: {mass_kg: 0.05, damping_Ns_m: 1}
guard: {max_force_N: 6, max_velocity_m_s: 1.5}
stability: {require: none}
)";

class Identify : public DaemonTest {
 protected:
  /// The table with these parts; each is one line, or none.
  std::string table(const std::string& model = "{mass_kg: 0.05, damping_Ns_m: 1.37}",
                    const std::string& hand = "", const std::string& sensor = "") {
    std::string text = kTable;
    for (const auto& [mark, part] :
         {std::pair<std::string, std::string>{"MODEL", model}, {"HAND", hand}, {"SENSOR", sensor}})
      text.replace(text.find(mark), mark.size(), part);
    std::ofstream(config_) << text;
    return config_;
  }
  int identify(std::vector<std::string> more) {
    std::vector<std::string> all{"identify", config_, "--device", "table",
                                 "--axis",   "x",     "-o",       file_};
    all.insert(all.end(), more.begin(), more.end());
    return ctl(std::move(all));
  }
  /// Nothing but the config is in the directory; a draft would be seen.
  bool wrote_nothing() const {
    for (const auto& entry : std::filesystem::directory_iterator(dir_.path())) {
      if (entry.path().string().starts_with(file_)) return false;
    }
    return true;
  }
  std::string file_ = dir_.file("x.yaml");
};

TEST_F(Identify, FindsTheTruthAndWritesAFileThatTheConfigTakes) {
  for (const char* method : {"stepped", "chirp"}) {
    table();
    ASSERT_EQ(identify({"--json", "--seed", "3", "--method", method}), 0) << ctl_err_;
    const daemon::Json answer = daemon::Json::parse(ctl_out_);
    const auto expect_inside = [&](const char* key, double truth) {
      const daemon::Json& figure = answer["model"][key];
      EXPECT_NEAR(figure["value"].get<double>(), truth, figure["half_width"].get<double>()) << key;
    };
    expect_inside("mass_kg", 0.061);
    expect_inside("damping_Ns_m", 1.1);
    expect_inside("coulomb_N", 0.12);
    expect_inside("delay_s", 0.00037);
    EXPECT_TRUE(answer["simulated"]["inside"]);
    EXPECT_TRUE(answer["latency_covers_delay"]);
    EXPECT_GE(answer["response"].size(), 12u);
    EXPECT_GT(answer["least_coherence"].get<double>(), 0.9);
    EXPECT_THAT(ctl_err_, HasSubstr("identify:   0 %"));
    EXPECT_FALSE(std::filesystem::exists(file_ + ".new"));

    table("{file: x.yaml}");
    ASSERT_EQ(ctl({"check", config_, "--json"}), 0) << ctl_err_;
    const daemon::Json axis = daemon::Json::parse(ctl_out_)["plan"]["devices"][0]["axes"][0];
    EXPECT_EQ(axis["model"]["mass_kg"], answer["model"]["mass_kg"]["value"]);
    EXPECT_GT(axis["model"]["damping_uncertainty"].get<double>(), 0);
  }
}

TEST_F(Identify, TheSameSeedGivesTheSameFigures) {
  table();
  ASSERT_EQ(identify({"--seed", "9"}), 0) << ctl_err_;
  const std::string first = read_text(file_);
  ASSERT_EQ(identify({"--seed", "9"}), 0) << ctl_err_;
  const std::string second = read_text(file_);
  EXPECT_EQ(first.substr(0, first.find("measured")), second.substr(0, second.find("measured")));
}

TEST_F(Identify, ShowsCoherenceAndIntervalsToPeople) {
  table();
  ASSERT_EQ(identify({}), 0) << ctl_err_;
  for (const char* words : {"coherence", "mass", "viscous damping", "dry friction", "delay",
                            "intervals of 99 %", "model: {file: "})
    EXPECT_THAT(ctl_out_, HasSubstr(words));
}

TEST_F(Identify, ALatencyBelowTheMeasuredDelayIsRefusedByCheck) {
  table();
  ASSERT_EQ(identify({}), 0) << ctl_err_;
  std::string text = read_text(table("{file: x.yaml}"));
  const std::string latency = "latency_s: 0.001";
  text.replace(text.find(latency), latency.size(), "latency_s: 0.0001");
  std::ofstream(config_) << text;
  EXPECT_EQ(ctl({"check", config_}), 65);
  EXPECT_THAT(ctl_err_, HasSubstr("devices[0].latency_s"));
  EXPECT_THAT(ctl_err_, HasSubstr("the delay that was measured"));
}

// So low a frequency takes long even in virtual time.
TEST_F(Identify, AnInterruptLeavesTheOlderFileAlone) {
  table();
  std::ofstream(file_) << "mass_kg: 1\n";
  Process process({HAPTICCTL_BINARY, "identify", config_, "--device", "table", "--axis", "x", "-o",
                   file_, "--from", "0.02"},
                  dir_.file("identify"));
  ASSERT_TRUE(eventually([&] { return !process.err().empty(); }));
  process.signal(SIGINT);
  EXPECT_EQ(process.wait(), 75);
  EXPECT_THAT(process.err(), HasSubstr("interrupted; nothing was written"));
  EXPECT_EQ(read_text(file_), "mass_kg: 1\n");
  EXPECT_FALSE(std::filesystem::exists(file_ + ".new"));
}

TEST_F(Identify, NamesThatTheConfigLacksAreToldWithThoseItHas) {
  table();
  EXPECT_EQ(ctl({"identify", config_, "--device", "tabel", "--axis", "x", "-o", file_}), 64);
  EXPECT_THAT(ctl_err_, HasSubstr("there is no device 'tabel'; did you mean 'table'?"));
  EXPECT_EQ(ctl({"identify", config_, "--device", "table", "--axis", "q", "-o", file_}), 64);
  EXPECT_THAT(ctl_err_, HasSubstr("there is no axis 'q'; there are: x y"));
  EXPECT_TRUE(wrote_nothing());
}

TEST_F(Identify, BoundsBeyondTheConfigAreRefusedAndThoseThatAreTooTightEndIt) {
  table();
  EXPECT_EQ(identify({"--force", "7"}), 64);
  EXPECT_THAT(ctl_err_, HasSubstr("--force: expected more than 0 and at most 6 N"));
  EXPECT_EQ(identify({"--from", "30", "--to", "40"}), 64);
  EXPECT_EQ(identify({"--force", "0.1"}), 1);  // friction holds the axis
  EXPECT_THAT(ctl_err_, HasSubstr("hardly moved"));
  EXPECT_TRUE(wrote_nothing());
}

TEST_F(Identify, AFileThatCannotBeWrittenIsToldBeforeAnythingMoves) {
  table();
  EXPECT_EQ(ctl({"identify", config_, "--device", "table", "--axis", "x", "-o",
                 dir_.file("none/x.yaml")}),
            73);
  EXPECT_THAT(ctl_err_, testing::Not(HasSubstr("identify: ")));
  const std::string before = read_text(config_);
  EXPECT_EQ(ctl({"identify", config_, "--device", "table", "--axis", "x", "-o", config_}), 64);
  EXPECT_THAT(ctl_err_, HasSubstr("config.yaml is a file that is read or written here already"));
  EXPECT_EQ(read_text(config_), before);
}

TEST_F(Identify, AHandIsFoundByTheForceSensor) {
  table("{mass_kg: 0.05, damping_Ns_m: 1.37}",
        "      hand: {mass_kg: 0.2, stiffness_N_m: 300, damping_Ns_m: 2}\n"
        "      force_sensor: {noise_N: 0.01}\n",
        "    force_sensor: {directions: [x, y]}\n");
  ASSERT_EQ(identify({"--hand", "--json"}), 0) << ctl_err_;
  const daemon::Json hand = daemon::Json::parse(ctl_out_)["hand"];
  EXPECT_NEAR(hand["mass_kg"]["value"].get<double>(), 0.2, 0.01);
  EXPECT_NEAR(hand["stiffness_N_m"]["value"].get<double>(), 300, 15);
  EXPECT_NEAR(hand["damping_Ns_m"]["value"].get<double>(), 2, 0.5);
  EXPECT_THAT(read_text(file_), HasSubstr("stiffness_N_m: "));
}

TEST_F(Identify, AHandWithoutAForceSensorIsRefused) {
  table();
  EXPECT_EQ(identify({"--hand"}), 65);
  EXPECT_THAT(ctl_err_, HasSubstr("device table has no force_sensor"));
  EXPECT_TRUE(wrote_nothing());
}

// A joint of a pantograph: its inertia in this pose, the other joint held.
TEST_F(Identify, AJointIsIdentifiedInItsPose) {
  const std::string example = std::string(HAPTICD_SOURCE_DIR) + "/config/examples/five_bar.yaml";
  ASSERT_EQ(ctl({"identify", example, "--device", "pantograph", "--axis", "left", "-o", file_,
                 "--from", "20", "--json"}),
            0)
      << ctl_err_;
  const daemon::Json answer = daemon::Json::parse(ctl_out_);
  EXPECT_THAT(answer["notes"].dump(), HasSubstr("this joint in this pose"));
  const daemon::Json& dry = answer["model"]["coulomb_Nm"];
  EXPECT_NEAR(dry["value"].get<double>(), 0.002, dry["half_width"].get<double>());
  EXPECT_THAT(read_text(file_), HasSubstr("inertia_kgm2: "));
  EXPECT_EQ(
      ctl({"identify", example, "--device", "pantograph", "--axis", "left", "-o", file_, "--hand"}),
      65);
  EXPECT_THAT(ctl_err_, HasSubstr("jointed"));
}

}  // namespace
}  // namespace hapticd::test
