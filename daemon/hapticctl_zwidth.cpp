#include "daemon/hapticctl_zwidth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "config/effective_guard.h"
#include "daemon/ctl_check.h"
#include "daemon/ctl_plot.h"
#include "daemon/ctl_verbs.h"
#include "daemon/device_factory.h"
#include "daemon/hapticctl_zwidth_report.h"
#include "daemon/hapticctl_zwidth_trial.h"
#include "daemon/interrupts.h"
#include "daemon/lock_file.h"
#include "daemon/output_check.h"
#include "daemon/output_file.h"
#include "daemon/realtime.h"
#include "daemon/wall_of.h"

namespace hapticd::daemon {
namespace {

constexpr double kDeflection_m = 5e-4;  // under the push, where force and encoder allow it
constexpr double kLeastPush = 0.01;     // of what the axis can
constexpr double kDeepest_m = 0.01;     // of the softest wall
constexpr double kGreatestPush = 0.3;   // of what the axis can
constexpr double kResolved = 16;        // counts of the encoder that a deflection has at least
constexpr double kRattles = 4;          // pushes by this against the damper at one count a tick
constexpr double kFloor = 0.05;         // of the deflection: motion that is none
constexpr double kFloorCounts = 4;      // likewise, at least
constexpr double kKnock = 0.5;          // of the push, for 5 ms
constexpr double kKnock_s = 5e-3;
constexpr double kSettle_s = 0.15;
constexpr int kPriority = 80;

/// Walls on one axis of one device, one after the other.
class Zwidth {
 public:
  Zwidth(config::Document document, const AxisLoop& one, const ZwidthOptions& options)
      : document_(std::move(document)), one_(one), options_(options) {
    const config::Device& device = document_.config.devices.front();
    by_the_clock_ = options.real_time || device.driver != config::Driver::sim;
    document_.config.stability.require = config::Require::none;
    document_.config.stability.proof.reset();
    for (config::Device& each : document_.config.devices) {
      const double allowed = config::effective_guard(document_.config.guard, each).max_force_N;
      each.guard.max_force_N = std::min(allowed, options.force_N.value_or(allowed));
    }
  }

  Result<void> prepare(const config::Compiled& compiled) {
    const control::Plan& plan = compiled.program->plan();
    const control::PlaneContact& wall = plan.planes.front();
    const control::CartesianAxis& axis = plan.cartesian_axes.front();
    direction_ = axis.scale * wall.normal[0] > 0 ? -1 : 1;
    surface_m_ = (wall.offset / wall.normal[0] - axis.origin) / axis.scale;
    greatest_N_ = std::min(plan.axes.front().max_effort,
                           options_.force_N.value_or(std::numeric_limits<double>::infinity()));
    counts_m_ = std::fabs(plan.axes.front().unit_per_raw);
    if (options_.push_N && !((1 + kKnock) * *options_.push_N <= greatest_N_)) {
      return fail(ExitCode::usage,
                  fmt::format("--push: with the knock it is {:.4g} N, and the axis can {:.4g} N",
                              (1 + kKnock) * *options_.push_N, greatest_N_));
    }
    if (!by_the_clock_) return {};
    realtime_.emplace(report_);
    enter_realtime(kPriority, {}, report_);
    return {};
  }

  /// Greatest stiffness for a damping, and what ended it.
  Result<ZwidthPoint> measure(double damping) {
    ZwidthPoint point{.damping = damping, .why = {}, .theory = {}};
    const auto measured = stiffest(
        softest(damping), [&](double stiffness) { return holds(stiffness, damping, point); });
    if (!measured) return tl::unexpected(measured.error());
    point.measured = unresolved_ ? std::numeric_limits<double>::infinity() : *measured;
    return point;
  }

 private:
  /// Of the walls that are tried: it settles within the watch, and gives way by little.
  double softest(double damping) const {
    return std::max({1.0, 4 * damping, least_push(damping) / (one_.scale * kDeepest_m)});
  }

  /// N, on the axis. Presses harder than the damper rattles at the encoder's steps.
  double least_push(double damping) const {
    const double rattle = one_.scale * damping * counts_m_ / one_.loop.period_s;
    return options_.push_N.value_or(std::max(kLeastPush * greatest_N_, kRattles * rattle));
  }
  double push(double stiffness, double damping) const {
    if (options_.push_N) return *options_.push_N;
    return std::max(std::min(one_.scale * stiffness * kDeflection_m, kGreatestPush * greatest_N_),
                    least_push(damping));
  }
  double deflection_m(double stiffness, double damping) const {
    return push(stiffness, damping) / (one_.scale * stiffness);
  }

  /// From the surface on a hand without mass presses along the wall's normal, and knocks once.
  void press(double force_N) {
    config::Device& device = document_.config.devices.front();
    if (!device.sim) return;
    device.sim->axes.front().position_m = surface_m_;
    device.sim->hand = {};
    device.sim->hand.script = {{.at_s = 0, .force_N = force_N},
                               {.at_s = kSettle_s, .force_N = (1 + kKnock) * force_N},
                               {.at_s = kSettle_s + kKnock_s, .force_N = force_N}};
  }

  Result<bool> holds(double stiffness, double damping, ZwidthPoint& point) {
    unresolved_ = !by_the_clock_ && (push(stiffness, damping) > kGreatestPush * greatest_N_ ||
                                     deflection_m(stiffness, damping) < kResolved * counts_m_);
    if (unresolved_) {
      point.why = "beyond what force and encoder of the device can tell";
      return false;
    }
    press(direction_ * push(stiffness, damping));
    auto compiled = with_wall(document_, stiffness, damping);
    if (!compiled) return tl::unexpected(compiled.error());
    if (auto ready = connect(*compiled); !ready) return tl::unexpected(ready.error());
    if (by_the_clock_)
      std::fprintf(stderr, "zwidth: press against a wall of %.4g N/m, %.4g N s/m\n", stiffness,
                   damping);
    const double floor_m =
        std::max(kFloorCounts * counts_m_, kFloor * deflection_m(stiffness, damping));
    const auto trial = run_trial(*compiled->program, rig_,
                                 {.settle_s = kSettle_s,
                                  .floor_m = by_the_clock_ ? options_.tremor_m : floor_m,
                                  .travel_m = options_.travel_m},
                                 interrupts());
    disconnect();
    if (!trial) return tl::unexpected(trial.error());
    if (!trial->touched) {
      return fail(
          ExitCode::no,
          fmt::format(
              "the wall of {:.4g} N/m was never felt{}: the device has to be beside the wall, and "
              "nothing may hold it back",
              stiffness, trial->why.empty() ? "" : ", " + trial->why));
    }
    if (!trial->stable) point.why = trial->why;
    return trial->stable;
  }

  Result<void> connect(const config::Compiled& compiled) {
    rig_.devices = make_devices(compiled);
    rig_.by_the_clock = by_the_clock_;
    const std::int64_t period_ns = std::llround(one_.loop.period_s * 1e9);
    if (by_the_clock_) {
      rig_.clock = std::make_unique<MonotonicClock>(TickScheduleOptions{.period_ns = period_ns});
    } else {
      rig_.clock = std::make_unique<VirtualClock>(period_ns);
    }
    auto info = connect_locked(*rig_.devices.front(), device_lock_directories(), locks_);
    if (!info) return tl::unexpected(info.error());
    return {};
  }
  void disconnect() {
    for (const auto& device : rig_.devices) device->disconnect();
    locks_.clear();
  }

  config::Document document_;
  const AxisLoop& one_;
  const ZwidthOptions& options_;
  bool by_the_clock_ = false, unresolved_ = false;
  double direction_ = 1, surface_m_ = 0, greatest_N_ = 0, counts_m_ = 0;
  ZwidthRig rig_;
  std::vector<LockFile> locks_;
  RealtimeReport report_;
  std::optional<ProcessRealtime> realtime_;
};

Result<void> check_consent(const config::Compiled& compiled, const ZwidthOptions& options) {
  const bool real = compiled.document.config.devices.front().driver != config::Driver::sim;
  if (!real || options.consent) return {};
  return fail(ExitCode::no,
              "zwidth shakes a real device until it is unstable: hold it, keep the e-stop at "
              "hand, and say so "
              "with --i-hold-the-device; --force and --travel bound it");
}

Result<std::vector<ZwidthPoint>> measure(const config::Compiled& compiled, const AxisLoop& one,
                                         const ZwidthOptions& options) {
  Zwidth zwidth(compiled.document, one, options);
  if (auto ready = zwidth.prepare(compiled); !ready) return tl::unexpected(ready.error());
  const double to = options.to_Ns_m.value_or(2 * one.mass / one.scale / one.loop.period_s);
  std::vector<ZwidthPoint> points;
  for (int i = 0; i < options.points; ++i) {
    const double damping = to * i / (options.points - 1);
    auto point = zwidth.measure(damping);
    if (!point) return tl::unexpected(point.error());
    const auto theory = stiffest_walls(compiled.document, damping);
    if (!theory) return tl::unexpected(theory.error());
    point->theory = *theory;
    std::fprintf(stderr, "zwidth: %3.0f %%, B = %.4g N s/m: K up to %.4g N/m: %s\n",
                 100.0 * (i + 1) / options.points, damping, point->measured, point->why.c_str());
    points.push_back(std::move(*point));
  }
  return points;
}

}  // namespace

ExitCode run_zwidth(const std::string& path, const ZwidthOptions& options, bool json) {
  if (auto writable = check_output(options.output, {path}); !writable)
    return print_error(writable.error(), json);
  if (auto drawable = check_picture(options.picture, {path, options.output}); !drawable)
    return print_error(drawable.error(), json);
  auto document = config::read_file(path);
  if (!document) return print_config_errors(document.error(), json);
  document->config.stability.proof.reset();  // it is about another wall
  auto compiled = config::compile(std::move(*document));
  if (!compiled) return print_config_errors(compiled.error(), json);
  const auto one = only_wall(*compiled);
  if (!one) return print_error(one.error(), json);
  if (auto consent = check_consent(*compiled, options); !consent)
    return print_error(consent.error(), json);
  const auto points = measure(*compiled, *one, options);
  if (!points) return print_error(points.error(), json);
  if (auto written = replace_file(options.output, zwidth_csv(*points, path)); !written)
    return print_error(written.error(), json);
  std::fputs(json ? (to_text(zwidth_json(*points, options.output)) + "\n").c_str()
                  : zwidth_text(*points).c_str(),
             stdout);
  if (options.picture.empty()) return ExitCode::ok;
  return run_plot(options.output, {.output = options.picture}, false);
}

}  // namespace hapticd::daemon
