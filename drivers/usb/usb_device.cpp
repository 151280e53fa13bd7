#include "drivers/usb/usb_device.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace hapticd::usb {
namespace {

constexpr std::int64_t kLook_ns = 1'000'000;

std::string hex(std::uint16_t number) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "%04x", number);
  return text.data();
}

}  // namespace

UsbDevice::UsbDevice(DeviceOptions options, std::unique_ptr<Host> host,
                     std::unique_ptr<Runner> runner)
    : options_(std::move(options)),
      host_(std::move(host)),
      runner_(std::move(runner)),
      protocol_(make_protocol(options_)) {
  exchange_.traffic.comes_and_goes = true;
}

UsbDevice::~UsbDevice() {
  disconnect();
}

// -- set-up

std::vector<std::string> UsbDevice::lock_names() const {
  const Selection& selection = options_.selection;
  std::string name = "usb-" + hex(selection.vendor) + "-" + hex(selection.product);
  for (const std::string* part : {&selection.serial, &selection.path})
    if (!part->empty()) name += "-" + *part;
  return {name};
}

Result<drivers::DeviceInfo> UsbDevice::connect() {
  disconnect();
  worker_ = std::make_unique<Worker>(options_, *host_, *protocol_, exchange_);
  runner_->start([worker = worker_.get()] { worker->run(); });
  while (worker_->first() == nullptr) runner_->pause(kLook_ns);
  const Worker::Outcome& came = *worker_->first();
  if (!came.found && !came.why.absent) {
    disconnect();
    return tl::unexpected(came.why.error);
  }
  return drivers::DeviceInfo{
      .model = came.found ? came.found->model : "not plugged in; it is waited for",
      .serial = came.found ? came.found->serial : "",
      .timing = options_.kind == Kind::falcon ? drivers::Timing::reply_to_command
                                              : drivers::Timing::free_running,
      .worst_sample_age_s = options_.worst_sample_age_s};
}

void UsbDevice::disconnect() noexcept {
  stop();
  if (worker_) worker_->end();
  runner_->join();
  arm_wanted_ = armed_ = failed_ = told_ = begun_ = false;
  link_ = 0;
}

std::string UsbDevice::status_text() const {
  return exchange_.link.load(std::memory_order_acquire) == 0 ? exchange_.doing.text()
                                                             : std::string{};
}

// -- loop

/// What failed was told in a tick; it is over when the power is off and the device is there. What is still wrong fails anew.
void UsbDevice::request(const drivers::TickTime&) noexcept {
  if (!told_ || arm_wanted_) return;
  if (exchange_.link.load(std::memory_order_acquire) == 0) return;
  told_ = failed_ = false;
}

drivers::Collected UsbDevice::collect(std::span<AxisSample> axes, Aux& aux) noexcept {
  look_at_link();
  (void)exchange_.reading.load(reading_);  // or the one before, once more
  fill(axes, aux);
  told_ = told_ || aux.faulted;
  return drivers::Collected::complete;
}

/// A connection that is not the one of the tick before was lost in between, even if there is a new one.
void UsbDevice::look_at_link() noexcept {
  const std::uint32_t link = exchange_.link.load(std::memory_order_acquire);
  if (link == link_) return;
  failed_ = failed_ || link_ != 0 || link > 1;
  begun_ = false;
  if (link == 0) return;
  link_ = link;
  failures_ = 0;
}

void UsbDevice::fill(std::span<AxisSample> axes, Aux& aux) noexcept {
  const bool up = exchange_.link.load(std::memory_order_acquire) == link_ && link_ != 0;
  const bool ours = up && reading_.link == link_;
  const std::int64_t age_ns =
      host_->now_ns() - reading_.stamp_ns + std::llround(1e9 * options_.arrival_age_s);
  const bool young = ours && age_ns <= std::llround(1e9 * options_.worst_sample_age_s);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    axes[i] = {.raw = reading_.counts[i],
               .stamp_ns = reading_.stamp_ns,
               .age_ns = age_ns,
               .freshness = !young   ? Freshness::missing
                            : begun_ ? Freshness::fresh
                                     : Freshness::first,
               .homed = ((reading_.homed >> i) & 1u) != 0,
               .drive_faults = reading_.drive_faults};
  }
  begun_ = begun_ || young;
  if (ours && reading_.failures != failures_) {
    failures_ = reading_.failures;
    failed_ = true;
  }
  armed_ = ours && reading_.armed && arm_wanted_;
  aux = {.digital = ours ? reading_.digital : 0,
         .armed = armed_,
         .faulted = failed_,
         .analogue = ours ? reading_.analogue : std::array<double, 6>{}};
}

void UsbDevice::command(std::span<const double> effort, std::span<double> delivered) noexcept {
  Command command{.at_ns = host_->now_ns(), .link = link_, .armed = arm_wanted_ && !failed_};
  for (std::size_t i = 0; i < effort.size(); ++i) {
    const double most = options_.axes[i].max_effort;
    const double wanted = std::isfinite(effort[i]) ? std::clamp(effort[i], -most, most) : 0;
    command.effort[i] = command.armed ? wanted : 0;
    delivered[i] = armed_ ? protocol_->carried(i, command.effort[i]) : 0;
  }
  give(command);
}

void UsbDevice::stop() noexcept {
  give({.at_ns = host_->now_ns(), .link = link_});
}

void UsbDevice::give(const Command& command) noexcept {
  exchange_.command.store(command);
  host_->wake();
}

}  // namespace hapticd::usb
