// What the supervisor sees of the loop, and what it makes of it.
#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>

#include "daemon/log.h"
#include "daemon/monotonic.h"
#include "daemon/supervisor.h"
#include "daemon/waiting.h"

namespace hapticd::daemon {
namespace {

bool same(const FaultReport& a, const FaultReport& b) {
  return a.code == b.code && a.axis == b.axis && a.device == b.device && a.found == b.found;
}

}  // namespace

void Supervisor::look() {
  const std::int64_t now_ns = monotonic_ns();
  (void)engine_->shared().status.load(servo_);  // else what is known stays
  seen_.mode = servo_.mode;
  follow_clear();
  enter(next_state(state_, seen_));
  note_fault();
  watch_waiting();
  if (engine_->swapped()) {
    log_info("reload: the loop runs on the new config");
    notify_.ready(status_sentence());
  }
  watch_heartbeat(now_ns);
  raise_alarms(now_ns);
  if (options_.duration_s &&
      static_cast<double>(now_ns - started_ns_) * 1e-9 >= *options_.duration_s) {
    cause_ = "--duration is over";
    ended_ = true;
  }
}

void Supervisor::enter(State next) {
  if (next == state_) return;
  log_info("{} -> {} ({})", name(state_), name(next),
           next == State::fault ? std::string("fault ") + std::string(entry(servo_.fault.code).name)
                                : cause_);
  state_ = next;
  if (next == State::off || !seen_.looping) return;
  if (!engine_->offered()) notify_.status(status_sentence());
}

/// Of the fault that stands, with the driver's own.
std::string Supervisor::fault_words() const {
  const std::uint16_t device = servo_.fault.device;
  const bool by_driver = servo_.fault.code == Fault::device && device < engine_->devices().size();
  return describe_fault(servo_.fault, engine_->program().spec(),
                        by_driver ? engine_->device(device).fault_text() : std::string());
}

/// Tells each fault once, counts it by kind.
void Supervisor::note_fault() {
  if (state_ != State::fault) {
    told_fault_ = {};
    return;
  }
  if (same(told_fault_, servo_.fault)) return;
  told_fault_ = servo_.fault;
  const std::string text = fault_words();
  log_error("fault {}", text);
  auto known = std::find_if(faults_.begin(), faults_.end(), [&](const FaultCount& fault) {
    return fault.code == servo_.fault.code;
  });
  if (known == faults_.end())
    known = faults_.insert(faults_.end(), FaultCount{servo_.fault.code, 0, "", 0});
  ++known->count;
  known->last = text;
  known->last_at_s = static_cast<double>(monotonic_ns() - started_ns_) * 1e-9;
}

/// Forces that were asked for and wait for somebody: told whenever what they wait for changes.
void Supervisor::watch_waiting() {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < engine_->devices().size(); ++i)
    words.push_back(engine_->device(i).status_text());
  waiting_ = waiting_for(engine_->program().spec(), engine_->live(), words);
  const bool asked = engine_->shared().enable.load() && state_ != State::off;
  if (!asked) told_waiting_.clear();
  if (!asked || waiting_ == told_waiting_) return;
  told_waiting_ = waiting_;
  for (const std::string& line : waiting_) log_info("forces wait: {}", line);
}

/// The loop takes `enable` back in every tick of a fault, so it is given only once the fault has
/// gone.
void Supervisor::follow_clear() {
  if (!clearing_since_tick_) return;
  constexpr std::int64_t kTicksToClear = 5;
  if (servo_.mode != control::Mode::fault) {
    clearing_since_tick_.reset();
    engine_->shared().enable.store(true);
  } else if (servo_.tick > *clearing_since_tick_ + kTicksToClear) {
    clearing_since_tick_.reset();
    log_error("enable: the cause of the fault stands: {}", fault_words());
  }
}

void Supervisor::watch_heartbeat(std::int64_t now_ns) {
  const std::uint64_t ticks = engine_->shared().counters.ticks.load(std::memory_order_relaxed);
  switch (heartbeat_->look(ticks, now_ns)) {
    case Heartbeat::Change::went_silent:
      log_error(
          "the servo thread has run no tick for more than a second; it is stuck in a driver or "
          "gets no CPU");
      break;
    case Heartbeat::Change::came_back:
      log_warning("the servo thread runs again");
      break;
    case Heartbeat::Change::none:
      break;
  }
  // Only a loop that moved since the last feed counts as alive.
  if (notify_.watchdog() && ticks != ticks_fed_) {
    ticks_fed_ = ticks;
    notify_.feed_watchdog();
  }
}

void Supervisor::raise_alarms(std::int64_t now_ns) {
  const ServoCounters& counters = engine_->shared().counters;
  if (const auto fresh = missed_alarm_.due(counters.missed_ticks.load(), now_ns)) {
    log_warning("{} ticks missed ({})", *fresh, missed_words());
  }
  if (const auto fresh = overrun_alarm_.due(counters.overruns.load(), now_ns)) {
    log_warning("{} ticks ended after their period", *fresh);
  }
  if (const auto fresh = dropped_alarm_.due(engine_->shared().records.dropped(), now_ns)) {
    log_warning(
        "{} records dropped: the telemetry thread gets too little CPU or its disk is too slow",
        *fresh);
  }
  if (const auto fresh = lost_alarm_.due(engine_->records_lost(), now_ns)) {
    log_warning("{} records are missing in recordings", *fresh);
  }
}

/// Which phase was late, since the last time that it was told.
std::string Supervisor::missed_words() {
  std::string text;
  for (std::size_t i = 0; i < kPhases; ++i) {
    const std::uint64_t now = engine_->shared().counters.missed_by[i].load();
    const std::uint64_t fresh = now - missed_told_[i];
    missed_told_[i] = now;
    if (fresh > 0)
      text += fmt::format("{}{} late: {}", text.empty() ? "" : ", ", kPhaseNames[i], fresh);
  }
  return text;
}

Summary Supervisor::summary() const {
  Summary s;
  s.duration_s = static_cast<double>(monotonic_ns() - started_ns_) * 1e-9;
  s.rate_Hz = compiled_.document.config.loop.rate_Hz;
  take_counters(engine_->shared().counters, s);
  s.faults = faults_;
  s.records_dropped = engine_->shared().records.dropped();
  s.records_lost = engine_->records_lost();
  // The thread's own files are gone once it has ended; stop() kept the last figures.
  const auto now = thread_now_ ? thread_now_ : read_thread_use(engine_->shared().thread_id.load());
  if (now && thread_at_start_) s.thread = *now - *thread_at_start_;
  s.kernel = kernel_description();
  s.preempt_rt = kernel_is_preempt_rt();
  s.realtime = engine_->realtime();
  double load = 0;
  if (::getloadavg(&load, 1) == 1) s.load_average = load;
  s.unproven = unproven_;
  take_records(engine_->program().spec(), engine_->live(), s);
  for (std::size_t i = 0; i < s.devices.size(); ++i) {
    if (const drivers::Traffic* bus = engine_->device(i).traffic())
      s.devices[i].traffic = {.late = bus->late.load(),
                              .not_sent = bus->not_sent.load(),
                              .lost = bus->lost.load(),
                              .foreign = bus->foreign.load(),
                              .malformed = bus->malformed.load(),
                              .connections = bus->connections.load(),
                              .round_trip_s = 1e-9 * static_cast<double>(bus->round_trip_ns.load()),
                              .worst_send_s = 1e-9 * static_cast<double>(bus->worst_send_ns.load()),
                              .comes_and_goes = bus->comes_and_goes};
  }
  return s;
}

std::string Supervisor::status_sentence() const {
  std::string text(name(state_));
  if (state_ == State::fault) text += fmt::format(": {}", entry(servo_.fault.code).name);
  if (state_ == State::ready && !gate_.permits(false))
    text += ", forces stay off: stability is not proved";
  return text;
}

}  // namespace hapticd::daemon
