// Whatever becomes of a config's text, the reader gives a document or located errors, and comes
// back.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

const std::vector<std::string>& examples() {
  static const std::vector<std::string> texts = {
      file_text(source_path("config/examples/wall.yaml")),
      file_text(source_path("config/examples/two_devices.yaml")),
      file_text(source_path("config/examples/paper2_wall.yaml")),
      file_text(source_path("config/examples/five_bar.yaml")),
      file_text(source_path("config/examples/falcon_sim.yaml")),
      file_text(source_path("config/examples/observer.yaml")),
      file_text(source_path("config/examples/homing.yaml"))};
  return texts;
}

/// Compiles `text`; if it is refused, every error has its file, a message and a place within the
/// text.
void check_outcome(const std::string& text) {
  const auto lines = std::count(text.begin(), text.end(), '\n') + 1;
  const auto compiled = read_text(text, "mutant.yaml").and_then(compile);
  if (compiled) {
    RC_ASSERT(compiled->program != nullptr);
    return;
  }
  RC_ASSERT(!compiled.error().empty());
  for (const ConfigError& error : compiled.error()) {
    RC_ASSERT(error.file == "mutant.yaml");
    RC_ASSERT(!error.message.empty());
    RC_ASSERT(error.line >= 1 && error.line <= lines + 1);
    RC_ASSERT(error.column >= 1);
    RC_ASSERT(error.code == ExitCode::bad_data);
  }
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
