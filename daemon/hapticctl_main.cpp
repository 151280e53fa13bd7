// hapticctl: the tool for people.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "daemon/ctl_check.h"
#include "daemon/ctl_cost.h"
#include "daemon/ctl_doctor.h"
#include "daemon/ctl_plot.h"
#include "daemon/ctl_simulate.h"
#include "daemon/ctl_verbs.h"
#include "daemon/ctl_why.h"
#include "daemon/hapticctl_certify.h"
#include "daemon/hapticctl_design.h"
#include "daemon/hapticctl_identify.h"

namespace {

using namespace hapticd;
using daemon::Request;
using daemon::Verb;

/// What the command line says; the verb that was named fills `run`.
struct CommandLine {
  CLI::App app{"Asks and tells hapticd, and works on its configs and recordings without it."};
  std::string socket = daemon::default_socket();
  bool json = false;
  bool unproven = false;
  bool csv = false;
  std::string input, output;
  daemon::SimulateOptions simulate;
  daemon::CostOptions cost;
  daemon::DoctorOptions doctor;
  daemon::PlotOptions plot;
  daemon::DesignOptions design;
  daemon::IdentifyOptions identify;
  std::string log_axes, size;  ///< checked, and put into `plot`, as they are read
  std::function<ExitCode()> run;
};

CLI::App* add_verb(CommandLine& line, const char* name, const char* help,
                   std::function<ExitCode()> run) {
  CLI::App* verb = line.app.add_subcommand(name, help);
  verb->add_flag("--json", line.json, "answer in JSON");
  verb->callback([&line, run = std::move(run)] { line.run = run; });
  return verb;
}

CLI::App* add_daemon_verb(CommandLine& line, Verb which, const char* help) {
  const auto name = std::string(daemon::kVerbNames[static_cast<std::size_t>(which)]);
  CLI::App* verb = add_verb(line, name.c_str(), help, [&line, which] {
    return daemon::run_verb(Request{which, line.unproven}, line.socket, line.json);
  });
  verb->add_option("--socket", line.socket, "where hapticd listens (or set HAPTICD_SOCKET)")
      ->capture_default_str()
      ->type_name("PATH");
  return verb;
}

void add_file_verbs(CommandLine& line) {
  CLI::App* check =
      add_verb(line, "check", "validate a config, print its plan and whether forces may be enabled",
               [&line] { return daemon::check_config(line.input, line.json); });
  check->add_option("FILE", line.input, "the config")->required();

  CLI::App* simulate =
      add_verb(line, "simulate", "run a config in virtual time, every tick into a recording",
               [&line] { return daemon::run_simulate(line.input, line.simulate, line.json); });
  simulate->add_option("CONFIG", line.input, "the config")->required();
  simulate->add_option("--duration", line.simulate.duration_s, "seconds of virtual time")
      ->required()
      ->check(CLI::Range(0.0, 1e9))
      ->type_name("S");
  simulate->add_option("-o,--output", line.simulate.output, "the recording, replaced if it exists")
      ->required()
      ->type_name("FILE");
  simulate->add_flag("--unproven", line.simulate.unproven,
                     "enable although stability.require is not met");

  CLI::App* exports = add_verb(line, "export", "write a recording in another format", [&line] {
    return daemon::run_export(line.input, line.output, line.json);
  });
  exports->add_option("FILE", line.input, "the recording")->required();
  exports->add_flag("--csv", line.csv, "as CSV: the only format so far")->required();
  exports
      ->add_option("-o,--output", line.output,
                   "where to (default: FILE.csv; - for standard output)")
      ->type_name("OUT");

  CLI::App* why = add_verb(line, "why", "tell what led to the last fault of a recording",
                           [&line] { return daemon::run_why(line.input, line.json); });
  why->add_option("FILE", line.input, "the recording, such as a flight recording")->required();
}

void add_stability(CommandLine& line) {
  CLI::App* certify =
      add_verb(line, "certify", "is it stable, by how much, and what does no proof cover",
               [&line] { return daemon::run_certify(line.input, line.json); });
  certify->add_option("CONFIG", line.input, "the config")->required();

  using daemon::DesignFor, daemon::DesignStructure;
  CLI::App* design =
      add_verb(line, "design", "a coupling for a config, with what proves it",
               [&line] { return daemon::run_design(line.input, line.design, line.json); });
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
      ->add_option(
          "--proof", line.design.proof,
          "any_scene: closed form; this_scene: exact test of its networks; paper: Theorem 4")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, DesignFor>{{"any_scene", DesignFor::any_scene},
                                           {"this_scene", DesignFor::this_scene},
                                           {"paper", DesignFor::paper}},
          CLI::ignore_case))
      ->type_name("P");
  design
      ->add_option("--aim", line.design.aim,
                   "stiffest, or transparent: least error against the networks of the scene")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, daemon::DesignAim>{{"stiffest", daemon::DesignAim::stiffest},
                                                   {"transparent", daemon::DesignAim::transparent}},
          CLI::ignore_case))
      ->type_name("A");
  design
      ->add_option("--corner", line.design.corner_rad_s,
                   "of the low-pass that the error is weighed with")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e5))
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
      ->check(CLI::Range(0.01, 0.9999))
      ->type_name("S");
}

void add_doctor(CommandLine& line) {
  CLI::App* doctor =
      add_verb(line, "doctor", "is this machine fit for the loop, and what does it add to latency",
               [&line] { return daemon::run_doctor(line.doctor, line.json); });
  doctor->add_option("CONFIG", line.doctor.config,
                     "run the loop of this config with forces off; without: the machine alone");
  doctor->add_option("--seconds", line.doctor.seconds, "how long the loop is watched")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 86'400.0))
      ->type_name("S");
  doctor->add_option("--priority", line.doctor.priority, "of the loop, where no config says")
      ->capture_default_str()
      ->check(CLI::Range(1, 99))
      ->type_name("N");
}

void add_identify(CommandLine& line) {
  daemon::IdentifyOptions& options = line.identify;
  CLI::App* verb =
      add_verb(line, "identify", "what an axis is made of, as a model file for the config",
               [&line] { return daemon::run_identify(line.input, line.identify, line.json); });
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
  verb->add_flag("--hand", options.hand,
                 "of the hand that holds the axis, by the device's force sensor");
  verb->add_flag("--real-time", options.real_time,
                 "by the clock; real devices always are, simulated ones run as fast as they can");
}

void add_cost(CommandLine& line) {
  CLI::App* cost = add_verb(line, "cost", "what each part of a config costs per tick",
                            [&line] { return daemon::run_cost(line.input, line.cost, line.json); });
  cost->add_option("CONFIG", line.input, "the config")->required();
  cost->add_option("--ticks", line.cost.ticks, "ticks that each figure is measured over")
      ->capture_default_str()
      ->check(CLI::Range(1000, 10'000'000))
      ->type_name("N");
}

void add_plot(CommandLine& line) {
  CLI::App* plot = add_verb(line, "plot", "draw a recording, or curves from a CSV file",
                            [&line] { return daemon::run_plot(line.input, line.plot, line.json); });
  daemon::PlotOptions& options = line.plot;
  plot->add_option("FILE", line.input, "the recording or CSV file")->required();
  plot->add_option("--out", options.output, "the picture, .png or .svg (default: FILE.png)")
      ->type_name("PICTURE");
  plot->add_option("--fields", options.fields, "what to draw, a panel each (default: the usual)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("A,B,...");
  plot->add_option("--from", options.from, "begin here: s of a recording, x of CSV")
      ->type_name("X");
  plot->add_option("--to", options.to, "end here")->type_name("X");
  plot->add_option("--log", line.log_axes, "axes in powers of ten")
      ->check([&options](const std::string& axes) { return daemon::set_log_axes(options, axes); })
      ->type_name("AXES");
  plot->add_flag("--scatter", options.scatter, "points instead of lines");
  plot->add_option("--size", line.size, "pixels, such as 1200x800")
      ->check([&options](const std::string& size) { return daemon::set_size(options, size); })
      ->type_name("WxH");
}

void describe(CommandLine& line) {
  line.app.set_version_flag("--version", "hapticctl " HAPTICD_VERSION);
  line.app.require_subcommand(1);
  add_daemon_verb(line, Verb::status, "state, faults, stability, how well the loop runs");
  add_daemon_verb(line, Verb::enable, "turn forces on, or leave a fault whose cause is gone")
      ->add_flag("--unproven", line.unproven,
                 "although nothing is proved (stability.require: none); it is logged");
  add_daemon_verb(line, Verb::disable, "ramp forces out");
  add_daemon_verb(line, Verb::estop, "zero force in the next tick");
  add_daemon_verb(line, Verb::reload, "load the config anew");
  add_file_verbs(line);
  add_stability(line);
  add_identify(line);
  add_cost(line);
  add_doctor(line);
  add_plot(line);
  line.app.footer(
      "Exit: 0 ok, 1 the answer is no, 64 usage, 65 bad data, 66 no such file, 69 no hapticd, "
      "no device or no gnuplot, 73 cannot write,\n"
      "75 try again, 77 no permission.");
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is told as an error, with what was saved
  try {
    CommandLine line;
    describe(line);
    try {
      line.app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return static_cast<int>(line.app.exit(error) == 0 ? ExitCode::ok : ExitCode::usage);
    }
    return static_cast<int>(line.run());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hapticctl: a defect of hapticctl: %s\n", error.what());
    return static_cast<int>(ExitCode::software);
  }
}
