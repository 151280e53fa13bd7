// hapticd: the daemon.
#include <cstdio>
#include <exception>
#include <utility>
#include <variant>

#include "config/compile.h"
#include "daemon/ctl_check.h"
#include "daemon/log.h"
#include "daemon/options.h"
#include "daemon/supervisor.h"

namespace {

using namespace hapticd;

ExitCode run(daemon::DaemonOptions options) {
  daemon::start_log(options.log_level);
  if (options.check) return daemon::check_config(options.config, false);
  auto compiled = config::load(options.config);
  if (!compiled) {
    for (const auto& error : compiled.error()) daemon::log_error("{}", config::to_string(error));
    return compiled.error().front().code;
  }
  return daemon::Supervisor(std::move(options), std::move(*compiled)).run();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    auto parsed = daemon::parse_daemon_options(argc, argv);
    if (const auto* ended = std::get_if<ExitCode>(&parsed)) return static_cast<int>(*ended);
    return static_cast<int>(run(std::get<daemon::DaemonOptions>(std::move(parsed))));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hapticd: a defect of hapticd: %s\n", error.what());
    return static_cast<int>(ExitCode::software);
  }
}
