// The strict reader: every way to be wrong that the design names, with place, path, what was
// expected and found.
#include "config/nearest.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

void expect_rate_error(const std::string& value, const std::vector<std::string>& words) {
  expect_error(replaced(kSmall, "rate_Hz: 1000", "rate_Hz: " + value), "2:17", "loop.rate_Hz",
               words);
}
void expect_bits_error(const std::string& value, const std::vector<std::string>& words) {
  expect_error(replaced(kSmall, "bits: 32", "bits: " + value), "10:47",
               "devices[0].axes[0].encoder.bits", words);
}

TEST(Reader, SmallConfigIsReadInFull) {
  const Config config = config_of(kSmall);
  ASSERT_EQ(config.devices.size(), 1U);
  const Axis& axis = config.devices[0].axes.at(0);
  EXPECT_EQ(config.devices[0].name, "left");
  EXPECT_EQ(axis.encoder.counts_per_m, 163840);
  EXPECT_EQ(axis.model->damping_uncertainty, 0.2);
  EXPECT_EQ(config.guard.max_force_N, 6);
  EXPECT_EQ(std::get<Plane>(config.scene.at(0)).normal, (std::array<double, 3>{1, 0, 0}));
}

TEST(Reader, WrittenDefaultsAreTheDefaults) {
  const std::string text = replaced(
      kSmall, "      - name: x\n",
      "      - name: x\n        kind: linear\n"
      "        velocity: {estimator: backward_difference}\n        observer: {mode: off}\n");
  EXPECT_EQ(config_of(text), config_of(kSmall));
  expect_error(replaced(text, "mode: off", "mode: clasic"), "12:26",
               "devices[0].axes[0].observer.mode", {"one of off, model", "'classic'"});
}

TEST(Reader, UnknownKeyGetsTheNearestValidOne) {
  expect_error(replaced(kSmall, "rate_Hz", "rate_hz"), "2:8", "loop.'rate_hz'",
               {"unknown key", "'rate_Hz'"});
  expect_error(replaced(kSmall, "bits: 32", "bist: 32"), "10:41",
               "devices[0].axes[0].encoder.'bist'", {"'bits'"});
}

TEST(Reader, UnknownKeyFarFromAllGetsTheList) {
  expect_error(kSmall + "haptics: {}\n", "16:1", "'haptics'",
               {"unknown key", "known here", "stability"});
}

TEST(Reader, MissingKeyIsNamedAtItsMap) {
  expect_error(replaced(kSmall, "counts_per_m: 163840, ", ""), "10:18",
               "devices[0].axes[0].encoder.counts_per_m", {"missing", "counts_per_m", "linear"});
  expect_error(replaced(kSmall, "version: 1\n", ""), "1:1", "version", {"missing"});
  expect_error(replaced(kSmall, "    latency_s: 0\n", ""), "4:5", "devices[0].latency_s",
               {"missing"});
}

TEST(Reader, WrongTypeIsRefused) {
  expect_rate_error("fast", {"expected a number from 100 to 8000 Hz", "found 'fast'"});
  expect_rate_error("[1000]", {"expected a number", "a list of 1"});
  expect_rate_error("{}", {"expected a number", "an empty map"});
  expect_rate_error("true", {"expected a number", "'true'"});
  expect_bits_error("3.5", {"expected a whole number", "3.5"});
  expect_bits_error("1e1", {"expected a whole number", "exponent"});
  expect_error(replaced(kSmall, "loop: {rate_Hz: 1000}", "loop: 5"), "2:7", "loop",
               {"expected a map", "'5'"});
  expect_error(replaced(kSmall, "loop: {rate_Hz: 1000}", "loop:"), "2:1", "loop",
               {"expected a map", "nothing"});
  expect_error(replaced(kSmall, "[x]", "x"), "6:42", "devices[0].kinematics.cartesian.directions",
               {"expected a list of 1 to 3 entries", "'x'"});
}

TEST(Reader, NothingIsNoNumber) {
  expect_error(replaced(kSmall, "    latency_s: 0\n", "    latency_s:\n"), "7:5",
               "devices[0].latency_s", {"expected a number", "nothing"});
}

TEST(Reader, QuotedNumberIsNoNumber) {
  expect_rate_error("'1000'", {"the text '1000'", "remove the quotes"});
  expect_bits_error("\"32\"", {"remove the quotes"});
}

TEST(Reader, NanAndInfinityAreRefused) {
  for (const char* nan : {".nan", ".NaN", "nan"}) expect_rate_error(nan, {"NaN is not taken"});
  for (const char* inf : {".inf", "-.inf", "+.Inf", "inf", "Infinity"})
    expect_rate_error(inf, {"infinity is not taken"});
  expect_rate_error("1e999", {"no double"});
}

TEST(Reader, OctalHexadecimalAndBinaryAreRefused) {
  for (const char* text : {"0x20", "0o40", "0b100000", "-0x1", "0XFF"})
    expect_bits_error(text, {"octal, hexadecimal"});
  expect_bits_error("040", {"leading zero"});
  expect_rate_error("01000", {"leading zero"});
  expect_rate_error("0x3e8", {"octal, hexadecimal"});
}

TEST(Reader, OtherNotationsOfNumbersAreRefused) {
  for (const char* text : {"1_000", "1:30", "1000Hz", "1 000", "1e", "e5", ".", "-", "+"}) {
    expect_rate_error(text, {"expected a number"});
  }
  expect_error(replaced(kSmall, "latency_s: 0", "latency_s: 0,001"), "7:16", "devices[0].latency_s",
               {"the decimal sign is a point"});
}

TEST(Reader, DecimalNotationsAreTaken) {
  for (const char* text :
       {"1000", "+1000", "1000.", "1000.0", "1e3", "1.0E+3", "10000e-1", ".1e4"}) {
    EXPECT_EQ(
        config_of(replaced(kSmall, "rate_Hz: 1000", "rate_Hz: " + std::string(text))).loop.rate_Hz,
        1000)
        << text;
  }
}

TEST(Reader, OutOfRangeNamesTheRange) {
  expect_rate_error("0", {"from 100 to 8000 Hz", "'0'"});
  expect_rate_error("8000.001", {"from 100 to 8000 Hz"});
  expect_bits_error("53", {"from 0 to 52"});
  expect_bits_error("-1", {"from 0 to 52"});
  expect_bits_error("99999999999999999999", {"too large"});
  expect_error(replaced(kSmall, "counts_per_m: 163840", "counts_per_m: 0"), "10:33",
               "devices[0].axes[0].encoder.counts_per_m", {"above 0"});
  expect_error(replaced(kSmall, "version: 1", "version: 2"), "1:10", "version",
               {"expected a whole number 1", "'2'"});
}

TEST(Reader, OnlyTrueAndFalseAreBool) {
  const auto with = [](const std::string& value) {
    return replaced(kSmall, "bits: 32", "reversed: " + value);
  };
  EXPECT_TRUE(config_of(with("true")).devices[0].axes[0].encoder.reversed);
  EXPECT_FALSE(config_of(with("false")).devices[0].axes[0].encoder.reversed);
  for (const char* text : {"yes", "no", "on", "off", "True", "TRUE", "y", "1", "'true'"}) {
    expect_error(with(text), "10:51", "devices[0].axes[0].encoder.reversed", {"true or false"});
  }
}

TEST(Reader, WordOfAnEnumerationIsCheckedAndSuggested) {
  expect_error(replaced(kSmall, "guard:", "start: {enable: when_redy}\nguard:"), "15:17",
               "start.enable", {"one of on_command, when_ready", "did you mean 'when_ready'"});
  expect_error(replaced(kSmall, "driver: sim", "driver: odrve"), "5:13", "devices[0].driver",
               {"expected one of sim, odrive", "did you mean 'odrive'?"});
  expect_error(replaced(kSmall, "- plane:", "- spere:"), "14:5", "scene[0]",
               {"expected one of plane, ", "did you mean 'sphere'?"});
}

TEST(Reader, SceneEntryHasOneKind) {
  expect_error(replaced(kSmall, "  - plane: {", "  - {}\n  - plane: {"), "14:5", "scene[0]",
               {"a map with one key"});
}

TEST(Reader, NamesAreLowerCaseWords) {
  for (const char* name :
       {"Left", "1left", "_left", "le-ft", "le ft", "''", "5", "true", "\"l\\0\"", "l\xc3\xa9"}) {
    expect_error(replaced(kSmall, "name: left", "name: " + std::string(name)), "4:11",
                 "devices[0].name", {"a name: a to z"});
  }
  EXPECT_EQ(config_of(replaced(kSmall, "name: left", "name: l_3ft")).devices[0].name, "l_3ft");
}

TEST(Reader, UnquotedNumberIsNoText) {
  expect_error(kSmall + "telemetry: {record: 5}\n", "16:21", "telemetry.record",
               {"expected a text", "quotes"});
}

TEST(Reader, NullStandsForTheDefaultOfAnOptionalKey) {
  EXPECT_EQ(config_of(kSmall + "telemetry: {record: null}\n"), config_of(kSmall));
  EXPECT_EQ(config_of(kSmall + "telemetry: {record: }\n"), config_of(kSmall));
}

TEST(Reader, ListLengthIsChecked) {
  expect_error(replaced(kSmall, "[1, 0, 0]", "[1, 0]"), "14:33", "scene[0].plane.normal",
               {"3 entries", "a list of 2"});
  expect_error(replaced(kSmall, "[x]", "[]"), "6:42", "devices[0].kinematics.cartesian.directions",
               {"1 to 3 entries"});
}

TEST(Reader, ListItemIsNamedByItsIndex) {
  expect_error(replaced(kSmall, "[1, 0, 0]", "[1, 0, up]"), "14:40", "scene[0].plane.normal[2]",
               {"a number", "'up'"});
}

TEST(Reader, TenThousandAxesGiveOneError) {
  std::string axes;
  for (int i = 0; i < 10'000; ++i) axes += "      - {nonsense: true}\n";
  const std::string text = replaced(kSmall, "      - name: x\n", axes + "      - name: x\n");
  expect_error(text, "9:7", "devices[0].axes", {"1 to 6 entries", "a list of 10001"});
}

TEST(Reader, AllErrorsComeAtOnceInTheOrderOfTheFile) {
  std::string text = replaced(kSmall, "rate_Hz: 1000", "rate_Hz: fast, rate_hz: 1");
  text = replaced(text, "latency_s: 0", "latency_s: &a 0");
  text = replaced(text, "bits: 32", "bits: 0x20, bits: 5");
  text = replaced(text, "stiffness_N_m: 1000", "stiffness_N_m: .nan");
  text = replaced(text, "guard: {max_force_N: 6}", "guard: {max_force_N: '6'}\nguard: {}");
  const auto errors = errors_of(text);
  const std::vector<int> lines = {2, 2, 7, 10, 10, 14, 15, 16};
  ASSERT_EQ(errors.size(), lines.size()) << listed(errors);
  for (std::size_t i = 0; i < lines.size(); ++i)
    EXPECT_EQ(errors[i].line, lines[i]) << listed(errors);
}

TEST(Reader, ErrorReadsAsOneLineForPeople) {
  const auto errors = errors_of(replaced(kSmall, "bits: 32", "bits: 99"));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(
      to_string(errors[0]),
      "test.yaml:10:47: devices[0].axes[0].encoder.bits: expected a whole number from 0 to 52, "
      "found '99'");
}

TEST(Reader, LongOrBinaryTextIsShownShort) {
  std::string value(5000, 'x');
  value.insert(0, "rate_Hz: \"").append("\\n\"");
  const auto errors = errors_of(replaced(kSmall, "rate_Hz: 1000", value));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_LT(errors[0].message.size(), 150U);
}

TEST(Nearest, FindsWhatWasMeant) {
  EXPECT_EQ(nearest("stifness_N_m", {"damping_Ns_m", "stiffness_N_m"}), "stiffness_N_m");
  EXPECT_EQ(nearest("RATE_HZ", {"rate_Hz", "priority"}), "rate_Hz");
  EXPECT_EQ(nearest("zz", {"x", "y"}), "");
  EXPECT_EQ(nearest(std::string(100'000, 'a'), {"a"}), "");
}

TEST(Nearest, DistanceCountsASwapOnce) {
  EXPECT_EQ(edit_distance("bist", "bits"), 1U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
}

}  // namespace
}  // namespace hapticd::config::test
