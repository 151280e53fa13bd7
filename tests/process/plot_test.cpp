// `hapticctl plot`, with the gnuplot of this machine.
#include <stdlib.h>

#include <filesystem>

#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

bool has_gnuplot() {
  return std::system("command -v gnuplot > /dev/null 2>&1") == 0;  // NOLINT(cert-env33-c)
}

/// Without gnuplot a picture cannot be tried; in CI that is a failure.
#define NEEDS_GNUPLOT()                                                           \
  if (!has_gnuplot()) {                                                           \
    const char* ci = ::getenv("CI");                                              \
    if (ci != nullptr && std::string(ci) == "true") FAIL() << "no gnuplot in CI"; \
    GTEST_SKIP() << "gnuplot is not installed (Debian's package gnuplot-nox)";    \
  }

class Plot : public DaemonTest {
 protected:
  std::string simulate(const std::string& name) {
    write_config({.failures = "{kind: nan, at_s: 0.8}"});
    const std::string file = dir_.file(name);
    EXPECT_EQ(ctl({"simulate", config_, "--duration", "1", "-o", file}), 1) << ctl_err_;
    return file;
  }
};

std::size_t big_endian(const std::string& bytes, std::size_t at) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes.at(at + i));
  return value;
}

TEST_F(Plot, ARecordingBecomesAPngOfTheAskedSize) {
  NEEDS_GNUPLOT()
  const std::string file = simulate("it's a \"run\".hapticrec");
  ASSERT_EQ(ctl({"plot", file, "--size", "640x700"}), 0) << ctl_err_;
  const std::string png = read_text(file + ".png");
  ASSERT_GT(png.size(), 1000u);
  EXPECT_THAT(png, StartsWith("\x89PNG\r\n"));
  EXPECT_EQ(big_endian(png, 16), 640u);
  EXPECT_EQ(big_endian(png, 20), 700u);
}

TEST_F(Plot, AnSvgHasTheSizeTheFieldsAndTheFault) {
  NEEDS_GNUPLOT()
  const std::string file = simulate("run"), picture = dir_.file("p.svg");
  ASSERT_EQ(ctl({"plot", file, "--out", picture, "--size", "900x500", "--fields",
                 "left.x.qd,scene_force", "--from", "0.2", "--json"}),
            0)
      << ctl_out_;
  const auto json = daemon::Json::parse(ctl_out_, nullptr, false);
  ASSERT_TRUE(json.is_object()) << ctl_out_;
  EXPECT_EQ(json["panels"][0]["curves"][0], "left.x.qd");
  EXPECT_EQ(json["panels"][1]["curves"][0], "left.x.scene_force");
  const std::string svg = read_text(picture);
  EXPECT_THAT(svg, AllOf(HasSubstr("<svg"), HasSubstr("width=\"900\" height=\"500\""),
                         HasSubstr("left.x.qd"), HasSubstr("scene_force [N]"),
                         HasSubstr("fault input_not_finite")));
}

TEST_F(Plot, CurvesOfACsvFileOnLogarithmicAxes) {
  NEEDS_GNUPLOT()
  write_file("front.csv", "time[ns],error[N],kind\n10,0.1,euler\n100,0.001,exact\n");
  const std::string picture = dir_.file("front.svg");
  ASSERT_EQ(ctl({"plot", dir_.file("front.csv"), "--out", picture, "--log", "xy", "--scatter"}), 0)
      << ctl_err_;
  EXPECT_THAT(read_text(picture), AllOf(HasSubstr("time [ns]"), HasSubstr("error [N]"),
                                        HasSubstr("euler"), HasSubstr("exact")));
}

TEST_F(Plot, WhatCannotBeDrawnIsToldByItsExitCode) {
  write_config({});
  EXPECT_EQ(ctl({"plot"}), 64);
  EXPECT_EQ(ctl({"plot", config_, "--size", "5x5"}), 64);
  EXPECT_EQ(ctl({"plot", config_, "--out", dir_.file("p.gif")}), 64);
  EXPECT_THAT(ctl_err_, HasSubstr(".png or .svg"));
  EXPECT_EQ(ctl({"plot", config_}), 65);
  EXPECT_THAT(ctl_err_, HasSubstr("neither a hapticd recording nor CSV"));
  EXPECT_EQ(ctl({"plot", dir_.file("none")}), 66);
}

TEST_F(Plot, APlaceThatCannotBeWrittenIsNamed) {
  NEEDS_GNUPLOT()
  write_file("a.csv", "x,y\n1,2\n2,3\n");
  EXPECT_EQ(ctl({"plot", dir_.file("a.csv"), "--out", dir_.file("none/p.png")}), 73);
  EXPECT_THAT(ctl_err_, HasSubstr("none/p.png"));
}

TEST_F(Plot, WithoutGnuplotThePackageIsNamed) {
  write_file("a.csv", "x,y\n1,2\n2,3\n");
  Process plot({HAPTICCTL_BINARY, "plot", dir_.file("a.csv")}, dir_.file("plot"),
               {{"PATH", dir_.path()}});
  EXPECT_EQ(plot.wait(), 69);
  EXPECT_THAT(plot.err(), HasSubstr("gnuplot-nox"));
  EXPECT_FALSE(std::filesystem::exists(dir_.file("a.csv.png")));
}

}  // namespace
}  // namespace hapticd::test
