// What hapticctl's command line says, and how a verb is added to it.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <utility>

#include "daemon/ctl_cost.h"
#include "daemon/ctl_doctor.h"
#include "daemon/ctl_plot.h"
#include "daemon/ctl_simulate.h"
#include "daemon/ctl_verbs.h"
#include "daemon/hapticctl_design.h"
#include "daemon/hapticctl_devices.h"
#include "daemon/hapticctl_emulate.h"
#include "daemon/hapticctl_identify.h"
#include "daemon/hapticctl_sweep.h"
#include "daemon/hapticctl_zwidth.h"

namespace hapticd::daemon {

/// What the command line says; the verb that was named fills `run`.
struct CommandLine {
  CLI::App app{"Asks and tells hapticd, and works on its configs and recordings without it."};
  std::string socket = default_socket();
  bool json = false;
  bool unproven = false;
  bool csv = false;
  std::string input, output;
  SimulateOptions simulate;
  CostOptions cost;
  DoctorOptions doctor;
  PlotOptions plot;
  DesignOptions design;
  IdentifyOptions identify;
  ZwidthOptions zwidth;
  SweepOptions sweep;
  EmulateOptions emulate;
  DevicesOptions devices;
  std::string log_axes, size;  ///< checked, and put into `plot`, as they are read
  std::function<ExitCode()> run;
};

/// Sets what runs when the verb is named.
inline CLI::App* add_verb(CommandLine& line, const char* name, const char* help,
                          std::function<ExitCode()> run) {
  CLI::App* verb = line.app.add_subcommand(name, help);
  verb->add_flag("--json", line.json, "answer in JSON");
  verb->callback([&line, run = std::move(run)] { line.run = run; });
  return verb;
}

/// certify, design, sweep, zwidth, identify: what looks at stability and measures for it.
void add_design_verbs(CommandLine& line);

}  // namespace hapticd::daemon
