#include "daemon/ctl_simulate.h"

#include <fmt/format.h>

#include <cstdio>

#include "daemon/ctl_check.h"
#include "daemon/ctl_verbs.h"
#include "daemon/interrupts.h"
#include "daemon/lifecycle.h"
#include "daemon/recording.h"
#include "daemon/stability_gate.h"

namespace hapticd::daemon {
namespace {

Json result_json(const SimulateResult& r, const std::string& fault, const std::string& verdict,
                 const std::string& output) {
  return {{"ok", true},
          {"output", output},
          {"ticks", r.ticks},
          {"simulated_s", r.simulated_s},
          {"wall_s", r.wall_s},
          {"largest_force_N", r.largest_force_N},
          {"forces", r.enabled},
          {"stability", verdict},
          {"fault", fault.empty() ? Json(nullptr) : Json(fault)},
          {"interrupted", r.interrupted}};
}

std::string result_text(const SimulateResult& r, const std::string& fault,
                        const std::string& verdict, const std::string& output) {
  std::string text =
      fmt::format("{}: {} ticks, {:g} s simulated in {:.3f} s ({:.0f} x real time){}\n", output,
                  r.ticks, r.simulated_s, r.wall_s, r.wall_s > 0 ? r.simulated_s / r.wall_s : 0.0,
                  r.interrupted ? ", interrupted" : "");
  text += fmt::format("largest force {:.3f} N, fault {}\n", r.largest_force_N,
                      fault.empty() ? "none" : fault);
  if (!r.enabled) text += verdict + "\nsimulate with forces all the same: --unproven\n";
  return text;
}

}  // namespace

ExitCode run_simulate(const std::string& config_path, const SimulateOptions& options, bool json) {
  auto compiled = config::load(config_path);
  if (!compiled) return print_config_errors(compiled.error(), json);
  const Gate gate = stability_gate(*compiled);
  auto result = simulate(*compiled, options, interrupts());
  if (!result) return print_error(result.error(), json);
  const std::string fault = result->fault.code == Fault::none
                                ? ""
                                : describe_fault(result->fault, compiled->program->spec());
  if (json) {
    std::puts(to_text(result_json(*result, fault, gate.verdict, options.output)).c_str());
  } else {
    std::fputs(result_text(*result, fault, gate.explanation(), options.output).c_str(), stdout);
  }
  return result->enabled && fault.empty() ? ExitCode::ok : ExitCode::no;
}

ExitCode run_export(const std::string& recording_path, std::string output, bool json) {
  auto recording = read_recording(recording_path);
  if (!recording) return print_error(recording.error(), json);
  if (output.empty()) output = recording_path + ".csv";
  const bool to_stdout = output == "-";
  if (auto written = write_csv(*recording, to_stdout ? "/dev/stdout" : output); !written) {
    return print_error(written.error(), json);
  }
  const std::string torn =
      recording->torn_bytes == 0
          ? ""
          : fmt::format("; the last {} bytes were no whole record", recording->torn_bytes);
  if (json && !to_stdout) {
    std::puts(to_text({{"ok", true},
                       {"output", output},
                       {"records", recording->size()},
                       {"torn_bytes", recording->torn_bytes}})
                  .c_str());
  } else {
    std::fprintf(stderr, "%s: %zu records%s\n", output.c_str(), recording->size(), torn.c_str());
  }
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
