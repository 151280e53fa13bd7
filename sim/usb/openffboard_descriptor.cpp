// The report descriptor: usages of HID PID 1.0, sizes as the firmware has them. Of its output reports those that the
// emulator obeys.
#include "sim/usb/hid_items.h"
#include "sim/usb/openffboard_wire.h"

namespace hapticd::sim::usb {
namespace {

constexpr std::uint16_t kDesktopPage = 0x01, kButtonPage = 0x09, kPidPage = 0x0f;
constexpr std::uint16_t kMostEffects = 40;
using Items = HidItems;

Items& begin_report(Items& items, std::uint16_t usage, OpenffboardReport id) {
  return items.item(Items::usage_page, kPidPage)
      .item(Items::usage, usage)
      .open(Items::logical)
      .item(Items::report_id, static_cast<std::uint8_t>(id));
}

Items& effect_index(Items& items, Items::Tag tag) {
  return items.item(Items::usage, 0x22).range(1, kMostEffects).fields(tag, 8, 1);
}

Items& effect_type(Items& items, Items::Tag tag) {
  return items.item(Items::usage, 0x25)
      .open(Items::logical)
      .usages({0x26, 0x27, 0x30, 0x31, 0x32, 0x33, 0x34, 0x40, 0x41, 0x42, 0x43})
      .range(1, 11)
      .fields(tag, 8, 1, Items::data_array)
      .close();
}

void pad_report(Items& items) {
  items.open(Items::physical).item(Items::report_id, 1).item(Items::usage_page, kButtonPage);
  items.item(Items::usage_minimum, 1).item(Items::usage_maximum, 64);
  items.range(0, 1).fields(Items::input, 1, 64);
  items.item(Items::usage_page, kDesktopPage)
      .usages({0x30, 0x31, 0x32, 0x33, 0x34, 0x35, 0x37, 0x36})
      .range(-32767, 32767)
      .fields(Items::input, 16, 8)
      .close();
}

void command_reports(Items& items) {
  items.item(Items::usage_page, 0xff00).item(Items::usage, 0).open(Items::application);
  for (const Items::Tag way : {Items::output, Items::input}) {
    items.item(Items::report_id, 0xa1).range(0, 4);
    std::uint16_t usage = 0;
    for (const unsigned bits : {8u, 16u, 8u, 32u, 64u, 64u})
      items.item(Items::usage, ++usage).fields(way, bits, 1);
  }
  items.close();
}

void state_report(Items& items) {
  begin_report(items, 0x92, OpenffboardReport::state)
      .usages({0x9f, 0xa0, 0xa4, 0xa6, 0x94})
      .range(0, 1)
      .fields(Items::input, 1, 5)
      .fields(Items::input, 1, 3, Items::constant)
      .close();
}

void set_effect_report(Items& items, std::size_t axes) {
  begin_report(items, 0x21, OpenffboardReport::set_effect);
  effect_type(effect_index(items, Items::output), Items::output);
  items.usages({0x50, 0x54, 0x51, 0xa7}).range(0, 32767).fields(Items::output, 16, 4);
  items.item(Items::usage, 0x52).range(0, 255).fields(Items::output, 8, 1);
  items.item(Items::usage, 0x53).range(1, 8).fields(Items::output, 8, 1);
  items.item(Items::usage, 0x55).open(Items::logical).item(Items::usage_page, kDesktopPage);
  for (std::size_t i = 0; i < axes; ++i)
    items.item(Items::usage, static_cast<std::int64_t>(0x30 + i));
  items.range(0, 1).fields(Items::output, 1, axes).close();
  items.item(Items::usage_page, kPidPage).item(Items::usage, 0x56).fields(Items::output, 1, 1);
  items.fields(Items::output, 1, 7 - axes, Items::constant);
  for (const int usage : {0x57, 0x58}) {  // direction, then offsets of type blocks
    items.item(Items::usage, usage).open(Items::logical);
    for (std::size_t i = 0; i < axes; ++i)
      items.item(Items::usage, static_cast<std::int64_t>(0x000a0001 + i));
    items.range(0, usage == 0x57 ? 36000 : 32765).fields(Items::output, 16, axes).close();
  }
  items.close();
}

void small_output_reports(Items& items) {
  effect_index(begin_report(items, 0x73, OpenffboardReport::constant_force), Items::output)
      .item(Items::usage, 0x70)
      .range(-32767, 32767)
      .fields(Items::output, 16, 1)
      .close();
  effect_index(begin_report(items, 0x77, OpenffboardReport::effect_operation), Items::output)
      .item(Items::usage, 0x78)
      .open(Items::logical)
      .usages({0x79, 0x7a, 0x7b})
      .range(1, 3)
      .fields(Items::output, 8, 1, Items::data_array)
      .close()
      .item(Items::usage, 0x7c)
      .range(0, 255)
      .fields(Items::output, 8, 1)
      .close();
  effect_index(begin_report(items, 0x90, OpenffboardReport::block_free), Items::output).close();
  begin_report(items, 0x95, OpenffboardReport::device_control)
      .item(Items::usage, 0x96)
      .open(Items::logical)
      .usages({0x97, 0x98, 0x99, 0x9a, 0x9b, 0x9c})
      .range(1, 6)
      .fields(Items::output, 1, 8)
      .close()
      .close();
  begin_report(items, 0x7d, OpenffboardReport::device_gain)
      .item(Items::usage, 0x7e)
      .range(0, 255)
      .fields(Items::output, 8, 1)
      .close();
}

void feature_reports(Items& items) {
  effect_type(begin_report(items, 0xab, OpenffboardReport::create_effect), Items::feature)
      .item(Items::usage_page, kDesktopPage)
      .item(Items::usage, 0x3b)
      .range(0, 511)
      .fields(Items::feature, 10, 1)
      .fields(Items::feature, 6, 1, Items::constant_array)
      .close();
  effect_index(begin_report(items, 0x89, OpenffboardReport::block_load), Items::feature)
      .item(Items::usage, 0x8b)
      .open(Items::logical)
      .usages({0x8c, 0x8d, 0x8e})
      .range(1, 3)
      .fields(Items::feature, 8, 1, Items::data_array)
      .close()
      .item(Items::usage, 0xac)
      .range(0, 65535)
      .fields(Items::feature, 16, 1, Items::data_array)
      .close();
  begin_report(items, 0x7f, OpenffboardReport::pool)
      .item(Items::usage, 0x80)
      .range(0, 65535)
      .fields(Items::feature, 16, 1)
      .item(Items::usage, 0x83)
      .range(0, 255)
      .fields(Items::feature, 8, 1)
      .usages({0xa9, 0xaa})
      .range(0, 1)
      .fields(Items::feature, 1, 2)
      .fields(Items::feature, 6, 1, Items::constant)
      .close();
}

}  // namespace

std::vector<std::uint8_t> openffboard_report_descriptor(std::size_t axes) {
  constexpr std::uint16_t kJoystick = 0x04;
  Items items;
  items.item(Items::usage_page, kDesktopPage).item(Items::usage, kJoystick);
  items.open(Items::application);
  pad_report(items);
  command_reports(items);
  state_report(items);
  set_effect_report(items, axes);
  small_output_reports(items);
  feature_reports(items);
  return items.close().bytes();
}

}  // namespace hapticd::sim::usb
