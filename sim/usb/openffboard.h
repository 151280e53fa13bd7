// OpenFFBoard as its firmware 1.17 behaves: composite of CDC and HID, force effects by HID PID, settings by report 0xA1.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "sim/usb/device.h"
#include "sim/usb/openffboard_axis.h"
#include "sim/usb/openffboard_effects.h"
#include "sim/usb/openffboard_wire.h"

namespace hapticd::sim::usb {

struct OpenffboardOptions {
  std::uint16_t vendor = 0x1209, product_id = 0xffb0;
  std::string product = "FFBoard F407VG", serial = "3052345678";
  std::size_t axes = 2;  ///< 1 or 2
  OpenffboardAxisOptions axis{};
  double cycle_phase_s = 0.5e-3;  ///< its loop of 1 kHz runs so long after the frame starts
  double silence_s =
      0;  ///< actuators off without a report for so long; 0: never, as the firmware is
};

/// Motors: position in counts of 65536 over the range `degrees` that it had at power-up; torque [N m].
class Openffboard final : public Device {
 public:
  static constexpr int kHid = 2;  ///< interface
  static constexpr std::uint8_t kIn = 3, kOut = 2;

  explicit Openffboard(const OpenffboardOptions& options);

  std::vector<std::uint8_t> device_descriptor() const override;
  std::vector<std::uint8_t> configuration_descriptor() const override;
  Names names() const override;
  std::vector<std::uint8_t> report_descriptor(int interface) const override;

  Answer control(const Setup& setup, std::span<const std::uint8_t> data,
                 std::int64_t now_ns) override;
  Answer out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
             std::int64_t now_ns) override;
  Answer in(std::uint8_t endpoint, std::size_t most_bytes, std::int64_t now_ns) override;
  void advance(std::int64_t now_ns) override;
  std::int64_t next_ns() const override { return next_cycle_ns_; }
  void replug(bool power_lost, std::int64_t now_ns) override;
  std::size_t motors() const override { return axes_.size(); }
  Motor& motor(std::size_t i) override { return axes_[i]; }

  void set_buttons(std::uint64_t buttons) { buttons_ = buttons; }
  void set_emergency(bool stopped) { emergency_ = stopped; }
  bool actuators_on() const { return effects_.active(); }
  const OpenffboardEffects& effects() const { return effects_; }
  const OpenffboardAxis& axis(std::size_t i) const { return axes_[i]; }

 private:
  void cycle(std::int64_t now_ns);
  void send_report();
  void send_reply();
  void take(std::span<const std::uint8_t> report, std::int64_t now_ns);
  void command(const OpenffboardCommand& asked);
  void answer_one(OpenffboardCommand asked, std::uint8_t instance);
  void answer(const OpenffboardCommand& asked, OpenffboardCommand::Type type, std::int64_t data,
              std::int64_t address);
  bool knows(const OpenffboardCommand& asked) const;
  std::optional<std::int64_t> read(const OpenffboardCommand& asked) const;
  bool write(const OpenffboardCommand& asked);
  Answer hid_request(const Setup& setup, std::span<const std::uint8_t> data, std::int64_t now_ns);
  Answer feature(std::uint8_t id) const;
  void send_state();
  std::uint32_t tick_ms(std::int64_t now_ns) const;

  OpenffboardOptions options_;
  std::deque<OpenffboardAxis> axes_;
  OpenffboardEffects effects_;
  std::deque<OpenffboardCommand> replies_;
  std::vector<std::uint8_t> slot_;  ///< loaded into the endpoint, goes out next
  OpenffboardPad sent_{};
  std::uint64_t buttons_ = 0;
  int cycles_since_pad_ = 0;
  bool emergency_ = false;
  std::int64_t boot_ns_ = 0, next_cycle_ns_ = 0, heard_ns_ = 0;
};

}  // namespace hapticd::sim::usb
