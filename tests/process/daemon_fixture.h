// hapticd as a process, with a config, a control socket and recordings in a directory of the test's
// own. The loop's limits on missed ticks are out of the way unless a test sets them: a busy machine
// must not fail a test.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "daemon/protocol.h"
#include "daemon/recording.h"
#include "tests/process/process.h"
#include "tests/unit/daemon/temp_dir.h"

namespace hapticd::test {

/// What tests vary. A hand presses the axis into the wall from the end of the ramp on, so that
/// there is a force.
struct Scenario {
  std::string enable = "when_ready";
  std::string require = "passive";
  double rate_Hz = 1000;
  double stiffness_N_m = 1000;
  double ramp_s = 0.05;
  int max_gap_ticks = 100'000;
  std::string failures = {};  ///< items of a YAML flow list
  std::string stuck_s = "null";
  std::string flight_dir = {};  ///< empty: in the test's directory
  bool record = true;
  std::string sim = {};     ///< more lines of `sim`, indented by 6
  std::string device = {};  ///< more lines of the device, indented by 4
  std::string axis = {};    ///< more lines of the axis, indented by 8
};

class DaemonTest : public testing::Test {
 protected:
  /// Writes the config and starts hapticd on it. `prefix`: what runs it, "setpriv ..."; `more`:
  /// arguments.
  void start(const Scenario& scenario, std::vector<std::string> more = {},
             std::vector<std::string> prefix = {}, const Process::Environment& environment = {});
  /// The same on whatever config.yaml holds.
  void run(std::vector<std::string> more = {}, std::vector<std::string> prefix = {},
           const Process::Environment& environment = {});
  void write_config(const Scenario& scenario) const;
  void write_file(const std::string& name, const std::string& text) const;

  /// hapticctl; exit code, with what it printed in ctl_out and ctl_err. The socket is named by the
  /// environment.
  int ctl(std::vector<std::string> arguments);
  /// `hapticctl status --json`; null when nobody answers.
  daemon::Json status();
  bool reaches(const std::string& state);
  /// The hand feels the wall.
  bool presses();
  bool passes_tick(int tick);
  /// So many ticks go by and forces are still on.
  bool stays_enabled(int ticks);
  /// The daemon's log holds this, now or soon.
  bool logs(const std::string& text);
  bool output_has(const std::string& text);
  /// Ends it by SIGTERM.
  int stop();
  daemon::Recording recording() const;
  /// The one flight recording in `dir`; "" and a failure if there are none or several.
  std::string flight(const std::string& dir) const;

  TempDir dir_;
  std::string config_ = dir_.file("config.yaml");
  std::string socket_ = dir_.file("h.sock");
  std::string record_ = dir_.file("all.hapticrec");
  std::unique_ptr<Process> hapticd_;
  std::string ctl_out_, ctl_err_;
};

}  // namespace hapticd::test
