// What each key of a config is: name, needed or not, range, unit, meaning. One description per
// struct of schema.h; the reader, the JSON schema and the man page's key table are visitors of it.
// The default of a key is what its struct has. Devices, axes, simulations, couplings, scenes have
// files of their own.
//
// A visitor offers
//   template <class T> void required(const char* key, T& field, const Key& about);
//   template <class T> void optional(const char* key, T& field, const Key& about);
//
// A new kind of scene object: see README.md.
#pragma once
#include "config/describe_axis.h"
#include "config/describe_coupling.h"
#include "config/describe_device.h"
#include "config/describe_field.h"
#include "config/describe_scene.h"
#include "config/describe_sim.h"
#include "config/describe_stability.h"
#include "config/key.h"
#include "config/schema.h"
#include "control/core/capacity.h"

namespace hapticd::config {

template <class V>
void describe(V& v, Loop& s) {
  v.optional("rate_Hz", s.rate_Hz,
             {.about = "ticks per second", .min = 100, .max = 8000, .unit = "Hz"});
  v.optional("priority", s.priority,
             {.about = "SCHED_FIFO priority of the servo thread", .min = 1, .max = 99});
  v.optional("cpu", s.cpu,
             {.about = "pin the servo thread to this CPU; null: any", .min = 0, .max = 1023});
  v.optional("max_gap_ticks", s.max_gap_ticks,
             {.about = "more missed ticks in a row are a fault",
              .min = 0,
              .max = 100'000,
              .unit = "ticks"});
  v.optional("max_missed_per_s", s.max_missed_per_s,
             {.about = "more missed ticks in one second are a fault", .min = 0, .max = 20'000});
}

template <class V>
void describe(V& v, Start& s) {
  v.optional(
      "enable", s.enable,
      {.about =
           "forces come on by 'hapticctl enable', or by themselves once all devices are ready"});
}

template <class V>
void describe(V& v, Control& s) {
  v.optional("socket", s.socket, {.about = "the socket that hapticctl talks to"});
}

template <class V>
void describe(V& v, Telemetry& s) {
  v.optional("flight_dir", s.flight_dir,
             {.about = "where the flight recorder writes; empty text: nowhere"});
  v.optional("flight_s", s.flight_s,
             {.about = "time before a fault that the flight recorder keeps",
              .min = 0.1,
              .max = 60,
              .unit = "s"});
  v.optional("record", s.record, {.about = "file that gets every record, in full; null: none"});
}

template <class V>
void describe(V& v, Config& s) {
  v.required("version", s.version, {.about = "of this format", .min = 1, .max = 1});
  v.optional("loop", s.loop, {.about = "the servo loop"});
  v.optional("start", s.start, {.about = "what happens at start"});
  v.required("devices", s.devices,
             {.about = "what is driven", .min_items = 1, .max_items = kMaxDevices});
  v.optional("coupling", s.coupling,
             {.about = "virtual springs and dampers between the contacts and what they touch; "
                       "null: the scene is felt directly"});
  v.optional("scene", s.scene,
             {.about = "what can be touched; each entry is a map with one key, the kind",
              .max_items = kMaxObjects});
  v.optional("sim", s.sim, {.about = "what simulated devices share"});
  v.optional("stability", s.stability, {.about = "what is demanded of the scene"});
  v.optional("guard", s.guard, {.about = "limits of every device"});
  v.optional("control", s.control, {.about = "how the daemon is talked to"});
  v.optional("telemetry", s.telemetry, {.about = "what is recorded"});
}

}  // namespace hapticd::config
