// What an OpenFFBoard's report descriptor says of the reports that this driver uses: they differ from build to build.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "control/core/result.h"
#include "drivers/hid/report_descriptor.h"
#include "drivers/hid/report_map.h"

namespace hapticd::hid::openffboard {

inline constexpr std::size_t kMostAxes = 2;

struct Layout {
  std::size_t axes = 0;  ///< that are used: X, or X and Y
  int force_axes = 0;    ///< that the build has: which bit enables a direction
  std::size_t set_effect_bytes = 0;
  /// Report 1: a position for each axis, then the first 32 buttons where there are any, then what else it has of axes, each
  /// as a share of its range.
  InputMap gamepad{};
  bool buttons = false;
  std::array<double, kMostAxes> counts_of_range{};  ///< the axis' `degrees` are so many steps

  std::size_t first_analogue() const noexcept { return axes + (buttons ? 1 : 0); }
};

/// Errors name what was expected and found.
Result<Layout> layout_of(const ReportDescriptor& descriptor, std::size_t axes);

}  // namespace hapticd::hid::openffboard
