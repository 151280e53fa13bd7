// An axis of an OpenFFBoard: its settings and the torque that it makes of effects and of itself.
#pragma once
#include <cstdint>
#include <optional>

#include "sim/motor.h"
#include "sim/usb/biquad.h"

namespace hapticd::sim::usb {

/// Settings at power-up; but for `power` and `invert` as the firmware has them.
struct OpenffboardAxisOptions {
  double full_torque_Nm = 1;  ///< of the motor at the full scale of 32767
  std::uint32_t cpr = 65536;  ///< encoder
  std::uint16_t power = 32767, degrees = 900;
  std::uint8_t idlespring = 127, damper = 30, friction = 0, inertia = 0, fxratio = 204,
               esgain = 127;
  int expo = 0;
  bool invert = false;
  double fade_in_s = 0;  ///< torque rises from 0 after plugging in; the firmware takes 2 s
};

class OpenffboardAxis final : public Motor {
 public:
  explicit OpenffboardAxis(const OpenffboardAxisOptions& options);

  double torque() const override;
  bool enabled() const override { return motor_on_; }
  void move_to(double counts, double counts_s) override;

  // -- a cycle of 1 ms
  void measure();
  /// `effects`: their sum, -32767..32767.
  void drive(bool actuators, bool emergency, std::int32_t effects);
  /// Of X or Y in the report of the game pad.
  std::int16_t pad() const;

  // -- settings, by command number; nothing: there is none that can be read, or written
  bool knows(std::uint32_t command) const;
  std::optional<std::int64_t> read(std::uint32_t command) const;
  bool write(std::uint32_t command, std::int64_t value);

  void power_up();  ///< settings as after boot
  void plugged_in();

 private:
  void set_expo(std::int64_t value);
  std::int32_t own_torque(bool actuators);
  std::int32_t end_stop() const;
  std::int32_t encoder() const;
  std::int32_t scaled(double degrees) const;

  OpenffboardAxisOptions options_, now_;
  double counts_per_degree_;
  double at_counts_ = 0;
  std::int32_t zero_encoder_ = 0;
  std::uint16_t wanted_degrees_;
  double expo_ = 1;
  std::int64_t expo_scale_ = 50, max_speed_ = 0, max_rate_ = 0;
  double degrees_ = 0, speed_ = 0, accel_ = 0, last_speed_ = 0;
  Biquad speed_filter_, accel_filter_, damper_filter_, friction_filter_, inertia_filter_;
  std::int32_t torque_ = 0, limited_from_ = 0;
  double fade_ = 1;
  bool motor_on_ = true, out_of_bounds_ = false, measured_ = false;
};

}  // namespace hapticd::sim::usb
