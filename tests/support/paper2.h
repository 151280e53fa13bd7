// Figures of paper 2's wall, computed apart from this code.
#pragma once
#include <fstream>
#include <nlohmann/json.hpp>

#include "control/design/check/linear.h"

namespace hapticd::test {

using check::Matrix;
using check::System;
using check::Vector;

inline const nlohmann::json& paper2_design() {
  static const auto data =
      nlohmann::json::parse(std::ifstream(HAPTICD_SOURCE_DIR "/tests/data/paper2/design.json"));
  return data;
}

}  // namespace hapticd::test
