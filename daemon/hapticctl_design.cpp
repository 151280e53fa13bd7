#include "daemon/hapticctl_design.h"

#include <cstdio>
#include <filesystem>
#include <utility>

#include "config/digest.h"
#include "config/write_yaml.h"
#include "daemon/ctl_check.h"
#include "daemon/ctl_verbs.h"
#include "daemon/hapticctl_design_robust.h"
#include "daemon/output_check.h"
#include "daemon/output_file.h"
#include "daemon/stability_gate.h"
#include "daemon/stability_json.h"

namespace hapticd::daemon {
namespace {

/// The config with the file as its coupling, just as the daemon will load it.
Result<Gate> gate_with(config::Document document, const std::string& file) {
  document.config.coupling = config::Coupling{.file = std::filesystem::absolute(file).string()};
  document.coupling_places.reset();
  const auto compiled = config::compile(std::move(document));
  if (!compiled) return fail(ExitCode::software, config::to_string(compiled.error().front()));
  return stability_gate(*compiled);
}

}  // namespace

ExitCode run_design(const std::string& path, const DesignOptions& options, bool json) {
  if (options.proof == DesignFor::robust) return run_design_robust(path, options, json);
  auto document = config::read_file(path);
  if (!document) return print_config_errors(document.error(), json);
  if (auto writable = check_output(options.output, {path}); !writable)
    return print_error(writable.error(), json);
  const auto file = design_coupling(*document, options);
  if (!file) return print_error(file.error(), json);
  const std::string body = config::to_yaml(*file);
  const std::string text = body + "digest: \"" + config::digest_of(body) + "\"\n";
  const std::string draft = options.output + ".draft";
  auto gate = replace_file(draft, text).and_then([&] { return gate_with(*document, draft); });
  std::remove(draft.c_str());
  if (gate && !gate->proved()) {
    gate = fail(ExitCode::no,
                "what was found is not proved by the daemon's own check, so nothing was "
                "written:\n" +
                    gate->explanation());
  }
  if (!gate) return print_error(gate.error(), json);
  if (auto written = replace_file(options.output, text); !written)
    return print_error(written.error(), json);
  if (json) {
    std::puts(
        to_text({{"ok", true}, {"output", options.output}, {"passive", stability_json(*gate)}})
            .c_str());
  } else {
    std::printf("%s: %s\nput this into the config:  coupling: {file: %s}\n", options.output.c_str(),
                gate->explanation().c_str(), named_from(path, options.output).c_str());
  }
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
