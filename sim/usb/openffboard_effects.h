// Force effects of an OpenFFBoard: what plays, for how long, and the sum on each axis.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "sim/usb/biquad.h"
#include "sim/usb/openffboard_wire.h"

namespace hapticd::sim::usb {

/// Constant force only: others take a place and make no force. Times are the board's ticks [ms].
class OpenffboardEffects {
 public:
  static constexpr std::size_t kEffects = 40, kAxes = 2;
  static constexpr std::uint16_t kEffectBytes = 80;
  static constexpr std::uint8_t kConstant = 1, kTypes = 12;
  static constexpr std::uint16_t kForEver = 0xffff;
  static constexpr std::int32_t kFull = 0x7fff;

  explicit OpenffboardEffects(std::size_t axes);

  // -- reports
  void create(std::uint8_t type);
  void set(const OpenffboardSetEffect& effect);
  void set(const OpenffboardConstant& force);
  void operate(const OpenffboardOperation& operation, std::uint32_t tick_ms);
  void free(std::uint8_t index);
  void control(
      std::uint8_t bits);  ///< 01 enable, 02 disable, 04 stop, 08 reset, 10 pause, 20 continue
  void set_gain(std::uint8_t gain) { gain_ = gain; }
  std::vector<std::uint8_t> block_load() const;
  std::vector<std::uint8_t> pool() const;
  std::vector<std::uint8_t> state() const;

  /// [Hz] of the low pass of constant forces; half the rate of 1 kHz: none.
  std::uint32_t filter_Hz() const { return filter_Hz_; }
  void set_filter_Hz(std::int64_t frequency);
  std::uint8_t filter_q() const { return filter_q_; }
  void set_filter_q(std::int64_t hundredths);

  void switch_on(bool on) { active_ = on; }
  void reset();
  bool active() const { return active_; }
  bool playing(std::size_t index) const { return effects_.at(index - 1).playing; }

  /// Sum on each axis, clipped to the full scale; what has lasted its time ends.
  std::array<std::int32_t, kAxes> forces(std::uint32_t tick_ms);

 private:
  struct Effect {
    bool playing = false;
    std::uint8_t type = 0, gain = 255;
    std::int16_t magnitude = 0;
    std::array<float, kAxes> factors{};
    std::uint16_t duration_ms = kForEver, delay_ms = 0;
    std::uint32_t start_ms = 0;
    std::array<Biquad, kAxes> filters{};
  };

  Effect* at(std::uint8_t index);
  void set_filters(Effect& effect) const;
  static bool waits_or_ends(Effect& effect, std::uint32_t tick_ms);

  std::size_t axes_;
  std::array<Effect, kEffects> effects_{};
  std::uint8_t gain_ = 255;
  bool active_ = false;
  std::uint32_t filter_Hz_ = 500;
  std::uint8_t filter_q_ = 70;
  std::uint8_t loaded_index_ = 1, load_status_ = 1;
  std::size_t used_ = 0;
};

}  // namespace hapticd::sim::usb
