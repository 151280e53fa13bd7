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
  if (auto opened = open_buses(); !opened) return tl::unexpected(opened.error());
  auto found = connect_drives();
  if (!found) {
    disconnect();
    return tl::unexpected(found.error());
  }
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
  if (!buses_.empty() && buses_.front().socket != nullptr) stop();
  if (own_wait_descriptor_) ::close(wait_descriptor_);
  own_wait_descriptor_ = false;
  wait_descriptor_ = -1;
  axes_.clear();
  buses_.clear();
  arm_wanted_ = bus_failed_ = false;
}

// -- loop

void CanDevice::request(const drivers::TickTime& time) noexcept {
  start_ns_ = time.start_ns;
  for (Axis& axis : axes_) {
    axis.heard = false;
    axis.drive->begin_tick(start_ns_);
  }
  const bool asks = options_.timing == Timing::in_phase;
  for (Bus& bus : buses_) {
    if (asks) empty(bus, false);
    bus.outbox.clear();
    for (const std::size_t i : bus.axes) axes_[i].drive->query(bus.outbox);
    (void)bus.socket->send(bus.outbox.frames());
  }
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
    if (heard == Heard::sample && in_time) axis.heard = true;
    if (heard == Heard::sample && !in_time) ++counters_.late;
    if (heard != Heard::other_master) return;
    ++counters_.foreign;
    return fail_bus(bus, received.local ? "another program on this machine commands these drives"
                                        : "another master on the bus commands these drives");
  }
}

/// In phase: a drive that may be asked has not answered yet, on a bus that works.
bool CanDevice::owed() const noexcept {
  return std::ranges::any_of(axes_, [&](const Axis& axis) {
    return !axis.heard && !axis.drive->silent() &&
           buses_[axis.bus].socket->trouble() < Trouble::bus_off;
  });
}

void CanDevice::fill(std::span<AxisSample> samples) noexcept {
  const std::int64_t now_ns = host_.now_ns();
  for (std::size_t i = 0; i < samples.size() && i < axes_.size(); ++i) {
    const Drive& drive = *axes_[i].drive;
    AxisSample& sample = samples[i];
    sample.raw = drive.counts();
    sample.stamp_ns = drive.stamp_ns();
    sample.age_ns = now_ns - drive.stamp_ns();
    sample.drive_limits = drive.limits();
    sample.drive_faults = drive.faults();
    const bool young =
        options_.timing == Timing::free_running ? sample.age_ns <= worst_age_ns_ : axes_[i].heard;
    // A drive that proves its watchdog is not asked; it has no force then, and stands where it was.
    const bool known = drive.knows_position() && (young || drive.silent());
    sample.freshness = known ? Freshness::fresh : Freshness::missing;
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

/// What failed is told in one tick at least; it is over when the power is off and nothing is wrong any more.
void CanDevice::report(Aux& aux) noexcept {
  aux = Aux{};
  aux.armed = std::ranges::all_of(axes_, [](const Axis& axis) { return axis.drive->armed(); });
  aux.faulted = bus_failed_ ||
                std::ranges::any_of(axes_, [](const Axis& axis) { return axis.drive->failed(); });
  if (!aux.faulted || arm_wanted_) return;
  bus_failed_ = false;
  for (Bus& bus : buses_) bus.socket->clear_trouble();
  for (Axis& axis : axes_) axis.drive->clear_failure();
}

void CanDevice::command(std::span<const double> effort, std::span<double> delivered) noexcept {
  for (Bus& bus : buses_) {
    bus.outbox.clear();
    for (const std::size_t i : bus.axes) {
      Drive& drive = *axes_[i].drive;
      const double most_Nm = drive.max_torque_Nm();
      const double wanted_Nm = effort[i] * drive.torque_per_effort();
      const double torque_Nm =
          std::isfinite(wanted_Nm) ? std::clamp(wanted_Nm, -most_Nm, most_Nm) : 0;
      if (bus_failed_)
        drive.stop_now(bus.outbox);
      else
        drive.act(torque_Nm, bus.outbox);
      axes_[i].frames_end = bus.outbox.frames().size();
    }
    // What was not sent leaves the drive with what it had.
    const std::size_t sent = bus.socket->send(bus.outbox.frames());
    for (const std::size_t i : bus.axes) {
      Axis& axis = axes_[i];
      if (axis.frames_end <= sent) axis.delivered_Nm = axis.drive->carried_Nm();
      axis.drive->sent(axis.frames_end <= sent);
      delivered[i] = axis.drive->armed() ? axis.delivered_Nm / axis.drive->torque_per_effort() : 0;
    }
  }
}

void CanDevice::set_armed(bool armed) noexcept {
  arm_wanted_ = armed;
  for (Axis& axis : axes_) axis.drive->set_armed(armed);
}

void CanDevice::stop() noexcept {
  for (Bus& bus : buses_) {
    bus.outbox.clear();
    for (const std::size_t i : bus.axes) {
      axes_[i].drive->stop_now(bus.outbox);
      axes_[i].delivered_Nm = 0;
    }
    (void)bus.socket->send(bus.outbox.frames());
  }
}

SocketCounters CanDevice::socket_counters() const noexcept {
  SocketCounters sum;
  for (const Bus& bus : buses_) {
    const SocketCounters& one = bus.socket->counters();
    sum.sent += one.sent;
    sum.received += one.received;
    sum.not_sent += one.not_sent;
    sum.lost += one.lost;
  }
  return sum;
}

}  // namespace hapticd::can
