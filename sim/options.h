// The truth of a simulated device: what its plant, hand and wires really are. Filled by config/,
// read by nobody else: no analysis and no compile of a plan may look at it.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "control/kinematics/kinematics.h"

namespace hapticd::sim {

/// Mechanical ends of an axis: stiff, lossy springs (sim/end_stops.h).
struct StopOptions {
  double min_m = 0;
  double max_m = 0;  ///< > min_m; the axis starts between them
};

/// One axis: mass and damper with Coulomb friction behind an encoder and a D/A converter. For a
/// rotary axis read rad for m, N m for N, kg m^2 for kg.
struct AxisOptions {
  double mass_kg = 0;       ///< > 0
  double damping_Ns_m = 0;  ///< >= 0
  double coulomb_N = 0;     ///< >= 0
  double delay_s = 0;       ///< command to force, >= 0, may exceed a period
  double position_m = 0;    ///< at start, at rest
  double counts_per_m =
      1e9;  ///< not 0; negative: reversed. The value is floor((position - zero) * counts_per_m +
            ///< noise)
  double zero_m = 0;                   ///< position at which the encoder reads 0
  int encoder_bits = 32;               ///< the value wraps into [0, 2^bits); up to 52; 0: never
  double noise_counts = 0;             ///< standard deviation of the encoder noise
  double dac_step_N = 0;               ///< effort is rounded to multiples of this; 0: exact
  double max_effort_N = 0;             ///< saturation, > 0
  bool relative = false;               ///< the encoder reads 0 where the axis is at connect()
  std::optional<double> index_m{};     ///< position of the encoder's index pulse
  std::optional<StopOptions> stops{};  ///< none: it moves freely
  double homed_at_s = 0;               ///< the device says `homed` from this device time on
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

/// A digital input of the device from `at_s` of device time on.
struct DigitalStep {
  double at_s = 0;
  std::uint32_t bits = 0;
};

/// A force sensor between hand and device: Aux::analogue has the hand's force on axis i, or that on
/// the tip of a linkage in the device frame. Without one it stays 0.
struct ForceSensorOptions {
  double noise_N = 0;  ///< standard deviation
};

/// Axes that are joints of one linkage with a tip; position_m is where a joint starts, in the
/// linkage's own angle or length. AxisOptions::mass_kg is the inertia at the joint (motor, and of
/// the links what is not named here). The links of a serial chain are point masses where its
/// DhJoint says. The hand holds the tip: its mass moves with it, its spring pulls along
/// hand_direction, towards the script's position_m from where the tip starts, its damper acts on
/// all of the tip's velocity. It carries its own weight.
struct LinkageOptions {
  std::variant<control::LinearMap, control::FiveBar, control::Delta, control::Serial> geometry;
  double inner_link_kg = 0;  ///< five-bar: uniform rods from base to elbow
  double outer_link_kg = 0;  ///< five-bar: uniform rods from elbow to tip
  double tip_kg = 0;
  std::array<double, 3> gravity{};  ///< m/s^2, device frame
  std::array<double, 3> hand_direction{
      1, 0, 0};  ///< unit vector, device frame: of the script's force and position
};

struct DeviceOptions {
  std::string name{};
  double period_s = 1e-3;
  double ramp_s = 0;  ///< the script starts this long after the device was armed
  int substeps = 10;  ///< of a tick: friction is solved, and extremes are observed, at these points
  std::uint64_t seed = 1;
  std::vector<AxisOptions> axes;
  HandOptions hand;
  std::vector<Failure> failures;
  std::optional<LinkageOptions> linkage{};  ///< none: axes are independent of each other
  std::optional<ForceSensorOptions> force_sensor{};
  std::vector<DigitalStep> digital{};  ///< in the order of their times
};

/// An axis that a shared hand holds.
struct HeldAxis {
  std::size_t device = 0;   ///< index among all devices
  std::size_t axis = 0;     ///< of that device
  double velocity_m_s = 0;  ///< at start
};

/// A linear hand that holds axes of several devices at once: two hands of one person, fingers of
/// one hand. With v the velocities of `axes` [m/s], in their order, -F acts on them [N]:
///
///   xi' = A xi + B v,   F = C xi + D v,   xi = 0 at start
///
/// It need not be passive. Matrices by rows, n = states, m = axes.size(). The devices that it
/// touches have axes without linkage, Coulomb friction and stops and no hand of their own; axes of
/// theirs that it does not name move beside it. Its devices share period_s and substeps.
struct SharedHandOptions {
  std::vector<HeldAxis> axes;
  std::size_t states = 0;  ///< up to 64
  std::vector<double> A;   ///< n x n
  std::vector<double> B;   ///< n x m
  std::vector<double> C;   ///< m x n
  std::vector<double> D;   ///< m x m
};

}  // namespace hapticd::sim
