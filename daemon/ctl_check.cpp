#include "daemon/ctl_check.h"

#include <cstdio>

#include "config/compile.h"
#include "config/print.h"
#include "daemon/protocol.h"
#include "daemon/stability_gate.h"
#include "daemon/stability_json.h"

namespace hapticd::daemon {
ExitCode print_config_errors(const std::vector<config::ConfigError>& errors, bool json) {
  const ExitCode code = errors.empty() ? ExitCode::bad_data : errors.front().code;
  if (!json) {
    for (const auto& error : errors) std::fprintf(stderr, "%s\n", config::to_string(error).c_str());
    return code;
  }
  Json list = Json::array();
  for (const auto& error : errors) {
    list.push_back({{"file", error.file},
                    {"line", error.line},
                    {"column", error.column},
                    {"path", error.path},
                    {"message", error.message}});
  }
  std::puts(to_text({{"ok", false}, {"code", static_cast<int>(code)}, {"errors", std::move(list)}})
                .c_str());
  return code;
}

ExitCode check_config(const std::string& path, bool json) {
  const auto compiled = config::load(path);
  if (!compiled) return print_config_errors(compiled.error(), json);
  const Gate gate = stability_gate(*compiled);
  if (json) {
    std::puts(to_text({{"ok", true},
                       {"plan", Json::parse(config::plan_json(*compiled))},
                       {"stability", stability_json(gate)}})
                  .c_str());
  } else {
    std::printf("%s\nstability: %s\n", config::describe_plan(*compiled).c_str(),
                gate.explanation().c_str());
  }
  return gate.permits(false) ? ExitCode::ok : ExitCode::no;
}

}  // namespace hapticd::daemon
