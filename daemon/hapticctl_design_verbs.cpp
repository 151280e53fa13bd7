#include <map>
#include <optional>
#include <string>

#include "daemon/hapticctl_certify.h"
#include "daemon/hapticctl_command_line.h"
#include "daemon/within.h"

namespace hapticd::daemon {
namespace {

void add_stability(CommandLine& line) {
  CLI::App* certify =
      add_verb(line, "certify", "is it stable, by how much, and what does no proof cover",
               [&line] { return run_certify(line.input, line.output, line.json); });
  certify->add_option("CONFIG", line.input, "the config")->required();
  certify
      ->add_option(
          "-o,--output", line.output,
          "write what proves the robust answers, for stability.proof; replaced if it exists")
      ->type_name("FILE");

  CLI::App* design = add_verb(line, "design", "a coupling for a config, with what proves it",
                              [&line] { return run_design(line.input, line.design, line.json); });
  design->add_option("CONFIG", line.input, "the config; its own coupling is not read")->required();
  design->add_option("-o,--output", line.design.output, "the coupling file, replaced if it exists")
      ->required()
      ->type_name("FILE");
  design
      ->add_option("--structure", line.design.structure,
                   "what may share a spring: decentralised, per_device or centralised")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, DesignStructure>{{"decentralised", DesignStructure::decentralised},
                                                 {"per_device", DesignStructure::per_device},
                                                 {"centralised", DesignStructure::centralised}},
          CLI::ignore_case))
      ->type_name("S");
  design
      ->add_option("--proof", line.design.proof,
                   "any_scene: closed form; this_scene: exact test of its networks; paper: Theorem "
                   "4; robust: the damping "
                   "of one wall or coupling, for the devices and hands as given")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, DesignFor>{{"any_scene", DesignFor::any_scene},
                                           {"this_scene", DesignFor::this_scene},
                                           {"paper", DesignFor::paper},
                                           {"robust", DesignFor::robust}},
          CLI::ignore_case))
      ->type_name("P");
  design
      ->add_option("--aim", line.design.aim,
                   "stiffest, or transparent: least error against the networks of the scene")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, DesignAim>{{"stiffest", DesignAim::stiffest},
                                           {"transparent", DesignAim::transparent}},
          CLI::ignore_case))
      ->type_name("A");
  design
      ->add_option("--corner", line.design.corner_rad_s,
                   "of the low-pass that the error is weighed with")
      ->capture_default_str()
      ->check(within(1e-3, 1e5))
      ->type_name("RAD_S");
  design
      ->add_option("--order", line.design.order,
                   "with --proof paper: states of each block's V(z); 0: springs and dampers")
      ->capture_default_str()
      ->check(CLI::Range(0, 24))
      ->type_name("N");
  design
      ->add_option("--damping-share", line.design.damping_share,
                   "share of the devices' damping that the proof may use")
      ->capture_default_str()
      ->check(within(0.01, 0.9999))
      ->type_name("S");
}

void add_identify(CommandLine& line) {
  IdentifyOptions& options = line.identify;
  CLI::App* verb =
      add_verb(line, "identify", "what an axis is made of, as a model file for the config",
               [&line] { return run_identify(line.input, line.identify, line.json); });
  verb->add_option("CONFIG", line.input, "the config; it is never rewritten")->required();
  verb->add_option("--device", options.device, "of the config")->required()->type_name("D");
  verb->add_option("--axis", options.axis, "of that device; the others are held")
      ->required()
      ->type_name("A");
  verb->add_option("-o,--output", options.output, "the model file, replaced if it exists")
      ->required()
      ->type_name("FILE");
  verb->add_option("--method", options.method, "stepped: a sine in steps; chirp: one that glides")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, identify::Method>{{"stepped", identify::Method::stepped},
                                                  {"chirp", identify::Method::chirp}},
          CLI::ignore_case))
      ->type_name("M");
  const auto bound = [&](const char* name, std::optional<double>& value, const char* help) {
    verb->add_option(name, value, help)->type_name("X");
  };
  bound("--force", options.force, "at most, N or N m (default: half of what is allowed)");
  bound("--travel", options.travel, "from where it is, m or rad (default: 0.02 m, 0.2 rad)");
  bound("--speed", options.speed, "at most, m/s or rad/s (default: half of what is allowed)");
  bound("--from", options.from_Hz, "lowest frequency, Hz (default: 2)");
  bound("--to", options.to_Hz, "highest frequency, Hz (default: 50; with --hand 20)");
  verb->add_option("--seed", options.seed, "noise of a simulated device")->type_name("N");
  verb->add_flag("--clamped", options.clamped,
                 "the other axes are clamped, by you: better than by force, where they move each "
                 "other; of a simulated device it is done");
  verb->add_flag("--hand", options.hand,
                 "of the hand that holds the axis, by the device's force sensor");
  verb->add_flag("--real-time", options.real_time,
                 "by the clock; real devices always are, simulated ones run as fast as they can");
}

CLI::Option* add_number(CLI::App& verb, const char* name, std::optional<double>& value,
                        const char* help) {
  return verb.add_option(name, value, help)->type_name("X");
}

void add_zwidth(CommandLine& line) {
  ZwidthOptions& options = line.zwidth;
  CLI::App* verb =
      add_verb(line, "zwidth", "how stiff the config's wall may be, for each damping of it",
               [&line] { return run_zwidth(line.input, line.zwidth, line.json); });
  verb->add_option("CONFIG", line.input, "the config: one axis, one plane")->required();
  verb->add_option("-o,--output", options.output, "the CSV file, replaced if it exists")
      ->required()
      ->type_name("FILE");
  verb->add_option("--picture", options.picture, "draw it, too: .png or .svg")
      ->type_name("PICTURE");
  add_number(*verb, "--to", options.to_Ns_m, "greatest damping, N s/m (default: twice mass/period)")
      ->check(within(1e-6, 1e5));
  verb->add_option("--points", options.points, "dampings, evenly from 0 on")
      ->capture_default_str()
      ->check(CLI::Range(2, 1000))
      ->type_name("N");
  add_number(*verb, "--push", options.push_N,
             "how hard a simulated hand presses, N (default: by the stiffness)")
      ->check(within(1e-9, 1e6));
  add_number(*verb, "--force", options.force_N, "at most, N (default: as the guard allows)")
      ->check(within(1e-6, 1e6));
  verb->add_option("--travel", options.travel_m, "motion beyond is unstable, m")
      ->capture_default_str()
      ->check(within(1e-6, 1.0))
      ->type_name("X");
  verb->add_option("--tremor", options.tremor_m,
                   "by the clock: motion up to this is the operator's, m")
      ->capture_default_str()
      ->check(within(0.0, 0.1))
      ->type_name("X");
  verb->add_flag("--i-hold-the-device", options.consent,
                 "of a real device: it may shake, an operator holds it");
  verb->add_flag("--real-time", options.real_time, "by the clock; real devices always are");
}

void add_sweep(CommandLine& line) {
  SweepOptions& options = line.sweep;
  CLI::App* verb =
      add_verb(line, "sweep",
               "curves of the config's wall: the paper's index and norm beside the sampled loop's",
               [&line] { return run_sweep(line.input, line.sweep, line.json); });
  verb->add_option("CONFIG", line.input, "the config: one axis, one plane")->required();
  verb->add_option("--over", options.over, "damping, stiffness, or frequency: admittances")
      ->required()
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, SweepOver>{{"damping", SweepOver::damping},
                                           {"stiffness", SweepOver::stiffness},
                                           {"frequency", SweepOver::frequency}},
          CLI::ignore_case))
      ->type_name("WHAT");
  verb->add_option("-o,--output", options.output, "the CSV file, replaced if it exists")
      ->required()
      ->type_name("FILE");
  verb->add_option("--picture", options.picture, "draw it, too: .png or .svg")
      ->type_name("PICTURE");
  add_number(*verb, "--from", options.from, "least value (default: by the config)")
      ->check(within(1e-9, 1e9));
  add_number(*verb, "--to", options.to, "greatest value (default: by the config)")
      ->check(within(1e-9, 1e9));
  verb->add_option("--points", options.points, "evenly spaced in powers of ten")
      ->capture_default_str()
      ->check(CLI::Range(2, 10'000))
      ->type_name("N");
}

}  // namespace

void add_design_verbs(CommandLine& line) {
  add_stability(line);
  add_identify(line);
  add_sweep(line);
  add_zwidth(line);
}

}  // namespace hapticd::daemon
