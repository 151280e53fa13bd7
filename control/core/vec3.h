// Points, directions and small matrices of the scene, in the world frame or an object's: plain
// numbers that can be copied bit by bit.
#pragma once
#include <array>
#include <cmath>

namespace hapticd {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  constexpr double& operator[](std::size_t i) noexcept { return i == 0 ? x : i == 1 ? y : z; }
  constexpr double operator[](std::size_t i) const noexcept { return i == 0 ? x : i == 1 ? y : z; }
  constexpr Vec3& operator+=(const Vec3& b) noexcept {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  constexpr Vec3& operator-=(const Vec3& b) noexcept {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
  bool operator==(const Vec3&) const = default;
};

constexpr Vec3 operator+(Vec3 a, const Vec3& b) noexcept {
  return a += b;
}
constexpr Vec3 operator-(Vec3 a, const Vec3& b) noexcept {
  return a -= b;
}
constexpr Vec3 operator-(const Vec3& a) noexcept {
  return {-a.x, -a.y, -a.z};
}
constexpr Vec3 operator*(double s, const Vec3& a) noexcept {
  return {s * a.x, s * a.y, s * a.z};
}
constexpr double dot(const Vec3& a, const Vec3& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(const Vec3& a, const Vec3& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr double squared_norm(const Vec3& a) noexcept {
  return dot(a, a);
}
inline double norm(const Vec3& a) noexcept {
  return std::sqrt(dot(a, a));
}

/// By rows.
struct Mat3 {
  std::array<Vec3, 3> row{};
  bool operator==(const Mat3&) const = default;
};

constexpr Mat3 diagonal(double s) noexcept {
  return {{{{s, 0, 0}, {0, s, 0}, {0, 0, s}}}};
}
constexpr Vec3 operator*(const Mat3& m, const Vec3& v) noexcept {
  return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)};
}
/// m' v.
constexpr Vec3 transposed_times(const Mat3& m, const Vec3& v) noexcept {
  return v.x * m.row[0] + v.y * m.row[1] + v.z * m.row[2];
}
constexpr Mat3 operator*(const Mat3& a, const Mat3& b) noexcept {
  Mat3 product;
  for (std::size_t i = 0; i < 3; ++i) product.row[i] = transposed_times(b, a.row[i]);
  return product;
}

/// m^-1 v by Cramer's rule; m regular.
constexpr Vec3 solve(const Mat3& m, const Vec3& v) noexcept {
  const Vec3 a = cross(m.row[1], m.row[2]);
  const Vec3 b = cross(m.row[2], m.row[0]);
  const Vec3 c = cross(m.row[0], m.row[1]);
  return (1 / dot(m.row[0], a)) * (v.x * a + v.y * b + v.z * c);
}

/// A rigid frame: world = turn * local + at.
struct Frame {
  Mat3 turn = diagonal(1);
  Vec3 at{};
  bool operator==(const Frame&) const = default;
};

constexpr Vec3 to_world(const Frame& frame, const Vec3& local) noexcept {
  return frame.turn * local + frame.at;
}
constexpr Vec3 to_local(const Frame& frame, const Vec3& world) noexcept {
  return transposed_times(frame.turn, world - frame.at);
}

}  // namespace hapticd
