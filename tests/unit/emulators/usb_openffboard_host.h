// A host of an emulated OpenFFBoard.
#pragma once
#include "sim/usb/openffboard.h"
#include "tests/unit/emulators/usb_host.h"

namespace hapticd::test::emulator {
using CommandType = sim::usb::OpenffboardCommand::Type;

inline constexpr std::uint16_t kAxis = 0xa01, kEffects = 0xa02;
inline constexpr std::uint16_t kForever = 0xffff;

/// Nothing of its own acts, and effects go through as they are.
inline sim::usb::OpenffboardOptions plain_board(std::size_t axes = 2) {
  sim::usb::OpenffboardOptions options;
  options.axes = axes;
  options.axis.idlespring = 0;
  options.axis.damper = 0;
  options.axis.fxratio = 255;
  return options;
}

inline UsbBytes set_effect_bytes(std::uint16_t duration_ms, std::uint16_t direction = 9000,
                                 std::uint8_t enable = 6, std::uint8_t index = 1) {
  const auto low = [](unsigned v) { return static_cast<std::uint8_t>(v & 0xff); };
  return {1,   index, 1,      low(duration_ms), low(duration_ms >> 8u), 0, 0, 0, 0, 0, 0,
          255, 0,     enable, low(direction),   low(direction >> 8u),   0, 0, 0, 0, 0, 0};
}

class BoardHost : public UsbHost {
 public:
  using UsbHost::UsbHost;
  UsbBytes create(std::uint8_t type = 1) {
    EXPECT_TRUE(usb_acked(ask({0x21, 9, 0x0311, 2, 4}, {0x11, type, 0, 0})));
    return ask({0xa1, 1, 0x0312, 2, 5}).bytes;
  }
  void send(const UsbBytes& report) { write(sim::usb::Openffboard::kOut, report, 2e-3); }
  void force(std::int16_t magnitude, std::uint8_t index = 1) {
    const auto bits = static_cast<std::uint16_t>(magnitude);
    send({5, index, static_cast<std::uint8_t>(bits & 0xff), static_cast<std::uint8_t>(bits >> 8)});
  }
  /// A constant force that plays for ever, in direction X.
  void play(std::int16_t magnitude, std::uint16_t duration_ms = kForever) {
    create();
    send(set_effect_bytes(duration_ms));
    send({0x0c, 0x01});
    force(magnitude);
    send({0x0a, 1, 1, 0xff});
  }
  void tell(const sim::usb::OpenffboardCommand& command) {
    send(sim::usb::openffboard_command(command));
  }
  /// The next command report.
  std::optional<sim::usb::OpenffboardCommand> answer() {
    for (int i = 0; i < 10; ++i) {
      const auto report = read(sim::usb::Openffboard::kIn, 0.2);
      if (!report) return std::nullopt;
      if (const auto command = sim::usb::openffboard_command(*report)) return command;
    }
    return std::nullopt;
  }
  std::optional<std::int64_t> setting(std::uint32_t command, std::uint16_t class_id = kAxis,
                                      std::uint8_t instance = 0) {
    tell({.type = CommandType::read,
          .class_id = class_id,
          .instance = instance,
          .command = command});
    const auto reply = answer();
    if (!reply || reply->type != CommandType::read || reply->command != command)
      return std::nullopt;
    return reply->data;
  }
};

}  // namespace hapticd::test::emulator
