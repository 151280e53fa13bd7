#include "control/scene/path.h"

#include <algorithm>
#include <cmath>

namespace hapticd::control {
namespace {

using Quaternion = std::array<double, 4>;

/// Share `s` of the shortest arc from unit a to unit b. What of b is at right angles to a, o, has
/// length sin(angle): cos(s angle) a + sin(s angle) o / |o| needs no threshold for small angles.
Quaternion slerp(const Quaternion& a, const Quaternion& b, double s) noexcept {
  if (a == b) return a;
  double along = 0, square = 0;
  for (std::size_t i = 0; i < 4; ++i) along += a[i] * b[i];
  const double sign = along < 0 ? -1 : 1;  // b and -b are the same turn
  Quaternion o{};
  for (std::size_t i = 0; i < 4; ++i) {
    o[i] = sign * b[i] - sign * along * a[i];
    square += o[i] * o[i];
  }
  const double length = std::sqrt(square);
  if (!(length > 0)) return a;
  const double angle = s * std::atan2(length, sign * along);
  const double keep = std::cos(angle), turn = std::sin(angle) / length;
  Quaternion between{};
  for (std::size_t i = 0; i < 4; ++i) between[i] = keep * a[i] + turn * o[i];
  return between;
}

/// Of a unit quaternion w, x, y, z.
Mat3 matrix_of(const Quaternion& q) noexcept {
  const auto [w, x, y, z] = q;
  return {{{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}}};
}

Frame frame_of(const Waypoint& waypoint) noexcept {
  return {.turn = matrix_of(waypoint.turn), .at = waypoint.position};
}

}  // namespace

Frame pose_at(const Path& path, std::span<const Waypoint> waypoints, double time_s) noexcept {
  const auto way = waypoints.subspan(path.first, path.count);
  const double end_s = way.back().at_s;
  if (path.repeat && end_s > 0 && time_s >= end_s) time_s = std::fmod(time_s, end_s);
  const auto later = [](double t, const Waypoint& waypoint) { return t < waypoint.at_s; };
  const auto next = std::upper_bound(way.begin(), way.end(), time_s, later);
  if (next == way.begin()) return frame_of(way.front());
  const Waypoint& before = *(next - 1);
  if (next == way.end()) return frame_of(before);
  const double share = (time_s - before.at_s) / (next->at_s - before.at_s);
  return {.turn = matrix_of(slerp(before.turn, next->turn, share)),
          .at = before.position + share * (next->position - before.position)};
}

}  // namespace hapticd::control
