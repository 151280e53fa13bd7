// Whatever becomes of a config's text, the reader gives a document or located errors, and comes
// back.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

const std::vector<std::string>& examples() {
  static const std::vector<std::string> texts = [] {
    std::vector<std::string> all;
    for (const char* name :
         {"wall", "two_devices", "paper2_wall", "five_bar", "falcon_sim", "observer", "homing",
          "coupling", "friction", "guides", "mesh", "moving", "paper1_example1", "falcon",
          "wooden_haptics", "teensy_rawhid", "openffboard_wheel"}) {
      all.push_back(file_text(source_path("config/examples/" + std::string(name) + ".yaml")));
    }
    return all;
  }();
  return texts;
}

/// Beside the examples, so that the files that they name are found.
std::string mutant() {
  return source_path("config/examples/mutant.yaml");
}

/// Compiles `text`; if it is refused, every error has its file, a message and a place within the
/// text.
void check_outcome(const std::string& text) {
  const auto lines = std::count(text.begin(), text.end(), '\n') + 1;
  const auto compiled = read_text(text, mutant()).and_then(compile);
  if (compiled) {
    RC_ASSERT(compiled->program != nullptr);
    return;
  }
  RC_ASSERT(!compiled.error().empty());
  for (const ConfigError& error : compiled.error()) {
    const bool in_coupling = error.file.ends_with("couplings/stylus.yaml");
    RC_ASSERT(error.file == mutant() || in_coupling);
    RC_ASSERT(!error.message.empty());
    RC_ASSERT(error.line >= 1 && error.line <= lines + 1);
    RC_ASSERT(error.column >= 1);
    RC_ASSERT(error.code == ExitCode::bad_data);
  }
}

TEST(Mutation, ExamplesThemselvesAreSound) {
  for (const std::string& text : examples()) {
    const auto compiled = read_text(text, mutant()).and_then(compile);
    EXPECT_TRUE(compiled) << text.substr(0, 200) << listed(compiled.error());
  }
}

/// Everything a person may get wrong with one word: another word of the same file.
RC_GTEST_PROP(Mutation, ExamplesWithOneWordInAnothersPlaceEndWell, ()) {
  std::string text = *rc::gen::elementOf(examples());
  const auto word_at = [&](std::size_t at) {
    const std::string marks = " \n,:[]{}";
    const std::size_t end = std::min(text.find_first_of(marks, at), text.size());
    const std::size_t begin = text.find_last_of(marks, end == 0 ? 0 : end - 1);
    const std::size_t start = begin == std::string::npos ? 0 : begin + 1;
    return std::pair(start, end > start ? end - start : 0);
  };
  const auto any = rc::gen::inRange<std::size_t>(0, text.size());
  const auto [from, from_size] = word_at(*any);
  const std::string word = text.substr(from, from_size);
  const auto [to, to_size] = word_at(*any);
  check_outcome(text.replace(to, to_size, word));
}

RC_GTEST_PROP(Mutation, TruncatedExamplesEndWell, ()) {
  const std::string& text = *rc::gen::elementOf(examples());
  check_outcome(text.substr(0, *rc::gen::inRange<std::size_t>(0, text.size())));
}

RC_GTEST_PROP(Mutation, ExamplesWithRandomBytesEndWell, ()) {
  std::string text = *rc::gen::elementOf(examples());
  const int changes = *rc::gen::inRange(1, 10);
  for (int i = 0; i < changes; ++i) {
    text[*rc::gen::inRange<std::size_t>(0, text.size())] = *rc::gen::arbitrary<char>();
  }
  check_outcome(text);
}

RC_GTEST_PROP(Mutation, ExamplesWithYamlsOwnMarksInsertedEndWell, ()) {
  const std::vector<std::string> marks = {
      "[",  "]",  "{",    "}", ":",     ": ",    ",",    "- ", "? ", "&a ",
      "*a", "!",  "!!x ", "|", ">",     "'",     "\"",   "#",  "%",  "@",
      "`",  "\n", "\n\n", " ", "---\n", "...\n", "<<: ", "\\", "~"};
  std::string text = *rc::gen::elementOf(examples());
  const int changes = *rc::gen::inRange(1, 6);
  for (int i = 0; i < changes; ++i) {
    text.insert(*rc::gen::inRange<std::size_t>(0, text.size()), *rc::gen::elementOf(marks));
  }
  check_outcome(text);
}

RC_GTEST_PROP(Mutation, ExamplesWithLinesSwappedOrLostEndWell, ()) {
  std::istringstream stream(*rc::gen::elementOf(examples()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  const auto any = rc::gen::inRange<std::size_t>(0, lines.size());
  std::swap(lines[*any], lines[*any]);
  lines[*any].clear();
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  check_outcome(text);
}

RC_GTEST_PROP(Mutation, AnyBytesEndWell, (const std::string& bytes)) {
  check_outcome(bytes);
}

}  // namespace
}  // namespace hapticd::config::test
