#include "control/build/mesh_clean.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <tuple>

namespace hapticd::build {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// A triangle lower than this share of its longest side has no normal.
constexpr double kFlat = 1e-12;

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::string problem_of(const TriangleSoup& soup) {
  const std::size_t count = soup.vertices.size();
  const auto bad = std::find_if_not(soup.vertices.begin(), soup.vertices.end(), is_finite);
  if (bad != soup.vertices.end())
    return "expected finite vertices, found " + place_text(*bad) + " as vertex " +
           std::to_string(bad - soup.vertices.begin()) + "; repair the mesh where it was made";
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (const std::uint32_t corner : soup.triangles[i])
      if (corner >= count)
        return "triangle " + std::to_string(i) + ": expected vertices below " +
               std::to_string(count) + ", found " + std::to_string(corner) +
               "; repair the mesh where it was made";
  return {};
}

/// Equal vertices become one; those that nothing uses any more stay behind unused.
void weld(TriangleSoup& soup) {
  struct Named {
    Vec3 at;
    std::uint32_t name;
  };
  std::vector<Named> order(soup.vertices.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = {soup.vertices[i], i};
  std::sort(order.begin(), order.end(), [](const Named& a, const Named& b) {
    return std::tie(a.at.x, a.at.y, a.at.z, a.name) < std::tie(b.at.x, b.at.y, b.at.z, b.name);
  });
  std::vector<std::uint32_t> welded(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    welded[order[i].name] =
        i > 0 && order[i].at == order[i - 1].at ? welded[order[i - 1].name] : order[i].name;
  for (Corners& triangle : soup.triangles)
    for (std::uint32_t& corner : triangle) corner = welded[corner];
}

bool has_area(const TriangleSoup& soup, const Corners& t) {
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return false;
  const Vec3 &a = soup.vertices[t[0]], &b = soup.vertices[t[1]], &c = soup.vertices[t[2]];
  const double longest = std::max({squared_norm(b - a), squared_norm(c - b), squared_norm(a - c)});
  return norm(cross(b - a, c - a)) > kFlat * longest;
}

std::size_t drop_flat(TriangleSoup& soup) {
  return std::erase_if(soup.triangles, [&](const Corners& t) { return !has_area(soup, t); });
}

/// Of triangles with the same three corners, in any order, the first stays.
std::size_t drop_repeated(TriangleSoup& soup) {
  std::vector<std::pair<Corners, std::uint32_t>> sorted(soup.triangles.size());
  for (std::uint32_t i = 0; i < sorted.size(); ++i) {
    sorted[i] = {soup.triangles[i], i};
    std::sort(sorted[i].first.begin(), sorted[i].first.end());
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> repeated(sorted.size());
  for (std::size_t i = 1; i < sorted.size(); ++i)
    repeated[sorted[i].second] = sorted[i].first == sorted[i - 1].first;
  std::size_t i = 0;
  return std::erase_if(soup.triangles, [&](const Corners&) { return repeated[i++]; });
}

}  // namespace

std::string place_text(const Vec3& place) {
  std::string text("(");
  text += number_text(place.x) + ", " + number_text(place.y) + ", " + number_text(place.z);
  return text + ") m";
}

std::string count_text(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

Result<TriangleSoup> clean(TriangleSoup soup, std::vector<std::string>& repairs) {
  if (const std::string problem = problem_of(soup); !problem.empty())
    return fail(ExitCode::bad_data, problem);
  const std::size_t given = soup.triangles.size();
  weld(soup);
  if (const std::size_t flat = drop_flat(soup); flat > 0)
    repairs.push_back(count_text(flat, "triangle") + " without area dropped");
  if (const std::size_t repeated = drop_repeated(soup); repeated > 0)
    repairs.push_back(count_text(repeated, "repeated triangle") + " dropped");
  if (soup.triangles.empty())
    return fail(ExitCode::bad_data, "expected triangles that have an area, found none among " +
                                        std::to_string(given) + "; is this the right file?");
  return soup;
}

}  // namespace hapticd::build
