// A host of an emulated Falcon.
#pragma once
#include "sim/usb/falcon.h"
#include "tests/unit/emulators/usb_host.h"

namespace hapticd::test::emulator {

inline constexpr std::uint16_t kRomDivisor = 0x4138, kLoaderDivisor = 0x0015, kRunDivisor = 0x0002;

inline UsbBytes command_bytes(std::array<int, 3> motors, bool homing = false) {
  UsbBytes bytes{'<'};
  for (const int motor : motors)
    for (int i = 0; i < 4; ++i)
      bytes.push_back(
          static_cast<std::uint8_t>('A' + (static_cast<unsigned>(motor) >> 4 * i & 15)));
  bytes.insert(bytes.end(), {static_cast<std::uint8_t>(homing ? 'B' : 'A'), 'A', '>'});
  return bytes;
}

/// A host of a Falcon: request, and bytes without status.
class FalconHost : public UsbHost {
 public:
  using UsbHost::UsbHost;

  void set(std::uint8_t request, std::uint16_t value) {
    EXPECT_TRUE(usb_acked(ask({0x40, request, value, 0, 0})));
  }
  void wake() {
    set(0, 1);
    set(0, 2);
    set(9, 16);
    set(3, kRomDivisor);
    set(4, 0x0008);
    set(2, 0);
    set(1, 0x0200);
    set(1, 0x0100);
    set(1, 0x0101);
  }
  /// What comes in `time_s`.
  UsbBytes hear(double time_s) {
    UsbBytes bytes;
    const std::int64_t until_ns = now_ns + std::llround(1e9 * time_s);
    while (now_ns < until_ns)
      if (const auto packet =
              read(sim::usb::Falcon::kIn, 1e-9 * static_cast<double>(until_ns - now_ns)))
        bytes.insert(bytes.end(), packet->begin() + 2, packet->end());
    return bytes;
  }
  bool greeted(double time_s = 0.05) {
    out(sim::usb::Falcon::kOut, {0x0a, 0x43, 0x0d});
    const UsbBytes heard = hear(time_s);
    return heard == UsbBytes{0x0a, 0x44, 0x2c, 0x0d};
  }
  void start_loader() {
    set(1, 0x0100);
    set(3, kLoaderDivisor);
    out(sim::usb::Falcon::kOut, {0x41});
    EXPECT_EQ(hear(0.04), UsbBytes{0x41});
  }
  /// Chunks that came back as sent, until one does not.
  std::size_t upload(const UsbBytes& image) {
    for (std::size_t i = 0; i < image.size(); i += 62) {
      const auto from = image.begin() + static_cast<std::ptrdiff_t>(i);
      const UsbBytes chunk(
          from, from + static_cast<std::ptrdiff_t>(std::min<std::size_t>(62, image.size() - i)));
      out(sim::usb::Falcon::kOut, chunk);
      if (hear(0.02) != chunk) return i / 62;
    }
    return (image.size() + 61) / 62;
  }
  void to_run_speed() {
    set(9, 1);
    set(3, kRunDivisor);
    set(0, 1);
    set(0, 2);
  }
  std::optional<UsbBytes> exchange(const UsbBytes& command, double time_s = 0.004) {
    out(sim::usb::Falcon::kOut, command);
    const UsbBytes heard = hear(time_s);
    const bool whole =
        heard.size() == sim::usb::kFalconFrameBytes && heard[0] == '<' && heard[15] == '>';
    if (!whole) return std::nullopt;
    return heard;
  }
};

inline sim::usb::FalconOptions loaded_falcon() {
  sim::usb::FalconOptions options;
  options.board.loaded = true;
  return options;
}

inline std::array<std::int16_t, 3> encoders_of(const UsbBytes& frame) {
  std::array<std::int16_t, 3> encoders{};
  for (std::size_t i = 0; i < 12; ++i)
    encoders[i / 4] =
        static_cast<std::int16_t>(encoders[i / 4] | (frame.at(i + 1) - 'A') << 4 * (i % 4));
  return encoders;
}

}  // namespace hapticd::test::emulator
