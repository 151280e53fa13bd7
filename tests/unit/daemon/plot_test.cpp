#include "daemon/plot.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "daemon/plot_csv.h"
#include "daemon/plot_gnuplot.h"
#include "daemon/plot_recording.h"
#include "daemon/plot_script.h"
#include "tests/unit/daemon/recording_fixture.h"

namespace hapticd::daemon {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Curve straight(std::size_t points) {
  Curve curve{.title = "y"};
  for (std::size_t i = 0; i < points; ++i) {
    curve.x.push_back(static_cast<double>(i));
    curve.y.push_back(0);
  }
  return curve;
}

std::vector<std::string> labels(const Picture& picture) {
  std::vector<std::string> all;
  for (const Panel& panel : picture.panels) all.push_back(panel.label);
  return all;
}

std::vector<std::string> titles(const Panel& panel) {
  std::vector<std::string> all;
  for (const Curve& curve : panel.curves) all.push_back(curve.title);
  return all;
}

TEST(Decimate, KeepsEveryPeakWithTwoPointsAColumn) {
  Curve curve = straight(100'000);
  curve.y[33'333] = 7;
  curve.y[33'335] = -5;
  curve.y[99'999] = 3;
  decimate(curve, 500);
  EXPECT_LE(curve.x.size(), 1000u);
  EXPECT_EQ(curve.x.size(), curve.y.size());
  EXPECT_TRUE(std::is_sorted(curve.x.begin(), curve.x.end()));
  for (const auto& [x, y] : {std::pair{33'333.0, 7.0}, {33'335.0, -5.0}, {99'999.0, 3.0}}) {
    const auto at = std::find(curve.x.begin(), curve.x.end(), x);
    ASSERT_NE(at, curve.x.end()) << x;
    EXPECT_EQ(curve.y[static_cast<std::size_t>(at - curve.x.begin())], y);
  }
}

TEST(Decimate, LeavesAShortCurveAsItIs) {
  Curve curve = straight(200);
  curve.y[7] = 1;
  const Curve before = curve;
  decimate(curve, 100);
  EXPECT_EQ(curve.x, before.x);
  EXPECT_EQ(curve.y, before.y);
}

TEST(Decimate, AGapStaysAGap) {
  Curve curve = straight(10'000);
  for (std::size_t i = 4000; i < 5000; ++i) curve.y[i] = kNaN;
  decimate(curve, 100);
  EXPECT_EQ(std::count_if(curve.y.begin(), curve.y.end(), [](double y) { return std::isnan(y); }),
            1);
  const auto gap =
      std::find_if(curve.y.begin(), curve.y.end(), [](double y) { return std::isnan(y); });
  const auto i = static_cast<std::size_t>(gap - curve.y.begin());
  EXPECT_LT(curve.x[i - 1], 4000);
  EXPECT_GE(curve.x[i + 1], 5000);
}

TEST(PlotScript, ALiteralHoldsWhateverANameIs) {
  EXPECT_EQ(quoted("it's"), "'it''s'");
  EXPECT_EQ(quoted("a\nsystem(\"ls\")\t\\n"), "'a system(\"ls\") \\n'");
}

TEST(PlotScript, HasAPanelForEachAndAllThatIsAskedFor) {
  const Picture picture{
      .title = "it's",
      .x_label = "t [s]",
      .panels = {{.label = "force [N]",
                  .curves = {{.title = "f", .x = {0, 1, 2}, .y = {1, kNaN, 2}}}},
                 {.label = "q", .curves = {{.title = "q", .x = {0, 2}, .y = {3, 4}}}}},
      .marks = {{.kind = Mark::Kind::fault, .from = 1.5, .to = 1.5, .text = "fault estop"},
                {.kind = Mark::Kind::limit, .from = 0.25, .to = 0.5, .text = "limit slew"}}};
  const std::string script = gnuplot_script(picture, PictureFormat::svg, 640, 480);
  EXPECT_THAT(script,
              AllOf(HasSubstr("set terminal svg size 640,480"),
                    HasSubstr("set multiplot layout 2,1 title 'it''s, shaded: limit slew'"),
                    HasSubstr("$p0c0 << EOD\n0 1\n\n2 2\nEOD\n"), HasSubstr("set xrange [0:2]"),
                    HasSubstr("arrow from 1.5, graph 0 to 1.5, graph 1"),
                    HasSubstr("rectangle from 0.25, graph 0 to 0.5, graph 1")));
  EXPECT_THAT(script, AllOf(HasSubstr("set ylabel 'force [N]'"), HasSubstr("set ylabel 'q'"),
                            HasSubstr("set xlabel 't [s]'"), HasSubstr("with lines"),
                            Not(HasSubstr("logscale"))));
}

TEST(PlotScript, PointsLogarithmsAndLabelsAreOnRequest) {
  Picture picture{.title = "", .x_label = "ns", .panels = {{.label = "error"}}};
  picture.panels[0].curves = {
      {.title = "a", .x = {1, 10}, .y = {1, 2}, .labels = {"euler", "x\"y"}}};
  picture.log_x = picture.scatter = true;
  const std::string script = gnuplot_script(picture, PictureFormat::png, 100, 100);
  EXPECT_THAT(script, AllOf(HasSubstr("pngcairo size 100,100"), HasSubstr("set logscale x\n"),
                            Not(HasSubstr("set logscale y")), HasSubstr("with points"),
                            HasSubstr("1 1 \"euler\"\n10 2 \"x y\"\n"), HasSubstr("with labels")));
}

TEST(PlotCsv, TheFirstRowNamesAndTheFirstColumnIsX) {
  const auto picture =
      csv_picture("t[s],a[N],\"b, c\",d[N]\n# a remark\n0,1,5,2\n1,,6,nan\n", "p/f.csv", {});
  ASSERT_TRUE(picture) << picture.error().text;
  EXPECT_EQ(picture->title, "f.csv");
  EXPECT_EQ(picture->x_label, "t [s]");
  EXPECT_THAT(labels(*picture), ElementsAre("[N]", "b, c"));
  EXPECT_THAT(titles(picture->panels[0]), ElementsAre("a", "d"));
  EXPECT_THAT(picture->panels[1].curves[0].y, ElementsAre(5, 6));
  EXPECT_TRUE(std::isnan(picture->panels[0].curves[0].y[1]));
}

TEST(PlotCsv, AColumnOfWordsLabelsThePoints) {
  const auto picture = csv_picture("ns,error,kind\n1,2,euler\n3,4,exact\n", "f", {.scatter = true});
  ASSERT_TRUE(picture) << picture.error().text;
  ASSERT_EQ(picture->panels.size(), 1u);
  ASSERT_EQ(picture->panels[0].curves.size(), 1u);
  EXPECT_THAT(picture->panels[0].curves[0].labels, ElementsAre("euler", "exact"));
}

TEST(PlotCsv, FieldsAndARangeAreChosen) {
  const auto picture =
      csv_picture("x,a,b\n0,1,2\n1,3,4\n2,5,6\n", "f", {.fields = {"b"}, .from = 0.5, .to = 1.5});
  ASSERT_TRUE(picture) << picture.error().text;
  EXPECT_THAT(labels(*picture), ElementsAre("b"));
  EXPECT_THAT(picture->panels[0].curves[0].x, ElementsAre(1));
  const auto wrong = csv_picture("x,a\n0,1\n", "f", {.fields = {"c"}});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ExitCode::usage);
  EXPECT_THAT(wrong.error().text, HasSubstr("there are: a"));
}

TEST(PlotCsv, WhatIsNoTableIsRefusedWithItsLine) {
  for (const auto& [text, what] : {std::pair{"version: 1\n", "line 1: expected the names of two"},
                                   {"a,b\n1,2\n1,2,3\n", "line 3: expected 2 fields, found 3"},
                                   {"a,b\nx,2\n", "'a': it is x"},
                                   {"a,b\n", "lines of numbers"},
                                   {"", "a line of names"}}) {
    const auto picture = csv_picture(text, "f", {});
    ASSERT_FALSE(picture) << text;
    EXPECT_EQ(picture.error().code, ExitCode::bad_data);
    EXPECT_THAT(picture.error().text,
                AllOf(HasSubstr("neither a hapticd recording nor CSV"), HasSubstr(what)));
  }
}

class PlotTest : public RecordingTest {
 protected:
  PlotTest() { recording_.header = header(); }
  void add(std::uint32_t n) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto bytes = record(static_cast<std::uint32_t>(recording_.size()));
      recording_.data.insert(recording_.data.end(), bytes.begin(), bytes.end());
    }
  }
  template <class T>
  void put(std::size_t i, const std::string& name, T value) {
    const Field* field = recording_.find(name);
    ASSERT_NE(field, nullptr) << name;
    std::memcpy(recording_.data.data() + i * recording_.header.record_bytes + field->offset, &value,
                sizeof value);
  }
  Picture picture(const PlotOptions& options = {}) {
    return recording_picture(recording_, "a/b.hapticrec", options).value();
  }
  Recording recording_;
};

TEST_F(PlotTest, ARecordingShowsPositionForceAndEffortOfEachDevice) {
  add(3);
  put(2, "left.y.force", 1.5);
  const Picture shown = picture();
  EXPECT_THAT(labels(shown),
              ElementsAre("left position [m]", "left force [N]", "left effort [N]",
                          "right position [m]", "right force [N]", "right effort [N]"));
  EXPECT_THAT(titles(shown.panels[1]), ElementsAre("left.x.force", "left.y.force"));
  EXPECT_THAT(shown.panels[1].curves[1].y, ElementsAre(0, 0, 1.5));
  EXPECT_THAT(shown.panels[1].curves[1].x, ElementsAre(0, 0.001, 0.002));
  EXPECT_EQ(shown.title, "b.hapticrec");
}

TEST_F(PlotTest, FieldsAreNamedInFullOrByTheirEnd) {
  add(5);
  const Picture shown = picture({.fields = {"left.x.qd", "q"}, .from = 0.001, .to = 0.003});
  EXPECT_THAT(labels(shown), ElementsAre("left.x.qd [m/s]", "q [m]"));
  EXPECT_THAT(titles(shown.panels[1]), ElementsAre("left.x.q", "left.y.q", "right.x.q"));
  EXPECT_EQ(shown.panels[0].curves[0].x.size(), 3u);
  const auto wrong = recording_picture(recording_, "f", {.fields = {"torque"}});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ExitCode::usage);
  EXPECT_THAT(wrong.error().text, HasSubstr("no field 'torque'"));
}

TEST_F(PlotTest, FaultsAndLimitsAreMarkedWhereTheyWere) {
  add(1000);
  for (std::size_t i = 200; i < 300; ++i) put(i, "limits", static_cast<std::uint32_t>(Limit::slew));
  put(600, "limits", static_cast<std::uint32_t>(Limit::slew));
  for (std::size_t i = 700; i < 1000; ++i) put(i, "fault", Fault::velocity);
  const std::vector<Mark> marks = picture().marks;
  ASSERT_EQ(marks.size(), 3u);
  EXPECT_EQ(marks[0].kind, Mark::Kind::limit);
  EXPECT_NEAR(marks[0].from, 0.2, 1e-9);
  EXPECT_NEAR(marks[0].to, 0.3, 1e-3);
  EXPECT_EQ(marks[0].text, "limit slew");
  EXPECT_NEAR(marks[1].from, 0.6, 1e-9);
  EXPECT_EQ(marks[1].text, "");
  EXPECT_EQ(marks[2].kind, Mark::Kind::fault);
  EXPECT_NEAR(marks[2].from, 0.7, 1e-9);
  EXPECT_EQ(marks[2].text, "fault velocity");
}

TEST_F(PlotTest, TheProxyIsBesideThePosition) {
  Field proxy = *recording_.find("left.x.position");
  proxy.name = "left.x.proxy";
  recording_.header.fields.push_back(proxy);
  add(1);
  EXPECT_THAT(titles(picture().panels[0]),
              ElementsAre("left.x.position", "left.y.position", "left.x.proxy"));
}

TEST_F(PlotTest, AFileIsKnownByWhatIsInItAndNothingToDrawIsAnError) {
  write_records(path("r"), 10);
  spill(path("c"), "x,y\n1,-2\n");
  EXPECT_EQ(read_picture(path("r"), {})->panels.size(), 6u);
  EXPECT_EQ(read_picture(path("c"), {})->panels.size(), 1u);
  const auto none = read_picture(path("c"), {.log_y = true});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ExitCode::bad_data);
  EXPECT_THAT(none.error().text, HasSubstr("above zero"));
  EXPECT_EQ(read_picture(path("r"), {.from = 5}).error().code, ExitCode::bad_data);
  EXPECT_EQ(read_picture(path("none"), {}).error().code, ExitCode::no_input);
  EXPECT_EQ(read_picture(dir_.string(), {}).error().code, ExitCode::no_input);
}

TEST_F(PlotTest, ALongRecordingIsDrawnWithAsManyPointsAsCanBeSeen) {
  write_records(path("r"), 50'000);
  const auto shown = read_picture(path("r"), {.width = 300});
  ASSERT_TRUE(shown);
  for (const Panel& panel : shown->panels) {
    for (const Curve& curve : panel.curves) EXPECT_LE(curve.x.size(), 600u);
  }
}

/// A program that stands for gnuplot.
class FakeGnuplot : public PlotTest {
 protected:
  std::string program(const std::string& body) const {
    const std::string file = path("gnuplot");
    spill(file, "#!/bin/sh\n" + body + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return file;
  }
};

TEST_F(FakeGnuplot, GetsTheScriptOnItsInputAndItsOutputIsThePicture) {
  const std::string script(300'000, 'x');
  const auto drawn = run_gnuplot(script, program("test \"$1\" = --default-settings && cat"));
  ASSERT_TRUE(drawn) << drawn.error().text;
  EXPECT_EQ(*drawn, script);
}

TEST_F(FakeGnuplot, AMissingOneIsToldWithItsPackage) {
  const auto drawn = run_gnuplot("", path("none"));
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().code, ExitCode::unavailable);
  EXPECT_THAT(drawn.error().text, HasSubstr("gnuplot-nox"));
}

TEST_F(FakeGnuplot, OneThatHangsIsKilled) {
  const auto drawn = run_gnuplot("", program("exec sleep 1000"), std::chrono::milliseconds(100));
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().code, ExitCode::unavailable);
  EXPECT_THAT(drawn.error().text, HasSubstr("was killed"));
}

TEST_F(FakeGnuplot, WhatItComplainsAboutIsPassedOn) {
  const auto drawn = run_gnuplot("", program("echo line 3: no such thing >&2; exit 1"));
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().code, ExitCode::software);
  EXPECT_THAT(drawn.error().text, HasSubstr("line 3: no such thing"));
}

}  // namespace
}  // namespace hapticd::daemon
