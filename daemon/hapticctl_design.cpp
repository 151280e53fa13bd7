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

Result<void> write_text(const std::string& path, const std::string& text) {
  return OutputFile::create(path, IfExists::replace).and_then([&](OutputFile file) -> Result<void> {
    if (auto written = file.write(text); !written) return written;
    return file.close();
  });
}

/// The config with the file as its coupling, just as the daemon will load it.
Result<Gate> gate_with(config::Document document, const std::string& file) {
  document.config.coupling = config::Coupling{.file = std::filesystem::absolute(file).string()};
  document.coupling_places.reset();
  const auto compiled = config::compile(std::move(document));
  if (!compiled) return fail(ExitCode::software, config::to_string(compiled.error().front()));
  return stability_gate(*compiled);
}

int report(const Error& error, bool json) {
  if (json) {
    std::puts(
        to_text({{"ok", false}, {"code", static_cast<int>(error.code)}, {"error", error.text}})
            .c_str());
  } else {
    std::fprintf(stderr, "hapticctl: design: %s\n", error.text.c_str());
  }
  return static_cast<int>(error.code);
}

}  // namespace

ExitCode run_design(const std::string& path, const DesignOptions& options, bool json) {
  if (options.proof == DesignFor::robust) return run_design_robust(path, options, json);
  auto document = config::read_file(path);
  if (!document) return print_config_errors(document.error(), json);
  if (auto writable = check_output(options.output, {path}); !writable)
    return print_error(writable.error(), json);
  const auto file = design_coupling(*document, options);
  if (!file) return static_cast<ExitCode>(report(file.error(), json));
  const std::string body = config::to_yaml(*file);
  const std::string text = body + "digest: \"" + config::digest_of(body) + "\"\n";
  const std::string draft = options.output + ".new";
  auto gate = write_text(draft, text).and_then([&] { return gate_with(*document, draft); });
  if (gate && !gate->proved()) {
    gate = fail(ExitCode::no,
                "what was found is not proved by the daemon's own check, so nothing was "
                "written:\n" +
                    gate->explanation());
  }
  if (!gate) {
    std::remove(draft.c_str());
    return static_cast<ExitCode>(report(gate.error(), json));
  }
  if (std::rename(draft.c_str(), options.output.c_str()) != 0) {
    std::remove(draft.c_str());
    return static_cast<ExitCode>(
        report({options.output + ": cannot be written", ExitCode::cannot_create}, json));
  }
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
