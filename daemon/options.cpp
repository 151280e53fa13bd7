#include "daemon/options.h"

#include <CLI/CLI.hpp>
#include <map>

#include "daemon/within.h"

namespace hapticd::daemon {

std::variant<DaemonOptions, ExitCode> parse_daemon_options(int argc, const char* const* argv) {
  DaemonOptions options;
  CLI::App app{"Haptic servo daemon: renders the scene of a config on its devices."};
  app.set_version_flag("--version", "hapticd " HAPTICD_VERSION);
  app.add_option("--config", options.config, "the config to run")->required()->type_name("FILE");
  app.add_option("--duration", options.duration_s, "end after this many seconds, with a summary")
      ->check(within(0.0, 1e9))
      ->type_name("S");
  app.add_flag("--require-realtime", options.require_realtime,
               "exit 77 before any device is armed if a real-time right is missing");
  app.add_flag("--check", options.check, "say what `hapticctl check` says of the config, and exit");
  app.add_option("--socket", options.socket, "listen here instead of at control.socket")
      ->type_name("PATH");
  app.add_option("--log-level", options.log_level, "debug, info, warning or error")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, LogLevel>{{"debug", LogLevel::debug},
                                                                  {"info", LogLevel::info},
                                                                  {"warning", LogLevel::warning},
                                                                  {"error", LogLevel::error}}))
      ->type_name("LEVEL");
  app.footer(
      "Signals: SIGINT and SIGTERM end it (forces ramp out first), SIGHUP loads the config anew,\n"
      "SIGUSR1 prints the summary.\n"
      "Exit: 0 ended as asked, 1 ended in a fault, 64 usage, 65 bad config, 66 no such file,\n"
      "69 device unavailable, 75 another hapticd holds socket or device, 77 no permission.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::ok : ExitCode::usage;
  }
  return options;
}

}  // namespace hapticd::daemon
