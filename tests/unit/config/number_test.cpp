// Numbers read and print the same wherever the machine stands.
#include "config/number.h"

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <locale>

#include "config/json_schema.h"
#include "config/print.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

struct CommaPoint : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// A German C locale, built into a directory of its own where the system has none. Empty: cannot be
/// had.
std::string german_locale(const std::filesystem::path& directory) {
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) return name;
  }
  const std::string made = (directory / "de_DE.UTF-8").string();
  const std::string command =
      "localedef -i de_DE -f UTF-8 --no-archive " + made + " >/dev/null 2>&1";
  if (std::system(command.c_str()) != 0 && !std::filesystem::exists(made)) return {};
  ::setenv("LOCPATH", directory.c_str(), 1);
  return std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr ? "de_DE.UTF-8" : std::string{};
}

class CommaLocale : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "hapticd_locale_XXXXXX").string();
    directory_ = ::mkdtemp(pattern.data());
    before_ = std::locale::global(std::locale(std::locale::classic(), new CommaPoint));
    std::ostringstream stream;
    stream << 1234.5;
    ASSERT_EQ(stream.str(), "1.234,5")
        << "C++ streams do not use the comma, so this test could not fail";
    if (german_locale(directory_).empty()) {
      std::cout
          << "no German C locale and no localedef: only C++ streams write commas in this run\n";
    } else {
      ASSERT_EQ(std::strtod("0,5", nullptr), 0.5)
          << "the C locale has no comma, so this test could not fail";
    }
  }
  void TearDown() override {
    std::locale::global(before_);
    std::setlocale(LC_ALL, "C");
    ::unsetenv("LOCPATH");
    std::filesystem::remove_all(directory_);
  }

 private:
  std::filesystem::path directory_;
  std::locale before_;
};

TEST_F(CommaLocale, ConfigReadsTheSame) {
  const Config config =
      config_of(replaced(kSmall, "rate_Hz: 1000", "rate_Hz: 1234.5, priority: 42"));
  EXPECT_EQ(config.loop.rate_Hz, 1234.5);
  EXPECT_EQ(config.loop.priority, 42);
  EXPECT_EQ(config.devices[0].axes[0].model->mass_kg, 0.05);
  expect_error(replaced(kSmall, "latency_s: 0", "latency_s: 0,001"), "7:16", "devices[0].latency_s",
               {"point"});
}

TEST_F(CommaLocale, AllTextsComeOutTheSame) {
  const std::string there[] = {describe_plan(compiled_of(kSmall)), plan_json(compiled_of(kSmall)),
                               json_schema(),
                               listed(errors_of(replaced(kSmall, "1000", "1234567")))};
  TearDown();
  const std::string here[] = {describe_plan(compiled_of(kSmall)), plan_json(compiled_of(kSmall)),
                              json_schema(),
                              listed(errors_of(replaced(kSmall, "1000", "1234567")))};
  for (std::size_t i = 0; i < std::size(here); ++i) EXPECT_EQ(there[i], here[i]);
  EXPECT_NE(here[0].find("1.096"), std::string::npos) << here[0];
}

TEST(Number, ExactTextGivesTheSameNumberBack) {
  for (const double value :
       {0.1, 1e-9, 1.0 / 3, 163840.0, 1e22, -0.0015, 0.0, 1e15, 123456789.125}) {
    EXPECT_EQ(parse_real(format_exact(value)).value(), value) << format_exact(value);
  }
}

TEST(Number, TextForPeopleIsShort) {
  EXPECT_EQ(format_number(1.37 * 0.8), "1.096");
  EXPECT_EQ(format_number(1000), "1000");
  EXPECT_EQ(format_exact(100'000), "100000");
}

TEST(Number, WhatLooksLikeANumberIsKnown) {
  for (const char* text : {"1", "-1.5", "1e3", ".5", "0x1F", ".inf", "-.nan", "007"})
    EXPECT_TRUE(looks_like_number(text)) << text;
  for (const char* text : {"a", "", "-", "nan", "inf", "1a", "x1", "1.2.3"})
    EXPECT_FALSE(looks_like_number(text)) << text;
}

}  // namespace
}  // namespace hapticd::config::test
