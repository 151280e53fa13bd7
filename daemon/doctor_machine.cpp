#include "daemon/doctor_machine.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <sstream>

namespace hapticd::daemon {
namespace {

using Text = std::string;

std::uint64_t hard_limit(int which) {
  rlimit limit{};
  if (getrlimit(static_cast<__rlimit_resource>(which), &limit) != 0) return 0;
  return limit.rlim_max == RLIM_INFINITY ? UINT64_MAX : limit.rlim_max;
}

Finding kernel(const KernelFiles& machine) {
  const Text release = machine.line("proc/sys/kernel/osrelease").value_or("unknown");
  if (machine.number("sys/kernel/realtime") == 1)
    return {"kernel", Severity::good, release + ", PREEMPT_RT"};
  return {"kernel", Severity::warning,
          release + " is not PREEMPT_RT: wake-ups may be late by a millisecond and more",
          "install a real-time kernel (Debian: apt install linux-image-rt-amd64) and boot it"};
}

Finding priority_right(const Rights& rights, int priority) {
  if (rights.root || rights.rtprio >= static_cast<std::uint64_t>(priority))
    return {"real-time priority", Severity::good,
            fmt::format("SCHED_FIFO {} is allowed here", priority)};
  return {
      "real-time priority", Severity::bad,
      fmt::format("this login may use real-time priorities up to {}, the loop wants {}",
                  rights.rtprio, priority),
      "a line `@hapticd - rtprio 95` in /etc/security/limits.d/hapticd.conf and a new login; the "
      "service has LimitRTPRIO in its unit"};
}

Finding memory_right(const Rights& rights) {
  constexpr std::uint64_t kEnough = std::uint64_t{1} << 28;
  if (rights.root || rights.memlock >= kEnough)
    return {"locked memory", Severity::good, "memory can be locked"};
  return {"locked memory", Severity::warning,
          fmt::format("this login may lock {} kB: the loop may wait for pages from disk",
                      rights.memlock / 1024),
          "a line `@hapticd - memlock unlimited` in /etc/security/limits.d/hapticd.conf and a new "
          "login; the service has LimitMEMLOCK in its unit"};
}

Finding time_limit(const Rights& rights) {
  if (rights.root || rights.rttime_us == UINT64_MAX)
    return {"real-time limit", Severity::good, "no RLIMIT_RTTIME"};
  return {"real-time limit", Severity::note,
          fmt::format("a real-time thread that does not sleep for {} us is ended by a signal; "
                      "hapticd then takes the force away first",
                      rights.rttime_us)};
}

/// Version 1 control groups may give a group no real-time at all.
Finding group_scheduling(const KernelFiles& machine) {
  for (const Text& directory : {Text("sys/fs/cgroup/cpu"), Text("sys/fs/cgroup/cpu,cpuacct")}) {
    for (const Text& slice : {Text("/system.slice"), Text("/user.slice")}) {
      const auto runtime = machine.number(directory + slice + "/cpu.rt_runtime_us");
      if (runtime != 0) continue;
      return {
          "RT group scheduling", Severity::bad,
          "control group " + slice.substr(1) + " has no real-time budget: SCHED_FIFO fails there",
          "sysctl kernel.sched_rt_runtime_us=-1, or a kernel without CONFIG_RT_GROUP_SCHED"};
    }
  }
  return {"RT group scheduling", Severity::good, "no control group takes real-time away"};
}

Finding throttling(const KernelFiles& machine) {
  const auto runtime = machine.number("proc/sys/kernel/sched_rt_runtime_us");
  const auto period = machine.number("proc/sys/kernel/sched_rt_period_us");
  if (!runtime || !period) return {"throttling", Severity::note, "cannot be read here"};
  if (*runtime < 0 || *runtime >= *period)
    return {"throttling", Severity::good, "real-time threads are never held back"};
  return {
      "throttling", Severity::note,
      fmt::format("real-time threads get at most {:.0f} % of each {:.1f} s; the loop uses far less",
                  100 * *runtime / *period, 1e-6 * *period)};
}

Finding governor(const KernelFiles& machine) {
  std::set<Text> others;
  bool any = false;
  for (const Text& cpu : machine.names("sys/devices/system/cpu", "cpu")) {
    const auto found = machine.line("sys/devices/system/cpu/" + cpu + "/cpufreq/scaling_governor");
    any = any || found.has_value();
    if (found && *found != "performance") others.insert(*found);
  }
  if (!any) return {"clock governor", Severity::good, "the clock frequency is not scaled here"};
  if (others.empty()) return {"clock governor", Severity::good, "performance on every CPU"};
  return {"clock governor", Severity::warning,
          fmt::format("{}: a CPU that was slow a moment ago runs the tick slowly",
                      fmt::join(others, ", ")),
          "cpupower frequency-set -g performance (Debian: apt install linux-cpupower)"};
}

Finding sleep_states(const KernelFiles& machine, const Rights& rights) {
  double longest = 0;
  Text name;
  const Text directory = "sys/devices/system/cpu/cpu0/cpuidle/";
  for (const Text& state : machine.names(directory, "state")) {
    const double latency = machine.number(directory + state + "/latency").value_or(0);
    if (machine.number(directory + state + "/disable") == 1 || latency <= longest) continue;
    longest = latency;
    name = machine.line(directory + state + "/name").value_or(state);
  }
  constexpr double kHarmless_us = 10;
  if (longest <= kHarmless_us) return {"sleep states", Severity::good, "no deep ones"};
  if (rights.root || rights.dma_latency)
    return {"sleep states", Severity::good,
            fmt::format("{} takes {:g} us to leave; hapticd keeps CPUs out of it while it runs",
                        name, longest)};
  return {"sleep states", Severity::warning,
          fmt::format("{} takes {:g} us to leave, and /dev/cpu_dma_latency may not be held here",
                      name, longest),
          "install hapticd's udev rule and join group hapticd, or boot with "
          "processor.max_cstate=1 intel_idle.max_cstate=0"};
}

/// Field 40 of /proc/PID/stat, counted behind the name, which may have blanks: 0 is not real-time.
std::optional<int> realtime_priority(const KernelFiles& machine, const Text& pid) {
  const auto stat = machine.line("proc/" + pid + "/stat");
  if (!stat) return {};
  const std::size_t close = stat->rfind(')');
  if (close == Text::npos) return {};
  std::istringstream fields(stat->substr(close + 1));
  constexpr int kBehindName = 38;
  Text field;
  for (int i = 0; i < kBehindName; ++i)
    if (!(fields >> field)) return {};
  return std::atoi(field.c_str());
}

bool serves_a_bus(const Text& thread) {
  constexpr std::array kDrivers{"xhci", "ehci", "ohci", "uhci", "can", "dwc"};
  return std::ranges::any_of(kDrivers,
                             [&](const char* driver) { return thread.find(driver) != Text::npos; });
}

Finding interrupt_threads(const KernelFiles& machine, int priority) {
  std::vector<Text> below;
  bool any = false;
  for (const Text& pid : machine.names("proc")) {
    if (pid.find_first_not_of("0123456789") != Text::npos) continue;
    const auto name = machine.line("proc/" + pid + "/comm");
    if (!name || !name->starts_with("irq/")) continue;
    any = true;
    const auto own = realtime_priority(machine, pid);
    if (own && *own <= priority && serves_a_bus(*name))
      below.push_back(fmt::format("{} (pid {}) at {}", *name, pid, *own));
  }
  if (!any)
    return {"interrupt threads", Severity::good,
            "interrupts are no threads here: they come before the loop"};
  if (below.empty())
    return {"interrupt threads", Severity::good, "those of USB and CAN come before the loop"};
  return {"interrupt threads", Severity::warning,
          fmt::format("behind the loop at {}: {}; replies wait until the loop sleeps", priority,
                      fmt::join(below, ", ")),
          fmt::format("chrt -f -p {} PID for each, or loop.priority below them",
                      std::min(priority + 5, 99))};
}

Finding autosuspend(const KernelFiles& machine) {
  std::vector<Text> sleepy;
  const Text directory = "sys/bus/usb/devices/";
  for (const Text& device : machine.names(directory)) {
    if (device.starts_with("usb") || device.find(':') != Text::npos) continue;
    if (machine.line(directory + device + "/power/control") != "auto") continue;
    sleepy.push_back(device + " " +
                     machine.line(directory + device + "/product").value_or("without a name"));
  }
  if (sleepy.empty()) return {"USB autosuspend", Severity::good, "no device may fall asleep"};
  return {"USB autosuspend", Severity::note,
          fmt::format("may fall asleep: {}", fmt::join(sleepy, ", ")),
          "if a haptic device is among them: echo on > /sys/bus/usb/devices/ID/power/control"};
}

std::vector<Finding> can_queues(const KernelFiles& machine) {
  constexpr double kCan = 280;  // ARPHRD_CAN
  constexpr double kLongest = 64;
  std::vector<Finding> findings;
  for (const Text& name : machine.names("sys/class/net")) {
    const Text directory = "sys/class/net/" + name;
    if (machine.number(directory + "/type") != kCan) continue;
    const double queue = machine.number(directory + "/tx_queue_len").value_or(0);
    const Text state = machine.line(directory + "/operstate").value_or("unknown");
    if (state == "down") {
      findings.push_back({"CAN " + name, Severity::warning, "is down",
                          "ip link set " + name + " up type can bitrate 1000000"});
    } else if (queue > kLongest) {
      findings.push_back(
          {"CAN " + name, Severity::warning,
           fmt::format("queues up to {:.0f} frames: a bus that stalls sends old efforts later",
                       queue),
           "ip link set " + name + " txqueuelen 16"});
    } else {
      findings.push_back(
          {"CAN " + name, Severity::good, fmt::format("up, queue of {:.0f} frames", queue)});
    }
  }
  return findings;
}

}  // namespace

Rights rights_of_this_process() {
  return {.root = geteuid() == 0,
          .rtprio = hard_limit(RLIMIT_RTPRIO),
          .memlock = hard_limit(RLIMIT_MEMLOCK),
          .rttime_us = hard_limit(RLIMIT_RTTIME),
          .dma_latency = access("/dev/cpu_dma_latency", W_OK) == 0};
}

std::optional<std::string> KernelFiles::line(const std::string& path) const {
  std::ifstream file(root_ / path);
  std::string text;
  if (!std::getline(file, text)) return {};
  return text;
}

std::optional<double> KernelFiles::number(const std::string& path) const {
  const auto text = line(path);
  if (!text) return {};
  std::istringstream stream(*text);
  double value = 0;
  if (!(stream >> value)) return {};
  return value;
}

std::vector<std::string> KernelFiles::names(const std::string& directory,
                                            const std::string& prefix) const {
  std::vector<std::string> found;
  std::error_code error;
  std::filesystem::directory_iterator entries(root_ / directory, error), end;
  for (; !error && entries != end; entries.increment(error)) {
    std::string name = entries->path().filename().string();
    if (name.starts_with(prefix)) found.push_back(std::move(name));
  }
  std::ranges::sort(found);
  return found;
}

std::vector<Finding> examine(const KernelFiles& machine, const Rights& rights, int priority) {
  std::vector<Finding> findings{
      kernel(machine),     priority_right(rights, priority), memory_right(rights),
      time_limit(rights),  group_scheduling(machine),        throttling(machine),
      governor(machine),   sleep_states(machine, rights),    interrupt_threads(machine, priority),
      autosuspend(machine)};
  for (Finding& one : can_queues(machine)) findings.push_back(std::move(one));
  return findings;
}

}  // namespace hapticd::daemon
