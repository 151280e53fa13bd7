// A record cut into windows, and the motion of each by the model from where the window begins: what
// the fit compares with the measurement. Short windows keep what the model does not know (play,
// cogging, a hand that brushes the axis) from adding up, and give as many scores that do not depend
// on each other.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "control/identify/motion.h"
#include "control/identify/record.h"

namespace hapticd::identify {

struct Window {
  std::size_t begin = 0;  ///< first sample
  std::size_t end = 0;    ///< one past the last
  Motion start{};         ///< at its first sample
};

/// Windows of about `length_s` that begin where the axis moves fastest, for a start at rest hardly
/// tells of its velocity; the starts by a parabola through the samples around them. The first `skip`
/// samples are left out, as the efforts before the record are taken for 0.
std::vector<Window> cut(const Record& record, double length_s, std::size_t skip);

/// Positions in all ticks of a window into `out`, as long as that.
void predict(const Record& record, const Dynamics& axis, const Window& window,
             std::span<double> out) noexcept;

}  // namespace hapticd::identify
