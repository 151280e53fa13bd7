#include "daemon/hapticctl_identify_session.h"

#include <fmt/format.h>
#include <poll.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "daemon/lock_file.h"
#include "daemon/realtime.h"

namespace hapticd::daemon {
namespace {

constexpr int kStopCycles = 5;          // a bus may lose one
constexpr double kLongestArming_s = 5;  // of the power stage
constexpr int kPriority = 80;
constexpr int kProgressEvery = 100;  // ticks

/// Position of an axis from its encoder: unwrapped, scaled, 0 where it began.
class AxisReader {
 public:
  explicit AxisReader(const control::AxisPlan& plan) : plan_(plan) {}

  /// NaN while there is no sample.
  double read(const AxisSample& sample) noexcept {
    fresh_ = sample.freshness >= Freshness::fresh && std::isfinite(sample.raw);
    if (!fresh_) return position_;
    if (std::isnan(position_)) raw_ = sample.raw;
    double counts = sample.raw - raw_;
    if (plan_.modulus_raw > 0) counts = std::remainder(counts, plan_.modulus_raw);
    raw_ = sample.raw;
    counts_ += counts;
    position_ = plan_.unit_per_raw * counts_;
    return position_;
  }
  bool fresh() const noexcept { return fresh_; }

 private:
  control::AxisPlan plan_;
  double raw_ = 0;
  double counts_ = 0;
  double position_ = std::numeric_limits<double>::quiet_NaN();
  bool fresh_ = false;
};

class Loop {
 public:
  Loop(IdentifySetup& setup, TickClock& clock)
      : setup_(setup),
        device_(*setup.device),
        clock_(clock),
        session_{.runner = identify::Runner(setup.excitation, setup.period_s),
                 .hand_force = {},
                 .held_loss = {setup.axes.size(), setup.axis, setup.period_s}},
        positions_(setup.axes.size(), 0.0),
        samples_(setup.axes.size()),
        effort_(setup.axes.size(), 0.0),
        delivered_(setup.axes.size(), 0.0) {
    for (std::size_t i = 0; i < setup.axes.size(); ++i) {
      readers_.emplace_back(setup.axes[i]);
      holds_.emplace_back(setup.holds[i], setup.period_s);
    }
  }

  /// Power stage on. False: it never was.
  bool arm(const std::atomic<bool>& interrupt) {
    device_.set_armed(true);
    const auto ticks = static_cast<int>(kLongestArming_s / setup_.period_s);
    for (int i = 0; i < ticks && !interrupt.load(); ++i) {
      begin_tick();
      device_.command(effort_, delivered_);
      if (aux_.armed) return true;
      if (aux_.faulted) return false;
    }
    return false;
  }

  /// One tick of the excitation. An error: the device cannot go on.
  Result<void> tick() {
    const std::int64_t missed = begin_tick();
    if (aux_.faulted || !aux_.armed) {
      return fail(ExitCode::unavailable,
                  aux_.faulted ? "the device reports a fault: " + device_.fault_text()
                               : std::string("the power stage of the device went off"));
    }
    book_missed(missed);
    for (std::size_t i = 0; i < readers_.size(); ++i) {
      const double position = readers_[i].read(samples_[i]);
      positions_[i] = position;
      const bool fresh = readers_[i].fresh();
      if (i == setup_.axis) {
        effort_[i] = session_.runner.tick(position, fresh);
      } else {
        const double hold = holds_[i].tick(position, fresh);  // looks how far it strays, too
        effort_[i] = setup_.clamped ? 0 : hold;
      }
    }
    device_.command(effort_, delivered_);
    session_.runner.delivered(delivered_[setup_.axis]);
    session_.held_loss.tick(positions_, delivered_);
    if (setup_.channel) session_.hand_force.push_back(aux_.analogue[*setup_.channel]);
    return {};
  }

  void stop() noexcept {
    device_.set_armed(false);
    for (int i = 0; i < kStopCycles; ++i) {
      begin_tick();
      device_.stop();
    }
  }

  IdentifySession& session() { return session_; }
  double greatest_stray() const {
    double greatest = 0;
    for (std::size_t i = 0; i < holds_.size(); ++i) {
      if (i != setup_.axis) greatest = std::max(greatest, holds_[i].strayed());
    }
    return greatest;
  }

 private:
  /// Waits for the tick and takes its samples; how many were missed before it.
  std::int64_t begin_tick() noexcept {
    const TickClock::Tick tick = clock_.next();
    for (AxisSample& sample : samples_) sample.freshness = Freshness::missing;
    device_.request(tick.time);
    while (device_.collect(samples_, aux_) == drivers::Collected::waiting) {
      if (!wait(tick.time.deadline_ns - clock_.now_ns())) break;
    }
    return tick.missed;
  }

  bool wait(std::int64_t timeout_ns) const noexcept {
    if (device_.wait_fd() < 0 || timeout_ns <= 0) return false;
    pollfd fd{.fd = device_.wait_fd(), .events = POLLIN, .revents = 0};
    const timespec timeout{.tv_sec = static_cast<time_t>(timeout_ns / 1'000'000'000),
                           .tv_nsec = static_cast<long>(timeout_ns % 1'000'000'000)};
    return ::ppoll(&fd, 1, &timeout, nullptr) > 0;
  }

  /// Ticks that nobody saw: the last effort was held.
  void book_missed(std::int64_t missed) {
    session_.missed_ticks += missed;
    for (std::int64_t i = 0; i < missed; ++i) {
      session_.runner.tick(0, false);
      session_.runner.delivered(delivered_[setup_.axis]);
      if (setup_.channel) session_.hand_force.push_back(aux_.analogue[*setup_.channel]);
    }
  }

  IdentifySetup& setup_;
  drivers::Device& device_;
  TickClock& clock_;
  IdentifySession session_;
  std::vector<double> positions_;
  std::vector<AxisReader> readers_;
  std::vector<identify::Hold> holds_;
  std::vector<AxisSample> samples_;
  Aux aux_;
  std::vector<double> effort_, delivered_;
};

Result<void> run(Loop& loop, const IdentifySetup& setup, const std::atomic<bool>& interrupt,
                 const IdentifyProgress& progress) {
  const identify::Runner& runner = loop.session().runner;
  if (!loop.arm(interrupt) && !interrupt.load()) {
    const std::string why = setup.device->fault_text();
    return fail(ExitCode::unavailable, "the power stage of the device did not come on" +
                                           (why.empty() ? why : "; the driver says: " + why));
  }
  for (std::int64_t tick = 0; runner.ended() == identify::Ended::running; ++tick) {
    if (interrupt.load()) return fail(ExitCode::try_again, "interrupted; nothing was written");
    if (auto done = loop.tick(); !done) return done;
    if (tick % kProgressEvery == 0) progress(runner.progress(), runner.excitation().frequency_Hz());
    // A joint that gives way is part of another motion than that which is fitted.
    const double stray = loop.greatest_stray();
    if (stray > setup.excitation.travel) {
      return fail(ExitCode::no,
                  fmt::format("{}: another axis could not be held: it moved by {:.3g}; lock it, or "
                              "allow less --force",
                              setup.name, stray));
    }
  }
  if (runner.ended() == identify::Ended::complete) return {};
  return fail(ExitCode::no, setup.name + ": " + runner.why());
}

Result<std::vector<LockFile>> connect(IdentifySetup& setup) {
  std::vector<LockFile> locks;
  auto info = connect_locked(*setup.device, device_lock_directories(), locks);
  if (!info) return tl::unexpected(info.error());
  return locks;
}

}  // namespace

Result<IdentifySession> run_session(IdentifySetup& setup, const std::atomic<bool>& interrupt,
                                    const IdentifyProgress& progress) {
  auto locks = connect(setup);
  if (!locks) {
    setup.device->disconnect();
    return tl::unexpected(locks.error());
  }
  const std::int64_t period_ns = std::llround(setup.period_s * 1e9);
  RealtimeReport report;
  std::optional<ProcessRealtime> realtime;
  std::unique_ptr<TickClock> clock = std::make_unique<VirtualClock>(period_ns);
  if (setup.by_the_clock) {
    realtime.emplace(report);
    enter_realtime(kPriority, {}, report);
    clock = std::make_unique<MonotonicClock>(TickScheduleOptions{.period_ns = period_ns});
  }
  Loop loop(setup, *clock);
  const Result<void> done = run(loop, setup, interrupt, progress);
  loop.stop();
  setup.device->disconnect();
  if (!done) return tl::unexpected(done.error());
  loop.session().greatest_stray = loop.greatest_stray();
  return std::move(loop.session());
}

}  // namespace hapticd::daemon
