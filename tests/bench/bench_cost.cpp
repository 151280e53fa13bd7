// What each kind of object and each part of the loop costs per tick: the figures of
// daemon/cost_table.h, in its words.
//
//   bench_cost [TICKS]     200 000 by default, per figure
//
// Kinds: one device of three Cartesian axes, point tool, as `hapticctl cost` measures them. Loop,
// observers and couplings: from pairs of configs that differ by one thing.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cost.h"
#include "daemon/cost_object.h"
#include "daemon/ctl_cost.h"
#include "tests/support/every_kind.h"

namespace {

using namespace hapticd;

std::size_t ticks = 200'000;

[[noreturn]] void give_up(const std::vector<config::ConfigError>& errors) {
  std::fprintf(stderr, "bench_cost: %s\n", config::to_string(errors.front()).c_str());
  std::exit(70);
}

config::Compiled compiled(config::Document document) {
  auto made = config::compile(std::move(document));
  if (!made) give_up(made.error());
  return std::move(*made);
}

double ns(const daemon::Cost& cost) {
  return cost.measured ? cost.measured->ns : -1;
}

using Objects = std::map<std::string, daemon::ObjectCost>;

/// By name; measured in a scene of one object, where no broad phase holds anything back.
Objects measure_objects(bool coupled) {
  auto document = config::read_text(
      test::every_kind_text(coupled, HAPTICD_SOURCE_DIR "/config/examples/ball.obj"), "bench");
  if (!document) give_up(document.error());
  const std::vector<config::SceneObject> objects = document->config.scene;
  document->config.scene.resize(1);
  const config::Compiled one = compiled(std::move(*document));
  const daemon::ObjectCosting costing(one, ticks, 0);
  Objects measured;
  for (const config::SceneObject& object : objects) {
    daemon::ObjectCost cost = costing.measure(object);
    std::string name = cost.name;
    measured.emplace(std::move(name), std::move(cost));
  }
  return measured;
}

double friction_ns(const Objects& objects) {
  return ns(objects.at("grit").touched) - ns(objects.at("marble").touched);
}

void print_kinds(const Objects& direct, const Objects& coupled) {
  for (const char* name : {"flat", "ribs", "block", "marble", "can", "pill", "ball", "home", "rail",
                           "bend", "syrup", "wind", "stops", "pole", "buzz"}) {
    const daemon::ObjectCost& object = direct.at(name);
    std::printf("    KindCost{\"%s\", %.0f, %.0f, %.0f},\n", object.kind.c_str(),
                ns(object.distant), ns(object.touched), ns(coupled.at(name).touched));
  }
}

/// Of a tick of the daemon's Cycle with devices in memory.
double loop_ns(std::size_t devices, std::size_t axes) {
  build::ProgramSpec spec;
  spec.axes.assign(devices * axes, {.max_effort = 10, .max_velocity = 10, .max_step = 1});
  for (std::size_t d = 0; d < devices; ++d) {
    const auto first = static_cast<std::uint16_t>(d * axes);
    spec.devices.push_back({.first_axis = first,
                            .axes = static_cast<std::uint16_t>(axes),
                            .first_coordinate = first,
                            .coordinates = static_cast<std::uint16_t>(axes),
                            .max_force = 10,
                            .max_slew = 5});
  }
  daemon::CostRig rig(spec);
  return daemon::tick_time(rig, ticks).ns;
}

double stage_ns(const config::Compiled& config) {
  return ns(daemon::cost(config, {.ticks = ticks}).stages.at(2).cost);
}

/// Devices of three coordinates, so many of them in a block.
double coupled_ns(std::size_t devices, std::size_t blocks_of) {
  std::string text = "version: 1\ndevices:\n";
  for (std::size_t d = 0; d < devices; ++d) {
    text += fmt::format(
        "  - {{name: d{}, driver: sim, latency_s: 0, kinematics: {{cartesian: {{directions: [x, y, "
        "z]}}}}, axes: [",
        d);
    for (const char* axis : {"x", "y", "z"})
      text += std::string("{name: ") + axis +
              ", encoder: {counts_per_m: 1.0e+6}, actuator: {max_force_N: 8}, model: {mass_kg: 1, "
              "damping_Ns_m: 5}}, ";
    text += "]}\n";
  }
  text += "coupling: {blocks: [";
  for (std::size_t d = 0; d < devices; d += blocks_of) {
    text += "{stiffness_N_m: 100, damping_Ns_m: 0.1, contacts: [";
    for (std::size_t i = 0; i < blocks_of; ++i) text += fmt::format("d{}, ", d + i);
    text += "]}, ";
  }
  text += "]}\nstability: {require: none}\n";
  auto document = config::read_text(text, "bench");
  if (!document) give_up(document.error());
  return stage_ns(compiled(std::move(*document)));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) ticks = std::strtoul(argv[1], nullptr, 10);
  const daemon::Machine machine = daemon::this_machine();
  std::printf("%s, %s, load %s\n", machine.processor.c_str(), machine.kernel.c_str(),
              machine.load.c_str());
  const Objects direct = measure_objects(false), coupled = measure_objects(true);
  print_kinds(direct, coupled);
  std::printf("plain plane %.1f, motion %.1f, friction %.1f\n", ns(direct.at("floor").touched),
              ns(direct.at("lid").distant) - ns(direct.at("block").distant), friction_ns(direct));
  std::printf("loop 1x1 %.1f 1x3 %.1f 3x1 %.1f 3x3 %.1f\n", loop_ns(1, 1), loop_ns(1, 3),
              loop_ns(3, 1), loop_ns(3, 3));
  std::printf("coupling 1 contact %.1f, 3 apart %.1f, 3 tied %.1f\n", coupled_ns(1, 1),
              coupled_ns(3, 1), coupled_ns(3, 3));
  return 0;
}
