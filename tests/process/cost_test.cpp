// `hapticctl cost`.
#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

using Cost = DaemonTest;

TEST_F(Cost, EveryPartOfAConfigHasARow) {
  write_config({});
  ASSERT_EQ(ctl({"cost", config_, "--ticks", "1000"}), 0) << ctl_err_;
  EXPECT_THAT(ctl_out_,
              AllOf(HasSubstr("period 1000000 ns"), HasSubstr("load"), HasSubstr("predicted"),
                    HasSubstr("loop"), HasSubstr("observers"), HasSubstr("coupling and networks"),
                    HasSubstr("broad phase"), HasSubstr("plane wall, touched"),
                    HasSubstr("total, nothing touched")));
  ASSERT_EQ(ctl({"cost", config_, "--ticks", "1000", "--json"}), 0) << ctl_err_;
  const auto json = daemon::Json::parse(ctl_out_, nullptr, false);
  ASSERT_TRUE(json.is_object()) << ctl_out_;
  EXPECT_EQ(json["period_ns"], 1e6);
  EXPECT_GT(json["stages"]["loop"]["measured_ns"].get<double>(), 0);
  EXPECT_EQ(json["objects"][0]["name"], "wall");
}

TEST_F(Cost, TenThousandObjectsAreAnswered) {
  write_config({});
  std::string text = read_text(config_);
  std::string spheres;
  for (int i = 0; i < 10'000; ++i) {
    spheres += "  - sphere: {name: s" + std::to_string(i) + ", center_m: [" +
               std::to_string(0.1 * (i % 100)) + ", 0, 0], radius_m: 0.01, stiffness_N_m: 10}\n";
  }
  text.insert(text.find("stability:"), spheres);
  write_file("config.yaml", text);
  ASSERT_EQ(ctl({"cost", config_, "--ticks", "1000"}), 0) << ctl_err_;
  EXPECT_THAT(ctl_out_, HasSubstr("and 9950 more of kind sphere, touched"));
}

TEST_F(Cost, EndsAsCheckDoesWhereThereIsNothingToMeasure) {
  write_file("config.yaml", "version: 1\n");
  EXPECT_EQ(ctl({"cost", config_}), 65);
  EXPECT_THAT(ctl_err_, HasSubstr("config.yaml"));
  EXPECT_EQ(ctl({"cost", dir_.file("none")}), 66);
  EXPECT_EQ(ctl({"cost"}), 64);
  EXPECT_EQ(ctl({"cost", config_, "--ticks", "0"}), 64);
}

}  // namespace
}  // namespace hapticd::test
