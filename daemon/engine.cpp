#include "daemon/engine.h"

#include <cmath>
#include <span>
#include <utility>

#include "control/recorded.h"
#include "daemon/device_factory.h"
#include "daemon/recording.h"

namespace hapticd::daemon {
namespace {

/// Four seconds at 1 kHz: more than telemetry ever sleeps, a few megabytes at most.
constexpr std::size_t kRingSlots = 4096;

RecordingHeader header_of(const build::Program& program, const config::Document& document) {
  return recording_header(program, document.digest, document.text);
}

TelemetryOptions telemetry_options(const config::Telemetry& telemetry) {
  TelemetryOptions options;
  options.flight_dir = telemetry.flight_dir;
  options.flight_s = telemetry.flight_s;
  options.record_path = telemetry.record.value_or("");
  return options;
}

/// Of any plan for the devices of this one: a reload may add what is recorded too.
std::size_t largest_record_bytes(const control::Plan& plan) {
  const std::size_t axes = plan.axes.size(), devices = plan.devices.size();
  std::size_t bytes =
      sizeof(control::RecordHeader) + axes * (3 * sizeof(double) + 8) + devices * sizeof(Aux);
  for (const control::RecordedField& field : control::kRecorded) {
    const std::size_t count = field.per == control::Per::axis     ? axes
                              : field.per == control::Per::device ? devices
                                                                  : plan.coordinates;
    bytes += count * sizeof(double);
  }
  return (bytes + 7) / 8 * 8;
}

bool same(const config::Telemetry& a, const config::Telemetry& b) {
  return a.flight_dir == b.flight_dir && a.flight_s == b.flight_s && a.record == b.record;
}

}  // namespace

ServoOptions servo_options(const config::Compiled& compiled) {
  const config::Loop& loop = compiled.document.config.loop;
  ServoOptions options;
  options.collect_ns = std::llround(1e9 * compiled.collect_s);
  options.schedule.period_ns = std::llround(1e9 / loop.rate_Hz);
  options.schedule.max_gap_ticks = loop.max_gap_ticks;
  options.schedule.max_missed_per_s = loop.max_missed_per_s;
  options.priority = loop.priority;
  options.cpu = loop.cpu;
  return options;
}

Engine::Engine(config::Compiled& compiled, TelemetryEvents events)
    : program_(std::move(compiled.program)),
      telemetry_config_(compiled.document.config.telemetry),
      events_(std::move(events)),
      header_(header_of(*program_, compiled.document)),
      servo_options_(servo_options(compiled)),
      devices_(make_devices(compiled)) {
  events_.record = [this](const std::byte* record) { live_.add(record); };
  const std::size_t slot_bytes = largest_record_bytes(program_->plan());
  ring_storage_.resize(kRingSlots * slot_bytes / sizeof(std::uint64_t));
  shared_ =
      std::make_unique<ServoShared>(std::as_writable_bytes(std::span(ring_storage_)), slot_bytes);
}

Engine::~Engine() {
  stop();
}

Result<void> Engine::connect() {
  const auto& names = program_->spec().device_names;
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    if (auto connected = connect_one(i, names[i]); !connected) {
      disconnect_all();
      return connected;
    }
  }
  return {};
}

Result<void> Engine::connect_one(std::size_t i, const std::string& name) {
  auto info = connect_locked(*devices_[i], device_lock_directories(), locks_);
  if (!info) return fail(info.error().code, "device " + name + ": " + info.error().text);
  infos_.push_back(*info);
  return {};
}

void Engine::disconnect_all() noexcept {
  for (std::size_t i = 0; i < infos_.size(); ++i) devices_[i]->disconnect();
  infos_.clear();
  locks_.clear();
}

void Engine::start() {
  process_realtime_.emplace(realtime_);
  start_telemetry();
  std::vector<drivers::Device*> devices;
  for (const auto& device : devices_) devices.push_back(device.get());
  servo_ =
      std::make_unique<ServoThread>(servo_options_, std::move(devices), program_.get(), *shared_);
  servo_->start(realtime_);
}

void Engine::start_telemetry() {
  live_.begin(program_->plan().record);
  telemetry_ = std::make_unique<Telemetry>(telemetry_options(telemetry_config_), header_,
                                           shared_->records, events_);
  auto started = telemetry_->start();
  if (started) return;
  events_.failed(started.error());
  // The ring must be emptied all the same, and faults still have their flight recording.
  TelemetryOptions without = telemetry_options(telemetry_config_);
  without.record_path.clear();
  telemetry_ = std::make_unique<Telemetry>(std::move(without), header_, shared_->records, events_);
  if (auto again = telemetry_->start(); !again) events_.failed(again.error());
}

void Engine::stop() {
  if (servo_) servo_->stop();
  if (telemetry_) telemetry_->stop();
  if (servo_ && retiring_) {
    // Adopted or not, nobody runs on either program any more.
    (void)shared_->plans.withdraw();
    (void)shared_->plans.collect();
    retiring_.reset();
  }
  disconnect_all();
}

bool Engine::swap(config::Compiled& fresh) {
  if (retiring_ || !shared_->plans.offer(fresh.program.get())) return false;
  retiring_ = std::exchange(program_, std::move(fresh.program));
  header_ = header_of(*program_, fresh.document);
  const config::Telemetry before =
      std::exchange(telemetry_config_, fresh.document.config.telemetry);
  if (retiring_->plan().record != program_->plan().record) return true;  // once it is adopted
  if (telemetry_ && same(telemetry_config_, before)) {
    telemetry_->set_header(header_);
  } else {
    restart_telemetry();
  }
  return true;
}

bool Engine::swapped() {
  if (!retiring_ || shared_->plans.collect() == nullptr) return false;
  retiring_.reset();
  if (shared_->records_held.load(std::memory_order_relaxed)) {
    restart_telemetry();  // the one that knew the old records has drained them
    shared_->records_held.store(false, std::memory_order_release);
  }
  return true;
}

void Engine::restart_telemetry() {
  if (telemetry_) {
    telemetry_->stop();
    lost_before_ += telemetry_->lost();
  }
  start_telemetry();
}

std::uint64_t Engine::records_lost() const noexcept {
  return lost_before_ + (telemetry_ ? telemetry_->lost() : 0);
}

}  // namespace hapticd::daemon
