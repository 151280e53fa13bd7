// Which reports of a HID device tell where it is, so that only the newest counts, and which each count.
#pragma once
#include "drivers/hid/openffboard_codec.h"
#include "drivers/hid/report_descriptor.h"
#include "drivers/usb/arrival_queue.h"

namespace hapticd::hid {

/// Of an OpenFFBoard, known by its command channel, its positions alone.
inline usb::Superseding superseding_of(const ReportDescriptor& descriptor) noexcept {
  constexpr std::uint8_t kId = openffboard::kCommandReport;
  const bool has_commands =
      descriptor.report_bytes(ReportKind::input, kId) == openffboard::kCommandBytes &&
      descriptor.report_bytes(ReportKind::output, kId) == openffboard::kCommandBytes;
  usb::Superseding superseding{.newest_only = true, .numbered = descriptor.numbered};
  if (has_commands) superseding.only_of_id = openffboard::kGamepadReport;
  return superseding;
}

/// The longest of a kind, with its id; 0: there is none.
inline std::size_t longest_report(const ReportDescriptor& descriptor, ReportKind kind) noexcept {
  std::size_t longest = 0;
  for (int id = 0; id < 256; ++id)
    longest = std::max(longest, descriptor.report_bytes(kind, static_cast<std::uint8_t>(id)));
  return longest;
}

}  // namespace hapticd::hid
