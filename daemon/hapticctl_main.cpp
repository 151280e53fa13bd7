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
#include "daemon/ctl_why.h"
#include "daemon/hapticctl_command_line.h"
#include "daemon/within.h"

namespace {

using namespace hapticd;
using daemon::add_verb;
using daemon::CommandLine;
using daemon::Request;
using daemon::Verb;

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
      ->check(daemon::within(0.0, 1e9))
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

void add_doctor(CommandLine& line) {
  CLI::App* doctor =
      add_verb(line, "doctor", "is this machine fit for the loop, and what does it add to latency",
               [&line] { return daemon::run_doctor(line.doctor, line.json); });
  doctor->add_option("CONFIG", line.doctor.config,
                     "run the loop of this config with forces off; without: the machine alone");
  doctor->add_option("--seconds", line.doctor.seconds, "how long the loop is watched")
      ->capture_default_str()
      ->check(daemon::within(0.1, 86'400.0))
      ->type_name("S");
  doctor->add_option("--priority", line.doctor.priority, "of the loop, where no config says")
      ->capture_default_str()
      ->check(CLI::Range(1, 99))
      ->type_name("N");
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

void add_bus_verbs(CommandLine& line) {
  CLI::App* devices =
      add_verb(line, "devices", "which devices are there, and why one cannot be used",
               [&line] { return daemon::run_devices(line.devices, line.json); });
  devices
      ->add_option("--interface", line.devices.interface,
                   "this CAN interface alone (default: all, and USB)")
      ->type_name("NAME");
  devices
      ->add_option("--ask", line.devices.ask,
                   "send this driver's question to every node, not only to those that were heard; "
                   "it may be a command of another protocol")
      ->delimiter(',')
      ->check(CLI::IsMember({"odrive", "moteus", "cia402"}))
      ->type_name("DRIVER");
  devices->add_option("--seconds", line.devices.listen_s, "how long each bus is listened to")
      ->capture_default_str()
      ->check(daemon::within(0.0, 60.0))
      ->type_name("S");

  CLI::App* emulate =
      add_verb(line, "emulate", "stand in for the drives and USB devices of a config",
               [&line] { return daemon::run_emulate(line.emulate, line.json); });
  daemon::EmulateOptions& options = line.emulate;
  emulate->add_option("CONFIG", options.config, "the config")->required();
  emulate->add_option("--bus", options.bus, "CAN: devices on this interface alone (default: all)")
      ->type_name("NAME");
  emulate->add_flag("--real", options.real,
                    "CAN: on a real controller, too: only where no real drive is on the bus");
  emulate->add_flag("--uhid", options.uhid,
                    "USB: show HID devices by /dev/uhid, not by a virtual host controller");
  emulate->add_option("--duration", options.duration_s, "end after so many seconds")
      ->check(daemon::within(0.0, 1e9))
      ->type_name("S");
  emulate
      ->add_option("--loss", options.loss,
                   "share of the frames or transfers that are lost, each way")
      ->check(daemon::within(0.0, 1.0))
      ->type_name("P");
  emulate->add_option("--duplicate", options.duplicate, "share that comes twice")
      ->check(daemon::within(0.0, 1.0))
      ->type_name("P");
  emulate->add_option("--runt", options.runt, "USB: share of the transfers here that are cut")
      ->check(daemon::within(0.0, 1.0))
      ->type_name("P");
  emulate->add_option("--delay", options.delay_s, "CAN: of every frame, each way")
      ->check(daemon::within(0.0, 1.0))
      ->type_name("S");
  emulate->add_option("--jitter", options.jitter_s, "and up to so much more")
      ->check(daemon::within(0.0, 1.0))
      ->type_name("S");
  emulate->add_option("--drift", options.drift_ppm, "CAN: that the drives' clocks run fast by")
      ->check(daemon::within(-1e4, 1e4))
      ->type_name("PPM");
  emulate
      ->add_option("--fault", options.faults,
                   "KIND:AXIS@SECONDS, may be repeated: reset, fail, mute or speak, such as "
                   "reset:left.x@2.5; of USB KIND:DEVICE@SECONDS: unplug, plug, reset, hang, mute, "
                   "speak or stall; - takes them from standard input")
      ->type_name("FAULT");
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
  daemon::add_design_verbs(line);
  add_cost(line);
  add_doctor(line);
  add_bus_verbs(line);
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
