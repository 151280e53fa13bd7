#include "tests/process/daemon_fixture.h"

#include <fmt/format.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <utility>

namespace hapticd::test {

void DaemonTest::write_file(const std::string& name, const std::string& text) const {
  std::ofstream(dir_.file(name)) << text;
}

void DaemonTest::write_config(const Scenario& s) const {
  write_file("config.yaml",
             fmt::format(R"(version: 1
loop: {{rate_Hz: {}, max_gap_ticks: {}, max_missed_per_s: 20000}}
start: {{enable: {}}}
devices:
  - name: left
    driver: sim
    sim:
      hand:
        {{mass_kg: 0.2, stiffness_N_m: 300, damping_Ns_m: 2,
         script: [{{at_s: 0}}, {{at_s: 0.3, position_m: -0.02}}]}}
      failures: [{}]
{}    kinematics: {{cartesian: {{directions: [x]}}}}
    latency_s: 0
{}    axes:
      - name: x
        encoder: {{counts_per_m: 1e7, stuck_s: {}}}
        actuator: {{max_force_N: 8}}
        model: {{mass_kg: 0.05, damping_Ns_m: 2, damping_uncertainty: 0.2}}
{}scene:
  - plane: {{name: wall, normal: [1, 0, 0], stiffness_N_m: {}, damping_Ns_m: 0.5}}
stability: {{require: {}}}
guard: {{max_force_N: 6, ramp_s: {}}}
control: {{socket: {}}}
telemetry: {{flight_dir: {}, flight_s: 2, record: {}}}
)",
                         s.rate_Hz, s.max_gap_ticks, s.enable, s.failures, s.sim, s.device,
                         s.stuck_s, s.axis, s.stiffness_N_m, s.require, s.ramp_s, socket_,
                         s.flight_dir.empty() ? dir_.file("flight") : s.flight_dir,
                         s.record ? record_ : "null"));
}

void DaemonTest::start(const Scenario& scenario, std::vector<std::string> more,
                       std::vector<std::string> prefix, const Process::Environment& environment) {
  write_config(scenario);
  run(std::move(more), std::move(prefix), environment);
}

void DaemonTest::run(std::vector<std::string> more, std::vector<std::string> prefix,
                     const Process::Environment& environment) {
  std::vector<std::string> command = std::move(prefix);
  if (command.empty() || command.back() != "--") {
    command.push_back(HAPTICD_BINARY);
  } else {
    command.back() = dir_.file("hapticd");  // a copy that any user may run
  }
  command.insert(command.end(), {"--config", config_});
  command.insert(command.end(), more.begin(), more.end());
  hapticd_ = std::make_unique<Process>(std::move(command), dir_.file("hapticd-log"), environment);
}

int DaemonTest::ctl(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), HAPTICCTL_BINARY);
  Process hapticctl(std::move(arguments), dir_.file("ctl"), {{"HAPTICD_SOCKET", socket_}});
  const auto code = hapticctl.wait();
  ctl_out_ = hapticctl.out();
  ctl_err_ = hapticctl.err();
  return code.value_or(-1);
}

daemon::Json DaemonTest::status() {
  if (ctl({"status", "--json"}) != 0) return nullptr;
  return daemon::Json::parse(ctl_out_, nullptr, false);
}

bool DaemonTest::reaches(const std::string& state) {
  return eventually([&] {
    const auto now = status();
    return now.is_object() && now["state"] == state;
  });
}

bool DaemonTest::presses() {
  return eventually([&] {
    const auto now = status();
    return now.is_object() && now["summary"]["largest_force_N"].get<double>() > 3;
  });
}

bool DaemonTest::passes_tick(int tick) {
  return eventually([&] {
    const auto now = status();
    return now.is_object() && now["tick"].get<int>() > tick;
  });
}

bool DaemonTest::stays_enabled(int ticks) {
  return passes_tick(status()["tick"].get<int>() + ticks) && status()["state"] == "enabled";
}

bool DaemonTest::logs(const std::string& text) {
  return eventually([&] { return hapticd_->err().find(text) != std::string::npos; });
}

bool DaemonTest::output_has(const std::string& text) {
  return eventually([&] { return hapticd_->out().find(text) != std::string::npos; });
}

int DaemonTest::stop() {
  hapticd_->signal(SIGTERM);
  return hapticd_->wait().value_or(-1);
}

daemon::Recording DaemonTest::recording() const {
  auto recording = daemon::read_recording(record_);
  EXPECT_TRUE(recording) << recording.error().text;
  return recording ? std::move(*recording) : daemon::Recording{};
}

std::string DaemonTest::flight(const std::string& dir) const {
  std::vector<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(dir)) files.push_back(file.path());
  EXPECT_EQ(files.size(), 1u);
  return files.size() == 1 ? files[0] : std::string();
}

}  // namespace hapticd::test
