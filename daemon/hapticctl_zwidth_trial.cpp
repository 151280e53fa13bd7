#include "daemon/hapticctl_zwidth_trial.h"

#include <algorithm>
#include <cmath>

#include "daemon/cycle.h"
#include "daemon/monotonic.h"

namespace hapticd::daemon {
namespace {

constexpr double kWindow_s = 0.25;
constexpr double kLongestStart_s = 30;  // power stage, homing, ramp
constexpr double kDecayed = 0.98;
constexpr int kStopCycles = 5;

/// Motion over a window: peak to peak, how often it turned round, whether the wall let go.
struct Motion {
  double low = INFINITY, high = -INFINITY;
  int turns = 0;
  bool opened = false;

  void add(double x, bool felt) noexcept {
    if (low <= high) turned(x - last_);
    last_ = x;
    low = std::min(low, x);
    high = std::max(high, x);
    opened = opened || !felt;
  }
  double size() const noexcept { return std::max(0.0, high - low); }

 private:
  void turned(double step) noexcept {
    if (step == 0) return;
    if (direction_ * step < 0) ++turns;
    direction_ = step;
  }
  double last_ = 0, direction_ = 0;
};

class Run {
 public:
  Run(build::Program& program, ZwidthRig& rig, const TrialOptions& options)
      : program_(program),
        clock_(*rig.clock),
        now_(rig.by_the_clock ? monotonic : standing_still),
        options_(options),
        period_s_(program.plan().period_s),
        cycle_(pointers(rig), program.plan()) {}
  /// A bus may lose one.
  ~Run() {
    for (int i = 0; i < kStopCycles; ++i) {
      static_cast<void>(clock_.next());
      cycle_.stop();
    }
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Until all force is let through.
  Result<void> start(const std::atomic<bool>& interrupt) {
    for (double t = 0; t < kLongestStart_s; t += period_s_) {
      if (interrupt.load()) return fail(ExitCode::try_again, "interrupted; nothing was written");
      tick();
      if (faulted()) return {};
      if (std::ranges::all_of(program_.state().ramp, [](double share) { return share >= 1; }))
        return {};
    }
    return fail(ExitCode::unavailable, "forces did not come on");
  }

  Trial watch(const std::atomic<bool>& interrupt) {
    Trial trial;
    for (double t = 0; t < options_.settle_s && !faulted(); t += period_s_) tick();
    const double began = position();
    Motion middle, last;
    for (double t = 0; t < options_.watch_s && !faulted() && !interrupt.load(); t += period_s_) {
      tick();
      if (t >= options_.watch_s / 2 - kWindow_s && t < options_.watch_s / 2)
        middle.add(position(), felt());
      if (t >= options_.watch_s - kWindow_s) last.add(position(), felt());
      if (std::fabs(position() - began) > options_.travel_m) {
        trial.why = "it moved further than --travel";
        trial.touched = touched_;
        return trial;
      }
    }
    trial.middle_m = middle.size();
    trial.last_m = last.size();
    trial.why = faulted() ? "it ended in a fault" : why_not(middle, last);
    trial.stable = trial.why.empty();
    trial.touched = touched_;
    return trial;
  }

 private:
  static std::vector<drivers::Device*> pointers(ZwidthRig& rig) {
    std::vector<drivers::Device*> devices;
    for (const auto& device : rig.devices) devices.push_back(device.get());
    return devices;
  }
  static std::int64_t monotonic() noexcept { return monotonic_ns(); }
  static std::int64_t standing_still() noexcept { return 0; }

  void tick() {
    const TickClock::Tick next = clock_.next();
    const CycleInput input{
        .time = next.time, .missed_ticks = next.missed, .enable = true, .unproven = true};
    cycle_.run(program_, input, now_, nullptr);
    touched_ = touched_ || felt();
  }
  std::string why_not(const Motion& middle, const Motion& last) const {
    if (last.opened) return "the contact does not stay closed";
    const bool swings = last.turns > 2 && last.size() > options_.floor_m;
    return swings && last.size() > kDecayed * middle.size() ? "its motion does not decay" : "";
  }

  bool felt() const noexcept { return program_.state().force[options_.coordinate] != 0; }
  bool faulted() const noexcept { return cycle_.output().mode == control::Mode::fault; }
  double position() const noexcept { return program_.state().q[options_.axis]; }

  build::Program& program_;
  TickClock& clock_;
  Now now_;
  TrialOptions options_;
  double period_s_;
  bool touched_ = false;  // ever, the ramp included
  Cycle cycle_;
};

}  // namespace

Result<Trial> run_trial(build::Program& program, ZwidthRig& rig, const TrialOptions& options,
                        const std::atomic<bool>& interrupt) {
  Run run(program, rig, options);
  if (auto started = run.start(interrupt); !started) return tl::unexpected(started.error());
  const Trial trial = run.watch(interrupt);
  if (interrupt.load()) return fail(ExitCode::try_again, "interrupted; nothing was written");
  return trial;
}

}  // namespace hapticd::daemon
