// A Z-width as CSV, JSON and text.
#pragma once
#include <string>
#include <vector>

#include "daemon/hapticctl_zwidth_lines.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {

struct ZwidthPoint {
  double damping = 0;
  double measured = 0;  ///< N/m; 0: none; infinite: beyond what can be told
  std::string why;      ///< what ended it
  StiffestWalls theory;
};

std::string zwidth_csv(const std::vector<ZwidthPoint>& points, const std::string& config);
Json zwidth_json(const std::vector<ZwidthPoint>& points, const std::string& output);
std::string zwidth_text(const std::vector<ZwidthPoint>& points);

}  // namespace hapticd::daemon
