#include "daemon/hapticctl_identify_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace hapticd::daemon {
namespace {

/// Names and units of an axis' figures, linear or rotary.
struct Words {
  const char *mass, *mass_unit, *damping, *damping_unit, *force, *force_unit, *position_unit;
};
constexpr Words kLinear{"mass_kg", "kg", "damping_Ns_m", "N s/m", "coulomb_N", "N", "m"};
constexpr Words kRotary{"inertia_kgm2", "kg m^2", "damping_Nms_rad", "N m s/rad", "coulomb_Nm",
                        "N m",          "rad"};

const Words& words_of(const IdentifyRun& run) {
  return run.setup.rotary ? kRotary : kLinear;
}

/// Rounded up: an interval must not shrink by being written down.
double share(double half_width, double value) {
  return value > 0 ? std::ceil(1e6 * half_width / value) / 1e6 : 1;
}

double least_coherence(const IdentifyRun& run) {
  double least = 1;
  for (const identify::ResponsePoint& point : run.response)
    least = std::min(least, point.coherence);
  return run.response.empty() ? 0 : least;
}

double duration_s(const IdentifyRun& run) {
  return static_cast<double>(run.session.runner.record().samples.size()) * run.setup.period_s;
}

double residual_counts(const IdentifyRun& run, const identify::Fit& fit) {
  return fit.residual / std::abs(run.setup.axes[run.setup.axis].unit_per_raw);
}

const char* method_text(identify::Method method) {
  return method == identify::Method::stepped ? "stepped sine" : "chirp";
}

std::string heading(const IdentifyRun& run) {
  const identify::ExcitationOptions& e = run.setup.excitation;
  const Words& words = words_of(run);
  std::string text = fmt::format(
      "{}: {} from {:.4g} to {:.4g} Hz, {:.1f} s; at most {:.4g} {}, {:.4g} {}, {:.4g} {}/s\n",
      run.setup.name, method_text(e.method), e.high_Hz, e.low_Hz, duration_s(run), e.force,
      words.force_unit, e.travel, words.position_unit, e.speed, words.position_unit);
  for (const std::string& note : run.setup.notes) text += "note: " + note + "\n";
  if (run.session.missed_ticks > 0)
    text += fmt::format("note: {} ticks were missed\n", run.session.missed_ticks);
  return text;
}

std::string response_text(const IdentifyRun& run, const std::string& unit) {
  std::string text = fmt::format("{:>12} {:>14} {:>10} {:>10}\n", "frequency/Hz", "response",
                                 "phase/deg", "coherence");
  for (const identify::ResponsePoint& point : run.response) {
    text += fmt::format("{:>12.3f} {:>14.4g} {:>10.1f} {:>10.5f}\n", point.frequency_Hz,
                        std::abs(point.response), std::arg(point.response) * 180 / std::numbers::pi,
                        point.coherence);
  }
  return text + "response in " + unit + "\n";
}

std::string figure_text(const char* what, double value, double half_width, const char* unit) {
  return fmt::format("{:<18} {:>12.5g} +- {:.2g} {}\n", what, value, half_width, unit);
}

Json figure_json(double value, double half_width) {
  return {{"value", value}, {"half_width", half_width}};
}

Json run_json(const IdentifyRun& run) {
  const identify::ExcitationOptions& e = run.setup.excitation;
  Json response = Json::array();
  for (const identify::ResponsePoint& point : run.response) {
    response.push_back({{"frequency_Hz", point.frequency_Hz},
                        {"magnitude", std::abs(point.response)},
                        {"phase_rad", std::arg(point.response)},
                        {"coherence", point.coherence}});
  }
  return {{"ok", true},
          {"axis", run.setup.name},
          {"output", run.options.output},
          {"at", run.at},
          {"method", e.method == identify::Method::stepped ? "stepped" : "chirp"},
          {"from_Hz", e.low_Hz},
          {"to_Hz", e.high_Hz},
          {"duration_s", duration_s(run)},
          {"bounds", {{"force", e.force}, {"travel", e.travel}, {"speed", e.speed}}},
          {"notes", run.setup.notes},
          {"missed_ticks", run.session.missed_ticks},
          {"held_axes_strayed", run.session.greatest_stray},
          {"confidence", 0.99},
          {"response", std::move(response)},
          {"least_coherence", least_coherence(run)}};
}

/// Does the config's latency cover what was found?
std::string latency_text(const IdentifyRun& run, const identify::Fit& fit) {
  const double most_s = fit.value.delay_s + fit.half_width.delay_s;
  if (run.setup.latency_s >= most_s) return {};
  return fmt::format(
      "latency_s of the device is {:g} s: it should be at least {:.3g} s, and what the loop may "
      "wake "
      "late\n",
      run.setup.latency_s, most_s);
}

bool simulated_inside(const IdentifyRun& run, const identify::Fit& fit) {
  return std::abs(*run.setup.simulated_delay_s - fit.value.delay_s) <= fit.half_width.delay_s;
}

}  // namespace

config::ModelFile model_file(const IdentifyRun& run, const identify::Fit& fit) {
  const identify::ExcitationOptions& e = run.setup.excitation;
  config::ModelFile file;
  config::AxisModel& model = file.model;
  const bool rotary = run.setup.rotary;
  (rotary ? model.inertia_kgm2 : model.mass_kg) = fit.value.mass;
  (rotary ? model.damping_Nms_rad : model.damping_Ns_m) = fit.value.viscous;
  (rotary ? model.coulomb_Nm : model.coulomb_N) = fit.value.coulomb;
  model.mass_uncertainty = std::min(1.0, share(fit.half_width.mass, fit.value.mass));
  model.damping_uncertainty = std::min(1.0, share(fit.half_width.viscous, fit.value.viscous));
  config::Measurement& measured = file.measured.emplace();
  measured.device = run.options.device;
  measured.axis = run.options.axis;
  measured.at = run.at;
  measured.method =
      e.method == identify::Method::stepped ? config::Excited::stepped : config::Excited::chirp;
  measured.rate_Hz = 1 / run.setup.period_s;
  measured.duration_s = duration_s(run);
  measured.from_Hz = e.low_Hz;
  measured.to_Hz = e.high_Hz;
  measured.least_coherence = least_coherence(run);
  (rotary ? measured.max_torque_Nm : measured.max_force_N) = e.force;
  measured.delay_s = fit.value.delay_s;
  measured.delay_uncertainty_s = fit.half_width.delay_s;
  if (fit.value.coulomb > 0)
    measured.coulomb_uncertainty = share(fit.half_width.coulomb, fit.value.coulomb);
  measured.residual_counts = residual_counts(run, fit);
  return file;
}

std::string model_text(const IdentifyRun& run, const identify::Fit& fit) {
  const Words& words = words_of(run);
  std::string text =
      heading(run) +
      response_text(run, fmt::format("{}/({})", words.position_unit, words.force_unit)) +
      figure_text(run.setup.rotary ? "inertia" : "mass", fit.value.mass, fit.half_width.mass,
                  words.mass_unit) +
      figure_text("viscous damping", fit.value.viscous, fit.half_width.viscous,
                  words.damping_unit) +
      figure_text("dry friction", fit.value.coulomb, fit.half_width.coulomb, words.force_unit) +
      figure_text("constant force", fit.value.bias, fit.half_width.bias, words.force_unit) +
      figure_text("delay", 1e3 * fit.value.delay_s, 1e3 * fit.half_width.delay_s, "ms");
  text += fmt::format("{:<18} {:>12.3g} counts of the encoder, root mean square\n", "unexplained",
                      residual_counts(run, fit));
  text += "intervals of 99 %\n";
  if (run.held_took > 0) {
    text += fmt::format(
        "of the viscous damping up to {:.2g} {} may be what the other joints took, which gave way: "
        "its interval has that, too{}\n",
        run.held_took, words.damping_unit,
        run.setup.clamped ? "" : "; clamp them and add --clamped for a narrower one");
  }
  if (run.setup.simulated_delay_s) {
    text += fmt::format("the simulated delay is {:.5g} ms: {} the interval\n",
                        1e3 * *run.setup.simulated_delay_s,
                        simulated_inside(run, fit) ? "inside" : "OUTSIDE");
  }
  return text + latency_text(run, fit);
}

Json model_json(const IdentifyRun& run, const identify::Fit& fit) {
  const Words& words = words_of(run);
  Json json = run_json(run);
  json["model"] = {
      {words.mass, figure_json(fit.value.mass, fit.half_width.mass)},
      {words.damping, figure_json(fit.value.viscous, fit.half_width.viscous)},
      {words.force, figure_json(fit.value.coulomb, fit.half_width.coulomb)},
      {"delay_s", figure_json(fit.value.delay_s, fit.half_width.delay_s)},
      {run.setup.rotary ? "bias_Nm" : "bias_N", figure_json(fit.value.bias, fit.half_width.bias)}};
  json["held_joints_took"] = run.held_took;
  json["residual_counts"] = residual_counts(run, fit);
  json["latency_s"] = run.setup.latency_s;
  json["latency_covers_delay"] = run.setup.latency_s >= fit.value.delay_s + fit.half_width.delay_s;
  json["simulated"] = nullptr;
  if (run.setup.simulated_delay_s) {
    json["simulated"] = {{"delay_s", *run.setup.simulated_delay_s},
                         {"inside", simulated_inside(run, fit)}};
  }
  return json;
}

std::string hand_file(const IdentifyRun& run, const identify::HandFit& fit) {
  const auto& [value, half_width, response] = fit;
  return fmt::format(
      "# The hand on {} as identified at {}: for sim: {{hand: ...}} of a device.\n"
      "# Half-widths of 99 % intervals: mass {:.2g} kg, stiffness {:.2g} N/m, damping {:.2g} N "
      "s/m; "
      "from {:.4g} to {:.4g} Hz,\n"
      "# coherence at least {:.4f}.\n"
      "mass_kg: {:.17g}\nstiffness_N_m: {:.17g}\ndamping_Ns_m: {:.17g}\n",
      run.setup.name, run.at, half_width.mass, half_width.stiffness, half_width.viscous,
      run.setup.excitation.low_Hz, run.setup.excitation.high_Hz, least_coherence(run),
      std::max(0.0, value.mass), std::max(0.0, value.stiffness), std::max(0.0, value.viscous));
}

std::string hand_text(const IdentifyRun& run, const identify::HandFit& fit) {
  return heading(run) + response_text(run, "N/m, force on the axis") +
         figure_text("hand mass", fit.value.mass, fit.half_width.mass, "kg") +
         figure_text("hand damping", fit.value.viscous, fit.half_width.viscous, "N s/m") +
         figure_text("hand stiffness", fit.value.stiffness, fit.half_width.stiffness, "N/m") +
         "intervals of 99 %\n";
}

Json hand_json(const IdentifyRun& run, const identify::HandFit& fit) {
  Json json = run_json(run);
  json["hand"] = {{"mass_kg", figure_json(fit.value.mass, fit.half_width.mass)},
                  {"damping_Ns_m", figure_json(fit.value.viscous, fit.half_width.viscous)},
                  {"stiffness_N_m", figure_json(fit.value.stiffness, fit.half_width.stiffness)}};
  return json;
}

}  // namespace hapticd::daemon
