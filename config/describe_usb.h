// What each key of a device on USB is; part of config/describe.h.
#pragma once
#include "config/key.h"
#include "config/schema_usb.h"
#include "control/core/capacity.h"
#include "drivers/hid/report_map.h"

namespace hapticd::config {

template <class V>
void describe(V& v, UsbDevice& s) {
  v.optional(
      "id", s.id,
      {.about = "vendor and product, hexadecimal, as lsusb prints them; null: 0403:cb48 of a "
                "falcon, 1209:ffb0 of an openffboard; hid_report needs it",
       .form = TextForm::hex_pair});
  v.optional("serial", s.serial, {.about = "serial number that it has; null: any"});
  v.optional("path", s.path,
             {.about = "port that it is plugged into, as in /sys/bus/usb/devices; null: any",
              .form = TextForm::usb_port});
  v.optional("interface", s.interface,
             {.about = "HID: which interface of the device; null: the one that fits",
              .min = 0,
              .max = 255});
  v.optional("usage", s.usage,
             {.about = "HID: usage page and usage of a top collection, hexadecimal; null: any",
              .form = TextForm::hex_pair});
  v.optional(
      "transport", s.transport,
      {.about = "HID: by the kernel's driver, or past it with several reads in flight, which "
                "is quicker"});
  v.optional("reads", s.reads, {.about = "libusb: reads in flight", .min = 2, .max = 8});
  v.optional(
      "arrival_age_s", s.arrival_age_s,
      {.about = "how old a sample is when it arrives, at most: the device's own time and the "
                "wire's; null: 0.001 s; an openffboard, whose answers stand for positions: 0.003 s",
       .min = 0,
       .max = 0.1,
       .unit = "s"});
  v.optional(
      "max_age_s", s.max_age_s,
      {.about = "an older sample is missing; at least arrival_age_s and 1 ms, in which the "
                "next one comes; null: 0.0025 s; with transport: hidapi, where a report waits for "
                "the one that goes out, 0.0035 s; an openffboard, which has to be asked while "
                "nothing moves: 0.008 s",
       .min = 0,
       .max = 0.1,
       .above_min = true,
       .unit = "s"});
  v.optional("send_s", s.send_s,
             {.about = "a command is with the device after so long, at most, the one included "
                       "that is on its way when it is given; null: 0.002 s; an openffboard, which "
                       "is told one thing a millisecond: 0.001 s more for each axis",
              .min = 0,
              .max = 0.1,
              .above_min = true,
              .unit = "s"});
  v.optional("drive_delay_s", s.drive_delay_s,
             {.about = "an effort acts so long after its command came, at most",
              .min = 0,
              .max = 0.1,
              .unit = "s"});
  v.optional("watchdog_s", s.watchdog_s,
             {.about = "the loop gave no command for so long: zero force; at least 3 periods",
              .min = 0,
              .max = 0.5,
              .above_min = true,
              .unit = "s"});
  v.optional(
      "silence_s", s.silence_s,
      {.about = "the device said nothing for so long: it is lost; more than max_age_s; null: "
                "0.1 s; an openffboard, which may be silent for 0.1 s: 0.15 s",
       .min = 0,
       .max = 10,
       .above_min = true,
       .unit = "s"});
}

template <class V>
void describe(V& v, Falcon& s) {
  v.optional(
      "firmware", s.firmware,
      {.about = "file that is loaded into a Falcon without firmware; null: it must have it"});
  v.optional("sha256", s.sha256,
             {.about = "of that file, 64 hexadecimal digits; null: any", .form = TextForm::sha256});
  v.optional("upload_tries", s.upload_tries,
             {.about = "how often loading is tried", .min = 1, .max = 100});
  v.optional(
      "counts_per_Nm", s.counts_per_Nm,
      {.about = "of the motor command, not 0; negative: a positive command turns an arm back",
       .min = -1e6,
       .max = 1e6,
       .unit = "counts/(N m)"});
  v.optional(
      "max_command", s.max_command,
      {.about = "largest motor command, either way", .min = 1, .max = 32767, .unit = "counts"});
  v.optional(
      "flush_on_bracket", s.flush_on_bracket,
      {.about = "the bridge sends each packet on at its end, without waiting for a "
                "millisecond to pass; a feature of the chip that not every Falcon may have"});
}

/// Where a number lies.
template <class V, class Field>
void describe_place(V& v, Field& s) {
  constexpr double kBits = 8 * hid::kMostReportBytes;
  v.required(
      "offset_bits", s.offset_bits,
      {.about = "its lowest bit (big endian: of its first byte), counted from the first byte "
                "of the report as the wire has it: an id takes bits 0 to 7",
       .min = 0,
       .max = kBits - 1});
  v.required("width_bits", s.width_bits, {.about = "bits that it has", .min = 1, .max = 64});
  v.optional("endian", s.endian, {.about = "which byte is first; big: whole bytes only"});
}

/// What a number means: raw * scale + offset.
template <class V, class Field>
void describe_offset(V& v, Field& s) {
  v.optional("signed", s.is_signed, {.about = "two's complement"});
  v.optional("float", s.is_float,
             {.about = "a floating-point number, IEEE 754, of 32 bits, which are whole bytes"});
  v.optional("offset", s.offset,
             {.about = "added to the scaled number", .min = -1e12, .max = 1e12});
}

template <class V>
void describe(V& v, PositionField& s) {
  describe_place(v, s);
  v.optional("scale", s.scale,
             {.about = "encoder counts of one step, not 0", .min = -1e12, .max = 1e12});
  describe_offset(v, s);
  v.optional("unwrap", s.unwrap,
             {.about = "the counter begins anew: it is counted on over its end; encoder.bits is "
                       "left out then, or 0"});
  v.optional(
      "modulus", s.modulus,
      {.about = "unwrap: after how many steps; null: 2^width_bits", .min = 2, .max = 4294967296.0});
}

template <class V>
void describe(V& v, AnalogueField& s) {
  describe_place(v, s);
  v.optional("scale", s.scale, {.about = "of one step, not 0", .min = -1e12, .max = 1e12});
  describe_offset(v, s);
}

template <class V>
void describe(V& v, ButtonField& s) {
  v.required("offset_bits", s.offset_bits,
             {.about = "its lowest bit; see report.in.positions[]",
              .min = 0,
              .max = 8 * hid::kMostReportBytes - 1});
  v.optional("width_bits", s.width_bits,
             {.about = "bits that it has: any but 0 is on", .min = 1, .max = 64});
}

template <class V>
void describe(V& v, SequenceField& s) {
  describe_place(v, s);
  v.optional(
      "modulus", s.modulus,
      {.about = "it begins anew after so many; null: 2^width_bits", .min = 2, .max = 4294967296.0});
}

template <class V>
void describe(V& v, BitField& s) {
  describe_place(v, s);
}

/// Which reports.
template <class V, class Map>
void describe_frame(V& v, Map& s) {
  v.optional("id", s.id,
             {.about = "report id; null: the device's reports have none", .min = 1, .max = 255});
  v.required("bytes", s.bytes,
             {.about = "length of the report, with the id",
              .min = 1,
              .max = hid::kMostReportBytes,
              .unit = "bytes"});
}

template <class V>
void describe(V& v, ReportIn& s) {
  describe_frame(v, s);
  v.required("positions", s.positions,
             {.about = "encoder counts, one for each axis",
              .min_items = 1,
              .max_items = kMaxAxesPerDevice});
  v.optional("buttons", s.buttons,
             {.about = "digital inputs, the first is bit 0", .max_items = hid::kMostFields});
  v.optional("analogue", s.analogue,
             {.about = "channels of force_sensor, in N", .max_items = kMaxAxesPerDevice});
  v.optional("sequence", s.sequence,
             {.about = "number that goes up by one in each report: tells lost and old ones; null: "
                       "there is none"});
}

template <class V>
void describe(V& v, EffortField& s) {
  describe_place(v, s);
  v.required("scale", s.scale,
             {.about = "N or N m of one step, not 0; negative: the motor is reversed",
              .min = -1e12,
              .max = 1e12});
  describe_offset(v, s);
  v.optional(
      "least", s.least,
      {.about = "N or N m: never less; null: what the number can hold", .min = -1e6, .max = 1e6});
  v.optional(
      "most", s.most,
      {.about = "N or N m: never more; null: what the number can hold", .min = -1e6, .max = 1e6});
}

template <class V>
void describe(V& v, ConstantByte& s) {
  v.required("byte", s.byte,
             {.about = "which byte, the first is 0", .min = 0, .max = hid::kMostReportBytes - 1});
  v.required("value", s.value, {.about = "that it always has", .min = 0, .max = 255});
}

template <class V>
void describe(V& v, ReportOut& s) {
  describe_frame(v, s);
  v.required("efforts", s.efforts,
             {.about = "one for each axis", .min_items = 1, .max_items = kMaxAxesPerDevice});
  v.optional(
      "constants", s.constants,
      {.about = "bytes that never change; all others are 0", .max_items = hid::kMostReportBytes});
  v.optional("heartbeat", s.heartbeat,
             {.about = "number that goes up with each report; null: none"});
  v.optional(
      "safe", s.safe,
      {.about = "the whole report, with the id, that is sent on stopping; empty: efforts of 0",
       .min = 0,
       .max = 255,
       .max_items = hid::kMostReportBytes});
  v.optional("every_s", s.every_s,
             {.about = "a report goes out at least so often; at most a third of watchdog_s",
              .min = 0.0005,
              .max = 1,
              .unit = "s"});
  v.optional("watchdog_s", s.watchdog_s,
             {.about = "the device's own: it goes off when it hears nothing for so long; null: it "
                       "has none",
              .min = 0,
              .max = 60,
              .above_min = true,
              .unit = "s"});
}

template <class V>
void describe(V& v, Report& s) {
  v.required("in", s.in, {.about = "from the device"});
  v.required("out", s.out, {.about = "to the device"});
}

template <class V>
void describe(V& v, OpenFfboard& s) {
  v.required("full_torque_Nm", s.full_torque_Nm,
             {.about = "of an axis at the full magnitude of an effect",
              .min = 0,
              .max = 10'000,
              .above_min = true,
              .unit = "N m"});
  v.optional("dead_man_s", s.dead_man_s,
             {.about = "an effect ends by itself after so long; it is set anew in time",
              .min = 0.02,
              .max = 1,
              .unit = "s"});
}

}  // namespace hapticd::config
