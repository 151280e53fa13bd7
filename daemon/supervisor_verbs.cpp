// What people ask of a running daemon, by the control socket or SIGHUP.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "daemon/log.h"
#include "daemon/reload_rules.h"
#include "daemon/supervisor.h"

namespace hapticd::daemon {
namespace {

std::string all_errors(const std::vector<config::ConfigError>& errors) {
  std::string text;
  for (const auto& error : errors) text += "\n  " + config::to_string(error);
  return text;
}

Json gate_json(const Gate& gate) {
  Json devices = Json::array();
  for (std::size_t i = 0; i < gate.devices.size(); ++i) {
    devices.push_back({{"device", gate.names[i]},
                       {"proved", gate.devices[i].proved},
                       {"why", gate.devices[i].why}});
  }
  return {{"proved", gate.proved()},
          {"forces_may_be_enabled", gate.permits(false)},
          {"verdict", gate.verdict},
          {"devices", std::move(devices)}};
}

}  // namespace

std::string Supervisor::answer(std::string_view message) {
  auto request = parse_request(message);
  if (!request) return to_text(error_reply(request.error()));
  look();
  auto replied = obey(*request);
  return to_text(replied ? *replied : error_reply(replied.error()));
}

Result<Json> Supervisor::obey(const Request& request) {
  switch (request.verb) {
    case Verb::status:
      return status();
    case Verb::enable:
      return enable(request.unproven);
    case Verb::disable:
      return disable();
    case Verb::estop:
      return estop();
    case Verb::reload:
      return reload();
  }
  return fail(ExitCode::software, "verb without an answer");
}

Result<Json> Supervisor::enable(bool unproven) {
  if (!gate_.permits(unproven)) {
    log_warning("enable refused: {}", gate_.verdict);
    return fail(ExitCode::no, "enable refused: " + gate_.explanation());
  }
  ServoShared& shared = engine_->shared();
  // Consent is to this config: a later enable on a proved one neither needs nor records it.
  unproven_ = gate_.answer == Gate::Answer::needs_unproven;
  shared.unproven.store(unproven_);
  if (unproven_) log_warning("enable --unproven: forces go on without a proof of stability");
  cause_ = "hapticctl enable";
  shared.estop.store(false);
  Json json = reply(Verb::enable);
  if (servo_.mode == control::Mode::fault) {
    log_info("enable: leaving fault {}", entry(servo_.fault.code).name);
    clearing_since_tick_ = servo_.tick;
    shared.clears.fetch_add(1);
    json["text"] = fmt::format("leaving fault {}", entry(servo_.fault.code).name);
  } else {
    shared.enable.store(true);
    json["text"] = state_ == State::enabled ? "forces are on" : forces_wait_for();
  }
  return json;
}

std::string Supervisor::forces_wait_for() const {
  if (waiting_.empty()) return "forces will be on once the devices are armed";
  return fmt::format("forces will be on once nothing is waited for any more:\n  {}",
                     fmt::join(waiting_, "\n  "));
}

Json Supervisor::disable() {
  cause_ = "hapticctl disable";
  clearing_since_tick_.reset();
  engine_->shared().enable.store(false);
  log_info("disable");
  Json json = reply(Verb::disable);
  json["text"] = state_ == State::enabled  ? "forces ramp out"
                 : state_ == State::homing ? "the search for references ends, forces are off"
                                           : "forces are off";
  return json;
}

Json Supervisor::estop() {
  engine_->shared().estop.store(true);  // before all else: the next tick sees it
  clearing_since_tick_.reset();
  engine_->shared().enable.store(false);
  log_warning("estop by hapticctl");
  Json json = reply(Verb::estop);
  json["text"] = "emergency stop: zero force from the next tick on; `hapticctl enable` leaves it";
  return json;
}

Json Supervisor::status() const {
  Json json = reply(Verb::status);
  json["state"] = name(state_);
  json["enabling"] = state_ != State::enabled &&
                     (clearing_since_tick_.has_value() || engine_->shared().enable.load());
  json["tick"] = servo_.tick;
  json["armed"] = servo_.armed;
  json["ramp"] = servo_.ramp;
  if (state_ == State::fault) {
    const FaultReport& fault = servo_.fault;
    json["fault"] = {{"name", entry(fault.code).name},
                     {"axis_or_device", blamed(fault, engine_->program().spec())},
                     {"found", fault.found},
                     {"allowed", fault.allowed},
                     {"unit", fault_unit(fault, engine_->program().spec())},
                     {"text", fault_words()}};
  } else {
    json["fault"] = nullptr;
  }
  json["config"] = {{"path", compiled_.document.path}, {"digest", compiled_.document.digest}};
  json["stability"] = gate_json(gate_);
  const Summary sum = summary();
  json["waiting_for"] = waiting_;
  json["summary"] = to_json(sum);
  json["table"] = to_table(sum);
  return json;
}

Result<Json> Supervisor::reload() {
  notify_.reloading();
  auto fresh = config::load(options_.config);
  Result<void> adopted;
  if (fresh) {
    adopted = adopt(std::move(*fresh));
  } else {
    adopted = fail(fresh.error().front().code,
                   "reload refused, the running config stays: the file does not compile:" +
                       all_errors(fresh.error()));
  }
  if (!adopted) {
    log_error("{}", adopted.error().text);
    notify_.ready(status_sentence());
    return tl::unexpected(adopted.error());
  }
  Json json = reply(Verb::reload);
  json["text"] = fmt::format("reloaded {} (digest {})\n{}", compiled_.document.path,
                             compiled_.document.digest, gate_.explanation());
  return json;
}

/// Everything is checked before anything is changed. The manager hears READY=1 once the loop runs
/// on it (look()).
Result<void> Supervisor::adopt(config::Compiled fresh) {
  auto obstacles = reload_obstacles(compiled_, fresh);
  if (obstacles.empty())
    obstacles = latency_obstacles(engine_->program().spec(), fresh.program->spec());
  if (!obstacles.empty()) {
    return fail(ExitCode::no, fmt::format("reload refused, the running config stays:\n  {}",
                                          fmt::join(obstacles, "\n  ")));
  }
  Gate gate = stability_gate(fresh);
  const bool forces = state_ == State::enabled || engine_->shared().enable.load() ||
                      clearing_since_tick_.has_value();
  if (forces && !gate.permits(unproven_)) {
    return fail(ExitCode::no,
                "reload refused, the running config stays: forces are on, disable first: " +
                    gate.explanation());
  }
  if (!engine_->swap(fresh)) {
    return fail(ExitCode::try_again,
                "reload refused: the one before is still under way; try again");
  }
  compiled_ = std::move(fresh);
  gate_ = std::move(gate);
  log_info("reload: {} (digest {})\n{}", compiled_.document.path, compiled_.document.digest,
           gate_.explanation());
  return {};
}

}  // namespace hapticd::daemon
