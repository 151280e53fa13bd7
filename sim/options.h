// The truth of a simulated device: what its plant, hand and wires really are. Filled by config/,
// read by nobody else: no analysis and no compile of a plan may look at it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace hapticd::sim {

/// One axis: mass and damper with Coulomb friction behind an encoder and a D/A converter.
struct AxisOptions {
  double mass_kg = 0;       ///< > 0
  double damping_Ns_m = 0;  ///< >= 0
  double coulomb_N = 0;     ///< >= 0
  double delay_s = 0;       ///< command to force, >= 0, may exceed a period
  double position_m = 0;    ///< at start, at rest
  double counts_per_m =
      1e9;  ///< not 0; negative: reversed. The value is floor(position * counts_per_m + noise)
  int encoder_bits = 32;    ///< the value wraps into [0, 2^bits); up to 52; 0: never
  double noise_counts = 0;  ///< standard deviation of the encoder noise
  double dac_step_N = 0;    ///< effort is rounded to multiples of this; 0: exact
  double max_effort_N = 0;  ///< saturation, > 0
};

/// One line of the hand's script: from `at_s` on. Lines are in the order of their times, which are
/// rounded to sub-steps.
struct ScriptStep {
  double at_s = 0;        ///< counted from the end of the start ramp
  double force_N = 0;     ///< held until the next step, added to the hand's own spring and damper
  double position_m = 0;  ///< where the hand's spring wants the axis; linear between steps
};

/// A passive hand held on every axis of the device: its mass moves with the axis, its spring pulls
/// to where the script says, its damper goes to ground. The script starts from rest where the
/// device starts, each time power comes on.
struct HandOptions {
  double mass_kg = 0;
  double stiffness_N_m = 0;
  double damping_Ns_m = 0;
  std::vector<ScriptStep> script;  ///< empty: at rest where the device starts
};

/// What a scripted failure does to a device; for rehearsals, from the first tick at or after `at_s`
/// of device time.
enum class FailureKind : std::uint8_t {
  nan,      ///< the axis reports NaN
  stuck,    ///< the axis repeats its last value and calls it fresh
  jump,     ///< the axis reports `size_m` too much
  missing,  ///< the axis reports no sample
  disarm,   ///< the power stage drops out, and stays off until it is asked for again
  fault,    ///< the device reports that it cannot go on
  slow,     ///< collect burns `for_s` of processor time, once
};

struct Failure {
  FailureKind kind = FailureKind::nan;
  std::size_t axis = 0;
  double at_s = 0;    ///< counted from the first tick
  double for_s = 0;   ///< how long; one tick at least
  double size_m = 0;  ///< jump only
};

struct DeviceOptions {
  std::string name;
  double period_s = 1e-3;
  double ramp_s = 0;  ///< the script starts this long after the device was armed
  int substeps = 10;  ///< of a tick: friction is solved, and extremes are observed, at these points
  std::uint64_t seed = 1;
  std::vector<AxisOptions> axes;
  HandOptions hand;
  std::vector<Failure> failures;
};

}  // namespace hapticd::sim
