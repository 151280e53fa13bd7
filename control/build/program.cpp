#include "control/build/program.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "control/build/scene.h"
#include "control/record.h"
#include "control/recorded.h"

namespace hapticd::build {
namespace {

/// Cuts one block of zeros into the spans that are taken from it, in the order of taking.
class Block {
 public:
  Block(std::vector<double>& storage, std::size_t size) : storage_(storage) {
    storage_.assign(size, 0.0);
  }
  std::span<double> take(std::size_t count) {
    const std::span<double> part(storage_.data() + taken_, count);
    taken_ += count;
    return part;
  }

 private:
  std::vector<double>& storage_;
  std::size_t taken_ = 0;
};

}  // namespace

Program::Program(ProgramSpec spec)
    : spec_(std::move(spec)), scene_(std::make_unique<Scene>(arrange_scene(spec_))) {
  complete_kinematics();
  make_plan();
  make_state();
  make_scene_state();
}

Program::~Program() = default;

std::size_t Program::coordinates() const noexcept {
  std::size_t count = 0;
  for (const control::DevicePlan& device : spec_.devices) count += device.coordinates;
  return count;
}

void Program::complete_kinematics() {
  std::vector<bool> mapped(spec_.axes.size(), false);
  for (const control::CartesianAxis& pair : spec_.cartesian_axes) mapped[pair.axis] = true;
  for (control::Linkage& linkage : spec_.linkages) {
    for (std::size_t i = 0; i < linkage.axes; ++i) mapped[linkage.first_axis + i] = true;
    linkage.jacobian = static_cast<std::uint32_t>(jacobian_size_);
    jacobian_size_ += std::size_t{linkage.axes} * linkage.coordinates;
  }
  for (const control::DevicePlan& device : spec_.devices) {
    for (std::uint16_t i = 0; i < device.axes; ++i) {
      if (mapped[device.first_axis + i]) continue;
      spec_.cartesian_axes.push_back(
          {.axis = static_cast<std::uint16_t>(device.first_axis + i),
           .coordinate = static_cast<std::uint16_t>(device.first_coordinate + i)});
    }
  }
}

void Program::make_plan() {
  plan_ = {.period_s = spec_.period_s,
           .rate_Hz = 1.0 / spec_.period_s,
           .axes = spec_.axes,
           .devices = spec_.devices,
           .stuck_watches = spec_.stuck_watches,
           .homings = spec_.homings,
           .low_passes = spec_.low_passes,
           .least_squares = spec_.least_squares,
           .foaws = spec_.foaws,
           .alpha_beta_gammas = spec_.alpha_beta_gammas,
           .cartesian_axes = spec_.cartesian_axes,
           .linkages = spec_.linkages,
           .linear_maps = spec_.linear_maps,
           .five_bars = spec_.five_bars,
           .deltas = spec_.deltas,
           .serials = spec_.serials,
           .force_sensors = spec_.force_sensors,
           .gravity_axes = spec_.gravity_axes,
           .gravity_tips = spec_.gravity_tips,
           .frictions = spec_.frictions,
           .axis_observers = spec_.axis_observers,
           .contact_observers = spec_.contact_observers,
           .planes = spec_.planes,
           .contacts = spec_.contacts,
           .encounters = spec_.encounters,
           .free_planes = spec_.free_planes,
           .reliefs = spec_.reliefs,
           .boxes = spec_.boxes,
           .spheres = spec_.spheres,
           .cylinders = spec_.cylinders,
           .capsules = spec_.capsules,
           .meshes = scene_->meshes,
           .point_guides = spec_.point_guides,
           .line_guides = spec_.line_guides,
           .curve_guides = spec_.curve_guides,
           .curve_points = spec_.curve_points,
           .viscous_fields = spec_.viscous_fields,
           .constant_fields = spec_.constant_fields,
           .detents = spec_.detents,
           .magnets = spec_.magnets,
           .vibrations = spec_.vibrations,
           .paths = spec_.paths,
           .waypoints = spec_.waypoints,
           .groups = scene_->groups.groups,
           .group_contacts = scene_->groups.group_contacts,
           .gains = scene_->groups.gains,
           .travels = spec_.travels,
           .power_limits = spec_.power_limits,
           .thermals = spec_.thermals,
           .workspaces = spec_.workspaces,
           .enable_inputs = spec_.enable_inputs,
           .passivity_controllers = spec_.passivity_controllers,
           .coordinates = coordinates(),
           .record = {}};
  plan_.record = control::record_layout(plan_);
}

void Program::make_state() {
  const auto make = [](auto& storage, auto& span, std::size_t count) {
    storage.resize(count);
    span = storage;
  };
  make(axes_, state_.axes, spec_.axes.size());
  make(ledger_, state_.ledger, spec_.axes.size());
  make(homings_, state_.homings, spec_.homings.size());
  make(low_passes_, state_.low_passes, spec_.low_passes.size());
  make(least_squares_, state_.least_squares, spec_.least_squares.size());
  make(foaws_, state_.foaws, spec_.foaws.size());
  make(alpha_beta_gammas_, state_.alpha_beta_gammas, spec_.alpha_beta_gammas.size());
  make(linkages_, state_.linkages, spec_.linkages.size());
  make(axis_observers_, state_.axis_observers, spec_.axis_observers.size());
  make(contact_observers_, state_.contact_observers, spec_.contact_observers.size());
  make(passivity_controllers_, state_.passivity_controllers, spec_.passivity_controllers.size());
  make(heat_, state_.heat, spec_.thermals.size());
  make(jacobian_, state_.jacobian, jacobian_size_);

  std::size_t size = 0;
  for (const control::RecordedField& field : control::kRecorded)
    size += (plan_.record.*field.layout).count;
  Block block(recorded_, size);
  for (const control::RecordedField& field : control::kRecorded)
    state_.*field.state = block.take((plan_.record.*field.layout).count);
  state_.recorded = recorded_;

  const std::size_t axes = spec_.axes.size(), devices = spec_.devices.size();
  Block rest(unrecorded_, 3 * plan_.coordinates + 2 * axes + 2 * devices);
  for (auto* part : {&state_.v, &state_.slewed, &state_.contact_delivered})
    *part = rest.take(plan_.coordinates);
  for (auto* part : {&state_.feedforward, &state_.beside}) *part = rest.take(axes);
  for (auto* part : {&state_.reach, &state_.ramp}) *part = rest.take(devices);
  std::fill(state_.reach.begin(), state_.reach.end(), 1.0);
  std::fill(state_.fade.begin(), state_.fade.end(), 1.0);
}

void Program::make_scene_state() {
  const auto make = [](auto& storage, auto& span, std::size_t count) {
    storage.resize(count);
    span = storage;
  };
  make(encounters_, state_.encounters, spec_.encounters.size());
  make(walks_, state_.walks, scene_->walks);
  make(segments_, state_.segments, scene_->segments);
  make(contacts_, state_.contacts, spec_.contacts.size());
  make(members_, state_.members, scene_->groups.group_contacts.size());
  make(near_, state_.near, spec_.encounters.size());
  make(coupling_memory_, state_.coupling_memory, scene_->groups.memory);
  make(network_, state_.network, scene_->groups.states);
  std::iota(near_.begin(), near_.end(), 0u);
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    contacts_[c].near_count = spec_.contacts[c].encounters;
    contacts_[c].proxy = spec_.contacts[c].fixed;
  }
}

}  // namespace hapticd::build
