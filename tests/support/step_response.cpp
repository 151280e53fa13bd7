#include "tests/support/step_response.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hapticd::test {

StepFigures figures(const StepResponse& response, std::size_t substeps, double expected_m) {
  StepFigures result;
  const auto& x = response.position_m;
  const auto overshoot = [&](double peak_m) {
    return std::max(0.0, 100 * (peak_m / expected_m - 1));
  };
  double tick_peak_m = 0;
  for (std::size_t i = substeps - 1; i < x.size(); i += substeps)
    tick_peak_m = std::max(tick_peak_m, x[i]);
  result.tick_overshoot_pct = overshoot(tick_peak_m);
  result.overshoot_pct = overshoot(*std::max_element(x.begin(), x.end()));
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool inside = std::abs(x[i] - expected_m) <= 0.02 * expected_m;
    if (!inside) result.settle_ms = 1e3 * response.substep_s * static_cast<double>(i + 1);
  }
  const std::size_t tail = x.size() / 10;
  result.steady_m = std::accumulate(x.end() - static_cast<std::ptrdiff_t>(tail), x.end(), 0.0) /
                    static_cast<double>(tail);
  result.peak_N = *std::max_element(response.force_N.begin(), response.force_N.end());
  return result;
}

}  // namespace hapticd::test
