// Fields act on the proxy without a surface. Each gives its force at a point and how that force
// falls off there; potentials are energies that the descent check counts.
//
// evaluate(field, y, step, period): `step` is how far the proxy came in this tick [m] relative to
// the field (backward difference: velocity = step / period). Coordinates as for shapes.
#pragma once
#include <cstdint>

#include "control/core/vec3.h"

namespace hapticd::control {

struct FieldValue {
  Vec3 force{};       ///< N, on the proxy
  Mat3 stiffness{};   ///< N/m, symmetric and >= 0: -d force/d y, its negative part left out
  double energy = 0;  ///< J: the potential; 0 for what only dissipates or drives
};

/// Region of a field: a ball. Infinite radius: everywhere.
struct Region {
  Vec3 centre{};
  double radius = 0;  ///< m, > 0, infinity allowed
};

/// Force -damping * velocity inside the region.
struct ViscousField {
  Region region{};
  double damping = 0;  ///< N s/m, >= 0
};

/// A constant force F that fades towards the edge of its region so that it is a potential, r the
/// distance from the centre, R the radius:
///   U = -F.(y - centre) (1 - (r/R)^2)^2,  0 from R on;  R infinite: U = -F.(y - centre), force F
struct ConstantField {
  Region region{};
  Vec3 force{};  ///< N
};

/// Pulls to rest places along a direction, one every `spacing`:
///   U = max_force spacing / (2 pi) (1 - cos(2 pi (along.y - offset) / spacing))
/// Half a spacing beyond the first and the last place, where the force is 0, it stays 0.
struct Detents {
  Vec3 along{};             ///< unit
  double offset = 0;        ///< m: a rest place
  double spacing = 0;       ///< m, > 0
  double max_force = 0;     ///< N, >= 0
  std::uint32_t count = 0;  ///< places, from `offset` on; 0: without end on both sides
};

/// Pulls to the surface of a ball (radius 0: to a point) from either side of it, p the distance to
/// that surface:
///   U = -(3 sqrt 3 / 8) max_force range (1 - p^2 / range^2)^2 for |p| < range, else 0
///   pull = (3 sqrt 3 / 2) max_force (p / range) (1 - p^2 / range^2)
/// The pull is max_force at p = range / sqrt 3, and ends without a step. In the centre of a ball that
/// has a radius it has no direction and is 0.
struct Magnet {
  Vec3 centre{};
  double radius = 0;     ///< m, >= 0
  double range = 0;      ///< m, > 0
  double max_force = 0;  ///< N, >= 0: the largest pull
};

/// A force that swings: force * sin(2 pi frequency t + phase) inside the region. Active: it may do
/// work, which is booked.
struct Vibration {
  Region region{};
  Vec3 force{};          ///< N, amplitude
  double frequency = 0;  ///< Hz, > 0
  double phase = 0;      ///< rad
};

FieldValue evaluate(const ViscousField& field, const Vec3& y, const Vec3& step,
                    double period) noexcept;
FieldValue evaluate(const ConstantField& field, const Vec3& y) noexcept;
FieldValue evaluate(const Detents& field, const Vec3& y) noexcept;
FieldValue evaluate(const Magnet& field, const Vec3& y) noexcept;
FieldValue evaluate(const Vibration& field, const Vec3& y, double time_s) noexcept;

/// Largest eigenvalue of the potential's second derivative anywhere [N/m]; what rendering the
/// field directly asks of the device (control/design/check/stability.h).
double steepest(const ConstantField& field) noexcept;
double steepest(const Detents& field) noexcept;
double steepest(const Magnet& field) noexcept;

}  // namespace hapticd::control
