#include "daemon/hapticctl_zwidth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "control/design/check/models.h"
#include "daemon/ctl_check.h"
#include "daemon/ctl_plot.h"
#include "daemon/ctl_verbs.h"
#include "daemon/device_factory.h"
#include "daemon/hapticctl_zwidth_lines.h"
#include "daemon/hapticctl_zwidth_trial.h"
#include "daemon/interrupts.h"
#include "daemon/lock_file.h"
#include "daemon/output_file.h"
#include "daemon/realtime.h"
#include "daemon/wall_of.h"

namespace hapticd::daemon {
namespace {

constexpr double kDeepest_m = 0.01;  // of the softest wall under the push
constexpr double kFloorCounts = 32;  // of the encoder: motion that is none
constexpr double kKnock = 0.5;       // of the push, for 5 ms
constexpr double kKnock_s = 5e-3;
constexpr double kSettle_s = 0.15;
constexpr double kPause_s = 1;  // between two walls on a real device
constexpr int kPriority = 80;

struct Point {
  double damping = 0;
  double measured = 0;  ///< N/m; 0: none
  StiffestWalls theory;
};

/// Walls on one axis of one device, one after the other.
class Zwidth {
 public:
  Zwidth(config::Document document, const AxisLoop& one, const ZwidthOptions& options)
      : document_(std::move(document)), one_(one), options_(options) {
    const config::Device& device = document_.config.devices.front();
    by_the_clock_ = options.real_time || device.driver != config::Driver::sim;
    document_.config.stability.require = config::Require::none;
    document_.config.stability.proof.reset();
    for (config::Device& each : document_.config.devices)
      if (options.force_N) each.guard.max_force_N = *options.force_N;
  }

  Result<void> prepare(const config::Compiled& compiled) {
    const control::AxisPlan& axis = compiled.program->plan().axes.front();
    push_N_ = options_.push_N.value_or(0.01 * axis.max_effort);
    counts_m_ = std::fabs(axis.unit_per_raw);
    if (!(push_N_ > 0)) return fail(ExitCode::usage, "--push: expected more than 0 N");
    press(compiled);
    if (!by_the_clock_) return {};
    realtime_.emplace(report_);
    enter_realtime(kPriority, {}, report_);
    return {};
  }

  /// The softest wall that is tried.
  double softest() const { return std::max(1.0, push_N_ / kDeepest_m); }

  Result<double> measure(double damping) {
    return stiffest(softest(), [&](double stiffness) { return holds(stiffness, damping); });
  }

 private:
  /// The simulated hand presses along the wall's normal, and knocks once.
  void press(const config::Compiled& compiled) {
    config::Device& device = document_.config.devices.front();
    if (!device.sim) return;
    const control::PlaneContact& plane = compiled.program->plan().planes.front();
    const double along =
        check::constant_jacobian(compiled.program->plan(), {0})(0, 0) * plane.normal[0];
    const double push = along > 0 ? -push_N_ : push_N_;
    device.sim->hand.script = {{.at_s = 0, .force_N = push},
                               {.at_s = kSettle_s, .force_N = (1 + kKnock) * push},
                               {.at_s = kSettle_s + kKnock_s, .force_N = push}};
  }

  Result<bool> holds(double stiffness, double damping) {
    auto compiled = with_wall(document_, stiffness, damping);
    if (!compiled) return tl::unexpected(compiled.error());
    if (auto ready = connect(*compiled); !ready) return tl::unexpected(ready.error());
    if (by_the_clock_)
      std::fprintf(stderr, "zwidth: press against a wall of %.4g N/m, %.4g N s/m\n", stiffness,
                   damping);
    const auto trial =
        run_trial(*compiled->program, rig_,
                  {.axis = 0,
                   .settle_s = kSettle_s,
                   .floor_m = by_the_clock_ ? options_.tremor_m : kFloorCounts * counts_m_,
                   .travel_m = options_.travel_m},
                  interrupts());
    disconnect();
    if (!trial) return tl::unexpected(trial.error());
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
    auto info = rig_.devices.front()->connect();
    if (!info) return tl::unexpected(info.error());
    if (info->lock_name.empty()) return {};
    auto locks = lock_device(info->lock_name, device_lock_directories());
    if (!locks) {
      disconnect();
      return tl::unexpected(locks.error());
    }
    locks_ = std::move(*locks);
    return {};
  }
  void disconnect() {
    for (const auto& device : rig_.devices) device->disconnect();
    locks_.clear();
  }

  config::Document document_;
  const AxisLoop& one_;
  const ZwidthOptions& options_;
  bool by_the_clock_ = false;
  double push_N_ = 0, counts_m_ = 0;
  ZwidthRig rig_;
  std::vector<LockFile> locks_;
  RealtimeReport report_;
  std::optional<ProcessRealtime> realtime_;
};

Result<AxisLoop> only_wall(const config::Compiled& compiled, const ZwidthOptions& options) {
  const std::vector<AxisLoop> loops = axis_loops(compiled);
  if (loops.size() != 1)
    return fail(ExitCode::bad_data, fmt::format("expected one device, found {}", loops.size()));
  if (!loops[0].why.empty()) return fail(ExitCode::bad_data, loops[0].why);
  if (!loops[0].wall)
    return fail(ExitCode::bad_data,
                "expected one plane that is rendered directly; this scene has another");
  const bool real = compiled.document.config.devices.front().driver != config::Driver::sim;
  if (real && !options.consent) {
    return fail(ExitCode::no,
                "zwidth shakes a real device until it is unstable: hold it, keep the e-stop at "
                "hand, and say so "
                "with --i-hold-the-device; --force and --travel bound it");
  }
  return loops[0];
}

std::string csv_of(const std::vector<Point>& points, const std::string& config) {
  std::string text =
      "# Z-width: greatest stiffness of the wall for each damping of it; " + config +
      "\ndamping[N "
      "s/m],measured[N/m],exact[N/m],robust[N/m],paper[N/m],passive[N/m],colgate[N/m]\n";
  for (const Point& p : points) {
    text += fmt::format("{:.6g}", p.damping);
    for (const double stiffness : {p.measured, p.theory.exact, p.theory.robust, p.theory.paper,
                                   p.theory.passive, p.theory.colgate})
      text += fmt::format(",{:.6g}", stiffness);
    text += "\n";
  }
  return text;
}

Json json_of(const std::vector<Point>& points, const std::string& output) {
  Json rows = Json::array();
  for (const Point& p : points) {
    rows.push_back({{"damping_Ns_m", p.damping},
                    {"measured_N_m", p.measured},
                    {"exact_N_m", p.theory.exact},
                    {"robust_N_m", p.theory.robust},
                    {"paper_N_m", p.theory.paper},
                    {"passive_N_m", p.theory.passive},
                    {"colgate_N_m", p.theory.colgate}});
  }
  return {{"ok", true}, {"output", output}, {"points", std::move(rows)}};
}

std::string text_of(const std::vector<Point>& points) {
  std::string text = fmt::format("{:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "B/(N s/m)",
                                 "measured", "exact", "robust", "paper", "passive", "Colgate");
  for (const Point& p : points)
    text += fmt::format("{:10.4g} {:10.4g} {:10.4g} {:10.4g} {:10.4g} {:10.4g} {:10.4g}\n",
                        p.damping, p.measured, p.theory.exact, p.theory.robust, p.theory.paper,
                        p.theory.passive, p.theory.colgate);
  return text + "greatest stiffness in N/m; 0: none\n";
}

Result<std::vector<Point>> measure(const config::Compiled& compiled, const AxisLoop& one,
                                   const ZwidthOptions& options) {
  Zwidth zwidth(compiled.document, one, options);
  if (auto ready = zwidth.prepare(compiled); !ready) return tl::unexpected(ready.error());
  const double to = options.to_Ns_m.value_or(2 * one.mass / one.loop.period_s);
  std::vector<Point> points;
  for (int i = 0; i < options.points; ++i) {
    const double damping = to * i / (options.points - 1);
    const auto measured = zwidth.measure(damping);
    if (!measured) return tl::unexpected(measured.error());
    const auto theory = stiffest_walls(compiled.document, damping);
    if (!theory) return tl::unexpected(theory.error());
    points.push_back({damping, *measured, *theory});
    std::fprintf(stderr, "zwidth: %3.0f %%, B = %.4g N s/m: K up to %.4g N/m\n",
                 100.0 * (i + 1) / options.points, damping, *measured);
  }
  return points;
}

}  // namespace

ExitCode run_zwidth(const std::string& path, const ZwidthOptions& options, bool json) {
  auto compiled = config::load(path);
  if (!compiled) return print_config_errors(compiled.error(), json);
  const auto one = only_wall(*compiled, options);
  if (!one) return print_error(one.error(), json);
  const auto points = measure(*compiled, *one, options);
  if (!points) return print_error(points.error(), json);
  if (auto written = replace_file(options.output, csv_of(*points, path)); !written)
    return print_error(written.error(), json);
  std::fputs(
      json ? (to_text(json_of(*points, options.output)) + "\n").c_str() : text_of(*points).c_str(),
      stdout);
  if (options.picture.empty()) return ExitCode::ok;
  PlotOptions plot{.output = options.picture};
  return run_plot(options.output, plot, false);
}

}  // namespace hapticd::daemon
