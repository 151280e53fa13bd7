#include "daemon/plot_gnuplot.h"

#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <optional>
#include <string_view>
#include <thread>

#include "daemon/file_descriptor.h"
#include "daemon/output_file.h"

extern char** environ;

namespace hapticd::daemon {
namespace {

constexpr std::size_t kMaxWords = 500;  // of what gnuplot complains about

tl::unexpected<Error> cannot_start(const std::string& program, int reason) {
  if (reason == ENOENT) {
    return fail(ExitCode::unavailable,
                program +
                    " is not installed, and pictures are drawn by it; on Debian: apt install "
                    "gnuplot-nox");
  }
  return fail(ExitCode::unavailable, program + " cannot be started: " + errno_text(reason));
}

/// A file in memory: unlike pipes, three of them cannot wait for each other.
FileDescriptor memory_file() {
  return FileDescriptor(::memfd_create("hapticctl-plot", MFD_CLOEXEC));
}

bool write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t done = ::write(fd, text.data(), text.size());
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(done));
  }
  return ::lseek(fd, 0, SEEK_SET) == 0;
}

std::string read_all(int fd) {
  std::string text;
  std::array<char, 64 * 1024> part;
  ::lseek(fd, 0, SEEK_SET);
  for (ssize_t got; (got = ::read(fd, part.data(), part.size())) > 0;)
    text.append(part.data(), static_cast<std::size_t>(got));
  return text;
}

/// 0, or why it could not be started.
int start(const std::string& program, int in, int out, int err, pid_t& child) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
  std::string name = program, defaults = "--default-settings";
  char* arguments[] = {name.data(), defaults.data(), nullptr};
  const int reason = ::posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  return reason;
}

/// How it ended; none: it was killed when patience ended.
std::optional<int> wait_for(pid_t child, std::chrono::milliseconds patience) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > give_up) {
      ::kill(child, SIGKILL);
      ::waitpid(child, nullptr, 0);
      return std::nullopt;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return status;
}

}  // namespace

Result<std::string> run_gnuplot(const std::string& script, const std::string& program,
                                std::chrono::milliseconds patience) {
  const FileDescriptor in = memory_file(), out = memory_file(), err = memory_file();
  if (!in.valid() || !out.valid() || !err.valid() || !write_all(in.get(), script))
    return cannot_start(program, errno);
  pid_t child = -1;
  if (const int reason = start(program, in.get(), out.get(), err.get(), child); reason != 0)
    return cannot_start(program, reason);
  const std::optional<int> status = wait_for(child, patience);
  if (!status) {
    return fail(ExitCode::unavailable, program + " was not done after " +
                                           std::to_string(patience.count() / 1000) +
                                           " s and was killed; draw less (--from, --to, --fields)");
  }
  std::string picture = read_all(out.get());
  if (WIFEXITED(*status) && WEXITSTATUS(*status) == 0 && !picture.empty()) return picture;
  return fail(ExitCode::software,
              program + " could not draw it: " + read_all(err.get()).substr(0, kMaxWords));
}

}  // namespace hapticd::daemon
