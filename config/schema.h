// A config as plain structs, as written in the file: units of the file, defaults beside each field.
// `describe` in config/describe.h names each key, its range and what it is for; the reader, the
// JSON schema and the man page follow it. Devices, axes, couplings, scenes, stability have files of their own.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "config/schema_coupling.h"
#include "config/schema_device.h"
#include "config/schema_scene.h"
#include "config/schema_stability.h"

namespace hapticd::config {

struct Loop {
  double rate_Hz = 1000;
  int priority = 80;
  std::optional<int> cpu;  ///< pin the servo thread to this CPU
  int max_gap_ticks = 5;
  int max_missed_per_s = 20;
  bool operator==(const Loop&) const = default;
};

enum class EnableWhen { on_command, when_ready };
struct Start {
  EnableWhen enable = EnableWhen::on_command;
  bool operator==(const Start&) const = default;
};

struct Control {
  std::string socket = "/run/hapticd/hapticd.sock";
  bool operator==(const Control&) const = default;
};

struct Telemetry {
  std::string flight_dir = "/var/lib/hapticd";  ///< empty: no flight recorder
  double flight_s = 5;                ///< seconds before a fault that the flight recorder keeps
  std::optional<std::string> record;  ///< file that gets every record, in full
  bool operator==(const Telemetry&) const = default;
};

struct Config {
  int version = 1;
  Loop loop;
  Start start;
  std::vector<Device> devices;
  std::optional<Coupling> coupling;
  std::vector<SceneObject> scene;
  Simulation sim;
  Stability stability;
  Guard guard;
  Control control;
  Telemetry telemetry;
  bool operator==(const Config&) const = default;
};

}  // namespace hapticd::config
