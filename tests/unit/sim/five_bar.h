// The paper's five-bar as a simulated device, and the reference values for it.
#pragma once
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "sim/options.h"

namespace hapticd::sim {

inline nlohmann::json five_bar_reference() {
  const std::string path = HAPTICD_SOURCE_DIR "/tests/data/paper2/five_bar.json";
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return nlohmann::json::parse(file);
}

/// At rest with the tip at (0, 0.25) m.
inline DeviceOptions five_bar() {
  DeviceOptions options;
  options.name = "five-bar";
  options.axes.assign(2, {.mass_kg = 1e-5, .max_effort_N = 0.4});
  options.axes[0].position_m = 2.25310712343;
  options.axes[1].position_m = 0.8884855301596;
  options.linkage =
      LinkageOptions{.geometry = control::FiveBar{.linkage = 0, .link_m = 0.2, .base_m = 0.1},
                     .inner_link_kg = 0.01,
                     .outer_link_kg = 0.006,
                     .tip_kg = 0.003};
  return options;
}

}  // namespace hapticd::sim
