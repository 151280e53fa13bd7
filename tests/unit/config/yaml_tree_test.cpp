// What a config must not use is refused with its place, and no text hurts the parser.
#include "config/yaml_tree.h"

#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

std::string repeated(const std::string& part, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += part;
  return text;
}

TEST(YamlTree, KeepsOrderMarksAndQuotes) {
  const YamlText yaml = parse_yaml("b: 1\na: {c: '2', d: [x, ~]}\n", "f");
  ASSERT_TRUE(yaml.sound);
  ASSERT_EQ(yaml.root.keys.size(), 2U);
  EXPECT_EQ(yaml.root.keys[0].text, "b");
  EXPECT_EQ(yaml.root.keys[1].mark.line, 2);
  const Node* a = find(yaml.root, "a");
  ASSERT_NE(a, nullptr);
  EXPECT_TRUE(find(*a, "c")->quoted);
  EXPECT_EQ(find(*a, "c")->mark.column, 8);
  EXPECT_EQ(find(*a, "d")->items[1].kind, NodeKind::null);
  EXPECT_EQ(find(*a, "e"), nullptr);
}

TEST(YamlTree, AnchorIsRefusedWhereItStands) {
  expect_error(replaced(kSmall, "latency_s: 0", "latency_s: &l 0"), "7:16", "", {"anchor"});
  expect_error(replaced(kSmall, "loop: {", "loop: &l {"), "2:7", "", {"anchor"});
  expect_error(replaced(kSmall, "scene:\n", "scene: &s\n"), "13:8", "", {"anchor"});
}

TEST(YamlTree, AliasIsRefused) {
  const auto errors =
      errors_of(replaced(kSmall, "rate_Hz: 1000", "rate_Hz: &r 1000, priority: *r"));
  ASSERT_EQ(errors.size(), 2U) << listed(errors);
  EXPECT_NE(errors[0].message.find("anchor"), std::string::npos);
  EXPECT_NE(errors[1].message.find("alias"), std::string::npos);
  EXPECT_EQ(errors[1].line, 2);
}

TEST(YamlTree, TagIsRefused) {
  expect_error(replaced(kSmall, "latency_s: 0", "latency_s: !!float 0"), "7:16", "", {"tag"});
  expect_error(replaced(kSmall, "latency_s: 0", "latency_s: ! 0"), "7:16", "", {"tag"});
  expect_error(replaced(kSmall, "loop: {", "loop: !loop {"), "2:7", "", {"tag"});
}

TEST(YamlTree, DuplicateKeyIsRefusedAndNamesTheFirst) {
  expect_error(kSmall + "guard: {max_force_N: 5}\n", "16:1", "",
               {"duplicate", "'guard'", "line 15"});
}

TEST(YamlTree, SecondDocumentIsRefused) {
  expect_error(kSmall + "---\nversion: 1\n", "16:1", "", {"second document"});
}

TEST(YamlTree, EndMarkAfterTheDocumentIsFine) {
  EXPECT_TRUE(errors_of("---\n" + kSmall + "...\n").empty());
}

TEST(YamlTree, KeyThatIsNoWordIsRefused) {
  expect_error(kSmall + "? [a, b]\n: 1\n", "16:3", "", {"key must be a word"});
}

TEST(YamlTree, SyntaxErrorHasItsPlace) {
  const auto errors = errors_of("version: 1\nloop: {rate_Hz: 1000\n");
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_GE(errors[0].line, 2);
  EXPECT_NE(errors[0].message.find("YAML syntax"), std::string::npos);
}

TEST(YamlTree, EmptyTextIsRefused) {
  expect_error("", "1:1", "", {"empty"});
  expect_error("# nothing but a comment\n", "1:1", "", {"empty"});
}

TEST(YamlTree, TextThatIsNoMapIsRefused) {
  expect_error("just words\n", "1:1", "", {"expected a map", "'just words'"});
  expect_error("- 1\n", "1:1", "", {"expected a map", "a list of 1"});
}

TEST(YamlTree, TextOverOneMebibyteIsRefusedBeforeParsing) {
  const std::string comment = "#" + std::string(kMaxTextBytes - kSmall.size() - 2, 'x') + "\n";
  EXPECT_TRUE(errors_of(kSmall + comment).empty()) << "exactly 1 MiB";
  expect_error(kSmall + comment + "\n", "0:0", "", {"1 MiB"});
  // It would be a syntax error, if it were parsed.
  expect_error(repeated("]", kMaxTextBytes + 1), "0:0", "", {"1 MiB"});
}

TEST(YamlTree, DeepNestingIsRefusedAndNothingElseHappens) {
  for (const char* part : {"[", "{", "{a: ", "- ", "? ", "[\n", "[[a, ", ": "}) {
    const std::string text = repeated(part, 100'000);
    const auto errors = errors_of(text);
    ASSERT_GE(errors.size(), 1U) << part;
    EXPECT_NE(errors.back().message.find("nested deeper than 32"), std::string::npos)
        << part << listed(errors);
  }
}

TEST(YamlTree, LargeHostileTextsEndInErrors) {
  for (const char* part :
       {"]",   ",",  "a:\n", "a: ", "&a ", "*a ", "! ", "!",     "'",       "\"", "%a b\n", "---\n",
        "[],", "[]", "\n",   "#\n", "a\n", "|\n", ": ", "- a\n", "a: {}\n", "\\", "@",      "`"}) {
    const std::size_t count = 400'000 / std::string(part).size();
    EXPECT_FALSE(errors_of(repeated(part, count)).empty()) << part;
  }
}

TEST(YamlTree, ManyDistinctKeysThenDuplicatesAreReadQuickly) {
  std::string text;
  for (int i = 0; i < 60'000; ++i) text += "k" + std::to_string(i) + ":\n";
  const auto errors = errors_of(text + repeated("k59999:\n", 60'000));
  EXPECT_EQ(errors.size(), kMaxErrors);
}

TEST(TextCheck, NulByteIsRefused) {
  std::string text = kSmall;
  text[kSmall.find("rate_Hz")] = '\0';
  expect_error(text, "2:8", "", {"NUL", "UTF-8"});
}

TEST(TextCheck, ControlCharacterIsRefused) {
  expect_error(kSmall + "# bell \a\n", "16:8", "", {"0x07"});
}

TEST(TextCheck, InvalidUtf8IsRefused) {
  for (const char* bytes : {"\xff", "\x80", "\xc0\xaf", "\xc3", "\xed\xa0\x80", "\xf5\x80\x80\x80",
                            "\xe2\x82", "\xf4\x90\x80\x80"}) {
    expect_error(kSmall + "# " + bytes + "\n", "16:3", "", {"not UTF-8"});
  }
}

TEST(TextCheck, Utf8IsFineInCommentsAndTexts) {
  const std::string text = replaced(
      kSmall, "guard:",
      "telemetry: {flight_dir: \"/tmp/f\xc3\xbcnf\"}  # \xe2\x82\xac \xf0\x9f\x99\x82\nguard:");
  EXPECT_EQ(config_of(text).telemetry.flight_dir, "/tmp/f\xc3\xbcnf");
}

TEST(TextCheck, TabAsIndentationIsRefused) {
  expect_error(replaced(kSmall, "    driver", "\tdriver"), "5:1", "", {"tab"});
  expect_error(replaced(kSmall, "    driver", "  \tdriver"), "5:3", "", {"tab"});
}

TEST(TextCheck, TabElsewhereIsFine) {
  EXPECT_TRUE(errors_of(replaced(kSmall, "version: 1", "version: 1\t# one")).empty());
}

TEST(TextCheck, CrLfReadsAsLfDoes) {
  std::string text;
  for (const char c : kSmall) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(config_of(text), config_of(kSmall));
  expect_error(replaced(text, "rate_Hz: 1000", "rate_Hz: x"), "2:17", "loop.rate_Hz", {"'x'"});
}

TEST(TextCheck, CarriageReturnAloneIsRefused) {
  expect_error("version: 1\rloop: {}\n", "1:11", "", {"carriage return"});
}

TEST(TextCheck, ByteOrderMarkIsSkipped) {
  EXPECT_EQ(config_of("\xEF\xBB\xBF" + kSmall), config_of(kSmall));
  expect_error("\xEF\xBB\xBF" + replaced(kSmall, "latency_s: 0", "latency_s: ! 0"), "7:16", "",
               {"tag"});
}

}  // namespace
}  // namespace hapticd::config::test
