// The paper's wall as a sampled loop: 0.01 kg, 0.022 N s/m, 1000 N/m, 1 kHz.
#pragma once
#include <optional>
#include <vector>

#include "control/build/filters.h"
#include "control/design/synthesis/sampled_search.h"
#include "tests/support/paper2.h"
#include "tests/support/period.h"

namespace hapticd::test {

inline synthesis::SampledWall paper2_wall(
    std::optional<System> velocity = check::backward_difference(kPeriod_s)) {
  return {.stiffness_N_m = 1000, .velocity = std::move(velocity), .period_s = kPeriod_s};
}

inline check::LoopCase paper2_device(double latency_s = 0) {
  return {.mass_kg = 0.01, .damping_Ns_m = 0.022, .latency_s = latency_s};
}

/// Mass and damping by half less and more, and between.
inline std::vector<check::LoopCase> paper2_box(double latency_s = 0) {
  return check::scaled_devices(paper2_device(latency_s), 0.5, 0.5, {-1, -0.5, 0, 0.5, 1});
}

/// The loops of the reference's exact tables.
struct ExactCase {
  const char* table;
  bool ideal;
  int delay_ticks;
  synthesis::SampledWall wall() const { return ideal ? paper2_wall(std::nullopt) : paper2_wall(); }
  check::LoopCase device() const { return paper2_device(delay_ticks * kPeriod_s); }
};
inline const std::vector<ExactCase> kExact = {{"exact_bd_delay0", false, 0},
                                              {"exact_bd_delay1", false, 1},
                                              {"exact_ideal_delay0", true, 0},
                                              {"exact_ideal_delay1", true, 1}};

}  // namespace hapticd::test
