#include "control/build/mesh_topology.h"

#include <algorithm>
#include <cmath>

#include "control/build/mesh_clean.h"

namespace hapticd::build {
namespace {

using Corners = std::array<std::uint32_t, 3>;
using control::kNoTriangle;

struct HalfEdge {
  std::uint64_t ends;  ///< both vertices, the smaller first: equal for both triangles of an edge
  std::uint32_t triangle;
  std::uint32_t edge;
};

std::uint32_t next_corner(const Corners& corners, std::size_t edge) {
  return corners[(edge + 1) % 3];
}

std::vector<HalfEdge> sorted_edges(const std::vector<Corners>& triangles) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t e = 0; e < 3; ++e) {
      const std::uint64_t a = triangles[t][e], b = next_corner(triangles[t], e);
      edges.push_back({std::min(a, b) << 32 | std::max(a, b), t, e});
    }
  std::sort(edges.begin(), edges.end(),
            [](const HalfEdge& a, const HalfEdge& b) { return a.ends < b.ends; });
  return edges;
}

/// Edges that do not have exactly two triangles.
struct BadEdges {
  std::size_t open = 0, crowded = 0;
  std::uint64_t first_open = 0, first_crowded = 0;

  void add(std::uint64_t ends, std::size_t triangles) {
    if (triangles == 1 && open++ == 0) first_open = ends;
    if (triangles > 2 && crowded++ == 0) first_crowded = ends;
  }
};

std::string edge_text(const TriangleSoup& soup, std::uint64_t ends) {
  return place_text(soup.vertices[ends >> 32]) + " to " +
         place_text(soup.vertices[ends & 0xffffffff]);
}

std::string problem_of(const TriangleSoup& soup, const BadEdges& bad) {
  const std::string expected = "expected a closed surface, every edge with two triangles; found ";
  if (bad.crowded > 0)
    return expected + count_text(bad.crowded, "edge") + " of more than two, the first from " +
           edge_text(soup, bad.first_crowded) + "; make one surface of the parts that meet there";
  if (bad.open > 0)
    return expected + count_text(bad.open, "open edge") + ", the first from " +
           edge_text(soup, bad.first_open) + "; fill the holes, or give a sheet a thickness";
  return {};
}

BadEdges pair_up(const std::vector<HalfEdge>& edges, std::vector<Corners>& neighbours) {
  BadEdges bad;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].ends == edges[i].ends) ++end;
    bad.add(edges[i].ends, end - i);
    if (end - i == 2) {
      neighbours[edges[i].triangle][edges[i].edge] = edges[i + 1].triangle;
      neighbours[edges[i + 1].triangle][edges[i + 1].edge] = edges[i].triangle;
    }
    i = end;
  }
  return bad;
}

void turn(Topology& topology, std::uint32_t triangle) {
  std::swap(topology.corners[triangle][1], topology.corners[triangle][2]);
  std::swap(topology.neighbours[triangle][0], topology.neighbours[triangle][2]);
}

/// Whether the triangle runs along the edge from -> to in that direction.
bool runs_along(const Corners& corners, std::uint32_t from, std::uint32_t to) {
  for (std::size_t e = 0; e < 3; ++e)
    if (corners[e] == from && next_corner(corners, e) == to) return true;
  return false;
}

/// Numbers the part of `seed`, and turns its triangles to agree with it. False: they cannot.
bool agree(Topology& topology, std::uint32_t seed) {
  std::vector<std::uint32_t> todo{seed};
  topology.part[seed] = topology.parts;
  bool possible = true;
  while (!todo.empty()) {
    const std::uint32_t t = todo.back();
    todo.pop_back();
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t n = topology.neighbours[t][e];
      const bool opposed = runs_along(topology.corners[n], topology.corners[t][e],
                                      next_corner(topology.corners[t], e));
      if (topology.part[n] != kNoTriangle) {
        possible = possible && !opposed;
        continue;
      }
      if (opposed) turn(topology, n);
      topology.part[n] = topology.parts;
      todo.push_back(n);
    }
  }
  ++topology.parts;
  return possible;
}

/// A part as seen from the others.
struct Part {
  double volume = 0;  ///< m^3, signed: > 0 facing outwards
  Vec3 corner{};      ///< one of its vertices
  Bounds bounds = kNoBounds;
};

std::vector<Part> parts_of(const TriangleSoup& soup, const Topology& topology) {
  std::vector<Part> parts(topology.parts);
  for (std::size_t t = 0; t < topology.corners.size(); ++t) {
    Part& part = parts[topology.part[t]];
    const Corners& corners = topology.corners[t];
    if (part.bounds.min.x > part.bounds.max.x) part.corner = soup.vertices[corners[0]];
    for (const std::uint32_t corner : corners) extend(part.bounds, soup.vertices[corner]);
    const Vec3 a = soup.vertices[corners[0]] - part.corner;
    const Vec3 b = soup.vertices[corners[1]] - part.corner;
    const Vec3 c = soup.vertices[corners[2]] - part.corner;
    part.volume += dot(a, cross(b, c)) / 6;
  }
  return parts;
}

bool contains(const Bounds& bounds, const Vec3& p) {
  for (std::size_t i = 0; i < 3; ++i)
    if (p[i] < bounds.min[i] || p[i] > bounds.max[i]) return false;
  return true;
}

/// How often a part goes around a point: the sum of the solid angles of its triangles over 4 pi
/// (van Oosterom and Strackee 1983).
double winding(const TriangleSoup& soup, const Topology& topology, std::uint32_t part,
               const Vec3& p) {
  double sum = 0;
  for (std::size_t t = 0; t < topology.corners.size(); ++t) {
    if (topology.part[t] != part) continue;
    const Vec3 a = soup.vertices[topology.corners[t][0]] - p;
    const Vec3 b = soup.vertices[topology.corners[t][1]] - p;
    const Vec3 c = soup.vertices[topology.corners[t][2]] - p;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    sum += std::atan2(dot(a, cross(b, c)),
                      la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * 3.141592653589793);
}

bool is_cavity(const TriangleSoup& soup, const Topology& topology, const std::vector<Part>& parts,
               std::uint32_t part) {
  for (std::uint32_t other = 0; other < parts.size(); ++other)
    if (other != part && contains(parts[other].bounds, parts[part].corner) &&
        std::fabs(winding(soup, topology, other, parts[part].corner)) > 0.5)
      return true;
  return false;
}

}  // namespace

Result<Topology> connect(const TriangleSoup& soup) {
  Topology topology;
  topology.corners = soup.triangles;
  topology.neighbours.resize(soup.triangles.size());
  topology.part.assign(soup.triangles.size(), kNoTriangle);
  const BadEdges bad = pair_up(sorted_edges(soup.triangles), topology.neighbours);
  if (const std::string problem = problem_of(soup, bad); !problem.empty())
    return fail(ExitCode::bad_data, problem);
  for (std::uint32_t t = 0; t < soup.triangles.size(); ++t)
    if (topology.part[t] == kNoTriangle && !agree(topology, t))
      return fail(ExitCode::bad_data,
                  "expected a surface with an inside and an outside; found one that has a single "
                  "side, near " +
                      place_text(soup.vertices[soup.triangles[t][0]]) +
                      "; no turning of its triangles makes them agree");
  return topology;
}

void turn_outwards(const TriangleSoup& soup, Topology& topology) {
  const std::vector<Part> parts = parts_of(soup, topology);
  std::vector<bool> inside_out(parts.size());
  for (std::uint32_t i = 0; i < parts.size(); ++i)
    inside_out[i] = parts[i].volume < 0 && !is_cavity(soup, topology, parts, i);
  for (std::uint32_t t = 0; t < topology.corners.size(); ++t)
    if (inside_out[topology.part[t]]) turn(topology, t);
}

std::size_t split_touching_corners(TriangleSoup& soup, Topology& topology) {
  const std::size_t before = soup.vertices.size();
  std::vector<bool> owned(before);
  std::vector<std::array<bool, 3>> done(topology.corners.size());
  for (std::uint32_t first = 0; first < topology.corners.size(); ++first)
    for (std::size_t c = 0; c < 3; ++c) {
      if (done[first][c]) continue;
      const std::uint32_t vertex = topology.corners[first][c];
      std::uint32_t name = vertex;
      if (owned[vertex]) {
        name = static_cast<std::uint32_t>(soup.vertices.size());
        soup.vertices.push_back(Vec3(soup.vertices[vertex]));
      }
      owned[vertex] = true;
      std::uint32_t t = first;
      std::size_t corner = c;
      do {
        done[t][corner] = true;
        topology.corners[t][corner] = name;
        t = topology.neighbours[t][corner];
        corner = 0;
        while (corner < 2 && (topology.corners[t][corner] != vertex || done[t][corner])) ++corner;
      } while (t != first);
    }
  return soup.vertices.size() - before;
}

}  // namespace hapticd::build
