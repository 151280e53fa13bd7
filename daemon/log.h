// Log lines, for people and the journal. The servo thread never calls any of this: it only records,
// and the supervisor and the telemetry thread tell.
#pragma once
#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace hapticd::daemon {

enum class LogLevel { debug, info, warning, error };

/// Once, before the first line. To the journal each line carries its priority as "<n>"
/// (sd-daemon(3)); to a terminal it carries the time, with colours; else the time alone.
void start_log(LogLevel least);

/// One message; lines within it are kept apart in the journal.
void log_text(LogLevel level, std::string_view text);

template <class... Args>
void log_debug(fmt::format_string<Args...> format, Args&&... args) {
  log_text(LogLevel::debug, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void log_info(fmt::format_string<Args...> format, Args&&... args) {
  log_text(LogLevel::info, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void log_warning(fmt::format_string<Args...> format, Args&&... args) {
  log_text(LogLevel::warning, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void log_error(fmt::format_string<Args...> format, Args&&... args) {
  log_text(LogLevel::error, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace hapticd::daemon
