// Soups whose shape is known in closed form, and slow searches over all triangles to hold the fast
// ones against.
#pragma once
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "control/build/mesh.h"

namespace hapticd::test {

inline constexpr double kPi = 3.141592653589793;

/// Direction at a colatitude and a longitude.
inline Vec3 direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// nu longitudes, nv bands of latitude, 2 nu (nv - 1) triangles; vertex at radius(theta, phi).
template <class Radius>
build::TriangleSoup globe(std::uint32_t nu, std::uint32_t nv, Radius&& radius) {
  build::TriangleSoup soup;
  const auto add = [&](double theta, double phi) {
    soup.vertices.push_back(radius(theta, phi) * direction(theta, phi));
  };
  add(0, 0);
  for (std::uint32_t j = 1; j < nv; ++j)
    for (std::uint32_t i = 0; i < nu; ++i) add(kPi * j / nv, 2 * kPi * i / nu);
  add(kPi, 0);
  const std::uint32_t south = 1 + nu * (nv - 1);
  const auto ring = [&](std::uint32_t j, std::uint32_t i) { return 1 + (j - 1) * nu + i % nu; };
  for (std::uint32_t i = 0; i < nu; ++i) {
    soup.triangles.push_back({0, ring(1, i), ring(1, i + 1)});
    soup.triangles.push_back({south, ring(nv - 1, i + 1), ring(nv - 1, i)});
  }
  for (std::uint32_t j = 1; j + 1 < nv; ++j)
    for (std::uint32_t i = 0; i < nu; ++i) {
      soup.triangles.push_back({ring(j, i), ring(j + 1, i), ring(j + 1, i + 1)});
      soup.triangles.push_back({ring(j, i), ring(j + 1, i + 1), ring(j, i + 1)});
    }
  return soup;
}

inline build::TriangleSoup sphere_soup(std::uint32_t nu, std::uint32_t nv, double radius = 0.05) {
  return globe(nu, nv, [&](double, double) { return radius; });
}

inline double bumpy_radius(double theta, double phi) {
  return 0.05 * (1 + 0.05 * std::sin(7 * theta) * std::sin(5 * phi));
}
inline build::TriangleSoup bumpy_soup(std::uint32_t nu, std::uint32_t nv) {
  return globe(nu, nv, bumpy_radius);
}

/// Axis-aligned, from `min` to `max`, twelve triangles.
inline build::TriangleSoup box_soup(const Vec3& min, const Vec3& max) {
  build::TriangleSoup soup;
  for (int i = 0; i < 8; ++i)
    soup.vertices.push_back(
        {(i & 1) ? max.x : min.x, (i & 2) ? max.y : min.y, (i & 4) ? max.z : min.z});
  soup.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return soup;
}
inline build::TriangleSoup cube_soup(double half = 0.05) {
  return box_soup({-half, -half, -half}, {half, half, half});
}
/// Free above and below z = 0 .. thickness.
inline build::TriangleSoup plate_soup(double side, double thickness) {
  return box_soup({-side / 2, -side / 2, 0}, {side / 2, side / 2, thickness});
}

/// A block with a groove along y whose walls rise at 45 degrees from the line x = z = 0 to
/// z = depth; the block ends at x = +-2 depth, z = -depth, y = +-length / 2.
inline build::TriangleSoup groove_soup(double depth, double length) {
  const std::vector<std::pair<double, double>> outline{
      {-2 * depth, -depth}, {0, -depth}, {2 * depth, -depth}, {2 * depth, depth},
      {depth, depth},       {0, 0},      {-depth, depth},     {-2 * depth, depth}};
  build::TriangleSoup soup;
  for (const double y : {length / 2, -length / 2})
    for (const auto& [x, z] : outline) soup.vertices.push_back({x, y, z});
  const std::uint32_t n = 8;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    soup.triangles.push_back({i, n + next, n + i});
    soup.triangles.push_back({i, next, n + next});
  }
  // The ends: seen from the middle of the bottom every other corner is in sight.
  for (std::uint32_t i = 2; i < 8; ++i) {
    soup.triangles.push_back({1, (i + 1) % n, i});
    soup.triangles.push_back({n + 1, n + i, n + (i + 1) % n});
  }
  return soup;
}

/// Appends a soup to another.
inline void add(build::TriangleSoup& to, const build::TriangleSoup& soup) {
  const auto base = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), soup.vertices.begin(), soup.vertices.end());
  for (const auto& t : soup.triangles)
    to.triangles.push_back({base + t[0], base + t[1], base + t[2]});
}

inline void scale(build::TriangleSoup& soup, double by) {
  for (Vec3& vertex : soup.vertices) vertex = by * vertex;
}

/// Every triangle the other way round.
inline void turn_inside_out(build::TriangleSoup& soup) {
  for (auto& t : soup.triangles) std::swap(t[1], t[2]);
}

/// Distance to a triangle: its plane if the foot lies inside all three edges, else the nearest
/// edge.
inline double distance_to(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const auto to_edge = [&](const Vec3& u, const Vec3& v) {
    const double share = std::fmin(std::fmax(dot(p - u, v - u) / squared_norm(v - u), 0), 1);
    return norm(p - u - share * (v - u));
  };
  const Vec3 n = cross(b - a, c - a);
  const bool inside = dot(n, cross(b - a, p - a)) >= 0 && dot(n, cross(c - b, p - b)) >= 0 &&
                      dot(n, cross(a - c, p - c)) >= 0;
  if (inside) return std::fabs(dot(n, p - a)) / norm(n);
  return std::fmin(to_edge(a, b), std::fmin(to_edge(b, c), to_edge(c, a)));
}
inline double distance_to(const build::TriangleSoup& soup, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& t : soup.triangles)
    least = std::fmin(
        least, distance_to(soup.vertices[t[0]], soup.vertices[t[1]], soup.vertices[t[2]], p));
  return least;
}

/// How often the surface goes around a point: 1 inside, 0 outside (solid angles, van Oosterom and
/// Strackee 1983).
inline double winding(const build::TriangleSoup& soup, const Vec3& p) {
  double sum = 0;
  for (const auto& t : soup.triangles) {
    const Vec3 a = soup.vertices[t[0]] - p, b = soup.vertices[t[1]] - p,
               c = soup.vertices[t[2]] - p;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    sum += std::atan2(dot(a, cross(b, c)),
                      la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * kPi);
}

/// The trajectory of the mesh benchmark: 20 s at 1 kHz over the middle latitudes, from 2 mm outside
/// to 2 mm inside.
struct Probe {
  double theta = 0, phi = 0;
  double depth = 0;  ///< m, > 0 inside
};
inline constexpr int kProbes = 20000;
inline Probe probe(int i) {
  const double t = i / 1000.0;
  return {kPi / 2 + 0.8 * std::sin(2 * kPi * 0.31 * t), std::sin(2 * kPi * 0.43 * t + 0.5),
          -0.002 * std::cos(2 * kPi * 0.5 * t)};
}

/// A point that follows a mesh as a contact does that has no coupling.
struct MeshProbe {
  control::Mesh mesh;
  double radius = 0;
  control::MeshWalk walk{};
  Vec3 proxy{};
  bool started = false;

  /// Push of the surface [m]: proxy less asked.
  Vec3 at(const Vec3& x) {
    const Vec3 from = started ? proxy : x;
    const control::Nearest nearest = control::nearest(mesh, walk, x, from, radius);
    started = true;
    proxy = nearest.depth > 0 ? nearest.point : x;
    return proxy - x;
  }
};

}  // namespace hapticd::test
