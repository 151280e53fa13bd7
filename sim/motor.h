// One motor with its encoder, between the electronics of an emulated device and its mechanics.
#pragma once

namespace hapticd::sim {

class Motor {
 public:
  virtual ~Motor() = default;
  /// That it makes now, in the unit that the electronics think in; 0 unless the power stage is on.
  virtual double torque() const = 0;
  /// Power stage on, follows what it is told.
  virtual bool enabled() const = 0;
  /// The mechanics tell where it is: turns, or counts, and their rate.
  virtual void move_to(double turns, double turns_s) = 0;
};

}  // namespace hapticd::sim
