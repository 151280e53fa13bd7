#include "daemon/hapticctl_sweep.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

#include "control/design/synthesis/exact_index.h"
#include "control/design/synthesis/robust_wall.h"
#include "daemon/ctl_check.h"
#include "daemon/ctl_plot.h"
#include "daemon/ctl_verbs.h"
#include "daemon/hapticctl_robust.h"
#include "daemon/interrupts.h"
#include "daemon/output_check.h"
#include "daemon/output_file.h"

namespace hapticd::daemon {
namespace {

struct SweepRange {
  double from, to;
};

/// Where nothing is said.
SweepRange usual(const AxisLoop& one, SweepOver over) {
  const double period_s = one.loop.period_s, mass = one.mass / one.scale;
  switch (over) {
    case SweepOver::damping:
      return {0.05 * mass / period_s, 3 * mass / period_s};
    case SweepOver::stiffness:
      return {1, 4 * mass / (period_s * period_s)};
    case SweepOver::frequency:
      break;
  }
  return {0.1, 0.5 / period_s};
}

/// Header and rows of CSV.
class Table {
 public:
  explicit Table(std::string header) : text_(std::move(header) + "\n") {}
  void row(const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0) text_ += ",";
      if (std::isfinite(values[i])) text_ += fmt::format("{:.9g}", values[i]);  // else a gap
    }
    text_ += "\n";
    ++rows_;
  }
  const std::string& text() const { return text_; }
  std::size_t rows() const { return rows_; }

 private:
  std::string text_;
  std::size_t rows_ = 0;
};

double decibels(double size) {
  return size > 0 ? 20 * std::log10(size) : -INFINITY;
}

/// J is the square of a norm.
double energy_dB(double index) {
  return 0.5 * decibels(index);
}

/// The loop of one K and B_c beside the paper's answer for them. `goal.wall_damping_Ns_m` stays what the wall means.
class WallCurves {
 public:
  WallCurves(const AxisLoop& one, const synthesis::WallGoal& goal, SweepOver over)
      : one_(one), goal_(goal), over_(over) {
    check::LoopBox closed = one.box;
    closed.contact = {1, 1};
    cases_ = check::cases_of(closed, 3);
    given_ = {
        .mass_kg = one.mass, .damping_Ns_m = one.damping, .latency_s = one.box.latency_s.high};
  }

  static std::string header(SweepOver over) {
    return std::string(over == SweepOver::damping ? "damping[N s/m]" : "stiffness[N/m]") +
           ",J paper[dB],J sampled[dB],J worst case[dB],|L| "
           "paper[dB],largest "
           "eigenvalue[1],of all cases[1]";
  }

  std::vector<double> at(double value) const {
    synthesis::WallGoal goal = goal_;
    const double damper = over_ == SweepOver::damping ? one_.scale * value : one_.damper;
    if (over_ == SweepOver::stiffness) goal.stiffness_N_m = one_.scale * value;
    const synthesis::PaperAnswer paper = synthesis::paper_answer(goal, damper);
    check::SampledLoop loop = one_.loop;
    loop.force = check::direct_wall(goal.stiffness_N_m, damper, one_.velocity);
    const synthesis::WallMeant meant{.stiffness_N_m = goal.stiffness_N_m,
                                     .damping_Ns_m = goal.wall_damping_Ns_m,
                                     .weight = goal.weight};
    return {value,
            energy_dB(paper.index),
            energy_dB(synthesis::exact_index(loop, given_, meant)),
            energy_dB(synthesis::largest_index(loop, cases_, meant).value),
            decibels(paper.norm),
            check::loop_radius(loop, given_),
            check::worst_of(loop, cases_).radius};
  }

 private:
  const AxisLoop& one_;
  const synthesis::WallGoal& goal_;
  SweepOver over_;
  std::vector<check::LoopCase> cases_;
  check::LoopCase given_;
};

std::vector<double> admittances(const synthesis::WallGoal& goal, double damper,
                                double frequency_Hz) {
  const check::Complex s(0, 2 * std::numbers::pi * frequency_Hz);
  const check::Complex meant = s / (goal.stiffness_N_m + goal.wall_damping_Ns_m * s);
  const check::Complex felt = synthesis::transmitted_admittance(goal, damper, s);
  const auto degrees = [](check::Complex y) { return std::arg(y) * 180 / std::numbers::pi; };
  return {frequency_Hz, decibels(std::abs(meant)), decibels(std::abs(felt)), degrees(meant),
          degrees(felt)};
}

Result<Table> sweep(const AxisLoop& one, const synthesis::WallGoal& goal,
                    const SweepOptions& options) {
  const SweepRange usually = usual(one, options.over);
  const double from = options.from.value_or(usually.from), to = options.to.value_or(usually.to);
  if (!(from < to))
    return fail(ExitCode::usage,
                fmt::format("expected --from below --to, found {:.4g} and {:.4g}", from, to));
  const bool frequency = options.over == SweepOver::frequency;
  Table table(frequency ? "frequency[Hz],meant[dB re 1 m/(N s)],transmitted[dB re 1 m/(N "
                          "s)],meant[deg],transmitted[deg]"
                        : WallCurves::header(options.over));
  const WallCurves curves(one, goal, options.over);
  for (int i = 0; i < options.points; ++i) {
    if (interrupts().load()) return fail(ExitCode::try_again, "interrupted; nothing was written");
    const double value = from * std::pow(to / from, static_cast<double>(i) / (options.points - 1));
    table.row(frequency ? admittances(goal, one.damper, value) : curves.at(value));
    if ((i + 1) % 50 == 0)
      std::fprintf(stderr, "sweep: %3.0f %%\n", 100.0 * (i + 1) / options.points);
  }
  return table;
}

}  // namespace

ExitCode run_sweep(const std::string& path, const SweepOptions& options, bool json) {
  if (auto writable = check_output(options.output, {path}); !writable)
    return print_error(writable.error(), json);
  if (auto drawable = check_picture(options.picture, {path, options.output}); !drawable)
    return print_error(drawable.error(), json);
  const auto compiled = config::load(path);
  if (!compiled) return print_config_errors(compiled.error(), json);
  const auto one = only_wall(*compiled);
  if (!one) return print_error(one.error(), json);
  const synthesis::WallGoal goal = paper_goal(*one, compiled->document.config.stability.paper);
  if (const std::string wrong = synthesis::malformed(goal); !wrong.empty())
    return print_error({path + ": " + wrong, ExitCode::bad_data}, json);
  const auto table = sweep(*one, goal, options);
  if (!table) return print_error(table.error(), json);
  if (auto written = replace_file(options.output, table->text()); !written)
    return print_error(written.error(), json);
  if (json) {
    std::puts(
        to_text({{"ok", true}, {"output", options.output}, {"points", table->rows()}}).c_str());
  } else {
    std::printf("%s written: %zu points\n", options.output.c_str(), table->rows());
  }
  if (options.picture.empty()) return ExitCode::ok;
  return run_plot(options.output, {.output = options.picture, .log_x = true}, false);
}

}  // namespace hapticd::daemon
