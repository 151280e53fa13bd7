#include <utility>

#include "daemon/summary.h"

namespace hapticd::daemon {
namespace {

Json times_json(const Summary& s) {
  Json json = Json::object();
  for (std::size_t i = 0; i < kPhases; ++i) {
    json[kPhaseNames[i]] = {{"p50", s.times[i].p50_us},
                            {"p99", s.times[i].p99_us},
                            {"p99_9", s.times[i].p999_us},
                            {"max", s.times[i].max_us}};
  }
  return json;
}

Json faults_json(const Summary& s) {
  Json json = Json::array();
  for (const FaultCount& fault : s.faults) {
    json.push_back({{"fault", entry(fault.code).name},
                    {"count", fault.count},
                    {"last", fault.last},
                    {"last_at_s", fault.last_at_s}});
  }
  return json;
}

Json limits_json(const Summary& s) {
  Json json = Json::object();
  for (const LimitCount& limit : s.limits) json[std::string(limit.name)] = limit.ticks;
  return json;
}

Json traffic_json(const std::optional<TrafficSummary>& bus) {
  if (!bus) return nullptr;
  if (bus->comes_and_goes)
    return {{"connections", bus->connections},   {"round_trip_s", bus->round_trip_s},
            {"worst_send_s", bus->worst_send_s}, {"samples_malformed", bus->malformed},
            {"samples_skipped", bus->late},      {"samples_lost", bus->lost},
            {"commands_replaced", bus->not_sent}};
  return {{"samples_late", bus->late},
          {"frames_not_sent", bus->not_sent},
          {"frames_lost", bus->lost},
          {"commands_of_others", bus->foreign}};
}

Json devices_json(const Summary& s) {
  Json json = Json::array();
  for (const DeviceSummary& device : s.devices) {
    Json axes = Json::object();
    for (const std::string& axis : device.homed) axes[axis] = true;
    for (const std::string& axis : device.not_homed) axes[axis] = false;
    json.push_back({{"device", device.name},
                    {"work_J", device.work_J},
                    {"fade", device.fade},
                    {"homed", std::move(axes)},
                    {"bus", traffic_json(device.traffic)}});
  }
  return json;
}

Json realtime_json(const RealtimeReport& got) {
  Json missing = Json::array();
  for (const MissingRight& right : got.missing) {
    missing.push_back({{"right", right.right}, {"reason", right.reason}, {"grant", right.grant}});
  }
  return {{"scheduling", got.scheduling},
          {"memory_locked", got.memory_locked},
          {"dma_latency_held", got.dma_latency_held},
          {"cpu", got.cpu ? Json(*got.cpu) : Json(nullptr)},
          {"missing", std::move(missing)}};
}

Json thread_json(const std::optional<ThreadUse>& use) {
  if (!use) return nullptr;
  return {{"minor_faults", use->minor_faults},
          {"major_faults", use->major_faults},
          {"voluntary_switches", use->voluntary_switches},
          {"involuntary_switches", use->involuntary_switches}};
}

}  // namespace

Json to_json(const Summary& s) {
  Json missed_by = Json::object();
  for (std::size_t i = 0; i < kPhases; ++i) missed_by[kPhaseNames[i]] = s.missed_by[i];
  return {{"duration_s", s.duration_s},
          {"rate_Hz", s.rate_Hz},
          {"ticks", s.ticks},
          {"late_wakes", s.late_wakes},
          {"overruns", s.overruns},
          {"gaps", s.gaps},
          {"missed_ticks", s.missed_ticks},
          {"missed_by", std::move(missed_by)},
          {"samples_held", s.samples_held},
          {"times_us", s.ticks == 0 ? Json(nullptr) : times_json(s)},
          {"largest_force_N", s.largest_force_N},
          {"unproven", s.unproven},
          {"faults", faults_json(s)},
          {"limits", limits_json(s)},
          {"devices", devices_json(s)},
          {"records_dropped", s.records_dropped},
          {"records_lost", s.records_lost},
          {"servo_thread", thread_json(s.thread)},
          {"realtime", realtime_json(s.realtime)},
          {"kernel", s.kernel},
          {"preempt_rt", s.preempt_rt},
          {"load_average", s.load_average ? Json(*s.load_average) : Json(nullptr)}};
}

}  // namespace hapticd::daemon
