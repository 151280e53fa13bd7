// What moves the axis: a sine whose frequency goes from high to low, in steps or as a chirp, and
// whose amplitude is found as it goes.
//
// Nothing is known of the axis, so the amplitude starts at a hundredth of the force allowed and
// grows from period to period until motion, speed or force has the share of its limit that it may
// take. From high to low, because a mass moves by F / (m w^2): going down, the amplitude is cut by
// the square of the ratio, so no step can move the axis further than the one before. It only
// changes where the sine is zero, and fades out at the end: nothing kicks.
//
// A stepped sine stands still in frequency and amplitude while it is measured, over blocks of whole
// periods and whole ticks.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hapticd::identify {

enum class Method { stepped, chirp };

struct ExcitationOptions {
  Method method = Method::stepped;
  double low_Hz = 1;
  double high_Hz = 40;   ///< > low_Hz
  int steps = 12;        ///< frequencies of a stepped sine, >= 2, by equal ratios
  int blocks = 8;        ///< measured at each, >= 2: coherence compares them
  double block_s = 0.1;  ///< length of a block, at least; one period at least
  int sweeps = 6;        ///< of a chirp, down and up in turn
  double sweep_s = 4;    ///< length of each
  double force = 0;      ///< N or N m, > 0: greatest amplitude
  double travel = 0;     ///< m or rad, > 0: greatest deviation from the middle
  double speed = 0;      ///< m/s or rad/s, > 0: greatest
};

/// Where a frequency was measured, in ticks since the excitation began.
struct Measured {
  double frequency_Hz = 0;
  int periods = 1;  ///< in a block
  std::size_t begin = 0;
  std::size_t block_ticks = 0;
  int blocks = 0;
  std::size_t ticks() const noexcept { return block_ticks * static_cast<std::size_t>(blocks); }
};

class Excitation {
 public:
  Excitation(const ExcitationOptions& options, double period_s);

  /// The next effort; `deviation` from the middle and `velocity` as they are now.
  double next(double deviation, double velocity) noexcept;
  bool done() const noexcept { return stage_ == Stage::done; }
  double progress() const noexcept;  ///< 0 to 1
  double frequency_Hz() const noexcept { return turns_per_tick_ / period_s_; }
  double amplitude() const noexcept { return amplitude_; }
  /// Of a stepped sine.
  const std::vector<Measured>& measured() const noexcept { return measured_; }
  /// At most; to reserve storage.
  std::size_t longest_ticks() const noexcept;

 private:
  enum class Stage : std::uint8_t { adjusting, settling, measuring, sweeping, fading, done };
  struct Tone {
    int periods = 1;
    std::size_t block_ticks = 1;
    double turns_per_tick() const noexcept {
      return static_cast<double>(periods) / static_cast<double>(block_ticks);
    }
  };
  void plan_tones();
  void enter(Stage stage) noexcept;
  double left_of_fade() const noexcept;
  void begin_tone() noexcept;
  void begin_measuring() noexcept;
  void sweep() noexcept;
  void move_as_far(double ratio) noexcept;
  double wanted_growth() const noexcept;
  void end_of_half() noexcept;
  void end_of_period() noexcept;

  ExcitationOptions options_;
  double period_s_;
  std::vector<Tone> tones_;
  std::vector<Measured> measured_;
  Stage stage_ = Stage::adjusting;
  std::size_t tone_ = 0;
  std::size_t tick_ = 0;
  std::size_t stage_ticks_ = 0;  ///< since the stage began
  int stage_periods_ = 0;
  int tone_periods_ = 0;  ///< at this frequency: it is not adjusted for ever
  double turns_per_tick_ = 0;
  double period_turns_per_tick_ = 0;  ///< when the last period ended
  double phase_ = 0;                  ///< turns, 0 to 1
  double amplitude_ = 0;
  double peak_ = 0;        ///< greatest deviation since the last period began
  double peak_speed_ = 0;  ///< likewise
  double half_peak_ = 0;   ///< greatest deviation since the last half of one
  double half_peak_speed_ = 0;
};

}  // namespace hapticd::identify
