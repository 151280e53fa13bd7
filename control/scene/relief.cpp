// A plane with a wavy or grooved surface: one nearest point of a curve, in the plane of `normal` and
// `along`. Lengths in units of wavelength / 2 pi, xi from the middle of a crest, the curve is
//
//   eta(xi) = a cos xi,  a = 2 pi amplitude / wavelength      (groove: a cos xi where < 0, else 0)
//
// and everything is its own mirror image at the middle of every crest and trough. So the nearest
// point of all is in the same half wave, 0 <= xi <= pi, as the point (x, y) itself. There the way to
// the curve is at right angles to it where
//
//   G(xi) = xi - x - (a cos xi - y) a sin xi = 0
//
// G' = 1 + a^2 + y a c - 2 a^2 c^2 with c = cos xi is positive on one interval of c; with
// G(0) = -x <= 0 and G(pi) = pi - x >= 0 G has exactly one root at which it rises, is negative before
// it and positive after it: Newton's method, held between the two signs, cannot miss it.
//
// A ball of radius r touches the curve at the same xi as its centre's nearest point, and its centre
// goes to r along the normal - unless that is beyond the middle of the trough: then the ball is too
// large for the trough, and comes to rest on both its flanks.
//
// Accuracy, of the wavelength: depth 1e-14; point and normal 1e-12, but for points whose distance
// from the curve is close to its radius of curvature there, where the nearest point itself is not
// well determined. 2 to 6 steps as a rule, kMostSteps at worst.
#include <numbers>

#include "control/scene/shape_parts.h"

namespace hapticd::control {
namespace {

constexpr double kHalfWave = std::numbers::pi;  ///< from crest to trough
constexpr double kWave = 2 * kHalfWave;

/// In the plane of the curve.
struct WaveVector {
  double along = 0;
  double up = 0;
};

struct Wave {
  double steepness = 0;  ///< a
  bool grooves = false;
};

/// A point of the curve: height a cos xi, inclination -a sin xi.
struct OnWave {
  double xi = 0;
  double height = 0;
  double slant = 0;
};

OnWave place_at(const Wave& wave, double xi) noexcept {
  return {xi, wave.steepness * std::cos(xi), wave.steepness * std::sin(xi)};
}

/// Unit, upwards.
WaveVector normal_at(const OnWave& at) noexcept {
  const double scale = 1 / std::sqrt(1 + at.slant * at.slant);
  return {at.slant * scale, scale};
}

struct WaveRise {
  double value = 0;
  double slope = 0;
};

constexpr int kMostSteps = 60;

/// The place between `low` and `high` before which f is negative and after which it is positive;
/// f(place) is a WaveRise. Newton's method converges squarely: a last step below 1e-9 is right to
/// rounding, and so small that the curve is straight on it.
template <class F>
OnWave rising_root(const Wave& wave, double low, double high, double start, F f) noexcept {
  OnWave at = place_at(wave, start);
  for (int i = 0; i < kMostSteps; ++i) {
    const WaveRise rise = f(at);
    if (rise.value < 0) low = at.xi;
    if (rise.value > 0) high = at.xi;
    const double next = at.xi - rise.value / rise.slope;
    const bool rises = rise.slope > 0;
    if (rises && std::abs(next - at.xi) < 1e-9) {
      const double end = std::clamp(next, low, high), step = end - at.xi;
      return {end, at.height - step * at.slant, at.slant + step * at.height};
    }
    at = place_at(wave, rises && next > low && next < high ? next : 0.5 * (low + high));
  }
  return at;
}

/// Root of G. The first guess: above the crests that of a flat crest, else where the answer was
/// before.
OnWave foot_on_wave(const Wave& wave, const WaveVector& p, double before) noexcept {
  const double a = wave.steepness;
  const double guess = p.up > a ? p.along / (1 + a * (p.up - a)) : before;
  return rising_root(wave, 0, kHalfWave, guess, [&](const OnWave& at) -> WaveRise {
    const double above = at.height - p.up;
    return {at.xi - p.along - above * at.slant, 1 + at.slant * at.slant - above * at.height};
  });
}

/// Centre of the ball that rests in the trough on both flanks, which it touches before `beyond`:
/// where xi + r normal(xi).along = pi; in a groove perhaps on its two edges. First guess: crests of
/// constant curvature a.
WaveVector resting_in_trough(const Wave& wave, double radius, double beyond) noexcept {
  const auto past_middle = [&](const OnWave& at) -> WaveRise {
    const WaveVector n = normal_at(at);
    return {at.xi + radius * n.along - kHalfWave, 1 + radius * at.height * n.up * n.up * n.up};
  };
  const double edge = wave.grooves ? kHalfWave / 2 : 0;
  if (wave.grooves && past_middle(place_at(wave, edge)).value >= 0)
    return {kHalfWave, std::sqrt(radius * radius - edge * edge)};
  const double guess = std::clamp(kHalfWave / (1 + radius * wave.steepness), edge, beyond);
  const OnWave touch = rising_root(wave, edge, beyond, guess, past_middle);
  return {kHalfWave, touch.height + radius * normal_at(touch).up};
}

struct WavePush {
  WaveVector normal{};
  double depth = 0;
};

WavePush push_to(const WaveVector& p, const WaveVector& there) noexcept {
  const Direction way = direction({there.along - p.along, there.up - p.up, 0});
  return {{way.unit.x, way.unit.y}, way.length};
}

/// Out of the wave, or out of a groove and its edges.
WavePush out_of_wave(const Wave& wave, const WaveVector& p, double before, double radius) noexcept {
  OnWave foot = foot_on_wave(wave, p, before);
  WaveVector normal = normal_at(foot);
  if (wave.grooves && foot.xi <= kHalfWave / 2 && p.up > 0) {  // above an edge normals fan out
    foot = {.xi = kHalfWave / 2};
    const Vec3 away = direction({p.along - foot.xi, 0, p.up}).unit;
    normal = {away.x, away.z};
  }
  const double depth =
      radius - (p.along - foot.xi) * normal.along - (p.up - foot.height) * normal.up;
  if (depth <= 0) return {};
  if (radius > 0 && foot.xi + radius * normal.along > kHalfWave)
    return push_to(p, resting_in_trough(wave, radius, foot.xi));
  return {normal, depth};
}

/// `before`: where along the half wave the answer was before. The flat is surely the nearest where a
/// groove is farther aside than the flat is above, and where G >= 0 at the edge already.
WavePush out_of(const Wave& wave, const WaveVector& p, double before, double radius) noexcept {
  const double to_groove = kHalfWave / 2 - p.along;
  if (!wave.grooves || to_groove < 0) return out_of_wave(wave, p, before, radius);
  const WavePush out_of_flat{{0, 1}, radius - p.up};
  if (-p.up * std::min(1.0, wave.steepness) <= to_groove) return out_of_flat;
  const WavePush into_groove = out_of_wave(wave, p, before, radius);
  return into_groove.depth < out_of_flat.depth ? into_groove : out_of_flat;
}

/// The height above which all is free.
double crest_height(const Relief& relief) noexcept {
  return relief.profile == Relief::Profile::groove ? 0 : relief.amplitude;
}

/// Wavelengths from the middle of a crest near the origin.
double turns_from_crest(const Relief& relief, double per_wave, const Vec3& point) noexcept {
  const double crest = relief.profile == Relief::Profile::groove ? 0 : 0.25;
  return dot(relief.along, point) * per_wave - crest;
}

}  // namespace

Nearest nearest(const Relief& shape, const Vec3& point, const Vec3& from, double radius) noexcept {
  const double up = dot(shape.normal, point) - shape.offset;
  if (up >= crest_height(shape) + radius) return {};
  const double per_wave = 1 / shape.wavelength, per_m = kWave * per_wave;
  const double turns = turns_from_crest(shape, per_wave, point), crest = std::round(turns);
  const double place = turns - crest, before = turns_from_crest(shape, per_wave, from) - crest;
  const double side = place < 0 || (place == 0 && before < 0) ? -1 : 1;
  const Wave wave{.steepness = per_m * shape.amplitude,
                  .grooves = shape.profile == Relief::Profile::groove};
  const WavePush push = out_of(wave, {kWave * side * place, per_m * up},
                               std::clamp(kWave * side * before, 0.0, kHalfWave), per_m * radius);
  if (push.depth <= 0) return {};
  const Vec3 normal = push.normal.up * shape.normal + side * push.normal.along * shape.along;
  return pushed_out(point, normal, push.depth * shape.wavelength / kWave);
}

}  // namespace hapticd::control
