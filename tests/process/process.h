// A program started by a test: arguments, environment, exit code, and what it printed, in files of
// the test's directory.
#pragma once
#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hapticd::test {

/// Guards against a hang only; no test asserts a time.
inline constexpr std::chrono::seconds kPatience{60};

/// Waits until it holds. False: patience is over.
bool eventually(const std::function<bool()>& condition,
                std::chrono::milliseconds patience = kPatience);

std::string read_text(const std::string& path);

class Process {
 public:
  using Environment = std::vector<std::pair<std::string, std::string>>;

  /// Standard output and error go to `output` + ".out" and ".err".
  Process(std::vector<std::string> command, std::string output,
          const Environment& environment = {});
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  /// Kills what still runs.
  ~Process();

  void signal(int number) const;
  /// Exit code; 128 + number when a signal ended it; none: it still runs after all patience.
  std::optional<int> wait();
  bool running();
  pid_t pid() const { return pid_; }
  std::string out() const { return read_text(output_ + ".out"); }
  std::string err() const { return read_text(output_ + ".err"); }

 private:
  pid_t pid_ = -1;
  std::string output_;
  std::optional<int> code_;
};

}  // namespace hapticd::test
