// A board that speaks raw HID: reports of a fixed layout, one each interval, and efforts in another.
#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/usb/device.h"
#include "sim/usb/report_layout.h"

namespace hapticd::sim::usb {

struct ReportBoardOptions {
  std::uint16_t vendor = 0x1234, product_id = 0x0006;
  std::string manufacturer = "hapticd", product = "report board", serial = "";
  Speed speed = Speed::full;
  std::uint8_t interval = 1;  ///< bInterval

  struct Interface {
    std::uint16_t usage_page = 0xffab, usage = 0x0200;
    std::optional<std::uint8_t> in_id{}, out_id{};
    std::size_t in_bytes = 8, out_bytes = 8;  ///< without the id; 0: no such report
    std::uint8_t in_endpoint = 1,
                 out_endpoint = 1;  ///< 0: none; reports out then come by SET_REPORT
  };
  std::vector<Interface> interfaces = {
      {}};  ///< the first is the board, others are there and silent

  // -- in
  std::vector<ReportField> positions{};   ///< one a motor [counts]
  std::vector<ReportField> buttons{};     ///< pressed: 1
  std::vector<ReportField> analogue{};    ///< raw
  std::optional<ReportField> sequence{};  ///< one more in each report

  // -- out
  struct Effort {
    ReportField field{};
    double per_raw = 1e-3;  ///< torque or force of the motor
    double most = 1e9;
  };
  std::vector<Effort> efforts{};  ///< one a motor
  std::optional<ReportField>
      heartbeat{};  ///< a report that has the same as the one before does not feed the watchdog
  double watchdog_s = 0;      ///< motors off without a report for so long; 0: never
  bool oldest_first = false;  ///< takes one report an interval, the oldest; else each at once
  std::size_t queue = 1;      ///< reports that wait in it then; more are not taken
};

/// mbed LPC1768 with three encoders and amplifiers; torque in A.
ReportBoardOptions wooden_haptics();
/// 64 bytes each way. In: word 0 sequence number, counts as int32 from byte 4, word 20 buttons. Out: mN or mN m as int16
/// from byte 0, byte 63 heartbeat.
ReportBoardOptions teensy_raw_hid(std::size_t motors = 2);

/// Motors: encoder counts; torque in the unit of `per_raw`.
class ReportBoard final : public Device {
 public:
  explicit ReportBoard(const ReportBoardOptions& options);

  Speed speed() const override { return options_.speed; }
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
  std::int64_t next_ns() const override;
  void replug(bool power_lost, std::int64_t now_ns) override;
  std::size_t motors() const override { return motors_.size(); }
  Motor& motor(std::size_t i) override { return motors_[i]; }

  void set_button(std::size_t i, bool pressed) { buttons_[i] = pressed ? 1 : 0; }
  void set_analogue(std::size_t i, std::int64_t raw) { analogue_[i] = raw; }
  bool power_on() const { return on_; }
  std::uint64_t reports_taken() const { return taken_; }

 private:
  class Channel final : public Motor {
   public:
    double torque() const override { return enabled_ ? torque_ : 0; }
    bool enabled() const override { return enabled_; }
    void move_to(double counts, double) override { counts_ = counts; }

   private:
    friend class ReportBoard;
    double counts_ = 0, torque_ = 0;
    bool enabled_ = false;
  };

  std::vector<std::uint8_t> report();
  void obey(std::span<const std::uint8_t> report, std::int64_t now_ns);
  Answer take(std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  void power(bool on);
  std::int64_t interval_ns() const;
  std::int64_t expires_ns() const;

  ReportBoardOptions options_;
  std::vector<Channel> motors_;
  std::vector<std::int64_t> buttons_, analogue_;
  std::deque<std::vector<std::uint8_t>> waiting_;
  std::int64_t sequence_ = 0, heartbeat_ = -1;
  std::int64_t fed_ns_ = 0, takes_next_ns_ = 0;
  std::uint64_t taken_ = 0;
  bool on_ = false;
};

}  // namespace hapticd::sim::usb
