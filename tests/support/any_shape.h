// Bodies of any size, place and pose for property tests, and the signed distance to each: < 0
// inside, and written without faces that are held, normals or `from`.
#pragma once
#include <rapidcheck.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "control/scene/shapes.h"

namespace hapticd::test::body {

using namespace control;

/// Doubles without ties, from a seed that is shown when a property fails.
class Random {
 public:
  Random() : engine_(*rc::gen::arbitrary<std::uint64_t>()) {}
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Vec3 vector(double size) {
    return {number(-size, size), number(-size, size), number(-size, size)};
  }
  Vec3 unit() {
    std::normal_distribution<double> n;
    const Vec3 v{n(engine_), n(engine_), n(engine_)};
    return (1 / norm(v)) * v;
  }
  Mat3 turn() {
    const Vec3 a = unit();
    Vec3 b = cross(a, unit());
    b = (1 / norm(b)) * b;
    return {{{a, b, cross(a, b)}}};
  }

 private:
  std::mt19937_64 engine_;
};

inline double over(double a) {
  return std::max(a, 0.0);
}

/// Of a box of N half lengths, from |coordinates|: < 0 inside.
template <std::size_t N>
double distance_to_box(const std::array<double, N>& at, const std::array<double, N>& half) {
  double out = 0, most = at[0] - half[0];
  for (std::size_t i = 0; i < N; ++i) {
    out = std::hypot(out, over(at[i] - half[i]));
    most = std::max(most, at[i] - half[i]);
  }
  return out + std::min(most, 0.0);
}

inline double signed_distance(const Plane& s, const Vec3& p) {
  return dot(s.normal, p - s.offset * s.normal);
}
inline double signed_distance(const Sphere& s, const Vec3& p) {
  return norm(p - s.centre) - s.radius;
}
inline double signed_distance(const Box& s, const Vec3& p) {
  const Vec3 v = p - s.frame.at;
  std::array<double, 3> at{};
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t i = 0; i < 3; ++i) at[j] += s.frame.turn.row[i][j] * v[i];
  for (double& coordinate : at) coordinate = std::abs(coordinate);
  return distance_to_box<3>(at, {s.half.x, s.half.y, s.half.z});
}
inline double signed_distance(const Cylinder& s, const Vec3& p) {
  const Vec3 v = p - s.centre;
  return distance_to_box<2>({norm(cross(s.axis, v)), std::abs(dot(s.axis, v))}, {s.radius, s.half});
}
inline double signed_distance(const Capsule& s, const Vec3& p) {
  const Vec3 v = p - s.centre;
  return std::hypot(norm(cross(s.axis, v)), over(std::abs(dot(s.axis, v)) - s.half)) - s.radius;
}

/// Sizes of about a metre: 0.3 to 1.
inline Plane any_plane(Random& r) {
  return {.normal = r.unit(), .offset = r.number(-1, 1)};
}
inline Sphere any_sphere(Random& r) {
  return {.centre = r.vector(1), .radius = r.number(0.3, 1)};
}
inline Box any_box(Random& r) {
  return {.frame = {r.turn(), r.vector(1)},
          .half = {r.number(0.3, 1), r.number(0.3, 1), r.number(0.3, 1)}};
}
inline Cylinder any_cylinder(Random& r) {
  return {.centre = r.vector(1),
          .axis = r.unit(),
          .radius = r.number(0.3, 1),
          .half = r.number(0.3, 1)};
}
inline Capsule any_capsule(Random& r) {
  return {
      .centre = r.vector(1), .axis = r.unit(), .radius = r.number(0.3, 1), .half = r.number(0, 1)};
}

inline double any_radius(Random& r) {
  return std::max(0.0, r.number(-0.25, 0.25));  // a point half of the time
}

inline Relief any_relief(Random& r) {
  const Mat3 turn = r.turn();
  return {.normal = turn.row[0],
          .along = turn.row[1],
          .offset = r.number(-1, 1),
          .amplitude = r.number(0, 0.2),
          .wavelength = r.number(0.1, 1),
          .profile = r.number(0, 1) < 0.5 ? Relief::Profile::sinusoid : Relief::Profile::groove};
}

}  // namespace hapticd::test::body
