// hapticctl doctor, on the machine that runs the tests.
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class Doctor : public DaemonTest {
 protected:
  Json finding(const std::string& topic) const {
    const Json answer = Json::parse(ctl_out_);
    for (const Json& one : answer["findings"])
      if (one["topic"] == topic) return one;
    return nullptr;
  }
  std::string wall() const {
    return std::string(HAPTICD_SOURCE_DIR) + "/config/examples/wall.yaml";
  }
};

TEST_F(Doctor, WatchesWakeUpsWithoutAConfig) {
  const int code = ctl({"doctor", "--seconds", "0.3", "--json"});
  EXPECT_TRUE(code == 0 || code == 1) << code << ctl_err_;
  EXPECT_FALSE(finding("kernel").is_null());
  EXPECT_FALSE(finding("wake-ups").is_null());
  EXPECT_TRUE(finding("round trip").is_null());
  EXPECT_EQ(Json::parse(ctl_out_)["ok"], code == 0);
}

TEST_F(Doctor, HoldsLatencyAgainstASimulatedDevicesDelay) {
  std::string text = read_text(wall());
  EXPECT_NE(ctl({"doctor", wall(), "--seconds", "0.3", "--json"}), 66);
  const std::string topic = "latency of left";
  const Json good = finding(topic);
  ASSERT_FALSE(good.is_null()) << ctl_out_ << ctl_err_;
  EXPECT_EQ(good["severity"], "good");
  const std::string axis = "- {mass_kg: 0.05, ";
  const auto at = text.find(axis);
  ASSERT_NE(at, std::string::npos);
  text.insert(at + axis.size(), "delay_s: 0.0004, ");
  std::ofstream(dir_.file("late.yaml")) << text;
  EXPECT_EQ(ctl({"doctor", dir_.file("late.yaml"), "--seconds", "0.3", "--json"}), 1) << ctl_err_;
  EXPECT_EQ(finding(topic)["severity"], "bad");
  EXPECT_THAT(finding(topic)["fix"].get<std::string>(), HasSubstr("latency_s: 0.000400"));
}

TEST_F(Doctor, AConfigThatIsMissingOrWrongIsTold) {
  EXPECT_EQ(ctl({"doctor", dir_.file("none.yaml")}), 66);
  std::ofstream(dir_.file("wrong.yaml")) << "version: 1\ndevices: []\nbogus: 1\n";
  EXPECT_EQ(ctl({"doctor", dir_.file("wrong.yaml")}), 65);
  EXPECT_EQ(ctl({"doctor", "--seconds", "-1"}), 64);
}

}  // namespace
}  // namespace hapticd::test
