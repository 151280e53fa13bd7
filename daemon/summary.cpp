#include "daemon/summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <fstream>
#include <sstream>
#include <string_view>

namespace hapticd::daemon {
namespace {

PhaseTimesSummary percentiles(const Histogram& histogram) {
  const auto us = [](std::uint64_t ns) { return static_cast<double>(ns) * 1e-3; };
  return {us(histogram.percentile_ns(0.5)), us(histogram.percentile_ns(0.99)),
          us(histogram.percentile_ns(0.999)), us(histogram.max_ns())};
}

std::string whole_file(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The number behind "name:" in a /proc status file.
std::optional<std::uint64_t> status_value(const std::string& status, const std::string& name) {
  std::istringstream lines(status);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(name + ":", 0) != 0) continue;
    std::istringstream value(line.substr(name.size() + 1));
    std::uint64_t number = 0;
    if (value >> number) return number;
  }
  return std::nullopt;
}

/// Lines of "name   value", one below the other.
class Table {
 public:
  void row(std::string_view name, const std::string& value) {
    text_ += fmt::format("  {:<20}{}\n", name, value);
  }
  void head(const std::string& line) { text_ += line + "\n"; }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string missed_words(const Summary& s) {
  if (s.missed_ticks == 0) return "0";
  std::string text = fmt::format("{} in {} gaps (", s.missed_ticks, s.gaps);
  for (std::size_t i = 0; i < kPhases; ++i) {
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", kPhaseNames[i], s.missed_by[i]);
  }
  return text + ")";
}

std::string rights_words(const RealtimeReport& got) {
  return fmt::format("{}; memory {}; CPU latency {}; {}", got.scheduling,
                     got.memory_locked ? "locked" : "not locked",
                     got.dma_latency_held ? "held" : "not held",
                     got.cpu ? fmt::format("on CPU {}", *got.cpu) : std::string("on any CPU"));
}

void add_times(const Summary& s, Table& table) {
  table.head(
      fmt::format("  {:<20}{:>10}{:>10}{:>10}{:>10}", "times [us]", "p50", "p99", "p99.9", "max"));
  for (std::size_t i = 0; i < kPhases; ++i) {
    const std::string what = i == 0 ? "wake-up late by" : kPhaseNames[i];
    table.head(fmt::format("    {:<18}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}", what,
                           s.times[i].p50_us, s.times[i].p99_us, s.times[i].p999_us,
                           s.times[i].max_us));
  }
}

void add_faults(const Summary& s, Table& table) {
  if (s.faults.empty()) table.row("faults", "none");
  for (const FaultCount& fault : s.faults) {
    table.row("fault", fmt::format("{} x {}, last at {:.3f} s: {}", fault.count,
                                   entry(fault.code).name, fault.last_at_s, fault.last));
  }
}

void add_limits(const Summary& s, Table& table) {
  if (s.limits.empty()) table.row("limits", "none");
  for (const LimitCount& limit : s.limits)
    table.row("limit", fmt::format("{} in {} ticks", limit.name, limit.ticks));
}

std::string traffic_words(const TrafficSummary& bus) {
  if (!bus.comes_and_goes)
    return fmt::format(
        "{} samples late, {} frames not sent, {} lost on the way here, {} commands of others",
        bus.late, bus.not_sent, bus.lost, bus.foreign);
  return fmt::format(
      "plugged in and set up {} times, round trip {:.2f} ms then, commands took at most {:.2f} ms "
      "on "
      "their way out; {} samples malformed, {} skipped, {} lost, {} commands replaced by newer "
      "ones",
      bus.connections, 1e3 * bus.round_trip_s, 1e3 * bus.worst_send_s, bus.malformed, bus.late,
      bus.lost, bus.not_sent);
}

void add_devices(const Summary& s, Table& table) {
  for (const DeviceSummary& device : s.devices) {
    table.row(
        "device " + device.name,
        fmt::format("its motors did {:.6g} J of work; fade {:.3g}; {}", device.work_J, device.fade,
                    device.not_homed.empty()
                        ? std::string("every axis homed")
                        : fmt::format("not homed: {}", fmt::join(device.not_homed, ", "))));
    if (const auto& bus = device.traffic) table.row("bus of " + device.name, traffic_words(*bus));
  }
}

void add_machine(const Summary& s, Table& table) {
  if (s.thread) {
    table.row(
        "servo thread",
        fmt::format("{} minor and {} major page faults, {} voluntary and {} involuntary switches, "
                    "since its first tick",
                    s.thread->minor_faults, s.thread->major_faults, s.thread->voluntary_switches,
                    s.thread->involuntary_switches));
  } else {
    table.row("servo thread",
              "page faults and context switches not available: /proc does not tell");
  }
  table.row("real time", rights_words(s.realtime));
  table.row("kernel", s.kernel);
  table.row("load average",
            s.load_average ? fmt::format("{:.2f}", *s.load_average) : "not available");
}

}  // namespace

void take_counters(const ServoCounters& counters, Summary& summary) {
  summary.ticks = counters.ticks.load();
  summary.late_wakes = counters.late_wakes.load();
  summary.overruns = counters.overruns.load();
  summary.gaps = counters.gaps.load();
  summary.missed_ticks = counters.missed_ticks.load();
  summary.samples_held = counters.samples_held.load();
  summary.largest_force_N = counters.largest_force_N.load();
  for (std::size_t i = 0; i < kPhases; ++i) {
    summary.missed_by[i] = counters.missed_by[i].load();
    summary.times[i] = percentiles(counters.times[i]);
  }
}

void take_records(const build::ProgramSpec& spec, const LiveView& live, Summary& summary) {
  for (const LimitEntry& row : limit_table()) {
    const auto bit = std::countr_zero(static_cast<std::uint32_t>(row.bit));
    const std::uint64_t ticks = live.limit_ticks[static_cast<std::size_t>(bit)];
    if (ticks > 0) summary.limits.push_back({row.name, ticks});
  }
  if (!live.known) return;
  for (std::size_t d = 0; d < spec.devices.size(); ++d) {
    DeviceSummary device{
        .name = spec.device_names[d], .work_J = live.work_J[d], .fade = live.fade[d]};
    for (std::size_t i = 0; i < spec.devices[d].axes; ++i) {
      const std::size_t axis = spec.devices[d].first_axis + i;
      (live.homed[axis] ? device.homed : device.not_homed).push_back(spec.axis_names[axis]);
    }
    summary.devices.push_back(std::move(device));
  }
}

std::optional<ThreadUse> read_thread_use(int thread_id) {
  const std::string folder = fmt::format("/proc/self/task/{}/", thread_id);
  return parse_thread_use(whole_file(folder + "stat"), whole_file(folder + "status"));
}

std::optional<ThreadUse> parse_thread_use(const std::string& stat, const std::string& status) {
  // The thread's name stands in parentheses and may hold anything; counting starts behind the last
  // one (proc(5)).
  const auto name_end = stat.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(stat.substr(name_end + 1));
  std::string skipped;
  constexpr int kFieldsBeforeMinorFaults = 7;  // state ppid pgrp session tty_nr tpgid flags
  for (int i = 0; i < kFieldsBeforeMinorFaults; ++i) fields >> skipped;
  ThreadUse use;
  if (!(fields >> use.minor_faults >> skipped >> use.major_faults)) return std::nullopt;
  const auto voluntary = status_value(status, "voluntary_ctxt_switches");
  const auto involuntary = status_value(status, "nonvoluntary_ctxt_switches");
  if (!voluntary || !involuntary) return std::nullopt;
  use.voluntary_switches = *voluntary;
  use.involuntary_switches = *involuntary;
  return use;
}

ThreadUse operator-(const ThreadUse& now, const ThreadUse& then) noexcept {
  return {now.minor_faults - then.minor_faults, now.major_faults - then.major_faults,
          now.voluntary_switches - then.voluntary_switches,
          now.involuntary_switches - then.involuntary_switches};
}

std::string to_table(const Summary& s) {
  Table table;
  table.head("summary");
  table.row("ran", fmt::format("{:.3f} s at {:g} Hz, {} ticks", s.duration_s, s.rate_Hz, s.ticks));
  table.row("missed ticks", missed_words(s));
  table.row("overruns", fmt::format("{} ticks ended after their period", s.overruns));
  table.row("late wake-ups", fmt::format("{} by more than a tenth of the period", s.late_wakes));
  if (s.ticks == 0) {
    table.row("times", "not available: no tick was run");
  } else {
    add_times(s, table);
  }
  table.row("largest force",
            fmt::format("{:.3f} N{}", s.largest_force_N,
                        s.unproven ? ", enabled without a proof of stability" : ""));
  table.row("samples held", fmt::format("{}", s.samples_held));
  add_limits(s, table);
  add_faults(s, table);
  add_devices(s, table);
  table.row("records", fmt::format("{} dropped, {} lost on the way to files", s.records_dropped,
                                   s.records_lost));
  add_machine(s, table);
  return table.take();
}

}  // namespace hapticd::daemon
