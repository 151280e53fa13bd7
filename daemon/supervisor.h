// The main thread: state machine, signals, control socket, reload, service manager. It looks after
// the servo thread fifty times a second and otherwise sleeps; the loop never waits for it.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/compile.h"
#include "control/core/result.h"
#include "daemon/alarms.h"
#include "daemon/control_socket.h"
#include "daemon/engine.h"
#include "daemon/file_descriptor.h"
#include "daemon/lifecycle.h"
#include "daemon/options.h"
#include "daemon/protocol.h"
#include "daemon/service_notify.h"
#include "daemon/signals.h"
#include "daemon/stability_gate.h"
#include "daemon/summary.h"

namespace hapticd::daemon {

class Supervisor {
 public:
  Supervisor(DaemonOptions options, config::Compiled compiled);
  ~Supervisor();

  /// Starts, serves until a signal or --duration ends it, stops. Everything that a person must know
  /// is logged.
  ExitCode run();

 private:
  // supervisor.cpp: start, events, end
  Result<void> start();
  Result<void> open_socket();
  Result<void> check_rights() const;
  void loop();
  void on_signal(int signal);
  ExitCode stop();

  // supervisor_watch.cpp: what is seen of the loop
  void look();
  void enter(State next);
  std::string fault_words() const;
  void note_fault();
  void follow_clear();
  void watch_heartbeat(std::int64_t now_ns);
  void raise_alarms(std::int64_t now_ns);
  std::string missed_words();
  Summary summary() const;
  std::string status_sentence() const;
  void watch_waiting();

  // supervisor_verbs.cpp: what people ask for
  std::string answer(std::string_view message);
  Result<Json> obey(const Request& request);
  Result<Json> enable(bool unproven);
  std::string forces_wait_for() const;
  Json disable();
  Json estop();
  Json status() const;
  Result<Json> reload();
  Result<void> adopt(config::Compiled fresh);

  DaemonOptions options_;
  config::Compiled compiled_;  // its program is in engine_
  Gate gate_;
  ServiceNotify notify_;
  Signals signals_;
  FileDescriptor timer_;
  std::optional<ControlSocket> socket_;
  std::unique_ptr<Engine> engine_;

  State state_ = State::off;
  Seen seen_;
  ServoStatus servo_;
  std::string cause_ = "start";       // of the next transition
  std::vector<std::string> waiting_;  // enable inputs and axes that stand in the way of forces
  std::vector<std::string> told_waiting_;
  bool unproven_ = false;  // forces were asked for without a proof
  bool ended_ = false;

  // An operator's way out of a fault: forces are asked for again once the loop has let go of it.
  std::optional<std::int64_t> clearing_since_tick_;

  std::int64_t started_ns_ = 0;
  std::vector<FaultCount> faults_;
  FaultReport told_fault_;
  std::optional<ThreadUse> thread_at_start_, thread_now_;
  std::uint64_t ticks_fed_ = 0;
  std::optional<Heartbeat> heartbeat_;
  RateLimitedCount missed_alarm_, overrun_alarm_, dropped_alarm_, lost_alarm_;
  std::array<std::uint64_t, kPhases> missed_told_{};
};

}  // namespace hapticd::daemon
