#include "daemon/hapticctl_zwidth_report.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

namespace hapticd::daemon {
namespace {

std::array<double, 6> columns(const ZwidthPoint& p) {
  return {p.measured,     p.theory.exact,   p.theory.robust,
          p.theory.paper, p.theory.passive, p.theory.colgate};
}

}  // namespace

/// What is beyond all that is tried is a gap.
std::string zwidth_csv(const std::vector<ZwidthPoint>& points, const std::string& config) {
  std::string text =
      "# Z-width: greatest stiffness of the wall for each damping of it; " + config +
      "\ndamping[N "
      "s/m],measured[N/m],exact[N/m],robust[N/m],paper[N/m],passive[N/m],colgate[N/m]\n";
  for (const ZwidthPoint& p : points) {
    text += fmt::format("{:.6g}", p.damping);
    for (const double stiffness : columns(p))
      text += std::isfinite(stiffness) ? fmt::format(",{:.6g}", stiffness) : ",";
    text += "\n";
  }
  return text;
}

Json zwidth_json(const std::vector<ZwidthPoint>& points, const std::string& output) {
  constexpr std::array kNames{"measured_N_m", "exact_N_m",   "robust_N_m",
                              "paper_N_m",    "passive_N_m", "colgate_N_m"};
  Json rows = Json::array();
  for (const ZwidthPoint& p : points) {
    Json row{{"damping_Ns_m", p.damping}, {"why", p.why}};
    const auto values = columns(p);
    for (std::size_t i = 0; i < values.size(); ++i)
      row[kNames[i]] = std::isfinite(values[i]) ? Json(values[i]) : Json(nullptr);
    rows.push_back(std::move(row));
  }
  return {{"ok", true}, {"output", output}, {"points", std::move(rows)}};
}

std::string zwidth_text(const std::vector<ZwidthPoint>& points) {
  std::string text = fmt::format("{:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "B/(N s/m)",
                                 "measured", "exact", "robust", "paper", "passive", "Colgate");
  for (const ZwidthPoint& p : points) {
    text += fmt::format("{:10.4g}", p.damping);
    for (const double stiffness : columns(p))
      text += std::isfinite(stiffness) ? fmt::format(" {:10.4g}", stiffness)
                                       : fmt::format(" {:>10}", "beyond");
    text += p.measured > 0 && std::isfinite(p.measured) ? "\n" : "  " + p.why + "\n";
  }
  return text + "greatest stiffness in N/m; 0: none\n";
}

}  // namespace hapticd::daemon
