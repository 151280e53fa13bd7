#include "drivers/can/can_device.h"

#include <sys/epoll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/can/cia402_drive.h"
#include "drivers/can/moteus_drive.h"
#include "drivers/can/odrive_drive.h"

namespace hapticd::can {
namespace {

using drivers::Timing;

std::unique_ptr<Drive> make_drive(const DeviceOptions& device, const DriveOptions& options) {
  switch (device.protocol) {
    case Protocol::odrive:
      return std::make_unique<OdriveDrive>(device, options);
    case Protocol::moteus:
      return std::make_unique<MoteusDrive>(device, options);
    case Protocol::cia402:
      return std::make_unique<Cia402Drive>(device, options);
  }
  return nullptr;
}

}  // namespace

CanDevice::CanDevice(DeviceOptions options, Host& host)
    : options_(std::move(options)),
      host_(host),
      worst_age_ns_(std::llround(1e9 * options_.worst_sample_age_s)) {}

CanDevice::~CanDevice() {
  disconnect();
}

// -- set-up

std::vector<std::string> CanDevice::lock_names() const {
  std::vector<std::string> names;
  for (const DriveOptions& drive : options_.drives)
    names.push_back("can-" + drive.interface + "-" + std::to_string(drive.node));
  return names;
}

Result<drivers::DeviceInfo> CanDevice::connect() {
  disconnect();
  make_axes();
  if (auto opened = open_buses(); !opened) {
    disconnect();
    return tl::unexpected(opened.error());
  }
  auto found = connect_drives();
  if (!found) {
    disconnect();
    return tl::unexpected(found.error());
  }
  for (Axis& axis : axes_)
    axis.drive->begin_tick(host_.now_ns());  // it may be armed before the first one
  make_wait_descriptor();
  return drivers::DeviceInfo{.model = *found,
                             .serial = {},
                             .timing = options_.timing,
                             .worst_sample_age_s = options_.worst_sample_age_s};
}

void CanDevice::make_axes() {
  axes_.clear();
  buses_.clear();
  for (const DriveOptions& options : options_.drives) {
    auto bus = std::ranges::find(buses_, options.interface, &Bus::interface);
    if (bus == buses_.end()) {
      buses_.push_back(
          {.interface = options.interface, .axes = {}, .socket = nullptr, .outbox = {}});
      bus = std::prev(buses_.end());
    }
    bus->axes.push_back(axes_.size());
    axes_.push_back({.drive = make_drive(options_, options),
                     .bus = static_cast<std::size_t>(bus - buses_.begin())});
    axes_.back().drive->tell(fault_text_);
  }
  for (Bus& bus : buses_) {
    std::ranges::sort(bus.axes, {}, [&](std::size_t i) { return options_.drives[i].node; });
    for (const std::size_t i : bus.axes) axes_[i].drive->lead(i == bus.axes.front());
  }
}

Result<void> CanDevice::open_buses() {
  for (Bus& bus : buses_) {
    SocketOptions wanted{.interface = bus.interface,
                         .fd = options_.protocol == Protocol::moteus,
                         .filters = {},
                         .frames_per_tick = bus.axes.size() + 2};
    for (const std::size_t i : bus.axes)
      for (const Filter& filter : axes_[i].drive->filters()) wanted.filters.push_back(filter);
    auto socket = host_.open(wanted);
    if (!socket) return tl::unexpected(socket.error());
    bus.socket = std::make_unique<Socket>(std::move(*socket));
  }
  return {};
}

Result<std::string> CanDevice::connect_drives() {
  std::string found;
  for (Bus& bus : buses_) {
    SocketConversation conversation(*bus.socket, host_);
    for (const std::size_t i : bus.axes) {
      auto drive = axes_[i].drive->connect(conversation);
      if (!drive) return drive;
      if (found.find(*drive) == std::string::npos) found += (found.empty() ? "" : "; ") + *drive;
    }
  }
  return found;
}

/// One descriptor that is readable when one of the buses is.
void CanDevice::make_wait_descriptor() {
  if (buses_.size() == 1) {
    wait_descriptor_ = buses_.front().socket->descriptor();
    return;
  }
  wait_descriptor_ = ::epoll_create1(EPOLL_CLOEXEC);
  own_wait_descriptor_ = true;
  for (const Bus& bus : buses_) {
    epoll_event event{};
    event.events = EPOLLIN;
    ::epoll_ctl(wait_descriptor_, EPOLL_CTL_ADD, bus.socket->descriptor(), &event);
  }
}

void CanDevice::disconnect() noexcept {
  stop();
  if (own_wait_descriptor_) ::close(wait_descriptor_);
  own_wait_descriptor_ = false;
  wait_descriptor_ = -1;
  axes_.clear();
  buses_.clear();
  arm_wanted_ = bus_failed_ = told_ = false;
}

// -- loop

void CanDevice::request(const drivers::TickTime& time) noexcept {
  start_ns_ = time.start_ns;
  let_go();
  for (Axis& axis : axes_) {
    axis.heard = false;
    axis.drive->begin_tick(start_ns_);
  }
  for (Bus& bus : buses_) ask(bus);
}

/// In phase. A drive that has not answered the tick before is not asked in this one: what comes of it now is late.
void CanDevice::ask(Bus& bus) noexcept {
  if (options_.timing != Timing::in_phase) return;
  empty(bus, false);
  bool owed = false;
  for (const std::size_t i : bus.axes) owed = owed || axes_[i].asked;
  const bool together = options_.protocol == Protocol::cia402;  // one SYNC asks all
  bus.outbox.clear();
  const std::int64_t now_ns = host_.now_ns();
  for (const std::size_t i : bus.axes) {
    Axis& axis = axes_[i];
    const bool owes = together ? owed : axis.asked;
    axis.asked = !owes && !axis.drive->silent();
    if (!axis.asked) continue;
    axis.asked_ns = now_ns;
    axis.drive->query(bus.outbox);
  }
  (void)bus.socket->send(bus.outbox.frames());
}

drivers::Collected CanDevice::collect(std::span<AxisSample> axes, Aux& aux) noexcept {
  for (Bus& bus : buses_) empty(bus, true);
  look_for_trouble();
  report(aux);
  fill(axes);
  return options_.timing == Timing::in_phase && owed() ? drivers::Collected::waiting
                                                       : drivers::Collected::complete;
}

/// Takes all that has arrived: the newest counts. A flood of frames must not hold the tick for ever.
void CanDevice::empty(Bus& bus, bool in_time) noexcept {
  constexpr int kMostCalls = 16;
  for (int call = 0; call < kMostCalls; ++call) {
    for (const Received& received : bus.socket->receive(host_.now_ns()))
      hear(bus, received, in_time);
    if (!bus.socket->more()) return;
  }
}

void CanDevice::hear(Bus& bus, const Received& received, bool in_time) noexcept {
  for (const std::size_t i : bus.axes) {
    Axis& axis = axes_[i];
    const Heard heard = axis.drive->take(received.frame, received.stamp_ns);
    if (heard == Heard::nothing) continue;
    if (heard == Heard::other_master) {
      ++foreign_;
      return fail_bus(bus, received.local ? "another program on this machine commands these drives"
                                          : "another master on the bus commands these drives");
    }
    if (heard != Heard::sample) return;
    const bool counts = in_time && (options_.timing != Timing::in_phase || axis.asked);
    axis.asked = false;
    axis.heard = axis.heard || counts;
    if (options_.timing == Timing::reply_to_command) axis.asked_ns = axis.command_ns;
    if (!counts) ++late_;
    return;
  }
}

/// In phase: a drive that was asked has not answered yet, on a bus that works.
bool CanDevice::owed() const noexcept {
  return std::ranges::any_of(axes_, [&](const Axis& axis) {
    return axis.asked && buses_[axis.bus].socket->trouble() < Trouble::bus_off;
  });
}

/// Of the newest sample, at most: since its question went out, or since it came.
std::int64_t CanDevice::age_ns(const Axis& axis, std::int64_t now_ns) const noexcept {
  return now_ns -
         (options_.timing == Timing::free_running ? axis.drive->stamp_ns() : axis.asked_ns);
}

void CanDevice::fill(std::span<AxisSample> samples) noexcept {
  const std::int64_t now_ns = host_.now_ns();
  for (std::size_t i = 0; i < samples.size() && i < axes_.size(); ++i) {
    const Axis& axis = axes_[i];
    const Drive& drive = *axis.drive;
    AxisSample& sample = samples[i];
    sample.raw = drive.counts();
    sample.stamp_ns = drive.stamp_ns();
    sample.age_ns = age_ns(axis, now_ns);
    sample.drive_limits = drive.limits();
    sample.drive_faults = drive.faults();
    const bool young =
        (options_.timing == Timing::free_running || axis.heard) && sample.age_ns <= worst_age_ns_;
    sample.freshness = drive.knows_position() && young ? Freshness::fresh : Freshness::missing;
  }
}

void CanDevice::look_for_trouble() noexcept {
  for (const Bus& bus : buses_)
    if (bus.socket->trouble() != Trouble::none) fail_bus(bus, word_of(bus.socket->trouble()));
}

void CanDevice::fail_bus(const Bus& bus, std::string_view what) noexcept {
  if (bus_failed_) return;
  bus_failed_ = true;
  fault_text_.begin().add(bus.interface).add(": ").add(what).publish();
}

void CanDevice::report(Aux& aux) noexcept {
  aux = Aux{};
  aux.armed = std::ranges::all_of(axes_, [](const Axis& axis) { return axis.drive->armed(); });
  aux.faulted = bus_failed_ ||
                std::ranges::any_of(axes_, [](const Axis& axis) { return axis.drive->failed(); });
  told_ = told_ || aux.faulted;
}

/// What failed was told in a tick; it is over when the power is off. What is still wrong fails anew.
void CanDevice::let_go() noexcept {
  if (!std::exchange(told_, false) || arm_wanted_) return;
  bus_failed_ = false;
  for (Bus& bus : buses_) bus.socket->clear_trouble();
  for (Axis& axis : axes_) axis.drive->clear_failure();
}

void CanDevice::command(std::span<const double> effort, std::span<double> delivered) noexcept {
  for (Bus& bus : buses_) command_bus(bus, effort, delivered);
  count();
}

void CanDevice::command_bus(Bus& bus, std::span<const double> effort,
                            std::span<double> delivered) noexcept {
  bus.outbox.clear();
  const std::int64_t now_ns = host_.now_ns();
  for (const std::size_t i : bus.axes) {
    Axis& axis = axes_[i];
    Drive& drive = *axis.drive;
    const double most_Nm = drive.max_torque_Nm();
    const double wanted_Nm = effort[i] * drive.torque_per_effort();
    axis.command_ns = now_ns;
    axis.first_frame = bus.outbox.frames().size();
    if (bus_failed_)
      drive.stop_now(bus.outbox);
    else
      drive.act(std::isfinite(wanted_Nm) ? std::clamp(wanted_Nm, -most_Nm, most_Nm) : 0,
                bus.outbox);
    axis.frames_end = bus.outbox.frames().size();
  }
  // What was not sent leaves the drive with what it had.
  const std::size_t sent = bus.socket->send(bus.outbox.frames());
  for (const std::size_t i : bus.axes) {
    Axis& axis = axes_[i];
    const bool all = axis.frames_end <= sent;
    if (all) axis.delivered_Nm = axis.drive->carried_Nm();
    if (axis.frames_end > axis.first_frame && !bus_failed_) axis.drive->sent(all);
    delivered[i] = axis.drive->armed() ? axis.delivered_Nm / axis.drive->torque_per_effort() : 0;
  }
}

void CanDevice::set_armed(bool armed) noexcept {
  arm_wanted_ = armed;
  for (Axis& axis : axes_) axis.drive->set_armed(armed);
}

void CanDevice::stop() noexcept {
  for (Bus& bus : buses_) {
    if (!bus.socket) continue;  // it could not be opened
    bus.outbox.clear();
    const std::int64_t now_ns = host_.now_ns();
    for (const std::size_t i : bus.axes) {
      axes_[i].command_ns = now_ns;
      axes_[i].drive->stop_now(bus.outbox);
      axes_[i].delivered_Nm = 0;
    }
    (void)bus.socket->send(bus.outbox.frames());
  }
  count();
}

void CanDevice::count() noexcept {
  std::uint64_t not_sent = 0, lost = 0;
  for (const Bus& bus : buses_) {
    if (!bus.socket) continue;
    not_sent += bus.socket->counters().not_sent;
    lost += bus.socket->counters().lost;
  }
  traffic_.late.store(late_, std::memory_order_relaxed);
  traffic_.foreign.store(foreign_, std::memory_order_relaxed);
  traffic_.not_sent.store(not_sent, std::memory_order_relaxed);
  traffic_.lost.store(lost, std::memory_order_relaxed);
}

}  // namespace hapticd::can
