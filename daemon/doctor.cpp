#include "daemon/doctor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hapticd::daemon {
namespace {

Finding wake_ups(const LoopTimes& times) {
  if (times.ticks == 0)
    return {"wake-ups", Severity::bad, "the loop did not run at all", "watch it for longer"};
  const std::string found = fmt::format(
      "late by {:.0f} us (half of them), {:.0f} us (p99.9), {:.0f} us at most, in {:.1f} s; {} of "
      "{} ticks missed",
      1e6 * times.wake_p50_s, 1e6 * times.wake_p999_s, 1e6 * times.wake_max_s, times.seconds,
      times.missed, times.ticks + times.missed);
  if (times.missed > 0)
    return {
        "wake-ups", Severity::warning, found,
        "mend what is said of kernel, governor and sleep states; give the loop a CPU of its own "
        "(loop.cpu and isolcpus), or a lower loop.rate_Hz"};
  if (times.wake_p999_s > 0.1 * times.period_s)
    return {
        "wake-ups", Severity::warning, found,
        "more than a tenth of the period: mend what is said of kernel, governor and sleep states"};
  return {"wake-ups", Severity::good, found};
}

Finding exchange(const LoopTimes& times) {
  const std::string found = fmt::format(
      "all devices answer within {:.0f} us (half of the ticks), {:.0f} us (p99.9), {:.0f} us at "
      "most",
      1e6 * times.collect_p50_s, 1e6 * times.collect_p999_s, 1e6 * times.collect_max_s);
  if (times.collect_p999_s < 0.5 * times.period_s) return {"round trip", Severity::good, found};
  return {"round trip", Severity::bad, found,
          "a tick waits half a period at most: lower loop.rate_Hz, or fewer devices on one bus"};
}

Finding latency(const LoopTimes& times, const DeviceTimes& device) {
  const std::string topic = "latency of " + device.name;
  if (!device.seen)
    return {topic, Severity::bad, "not one sample came",
            "see that the device is on and that its driver is the right one"};
  const double needed_s = needed_latency_s(times, device);
  std::string found = fmt::format(
      "samples are {:.0f} us old (half of them), {:.0f} us (p99.9), {:.0f} us at most; with step "
      "and "
      "command the host adds {:.0f} us",
      1e6 * device.p50_s, 1e6 * device.p999_s, 1e6 * device.max_s,
      1e6 * host_share_s(times, device));
  if (device.simulated)
    found += fmt::format("; that does not delay a simulated device, whose delay_s is {:.6g}",
                         device.simulated_delay_s);
  if (device.latency_s >= needed_s) return {topic, Severity::good, std::move(found)};
  found += fmt::format("; latency_s is {:.6g}", device.latency_s);
  return {topic, Severity::bad, std::move(found),
          fmt::format("latency_s: {:.6f} or more for {}", 1e-6 * std::ceil(1e6 * needed_s),
                      device.name)};
}

}  // namespace

double host_share_s(const LoopTimes& times, const DeviceTimes& device) {
  // Who has answered waits for the others: at most as long as the whole exchange takes.
  const double waits_s = times.devices.size() > 1 ? times.collect_p999_s : 0;
  return device.p999_s + waits_s + times.answer_p999_s;
}

double needed_latency_s(const LoopTimes& times, const DeviceTimes& device) {
  return device.simulated ? device.simulated_delay_s : host_share_s(times, device);
}

std::vector<Finding> judge(const LoopTimes& times) {
  std::vector<Finding> findings{wake_ups(times)};
  if (times.devices.empty()) return findings;
  findings.push_back(exchange(times));
  for (const DeviceTimes& device : times.devices) findings.push_back(latency(times, device));
  return findings;
}

}  // namespace hapticd::daemon
