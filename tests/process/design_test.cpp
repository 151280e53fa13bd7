// hapticctl certify and design, as people run them; and the daemon that checks what they wrote.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class Design : public DaemonTest {
 protected:
  std::string example(const std::string& name) const {
    return std::string(HAPTICD_SOURCE_DIR) + "/config/examples/" + name;
  }
  /// Example 1 with the coupling of a file.
  std::string config_with(const std::string& coupling) {
    std::string text = read_text(example("paper1_example1.yaml"));
    const auto begin = text.find("\ncoupling:"), end = text.find("\nscene:");
    EXPECT_NE(begin, std::string::npos);
    EXPECT_NE(end, std::string::npos);
    text.replace(begin, end - begin, "\ncoupling: {file: " + coupling + "}\n");
    std::ofstream(dir_.file("config.yaml")) << text;
    return dir_.file("config.yaml");
  }
};

TEST_F(Design, CertifyTellsAllFourAnswers) {
  ASSERT_EQ(ctl({"certify", example("paper1_example1.yaml"), "--json"}), 0) << ctl_err_;
  const Json answer = Json::parse(ctl_out_);
  EXPECT_TRUE(answer["passive"]["proved"]);
  EXPECT_EQ(answer["passive"]["devices"][0]["theorem"], "A");
  EXPECT_NEAR(answer["exact"][0]["margin_Ns_m"].get<double>(), 1.0439005, 1e-6);
  EXPECT_NEAR(answer["paper"][0]["margin_Ns_m"].get<double>(), 0.79791376, 1e-6);
  ASSERT_EQ(answer["robust"].size(), 3U);
  EXPECT_EQ(answer["robust"][0]["answer"], "not available");
}

TEST_F(Design, CertifyTellsThePapersYesBesideTheSampledLoopsNo) {
  std::string text = read_text(example("paper2_wall.yaml"));
  const std::string damper = "damping_Ns_m: 1}";
  ASSERT_NE(text.find(damper), std::string::npos);
  text.replace(text.find(damper), damper.size(), "damping_Ns_m: 15}");
  std::ofstream(dir_.file("wall15.yaml")) << text;
  EXPECT_EQ(ctl({"certify", dir_.file("wall15.yaml"), "--json"}), 1) << ctl_err_;
  const Json answer = Json::parse(ctl_out_);
  const Json& robust = answer["robust"][0];
  EXPECT_EQ(robust["answer"], "no");
  EXPECT_EQ(robust["paper"]["answer"], "yes");
  // The model's damping is known: only the mass is uncertain.
  EXPECT_NEAR(robust["tolerated_share"].get<double>(), 0.2, 0.01);  // m >= 0.0080 kg
  EXPECT_FALSE(answer["passive"]["proved"]);
}

TEST_F(Design, CertifyOfAnUnprovedSceneIsNo) {
  std::string text = read_text(example("paper1_example1.yaml"));
  const std::string stiffness = "704.9058";
  text.replace(text.find(stiffness), stiffness.size(), "2741");
  std::ofstream(dir_.file("stiff.yaml")) << text;
  EXPECT_EQ(ctl({"certify", dir_.file("stiff.yaml")}), 1);
  EXPECT_THAT(ctl_out_, HasSubstr("not proved"));
}

TEST_F(Design, WhatIsDesignedIsProvedAndNamedInItsFile) {
  struct Case {
    std::vector<std::string> asked;
    const char* theorem;
  };
  for (const Case& one :
       {Case{{"--proof", "any_scene"}, "A"}, Case{{"--proof", "this_scene"}, "exact"},
        Case{{"--proof", "paper"}, "A"}, Case{{"--proof", "paper", "--order", "1"}, "B"},
        Case{{"--proof", "paper", "--order", "2", "--structure", "centralised"}, "B"}}) {
    const std::string file = dir_.file("designed.yaml");
    std::vector<std::string> command{"design", example("paper1_example1.yaml"), "-o", file};
    command.insert(command.end(), one.asked.begin(), one.asked.end());
    SCOPED_TRACE(testing::PrintToString(one.asked));
    ASSERT_EQ(ctl(command), 0) << ctl_err_;
    ASSERT_EQ(ctl({"certify", config_with(file), "--json"}), 0) << ctl_out_ << ctl_err_;
    EXPECT_EQ(Json::parse(ctl_out_)["passive"]["devices"][0]["theorem"], one.theorem);
    ASSERT_EQ(ctl({"simulate", dir_.file("config.yaml"), "--duration", "1", "-o",
                   dir_.file("run.rec"), "--json"}),
              0)
        << ctl_err_;
    EXPECT_TRUE(Json::parse(ctl_out_)["forces"]);
    EXPECT_TRUE(Json::parse(ctl_out_)["fault"].is_null());
  }
}

TEST_F(Design, AnEditByHandTakesTheProofAway) {
  const std::string file = dir_.file("c.yaml");
  ASSERT_EQ(ctl({"design", example("paper1_example1.yaml"), "-o", file, "--proof", "this_scene"}),
            0)
      << ctl_err_;
  std::string text = read_text(file);
  const auto at = text.find("stiffness_N_m: 8") + 15;
  text[at] = '9';
  std::ofstream(file) << text;
  EXPECT_EQ(ctl({"certify", config_with(file)}), 1);
  EXPECT_THAT(ctl_out_, HasSubstr("was changed after it was designed"));
}

TEST_F(Design, AnotherRateTakesTheProofAway) {
  const std::string file = dir_.file("c.yaml");
  ASSERT_EQ(ctl({"design", example("paper1_example1.yaml"), "-o", file, "--proof", "this_scene"}),
            0)
      << ctl_err_;
  std::string text = read_text(config_with(file));
  const std::string rate = "rate_Hz: 1000";
  text.replace(text.find(rate), rate.size(), "rate_Hz: 990");
  std::ofstream(dir_.file("slow.yaml")) << text;
  EXPECT_EQ(ctl({"certify", dir_.file("slow.yaml")}), 1);
  EXPECT_THAT(ctl_out_, HasSubstr("loop.rate_Hz was 1000 when it was designed and is 990 now"));
}

TEST_F(Design, WhatCannotBeDesignedIsToldAndNothingIsWritten) {
  const std::string file = dir_.file("c.yaml");
  EXPECT_EQ(ctl({"design", example("wall.yaml"), "-o", file, "--proof", "this_scene"}), 1);
  EXPECT_THAT(ctl_err_, HasSubstr("linear scenes"));
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(ctl({"design", example("paper1_example1.yaml"), "-o", dir_.file("no/c.yaml")}), 73);
  EXPECT_EQ(ctl({"design", dir_.file("none.yaml"), "-o", file}), 66);
  EXPECT_EQ(ctl({"design", example("paper1_example1.yaml"), "-o", file, "--proof", "magic"}), 64);
  EXPECT_EQ(ctl({"design", example("paper1_example1.yaml"), "-o", file, "--order", "1"}), 64);
  EXPECT_THAT(ctl_err_, HasSubstr("add --proof paper"));
}

}  // namespace
}  // namespace hapticd::test
