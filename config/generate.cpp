// Writes what is generated from config/describe.h to standard output:
//   hapticd_config_schema          the JSON schema     (config/hapticd.schema.json)
//   hapticd_config_schema --man    the key reference   (between the marks in
//   systemd/hapticd.yaml.5.scd)
#include <cstdio>
#include <string>

#include "config/json_schema.h"
#include "config/man_keys.h"
#include "control/core/result.h"

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if (argc > 2 || (argc == 2 && mode != "--man")) {
    std::fputs("usage: hapticd_config_schema [--man]\n", stderr);
    return static_cast<int>(hapticd::ExitCode::usage);
  }
  const std::string text =
      mode == "--man" ? hapticd::config::man_keys() : hapticd::config::json_schema();
  const bool written = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  return static_cast<int>(written ? hapticd::ExitCode::ok : hapticd::ExitCode::cannot_create);
}
