#include "control/scene/fields.h"

#include <algorithm>
#include <numbers>

namespace hapticd::control {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// The magnet's stiffness on the surface, times range / max_force: p (1 - p^2) is 2 / (3 sqrt 3) at
/// most.
constexpr double kMagnetSlope = 1.5 * std::numbers::sqrt3;

bool within(const Region& region, const Vec3& y) noexcept {
  return squared_norm(y - region.centre) < region.radius * region.radius;
}

/// m + s v v'.
Mat3 plus_outer(Mat3 m, double s, const Vec3& v) noexcept {
  for (std::size_t i = 0; i < 3; ++i) m.row[i] += (s * v[i]) * v;
  return m;
}

/// Sine and cosine of a phase in turns, whole turns taken off first: exact far from the origin.
struct Swing {
  double sine, cosine;
};
Swing swing(double turns) noexcept {
  const double angle = kTurn * (turns - std::round(turns));
  return {std::sin(angle), std::cos(angle)};
}

/// A symmetric matrix of two rows: (a b; b c).
struct Mat2 {
  double a, b, c;
};

/// Without its negative eigenvalue: with eigenvalues m -+ s, s > |m|, M = (m + s) P + (m - s)(1 - P),
/// so P = (M - (m - s)) / 2 s projects on the positive one.
Mat2 without_negative(const Mat2& m) noexcept {
  const double mean = 0.5 * (m.a + m.c), half = 0.5 * (m.a - m.c);
  const double spread = std::sqrt(half * half + m.b * m.b);
  const double low = mean - spread, high = mean + spread;
  if (low >= 0) return m;
  if (high <= 0) return {};
  const double share = high / (2 * spread);
  return {share * (m.a - low), share * m.b, share * (m.c - low)};
}

}  // namespace

FieldValue evaluate(const ViscousField& field, const Vec3& y, const Vec3& step,
                    double period) noexcept {
  if (!within(field.region, y)) return {};
  const double rate = field.damping / period;
  return {.force = -rate * step, .stiffness = diagonal(rate)};
}

// With d = y - centre, w = (1 - d^2/R^2)^2, q = 4 (1 - d^2/R^2) / R^2:
//
//   U = -(F.d) w,  grad w = -q d,  force = F w - (F.d) q d
//   Hessian of U = q (F d' + d F' + (F.d)) - 8 (F.d) / R^4 d d'
//
// F = f1 e1 + f2 e2 with e1 along d: (F.d) q is the eigenvalue across the plane of e1 and e2, in
// which the rest is a matrix of two rows.
FieldValue evaluate(const ConstantField& field, const Vec3& y) noexcept {
  if (!within(field.region, y)) return {};
  const Vec3 d = y - field.region.centre;
  const double square = squared_norm(d),
               per_square = 1 / (field.region.radius * field.region.radius);
  const double inner = 1 - square * per_square, weight = inner * inner;
  const double q = 4 * inner * per_square, work = dot(field.force, d);
  FieldValue value{.force = weight * field.force - (work * q) * d, .energy = -work * weight};
  const double distance = std::sqrt(square);
  if (!(distance > 0)) return value;

  const Vec3 e1{d.x / distance, d.y / distance, d.z / distance};
  const double f1 = dot(field.force, e1);
  const Vec3 across = field.force - f1 * e1;
  const double f2 = norm(across);
  const Vec3 e2 = f2 > 0 ? (1 / f2) * across : Vec3{};
  const double aside = q * work;
  const Mat2 plane = without_negative(
      {3 * aside - 8 * work * square * per_square * per_square, q * distance * f2, aside});
  const double out = std::max(0.0, aside);
  value.stiffness = plus_outer(plus_outer(diagonal(out), plane.a - out, e1), plane.c - out, e2);
  for (std::size_t i = 0; i < 3; ++i)
    value.stiffness.row[i] += (plane.b * e1[i]) * e2 + (plane.b * e2[i]) * e1;
  return value;
}

FieldValue evaluate(const Detents& field, const Vec3& y) noexcept {
  const double places = (dot(field.along, y) - field.offset) / field.spacing;
  const double height = field.max_force * field.spacing / kTurn;
  if (field.count > 0 && !(places > -0.5 && places < field.count - 0.5))
    return {.energy = 2 * height};
  const Swing at = swing(places);
  const double stiffness = std::max(0.0, steepest(field) * at.cosine);
  return {.force = (-field.max_force * at.sine) * field.along,
          .stiffness = plus_outer({}, stiffness, field.along),
          .energy = height * (1 - at.cosine)};
}

// dU/dp = k p (1 - p^2/range^2), k = steepest(); d2U/dp2 = k (1 - 3 p^2/range^2) along the radius,
// dU/dp / r across it.
FieldValue evaluate(const Magnet& field, const Vec3& y) noexcept {
  const Vec3 d = y - field.centre;
  const double reach = field.radius + field.range, square = squared_norm(d);
  if (square >= reach * reach) return {};
  const double distance = std::sqrt(square), p = distance - field.radius;
  const double share = p / field.range, left = 1 - share * share;
  if (left <= 0) return {};
  const double k = steepest(field);
  FieldValue value{.energy = -0.25 * k * field.range * field.range * left * left};
  if (!(distance > 0)) {
    if (field.radius == 0) value.stiffness = diagonal(k);
    return value;
  }
  const Vec3 outwards{d.x / distance, d.y / distance, d.z / distance};
  const double along = std::max(0.0, k * (1 - 3 * share * share));
  const double across = std::max(0.0, k * left * (p / distance));
  value.force = (-k * p * left) * outwards;
  value.stiffness = plus_outer(diagonal(across), along - across, outwards);
  return value;
}

FieldValue evaluate(const Vibration& field, const Vec3& y, double time_s) noexcept {
  if (!within(field.region, y)) return {};
  const double turns = field.frequency * time_s;
  const double angle = kTurn * (turns - std::floor(turns)) + field.phase;
  return {.force = std::sin(angle) * field.force};
}

// The Hessian's largest eigenvalue is at the edge, against the force: 8 |F| / R.
double steepest(const ConstantField& field) noexcept {
  return 8 * norm(field.force) / field.region.radius;
}

double steepest(const Detents& field) noexcept {
  return kTurn * field.max_force / field.spacing;
}

double steepest(const Magnet& field) noexcept {
  return kMagnetSlope * field.max_force / field.range;
}

}  // namespace hapticd::control
