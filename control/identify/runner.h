// One axis being identified, tick by tick: position in, effort out. It first finds out for a second what
// effort holds the axis against its weight, and goes on with that. It centres the axis with a weak
// spring and a damper of a few periods, so that it does not creep out of its travel, adds the
// excitation, and holds the bounds: force by saturation, travel and speed by ending with zero effort
// and the reason. All that was sampled and delivered is recorded; to the fit the spring is part of the
// effort.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "control/identify/excitation.h"
#include "control/identify/record.h"

namespace hapticd::identify {

enum class Ended : std::uint8_t { running, complete, too_far, too_fast, no_samples };

class Runner {
 public:
  /// Set-up: reserves all that it will record.
  Runner(const ExcitationOptions& options, double period_s);

  /// The effort of this tick; 0 once ended(). `fresh`: the position is of this tick.
  double tick(double position, bool fresh) noexcept;
  /// What the wire could carry of it. Call once after each tick().
  void delivered(double effort) noexcept;

  Ended ended() const noexcept { return ended_; }
  /// For people: what was exceeded, by how much, at which frequency.
  std::string why() const;
  const Excitation& excitation() const noexcept { return excitation_; }
  double progress() const noexcept { return excitation_.progress(); }
  const Record& record() const noexcept { return record_; }
  /// Of a stepped sine, in ticks of record().
  std::vector<Measured> measured() const;

 private:
  void see(double position, bool fresh) noexcept;
  double velocity() const noexcept;
  double weigh(double deviation, double velocity) noexcept;
  double bounded(double effort) const noexcept;
  double centring(double share, double deviation, double velocity) const noexcept;
  void hold_bounds(double deviation, double velocity) noexcept;

  ExcitationOptions options_;
  Excitation excitation_;
  Record record_;
  Ended ended_ = Ended::running;
  double middle_ = 0;
  double found_ = 0;       ///< what ended it
  std::size_t begin_ = 0;  ///< sample of the first tick of the excitation
  std::size_t missing_ = 0;
  std::array<double, 5> last_{};  ///< positions, newest first
  double weight_ = 0;             ///< effort that holds the axis where it is
};

}  // namespace hapticd::identify
