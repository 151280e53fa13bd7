#include "daemon/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string>

namespace hapticd::daemon {
namespace {

bool journal_prefixes = false;

/// $JOURNAL_STREAM holds "device:inode" of the stream that systemd connected; it is inherited even
/// where stderr was sent elsewhere since, so the two are compared.
bool stderr_is_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat info {};
  if (stream == nullptr || ::fstat(STDERR_FILENO, &info) != 0) return false;
  return fmt::format("{}:{}", info.st_dev, info.st_ino) == stream;
}

spdlog::level::level_enum to_spdlog(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return spdlog::level::debug;
    case LogLevel::info:
      return spdlog::level::info;
    case LogLevel::warning:
      return spdlog::level::warn;
    case LogLevel::error:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

/// syslog(3) priorities.
int priority(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return 7;
    case LogLevel::info:
      return 6;
    case LogLevel::warning:
      return 4;
    case LogLevel::error:
      return 3;
  }
  return 6;
}

}  // namespace

void start_log(LogLevel least) {
  journal_prefixes = stderr_is_journal();
  // Colours only where somebody looks: the sink itself asks isatty().
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  auto logger = std::make_shared<spdlog::logger>("hapticd", std::move(sink));
  logger->set_pattern(journal_prefixes ? "%v" : "%H:%M:%S.%e %^%l%$: %v");
  logger->set_level(to_spdlog(least));
  logger->flush_on(spdlog::level::debug);
  spdlog::set_default_logger(std::move(logger));
}

void log_text(LogLevel level, std::string_view text) {
  const auto at = to_spdlog(level);
  if (!journal_prefixes) {
    spdlog::log(at, text);
    return;
  }
  while (!text.empty()) {
    const auto end = text.find('\n');
    spdlog::log(at, "<{}>{}", priority(level), text.substr(0, end));
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
  }
}

}  // namespace hapticd::daemon
