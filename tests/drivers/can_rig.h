// The daemon's device on emulated drives: a config is compiled, its CAN device speaks over a socket pair to drives that
// have encoders and decoders of their own, and the whole cycle runs in virtual time.
#pragma once
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/compile.h"
#include "config/error.h"
#include "daemon/cycle.h"
#include "drivers/can/can_device.h"
#include "sim/can/cia402_drive.h"
#include "sim/can/emulated_bus.h"
#include "sim/can/moteus_drive.h"
#include "sim/can/odrive_drive.h"
#include "sim/emulated_device.h"
#include "tests/drivers/system_calls.h"

namespace hapticd::test {

inline config::Compiled compile_text(const std::string& text) {
  auto compiled = config::read_text(text, "rig.yaml").and_then(config::compile);
  if (compiled) return std::move(*compiled);
  std::string all;
  for (const auto& error : compiled.error()) all += config::to_string(error) + "\n";
  throw std::runtime_error(all);
}

/// What the drives of a rig are, where they are not as the config says.
struct Emulation {
  sim::can::OdriveOptions odrive{};
  sim::can::MoteusOptions moteus{};
  sim::can::Cia402Options cia402{};
  double cia402_counts_factor = 1;  ///< of the config's counts per turn
  sim::can::WireOptions wire{};
  double step_s = 250e-6;
};

/// Drives and buses of one device of a config.
class EmulatedRig {
 public:
  EmulatedRig(const can::DeviceOptions& device, const sim::DeviceOptions& truth,
              const Emulation& given, std::int64_t start_ns) {
    std::vector<sim::EmulatedDevice::Joint> joints;
    for (const can::DriveOptions& drive : device.drives) {
      drives_.push_back(make_drive(device, drive, given, start_ns));
      bus(drive.interface, given.wire).add(*drives_.back());
      const double turns_per_unit = drive.counts_per_unit / drive.counts_per_turn;
      joints.push_back(sim::turning(*drives_.back(), turns_per_unit));
    }
    body_ = std::make_unique<sim::EmulatedDevice>(truth, joints, given.step_s);
    if (auto started = body_->start(); !started) throw std::runtime_error(started.error().text);
  }
  ~EmulatedRig() {
    for (auto& [name, one] : buses_) {
      ::close(one.near);
      if (one.far >= 0) ::close(one.far);
    }
  }

  void advance(std::int64_t now_ns) {
    body_->advance(now_ns);
    for (auto& [name, one] : buses_)
      if (!held_) one.bus->advance(now_ns);
  }
  std::int64_t next_ns() const {
    std::int64_t next = INT64_MAX;
    for (const auto& [name, one] : buses_) next = std::min(next, one.bus->next_ns());
    return next;
  }
  std::uint64_t sent() const {
    std::uint64_t sum = 0;
    for (const auto& [name, one] : buses_) sum += one.bus->sent();
    return sum;
  }
  /// Nothing moves on the buses.
  void hold(bool held) { held_ = held; }

  int near_end(const std::string& interface) { return buses_.at(interface).near; }
  sim::can::EmulatedBus& bus(const std::string& interface) { return *buses_.at(interface).bus; }
  sim::can::Drive& drive(std::size_t axis) { return *drives_[axis]; }
  sim::EmulatedDevice& body() { return *body_; }
  /// Closes the drives' end: the interface is gone.
  void unplug(const std::string& interface) {
    ::close(buses_.at(interface).far);
    buses_.at(interface).far = -1;
    held_ = true;
  }

 private:
  struct One {
    int near = -1, far = -1;
    std::unique_ptr<sim::can::EmulatedBus> bus;
  };

  sim::can::EmulatedBus& bus(const std::string& interface, const sim::can::WireOptions& wire) {
    One& one = buses_[interface];
    if (one.bus) return *one.bus;
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0)
      throw std::runtime_error("socketpair");
    one.near = ends[0];
    one.far = ends[1];
    one.bus = std::make_unique<sim::can::EmulatedBus>(one.far, wire);
    return *one.bus;
  }

  static std::unique_ptr<sim::can::Drive> make_drive(const can::DeviceOptions& device,
                                                     const can::DriveOptions& drive,
                                                     const Emulation& given,
                                                     std::int64_t start_ns) {
    switch (device.protocol) {
      case can::Protocol::odrive: {
        sim::can::OdriveOptions options = given.odrive;
        options.node = drive.node;
        options.counts_per_turn = drive.counts_per_turn;
        if (device.timing == drivers::Timing::in_phase) options.estimates_every_s = 0;
        return std::make_unique<sim::can::OdriveDrive>(options, start_ns);
      }
      case can::Protocol::moteus: {
        sim::can::MoteusOptions options = given.moteus;
        options.servo = drive.node;
        options.prefix = device.prefix;
        options.counts_per_turn = drive.counts_per_turn;
        return std::make_unique<sim::can::MoteusDrive>(options, start_ns);
      }
      case can::Protocol::cia402: {
        sim::can::Cia402Options options = given.cia402;
        options.node = drive.node;
        options.counts_per_rev = given.cia402_counts_factor * drive.counts_per_turn;
        return std::make_unique<sim::can::Cia402Drive>(options, start_ns);
      }
    }
    return nullptr;
  }

  std::map<std::string, One> buses_;
  std::vector<std::unique_ptr<sim::can::Drive>> drives_;
  std::unique_ptr<sim::EmulatedDevice> body_;
  bool held_ = false;
};

/// Config, device, drives and cycle, in virtual time.
class CanRig {
 public:
  explicit CanRig(const std::string& text, const Emulation& emulation = {})
      : compiled_(compile_text(text)),
        drives_(compiled_.can.at(0).value(), compiled_.simulated.at(0), emulation, kStart_ns),
        host_(*this),
        device_(*compiled_.can[0], host_),
        loop_end_(*this),
        cycle_({&loop_end_}, compiled_.program->plan()) {
    now_ns_ = kStart_ns;
    period_ns_ = std::llround(1e9 * compiled_.can[0]->period_s);
    current_ = this;
  }
  ~CanRig() { current_ = nullptr; }

  Result<drivers::DeviceInfo> connect() {
    current_ = this;
    auto info = device_.connect();
    next_start_ns_ = (now_ns_ / period_ns_ + 2) * period_ns_;
    return info;
  }

  /// One tick; afterwards the drives have what it sent.
  const control::TickOutput& tick() {
    current_ = this;
    pass_until(next_start_ns_);
    input.time = {.tick = ++tick_,
                  .start_ns = next_start_ns_,
                  .deadline_ns = next_start_ns_ + std::llround(1e9 * compiled_.collect_s)};
    cycle_.run(*compiled_.program, input, &CanRig::clock, nullptr);
    input.clear_fault = false;
    next_start_ns_ += period_ns_;
    pass_until(next_start_ns_ - 1);
    return cycle_.output();
  }
  /// The loop hangs: time passes for the drives alone.
  void stand_still(std::int64_t duration_ns) {
    const std::int64_t end_ns = now_ns_ + duration_ns;
    while (now_ns_ < end_ns) pass_until(std::min(end_ns, now_ns_ + period_ns_));
    next_start_ns_ = (now_ns_ / period_ns_ + 1) * period_ns_;
    tick_ += duration_ns / period_ns_;
  }
  /// The kernel takes what is asked and refuses what is commanded.
  void drop_commands(bool dropped) { drop_commands_ = dropped; }
  /// The queue towards the bus takes a few frames only.
  void small_queue() {
    const int bytes = 1;  // the kernel makes it the least that it has
    ::setsockopt(drives_.near_end("can0"), SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  }
  /// Ticks until it is so; false: not within `most`.
  template <class Condition>
  bool run_until(Condition condition, int most) {
    for (int i = 0; i < most; ++i) {
      tick();
      if (condition()) return true;
    }
    return false;
  }
  /// From ready to forces, or not within three seconds.
  bool enable() {
    input.enable = true;
    return run_until([&] { return cycle_.output().mode == control::Mode::enabled; }, 3000);
  }
  bool recover() {
    input.enable = input.clear_fault = true;
    return run_until(
        [&] {
          input.clear_fault = input.clear_fault || cycle_.output().mode == control::Mode::fault;
          return cycle_.output().mode == control::Mode::enabled;
        },
        3000);
  }

  // The parts of a tick, for who calls the device himself.
  drivers::TickTime begin_tick() {
    pass_until(next_start_ns_);
    return {.tick = ++tick_,
            .start_ns = next_start_ns_,
            .deadline_ns = next_start_ns_ + period_ns_ / 2};
  }
  void pass(std::int64_t duration_ns) { pass_until(now_ns_ + duration_ns); }
  void end_tick() {
    next_start_ns_ += period_ns_;
    pass_until(next_start_ns_ - 1);
  }
  /// The host's end of can0, for who speaks without a device.
  can::Socket& socket() {
    if (!socket_)
      socket_ = std::make_unique<can::Socket>(can::Socket::of(::dup(drives_.near_end("can0"))));
    return *socket_;
  }
  can::Host& host() { return host_; }

  double motor_Nm(std::size_t axis = 0) { return drives_.drive(axis).torque_Nm(); }
  control::Mode mode() const { return cycle_.output().mode; }
  std::string fault_text() const { return device_.fault_text(); }
  EmulatedRig& drives() { return drives_; }
  can::CanDevice& device() { return device_; }
  daemon::Cycle& cycle() { return cycle_; }
  const config::Compiled& compiled() const { return compiled_; }
  build::Program& program() { return *compiled_.program; }
  std::int64_t now_ns() const { return now_ns_; }
  std::int64_t period_ns() const { return period_ns_; }
  const AxisSample& sample(std::size_t axis = 0) const { return cycle_.samples()[axis]; }

  daemon::CycleInput input;

 private:
  static constexpr std::int64_t kStart_ns = 1'000'000'000;

  void pass_until(std::int64_t time_ns) {
    drives_.advance(now_ns_);  // what was sent just now leaves now
    if (time_ns <= now_ns_) return;
    now_ns_ = time_ns;
    drives_.advance(now_ns_);
  }
  /// Until something came, or to the time.
  void pass_until_news(std::int64_t until_ns) {
    const std::uint64_t before = drives_.sent();
    drives_.advance(now_ns_);
    while (now_ns_ < until_ns && drives_.sent() == before)
      pass_until(std::min(until_ns, std::max(now_ns_ + 1000, drives_.next_ns())));
  }
  /// While the loop waits for the buses, time passes for them.
  static std::int64_t clock() noexcept {
    CanRig& rig = *current_;
    if (rig.waiting_) rig.pass_until_news(rig.input.time.deadline_ns);
    return rig.now_ns_;
  }

  class VirtualHost final : public can::Host {
   public:
    explicit VirtualHost(CanRig& rig) : rig_(rig) {}
    std::int64_t now_ns() noexcept override { return rig_.now_ns_; }
    void wait(int, std::int64_t until_ns) override { rig_.pass_until_news(until_ns); }
    Result<can::Socket> open(const can::SocketOptions& options) override {
      rig_.filters = options.filters;
      const int descriptor = ::dup(rig_.drives_.near_end(options.interface));
      return can::Socket::of(descriptor);
    }

   private:
    CanRig& rig_;
  };

  /// The device as the loop has it, and whether the loop waits for it.
  class LoopEnd final : public drivers::Device {
   public:
    explicit LoopEnd(CanRig& rig) : rig_(rig) {}
    Result<drivers::DeviceInfo> connect() override { return rig_.device_.connect(); }
    void disconnect() noexcept override { rig_.device_.disconnect(); }
    void request(const drivers::TickTime& time) noexcept override { rig_.device_.request(time); }
    drivers::Collected collect(std::span<AxisSample> axes, Aux& aux) noexcept override {
      const auto collected = rig_.device_.collect(axes, aux);
      rig_.waiting_ =
          collected == drivers::Collected::waiting && rig_.now_ns_ < rig_.input.time.deadline_ns;
      return collected;
    }
    int wait_fd() const noexcept override { return rig_.device_.wait_fd(); }
    void command(std::span<const double> effort, std::span<double> delivered) noexcept override {
      rig_.waiting_ = false;
      system_calls().queue_full = rig_.drop_commands_;
      rig_.device_.command(effort, delivered);
      system_calls().queue_full = false;
    }
    void set_armed(bool armed) noexcept override { rig_.device_.set_armed(armed); }
    void stop() noexcept override {
      rig_.waiting_ = false;
      rig_.device_.stop();
    }
    std::string fault_text() const override { return rig_.device_.fault_text(); }

   private:
    CanRig& rig_;
  };

  static inline CanRig* current_ = nullptr;

 public:
  std::vector<can::Filter> filters;

 private:
  config::Compiled compiled_;
  EmulatedRig drives_;
  VirtualHost host_;
  std::unique_ptr<can::Socket> socket_;
  can::CanDevice device_;
  LoopEnd loop_end_;
  daemon::Cycle cycle_;
  std::int64_t now_ns_ = 0, next_start_ns_ = 0, period_ns_ = 0, tick_ = 0;
  bool waiting_ = false;
  bool drop_commands_ = false;
};

}  // namespace hapticd::test
