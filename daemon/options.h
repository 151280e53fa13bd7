// The command line of hapticd.
#pragma once
#include <optional>
#include <string>
#include <variant>

#include "control/core/result.h"
#include "daemon/log.h"

namespace hapticd::daemon {

/// Where hapticd listens and hapticctl asks unless told otherwise; config/schema.h has the same
/// default.
inline constexpr const char* kDefaultSocket = "/run/hapticd/hapticd.sock";

struct DaemonOptions {
  std::string config;
  std::optional<double> duration_s;   ///< end by itself after this long; none: at a signal
  bool require_realtime = false;      ///< a missing right ends the start with no_permission
  bool check = false;                 ///< only check the config
  std::optional<std::string> socket;  ///< instead of control.socket
  LogLevel log_level = LogLevel::info;
};

/// The options, or the exit code where the command line already ended the program (--help,
/// --version, an error).
std::variant<DaemonOptions, ExitCode> parse_daemon_options(int argc, const char* const* argv);

}  // namespace hapticd::daemon
