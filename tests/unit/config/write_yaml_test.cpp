// What is written as YAML is read back as the same struct.
#include "config/write_yaml.h"

#include "config/digest.h"
#include "tests/unit/config/full_config.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

void expect_read_back(const Config& config) {
  const std::string text = to_yaml(config);
  const auto document = read_text(text, "written.yaml");
  ASSERT_TRUE(document) << listed(document.error()) << text;
  EXPECT_EQ(document->config, config) << text;
}

TEST(WriteYaml, EveryKeyIsReadBack) {
  expect_read_back(config_of(kFull.dump()));
}

TEST(WriteYaml, DefaultsAreReadBack) {
  expect_read_back(config_of(kSmall));
}

TEST(WriteYaml, EveryKindOfObjectIsReadBack) {
  for (const json* kinds : {&kOtherKinds, &kOtherSurfaces}) {
    for (const auto& [key, ignored] : kinds->items()) {
      if (key == "five_bar" || key == "delta" || key == "serial") continue;
      json config = kFull;
      config["scene"] = json::array({json{{key, other_kind(key)}}});
      expect_read_back(config_of(config.dump()));
    }
  }
}

TEST(WriteYaml, NumbersKeepTheirLastBit) {
  Config config = config_of(kSmall);
  for (const double value : {0.1, 1.0 / 30, 1e-7, 1 / 123456.789012345, 2.2250738585072014e-5}) {
    config.devices[0].latency_s = value;
    expect_read_back(config);
  }
}

TEST(WriteYaml, TextsInQuotesAreReadBack) {
  Config config = config_of(kSmall);
  config.telemetry.flight_dir = R"(/tmp/a "quoted" \ path: [x], #y)";
  expect_read_back(config);
}

TEST(Digest, LeavesOutItsOwnLine) {
  const std::string text = "a: 1\nb: 2\n";
  EXPECT_EQ(digest_of_rest(text), digest_of(text));
  EXPECT_EQ(digest_of_rest(text + "digest: x\n"), digest_of(text));
  EXPECT_EQ(digest_of_rest("a: 1\ndigest: x\nb: 2\n"), digest_of(text));
  EXPECT_NE(digest_of_rest("a: 1\n digest: x\nb: 2\n"), digest_of(text));
  EXPECT_EQ(digest_of(""), "cbf29ce484222325") << "FNV-1a's offset basis";
  EXPECT_EQ(digest_of("a"), "af63dc4c8601ec8c") << "published test vector";
}

}  // namespace
}  // namespace hapticd::config::test
