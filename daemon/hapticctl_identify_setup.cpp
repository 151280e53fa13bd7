#include "daemon/hapticctl_identify_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "config/compilation.h"
#include "config/effective_guard.h"
#include "daemon/device_factory.h"

namespace hapticd::daemon {
namespace {

constexpr double kForceShare = 0.5;  // of what the axis may exert
constexpr double kSpeedShare = 0.5;  // of guard.max_velocity
constexpr double kTravel_m = 0.02;
constexpr double kTravel_rad = 0.2;
constexpr double kJointTravel_rad = 0.05;  // over which a linkage hardly changes
constexpr double kLowest_Hz = 0.01;        // minutes for each frequency
constexpr double kFrom_Hz = 2;
constexpr double kTo_Hz = 50;
constexpr double kHandTo_Hz = 20;
constexpr double kLeastTicks = 16;  // of a period at the highest frequency

/// The item of that name.
template <class Item>
Result<std::size_t> index_of(const std::vector<Item>& items, const std::string& name,
                             const char* what) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return fail(ExitCode::usage, config::unknown_name(what, name, names));
  return static_cast<std::size_t>(found - names.begin());
}

/// What an option may be.
struct Allowed {
  double most;
  std::string unit;
  double above = 0;
};

/// An option held against its limits; what it is by itself if it is not given.
Result<double> bounded(const char* option, const std::optional<double>& given, double otherwise,
                       const Allowed& allowed) {
  if (!given) return std::min(otherwise, allowed.most);
  if (*given > allowed.above && *given <= allowed.most) return *given;
  return fail(ExitCode::usage,
              fmt::format("{}: expected more than {:g} and at most {:g} {}, found {:g}", option,
                          allowed.above, allowed.most, allowed.unit, *given));
}

class Setup {
 public:
  Setup(config::Compiled& compiled, const IdentifyOptions& options, std::size_t device,
        std::size_t axis)
      : compiled_(compiled),
        options_(options),
        number_(device),
        device_(compiled.document.config.devices[device]),
        axis_(device_.axes[axis]) {
    setup_.axis = axis;
    setup_.name = device_.name + "." + axis_.name;
    setup_.rotary = axis_.kind == config::AxisKind::rotary;
    setup_.jointed = !std::holds_alternative<config::Cartesian>(device_.kinematics);
    setup_.clamped = options.clamped;
  }

  Result<IdentifySetup> make() {
    add_plan();
    if (auto done = add_bounds(); !done) return tl::unexpected(done.error());
    if (auto done = add_sensor(); !done) return tl::unexpected(done.error());
    add_holds();
    add_device();
    if (setup_.jointed) {
      setup_.notes.push_back(
          "the device is jointed: the figures are those of this joint in this pose, with the other "
          "joints held");
    }
    return std::move(setup_);
  }

 private:
  void add_plan() {
    const control::Plan& plan = compiled_.program->plan();
    const control::DevicePlan& device = plan.devices[number_];
    setup_.axes.assign(&plan.axes[device.first_axis], &plan.axes[device.first_axis] + device.axes);
    setup_.period_s = plan.period_s;
    setup_.latency_s = setup_.delay_s = device_.latency_s;
    for (const config::NamedModel& model : compiled_.document.models) {
      const std::string path = fmt::format("devices[{}].axes[{}].model", number_, setup_.axis);
      if (model.path == path && model.measured) setup_.delay_s = model.measured->delay_s;
    }
  }

  double most_force() const {
    const double actuator = setup_.axes[setup_.axis].max_effort;
    if (setup_.jointed) return actuator;
    return std::min(actuator,
                    config::effective_guard(compiled_.document.config.guard, device_).max_force_N);
  }

  Result<void> add_bounds() {
    const bool rotary = setup_.rotary;
    const control::AxisPlan& axis = setup_.axes[setup_.axis];
    identify::ExcitationOptions& excitation = setup_.excitation;
    excitation.method = options_.method;
    const double highest_Hz = 1 / (kLeastTicks * setup_.period_s);
    const auto force = bounded("--force", options_.force, kForceShare * most_force(),
                               {most_force(), rotary ? "N m" : "N"});
    const auto speed = bounded("--speed", options_.speed, kSpeedShare * axis.max_velocity,
                               {axis.max_velocity, rotary ? "rad/s" : "m/s"});
    const auto travel =
        bounded("--travel", options_.travel, usual_travel(), {most_travel(), rotary ? "rad" : "m"});
    const auto to_Hz = bounded("--to", options_.to_Hz, options_.hand ? kHandTo_Hz : kTo_Hz,
                               {highest_Hz, "Hz", kLowest_Hz});
    for (const auto* one : {&force, &speed, &travel, &to_Hz}) {
      if (!*one) return tl::unexpected(one->error());
    }
    const auto from_Hz =
        bounded("--from", options_.from_Hz, std::clamp(*to_Hz / 10, kLowest_Hz, kFrom_Hz),
                {*to_Hz / 2, "Hz", kLowest_Hz});
    if (!from_Hz) return tl::unexpected(from_Hz.error());
    excitation.force = *force;
    excitation.speed = *speed;
    excitation.travel = *travel;
    excitation.high_Hz = *to_Hz;
    excitation.low_Hz = *from_Hz;
    excitation.sweep_s = std::max(excitation.sweep_s, 4 / *from_Hz);
    return {};
  }

  double usual_travel() const {
    if (!setup_.rotary) return kTravel_m;
    return setup_.jointed ? kJointTravel_rad : kTravel_rad;
  }

  /// Half of the axis' own travel, if the config knows it.
  double most_travel() const {
    const auto& travel = axis_.travel;
    if (!travel) return setup_.rotary ? 10 : 1;
    const auto& low = setup_.rotary ? travel->min_rad : travel->min_m;
    const auto& high = setup_.rotary ? travel->max_rad : travel->max_m;
    return low && high ? (*high - *low) / 2 : kTravel_m;
  }

  Result<void> add_sensor() {
    if (!options_.hand) return {};
    if (options_.method != identify::Method::stepped)
      return fail(ExitCode::usage, "--hand takes a stepped sine: leave --method out");
    if (setup_.jointed) {
      return fail(ExitCode::bad_data, "device " + device_.name +
                                          " is jointed: its force sensor measures at the tip, not "
                                          "along a joint; --hand needs a Cartesian device");
    }
    if (!device_.force_sensor) {
      return fail(ExitCode::bad_data,
                  "device " + device_.name +
                      " has no force_sensor: without one the hand cannot be told from the axis");
    }
    const auto& channels = device_.force_sensor->directions;
    const auto wanted = std::get<config::Cartesian>(device_.kinematics).directions[setup_.axis];
    const auto found = std::find(channels.begin(), channels.end(), wanted);
    if (found == channels.end()) {
      return fail(ExitCode::bad_data, "the force_sensor of device " + device_.name +
                                          " has no channel along axis " + axis_.name);
    }
    setup_.channel = static_cast<std::size_t>(found - channels.begin());
    return {};
  }

  void add_holds() {
    for (std::size_t i = 0; i < device_.axes.size(); ++i) {
      const config::Axis& axis = device_.axes[i];
      const bool rotary = axis.kind == config::AxisKind::rotary;
      const config::AxisModel model = axis.model.value_or(config::AxisModel{});
      setup_.holds.push_back({.mass = (rotary ? model.inertia_kgm2 : model.mass_kg).value_or(0),
                              .force = kForceShare * setup_.axes[i].max_effort,
                              .travel = rotary ? kTravel_rad : kTravel_m});
    }
  }

  /// A simulated hand lets go, or holds still: what it does by its script is no part of the axis.
  void add_device() {
    const bool simulated = device_.driver == config::Driver::sim;
    if (simulated) {
      sim::DeviceOptions& truth = compiled_.simulated[number_];
      setup_.simulated_delay_s = truth.axes[setup_.axis].delay_s;
      if (options_.seed) truth.seed = *options_.seed;
      if (compiled_.shared_hand) setup_.notes.push_back("the simulated hand lets go of the device");
      compiled_.shared_hand.reset();
      let_go(truth.hand);
      if (options_.clamped) clamp(truth);
    }
    setup_.by_the_clock = !simulated || options_.real_time;
    setup_.device = std::move(make_devices(compiled_)[number_]);
  }

  /// What the operator of a simulated device does.
  void clamp(sim::DeviceOptions& truth) const {
    constexpr double kPlay = 5e-5;  // m or rad
    for (std::size_t i = 0; i < truth.axes.size(); ++i) {
      if (i == setup_.axis) continue;
      const double at = truth.axes[i].position_m;
      truth.axes[i].stops = sim::StopOptions{.min_m = at - kPlay, .max_m = at + kPlay};
    }
  }

  void let_go(sim::HandOptions& hand) {
    const bool holds = hand.mass_kg > 0 || hand.stiffness_N_m > 0 || hand.damping_Ns_m > 0;
    if (!options_.hand && (holds || !hand.script.empty())) {
      setup_.notes.push_back("the simulated hand lets go of the device");
      hand = {};
    } else if (!hand.script.empty()) {
      setup_.notes.push_back("the simulated hand holds still: its script is not run");
      hand.script.clear();
    }
  }

  config::Compiled& compiled_;
  const IdentifyOptions& options_;
  std::size_t number_;
  const config::Device& device_;
  const config::Axis& axis_;
  IdentifySetup setup_;
};

}  // namespace

Result<IdentifySetup> identify_setup(config::Compiled& compiled, const IdentifyOptions& options) {
  const auto& devices = compiled.document.config.devices;
  const auto device = index_of(devices, options.device, "device");
  if (!device) return tl::unexpected(device.error());
  const auto axis = index_of(devices[*device].axes, options.axis, "axis");
  if (!axis) return tl::unexpected(axis.error());
  return Setup(compiled, options, *device, *axis).make();
}

}  // namespace hapticd::daemon
