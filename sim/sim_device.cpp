#include "sim/sim_device.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <string>
#include <utility>

#include "sim/check_options.h"

namespace hapticd::sim {
namespace {

constexpr std::int64_t kBeforeScript = std::numeric_limits<std::int64_t>::min() / 2;

std::int64_t processor_time_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

void burn(std::int64_t duration_ns) noexcept {
  if (duration_ns <= 0) return;
  const std::int64_t end_ns = processor_time_ns() + duration_ns;
  while (processor_time_ns() < end_ns) {
  }
}

}  // namespace

SimDevice::SimDevice(DeviceOptions options)
    : options_(std::move(options)), failures_({}, options_.period_s) {}

SimDevice::SimDevice(std::shared_ptr<SharedHand> hand, std::size_t device)
    : SimDevice(hand->device(device)) {
  hand_ = std::move(hand);
  number_ = device;
}

Result<drivers::DeviceInfo> SimDevice::connect() {
  if (const std::string wrong = problem(); !wrong.empty()) {
    return fail(ExitCode::bad_data, "simulated device " + options_.name + ": " + wrong);
  }
  make_plants();
  make_inputs();
  failures_ = Failures(options_.failures, options_.period_s);
  ramp_substeps_ =
      std::llround(options_.ramp_s / TimeGrid{options_.period_s, options_.substeps}.substep_s());
  started_ = arm_wanted_ = armed_ = dropped_out_ = false;
  return drivers::DeviceInfo{.model = "simulated device",
                             .serial = {},
                             .timing = drivers::Timing::in_phase,
                             .worst_sample_age_s = 0};
}

std::string SimDevice::problem() const {
  const std::string own = first_problem(options_);
  if (!own.empty() || !hand_) return own;
  const std::string shared = hand_->problem();
  return shared.empty() ? shared : "shared hand: " + shared;
}

void SimDevice::make_plants() {
  const TimeGrid grid{options_.period_s, options_.substeps};
  wires_.clear();
  axes_.clear();
  linkage_.reset();
  if (hand_) return hand_->restart();
  for (std::size_t i = 0; i < options_.axes.size(); ++i) {
    wires_.emplace_back(options_.axes[i], options_.period_s, options_.seed, i);
    if (!options_.linkage) axes_.emplace_back(options_.axes[i], options_.hand, grid);
  }
  if (options_.linkage) linkage_.emplace(options_);
}

void SimDevice::make_inputs() {
  const std::size_t axes = options_.axes.size();
  samples_.assign(axes, AxisSample{});
  homed_tick_.clear();
  for (const AxisOptions& axis : options_.axes)
    homed_tick_.push_back(tick_at(axis.homed_at_s, options_.period_s));
  digital_.clear();
  for (const DigitalStep& step : options_.digital)
    digital_.push_back({tick_at(step.at_s, options_.period_s), step.bits});
  force_noise_.clear();
  analogue_ = {};
  if (!options_.force_sensor) return;
  const std::size_t channels = options_.linkage ? 3 : std::min(axes, analogue_.size());
  for (std::size_t i = 0; i < channels; ++i) force_noise_.emplace_back(options_.seed, axes + i);
}

void SimDevice::disconnect() noexcept {
  arm_wanted_ = armed_ = false;
  for (Wires& axis : wires()) axis.cut();
}

void SimDevice::request(const drivers::TickTime& time) noexcept {
  if (!started_) {
    started_ = true;
    first_tick_ = tick_ = time.tick;
  }
  run_until(time.tick);
  failures_.move_to(tick_ - first_tick_);
  measure(time.start_ns);
  measure_force();
}

void SimDevice::run_until(std::int64_t tick) noexcept {
  if (hand_) hand_->run_until(tick);
  for (std::int64_t left = owed_ticks(tick_, tick); left > 0; --left) run_tick();
  tick_ = std::max(tick, tick_);
}

// Number of the sub-step of the hand's script that begins now; negative: before it.
std::int64_t SimDevice::script_substep() const noexcept {
  return armed_ ? (tick_ - armed_tick_) * options_.substeps - ramp_substeps_ : kBeforeScript;
}

void SimDevice::run_tick() noexcept {
  if (linkage_) linkage_->run_tick(wires_, script_substep());
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].run_tick(wires_[i], script_substep());
  ++tick_;
}

void SimDevice::measure(std::int64_t stamp_ns) noexcept {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::span<Wires> wires = this->wires();
  for (std::size_t i = 0; i < wires.size(); ++i) {
    const double counts = wires[i].read_encoder(truth(i).position_m, failures_.jump_m(i));
    AxisSample& sample = samples_[i];
    const bool missing = failures_.on(FailureKind::missing, i);
    if (!missing && !failures_.on(FailureKind::stuck, i)) sample.raw = counts;
    if (failures_.on(FailureKind::nan, i)) sample.raw = kNaN;
    sample.freshness = missing ? Freshness::missing : Freshness::fresh;
    sample.homed = tick_ - first_tick_ >= homed_tick_[i];
    sample.index = wires[i].index().seen;
    sample.index_raw = wires[i].index().counts;
    sample.stamp_ns = stamp_ns;
  }
}

void SimDevice::measure_force() noexcept {
  if (force_noise_.empty()) return;
  if (linkage_) std::copy_n(linkage_->hand_force_N(script_substep()).begin(), 3, analogue_.begin());
  for (std::size_t i = 0; i < force_noise_.size(); ++i) {
    if (hand_) analogue_[i] = hand_->force_N(number_, i);
    if (!axes_.empty()) analogue_[i] = axes_[i].hand_force_N(script_substep());
    const double noise_N = options_.force_sensor->noise_N;
    if (noise_N > 0) analogue_[i] += noise_N * force_noise_[i].normal();
  }
}

std::uint32_t SimDevice::digital() const noexcept {
  std::uint32_t bits = 0;
  for (const DigitalChange& change : digital_)
    if (change.tick <= tick_ - first_tick_) bits = change.bits;
  return bits;
}

drivers::Collected SimDevice::collect(std::span<AxisSample> axes, Aux& aux) noexcept {
  switch_power();
  burn(failures_.take_burn_ns());
  std::copy_n(samples_.begin(), std::min(samples_.size(), axes.size()), axes.begin());
  aux = Aux{};
  aux.armed = armed_;
  aux.faulted = failures_.on(FailureKind::fault);
  aux.digital = digital();
  aux.analogue = analogue_;
  return drivers::Collected::complete;
}

// A power stage that dropped out stays off until it is asked for again.
void SimDevice::switch_power() noexcept {
  const bool drops_out = failures_.on(FailureKind::disarm);
  if (drops_out && !dropped_out_) arm_wanted_ = false;
  dropped_out_ = drops_out;
  const bool armed = arm_wanted_ && !drops_out;
  if (armed == armed_) return;
  armed_ = armed;
  armed_tick_ = tick_;
  for (Wires& axis : wires()) axis.cut();
  for (Axis& axis : axes_) axis.restart_script();
  if (linkage_) linkage_->restart_script();
}

void SimDevice::command(std::span<const double> effort, std::span<double> delivered) noexcept {
  const std::span<Wires> wires = this->wires();
  const std::size_t count = std::min({wires.size(), effort.size(), delivered.size()});
  for (std::size_t i = 0; i < count; ++i) {
    delivered[i] = armed_ ? wires[i].command(effort[i]) : 0;
  }
}

void SimDevice::stop() noexcept {
  for (Wires& axis : wires()) axis.command(0);
}

std::string SimDevice::fault_text() const {
  return failures_.on(FailureKind::fault) ? "scripted failure of a simulated device" : "";
}

}  // namespace hapticd::sim
