// Joints <-> contact, in the world frame.
//
//   x = origin + turn p(q),  v = J qd,  tau = J' f,  J = turn dp/dq
//
// p is the tip in the device's own frame, `turn` the rows of scale * rotation for the world
// directions that the contact has. So a scaled workspace keeps power: f.v = tau.qd.
//
// A Cartesian device whose axes lie along world directions is a row of CartesianAxis per axis and
// has no Jacobian. Every other device is one Linkage and one entry in the array of its kind, which
// fills tip and dp/dq.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "control/core/capacity.h"
#include "control/core/findings.h"

namespace hapticd::control {

struct Plan;
struct State;

/// An axis that is a coordinate of its contact: x = scale q + origin, effort = scale force.
struct CartesianAxis {
  std::uint16_t axis = 0;
  std::uint16_t coordinate = 0;
  double scale = 1;   ///< != 0; negative: the axis runs against the world direction
  double origin = 0;  ///< m
};

/// What a device with a Jacobian has whatever its kind.
struct Linkage {
  std::uint16_t device = 0;
  std::uint16_t first_axis = 0;
  std::uint16_t axes = 0;  ///< 1 to kMaxJoints
  std::uint16_t first_coordinate = 0;
  std::uint16_t coordinates = 0;  ///< 1 to 3
  std::uint32_t jacobian =
      0;  ///< where its coordinates x axes block begins in State::jacobian, row-major
  std::array<double, 3> origin{};               ///< m, of the contact's coordinates
  std::array<std::array<double, 3>, 3> turn{};  ///< coordinates x 3 (device frame)
  /// Of J, Frobenius: no force beyond it, fading from half of it on; infinity: J is never singular.
  double max_condition = 20;
  bool rotary = false;  ///< joints are angles
};

/// Cartesian axes in a turned frame: dp/dq is constant.
struct LinearMap {
  std::uint16_t linkage = 0;
  std::array<std::array<double, kMaxJoints>, 3> columns{};  ///< dp/dq, 3 x axes
};

/// Planar five-bar, equal links, elbows out, tip on the upper branch (device frame: z = 0).
/// Bases at (-base/2, 0) and (base/2, 0). q = angles of the two inner links from +x.
struct FiveBar {
  std::uint16_t linkage = 0;
  double link_m = 0;
  double base_m = 0;
};

/// Delta with three legs, each a driven arm and a parallelogram (Novint Falcon; Tsai and Stamper
/// 1996). Lengths in m; leg i stands at `leg[i]` (cos, sin) around z.
struct Delta {
  std::uint16_t linkage = 0;
  double a = 0, b = 0, c = 0, d = 0, e = 0, f = 0, r = 0, s = 0;
  std::array<std::array<double, 2>, 3> leg{};
  std::array<double, 3> home{};  ///< m: where the first forward solution starts
};

/// One joint of a serial chain in standard Denavit-Hartenberg form: about (or along) z_{i-1} by
/// theta + q (d + q), then a along x_i and a twist about it.
struct DhJoint {
  double theta = 0, d = 0, a = 0;  ///< rad, m, m
  double cos_twist = 1, sin_twist = 0;
  bool prismatic = false;
  double mass = 0;                 ///< kg of the link behind it, for gravity compensation
  std::array<double, 3> center{};  ///< m: its centre of mass in the frame behind the joint
};

struct Serial {
  std::uint16_t linkage = 0;
  std::uint16_t joints = 0;
  std::array<double, 3> gravity{};  ///< m/s^2, device frame: compensated where links have masses
  std::array<DhJoint, kMaxJoints> joint{};
};

/// Tip [m] and dp/dq (3 x axes) in the device's own frame.
struct LinkagePose {
  std::array<double, 3> tip{};
  std::array<std::array<double, kMaxJoints>, 3> jacobian{};
};

// Forward kinematics of one linkage: `q` has its axes' positions. False where no pose fits them;
// `pose` is then left alone. For a delta pose.tip is where the iteration starts.
bool pose_of(const LinearMap& map, const double* q, LinkagePose& pose) noexcept;
bool pose_of(const FiveBar& bars, const double* q, LinkagePose& pose) noexcept;
bool pose_of(const Delta& delta, const double* q, LinkagePose& pose) noexcept;
bool pose_of(const Serial& chain, const double* q, LinkagePose& pose) noexcept;

// Inverse kinematics where it is closed. False: out of reach.
bool joints_of(const FiveBar& bars, const std::array<double, 3>& tip, double* q) noexcept;
bool joints_of(const Delta& delta, const std::array<double, 3>& tip, double* q) noexcept;

/// Efforts that hold the links of a serial chain against `gravity` [m/s^2, device frame].
void holding_efforts(const Serial& chain, const double* q, const std::array<double, 3>& gravity,
                     double* effort) noexcept;

struct LinkageState {
  std::array<double, 3> tip{};  ///< m, device frame: where the next forward solution starts
};

/// q, qd -> x, v and the Jacobians. Sets state.reach (0 to 1 per device: 1 well inside the
/// workspace, 0 where J is singular) and Limit::singular; where no pose fits the joints it keeps
/// the last one and reports Fault::kinematics.
void forward(const Plan& plan, State& state, Findings& findings) noexcept;

/// effort = J' force for every device. `force` by contact coordinate, `effort` by axis.
void transpose(const Plan& plan, const State& state, std::span<const double> force,
               std::span<double> effort) noexcept;

/// The contact force that `effort` of a device stands for: the solution of J' f = effort with the
/// Jacobian of the last forward(). False where J is not square or has no inverse.
bool contact_force(const Plan& plan, const State& state, std::size_t device, const double* effort,
                   double* force) noexcept;

}  // namespace hapticd::control
