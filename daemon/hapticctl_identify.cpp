#include "daemon/hapticctl_identify.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <utility>

#include "config/write_yaml.h"
#include "daemon/ctl_check.h"
#include "daemon/ctl_verbs.h"
#include "daemon/hapticctl_identify_report.h"
#include "daemon/hapticctl_identify_session.h"
#include "daemon/interrupts.h"
#include "daemon/output_check.h"
#include "daemon/output_file.h"

namespace hapticd::daemon {
namespace {

constexpr double kLongestDelayTicks = 15;  // a little more than latency_s may be
constexpr double kLeastDelay_s = 5e-3;     // of the longest one that is looked for
constexpr int kChirpPoints = 12;
constexpr double kProgressStep = 0.1;
constexpr const char* kInterrupted = "interrupted; nothing was written";

/// A line for each tenth of the way.
class ProgressLines {
 public:
  void operator()(double progress, double frequency_Hz) {
    if (progress < next_) return;
    std::fprintf(stderr, "identify: %3.0f %%, %.3g Hz\n", 100 * progress, frequency_Hz);
    next_ = progress + kProgressStep;
  }

 private:
  double next_ = 0;
};

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

std::vector<identify::ResponsePoint> response_of(const IdentifySetup& setup,
                                                 const IdentifySession& session) {
  const identify::Record& record = session.runner.record();
  const identify::ExcitationOptions& e = setup.excitation;
  if (e.method == identify::Method::stepped) {
    return identify::stepped_response(identify::positions(record), identify::efforts(record),
                                      session.runner.measured());
  }
  return identify::chirp_response(identify::positions(record), identify::efforts(record),
                                  {.low_Hz = e.low_Hz,
                                   .high_Hz = e.high_Hz,
                                   .points = kChirpPoints,
                                   .period_s = setup.period_s});
}

/// Text, JSON and file of what was found.
struct Found {
  std::string text, file;
  Json json;
};

Result<Found> find_model(IdentifyRun run) {
  const double longest_s = std::max(kLeastDelay_s, kLongestDelayTicks * run.setup.period_s);
  auto fit = identify::fit(run.session.runner.record(),
                           {.high_Hz = run.setup.excitation.high_Hz,
                            .longest_delay_s = longest_s,
                            .proceed = [](int iteration) {
                              std::fprintf(stderr, "identify: fitting, step %d\n", iteration);
                              return !interrupts().load();
                            }});
  if (interrupts().load()) return fail(ExitCode::try_again, kInterrupted);
  if (!fit) return tl::unexpected(fit.error());
  if (run.setup.jointed) {
    run.held_took = run.session.held_loss.most(fit->value.viscous, fit->value.coulomb);
    fit->half_width.viscous += run.held_took;
  }
  run.response = response_of(run.setup, run.session);
  return Found{model_text(run, *fit), config::to_yaml(model_file(run, *fit)),
               model_json(run, *fit)};
}

Result<Found> find_hand(IdentifyRun run) {
  auto fit = identify::fit_hand(run.session.runner.record(), run.session.hand_force,
                                run.session.runner.measured(), {.delay_s = run.setup.delay_s});
  if (!fit) return tl::unexpected(fit.error());
  run.response = fit->force_per_position;
  return Found{hand_text(run, *fit), hand_file(run, *fit), hand_json(run, *fit)};
}

Result<Found> identify_axis(IdentifySetup& setup, const IdentifyOptions& options) {
  const auto session = run_session(setup, interrupts(), ProgressLines());
  if (!session) return tl::unexpected(session.error());
  const IdentifyRun run{setup, *session, options, utc_now(), {}};
  auto found = options.hand ? find_hand(run) : find_model(run);
  if (found && interrupts().load()) return fail(ExitCode::try_again, kInterrupted);
  if (found) {
    if (auto written = replace_file(options.output, found->file); !written)
      return tl::unexpected(written.error());
  }
  return found;
}

}  // namespace

ExitCode run_identify(const std::string& config_path, const IdentifyOptions& options, bool json) {
  auto compiled = config::load(config_path);
  if (!compiled) return print_config_errors(compiled.error(), json);
  if (auto output = check_output(options.output, {config_path}); !output)
    return print_error(output.error(), json);
  auto setup = identify_setup(*compiled, options);
  if (!setup) return print_error(setup.error(), json);
  const auto found = identify_axis(*setup, options);
  if (!found) return print_error(found.error(), json);
  if (json) {
    std::puts(to_text(found->json).c_str());
  } else {
    const std::string next = options.hand ? "its keys are those of sim: {hand: ...}"
                                          : "put this into the config:  model: {file: " +
                                                named_from(config_path, options.output) + "}";
    std::printf("%s%s written; %s\n", found->text.c_str(), options.output.c_str(), next.c_str());
  }
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
