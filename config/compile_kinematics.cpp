// Kinematics, weight and force sensor of one device to the plan's arrays.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "config/compilation.h"
#include "config/describe.h"
#include "config/linkage_geometry.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

class KinematicsCompiler {
 public:
  KinematicsCompiler(Compilation& compilation, const DevicePlace& place)
      : compilation_(compilation),
        spec_(compilation.spec),
        place_(place),
        path_(place.path + ".kinematics.") {}

  void add(const Cartesian& cartesian) {
    if (!check_directions(cartesian) || !check_kinds("cartesian", false)) return;
    if (along_world_directions()) {
      add_axes();
      return;
    }
    control::LinearMap map = linear_map(cartesian);
    map.linkage = add_linkage();
    spec_.linear_maps.push_back(map);
  }

  void add(const FiveBar& bars) {
    if (!check_count("five_bar", 2) || !check_kinds("five_bar", true)) return;
    if (bars.base_m >= 4 * bars.link_m) {
      compilation_.refuse(path_ + "five_bar.base_m", "expected less than four times link_m, " +
                                                         format_number(4 * bars.link_m) +
                                                         " m, or the links do not meet; found " +
                                                         format_number(bars.base_m) + " m");
    }
    control::FiveBar made = five_bar(bars);
    made.linkage = add_linkage();
    spec_.five_bars.push_back(made);
  }

  void add(const Delta& legs) {
    if (!check_count("delta", 3) || !check_kinds("delta", true)) return;
    control::Delta made = delta(legs);
    std::array<double, 3> angles{};
    if (!control::joints_of(made, made.home, angles.data())) {
      compilation_.refuse(path_ + "delta.home_m",
                          "this position is out of reach of the legs; give one well inside the "
                          "workspace, or correct the lengths");
    }
    made.linkage = add_linkage();
    spec_.deltas.push_back(made);
  }

  void add(const Serial& chain) {
    if (!check_count("serial.joints", chain.joints.size()) || !check_joints(chain)) return;
    const std::optional<Gravity>& gravity = place_.device.gravity;
    if (!gravity && has_mass(chain)) {
      compilation_.refuse(path_ + "serial.joints",
                          "links have masses, but the device has no 'gravity' that its motors "
                          "should hold them against; add it (gravity: {} is the earth's), or "
                          "remove the masses");
    }
    control::Serial made = serial(chain);
    if (gravity) made.gravity = place_.frame.into_device(gravity->acceleration_m_s2);
    made.linkage = add_linkage();
    spec_.serials.push_back(made);
  }

 private:
  bool check_count(const std::string& key, std::size_t joints) {
    if (joints == place_.axes.size()) return true;
    compilation_.refuse(path_ + key, "expected as many axes as joints, " + std::to_string(joints) +
                                         ", found " + std::to_string(place_.axes.size()) + " axes");
    return false;
  }

  bool check_kind(std::size_t axis, const std::string& kind, bool rotary) {
    if (place_.axes[axis].rotary == rotary) return true;
    compilation_.refuse(place_.axes[axis].path + ".kind",
                        std::string("expected ") + (rotary ? "rotary" : "linear") +
                            ", as kinematics." + kind + " has it, found " +
                            (rotary ? "linear" : "rotary"));
    return false;
  }

  bool check_kinds(const std::string& kind, bool rotary) {
    bool sound = true;
    for (std::size_t i = 0; i < place_.axes.size(); ++i) sound &= check_kind(i, kind, rotary);
    return sound;
  }

  bool check_joints(const Serial& chain) {
    bool sound = true;
    for (std::size_t i = 0; i < chain.joints.size(); ++i)
      sound &= check_kind(i, indexed("serial.joints", i), !chain.joints[i].prismatic);
    return sound;
  }

  bool check_directions(const Cartesian& cartesian) {
    const std::vector<Direction>& directions = cartesian.directions;
    const std::string path = path_ + "cartesian.directions";
    bool sound = directions.size() == place_.axes.size();
    if (!sound) {
      compilation_.refuse(path, "expected one direction for each of the " +
                                    std::to_string(place_.axes.size()) + " axes, found " +
                                    std::to_string(directions.size()));
    }
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const auto before = directions.begin() + static_cast<std::ptrdiff_t>(i);
      if (std::find(directions.begin(), before, directions[i]) == before) continue;
      sound = false;
      compilation_.refuse(
          indexed(path, i),
          "direction '" + std::string(word_of(directions[i])) +
              "' is taken by another axis; two motors on one direction are not supported");
    }
    return sound;
  }

  /// Of coordinate `coordinate` per unit of axis `axis`.
  double share(std::size_t coordinate, std::size_t axis) const {
    const Vector3 turn = place_.frame.turn(coordinate);
    const Vector3& motion = place_.frame.motions[axis];
    return turn[0] * motion[0] + turn[1] * motion[1] + turn[2] * motion[2];
  }

  /// Does every axis move the contact along one world direction only? Axes stand at right angles,
  /// so each direction then has one axis.
  bool along_world_directions() const {
    return place_.frame.directions.size() == place_.frame.motions.size() &&
           std::none_of(place_.frame.motions.begin(), place_.frame.motions.end(),
                        [&](const Vector3& motion) { return is_slanted(motion); });
  }

  bool is_slanted(const Vector3& motion) const {
    const Matrix3& r = place_.frame.rotation;
    return std::none_of(r.begin(), r.end(), [&](const Vector3& row) {
      return std::abs(row[0] * motion[0] + row[1] * motion[1] + row[2] * motion[2]) == 1;
    });
  }

  void add_axes() {
    for (std::size_t coordinate = 0; coordinate < place_.frame.directions.size(); ++coordinate) {
      for (std::size_t axis = 0; axis < place_.axes.size(); ++axis) {
        if (share(coordinate, axis) == 0) continue;
        spec_.cartesian_axes.push_back(
            {.axis = place_.axis(axis),
             .coordinate = place_.coordinate(coordinate),
             .scale = share(coordinate, axis),
             .origin = place_.frame.position[place_.frame.directions[coordinate]]});
      }
    }
  }

  /// Its index.
  std::uint16_t add_linkage() {
    const ContactFrame& frame = place_.frame;
    control::Linkage linkage{.device = place_.index,
                             .first_axis = place_.first_axis,
                             .axes = static_cast<std::uint16_t>(place_.axes.size()),
                             .first_coordinate = place_.first_coordinate,
                             .coordinates = static_cast<std::uint16_t>(frame.directions.size())};
    linkage.rotary = std::any_of(place_.axes.begin(), place_.axes.end(),
                                 [](const AxisValues& axis) { return axis.rotary; });
    for (std::size_t i = 0; i < frame.directions.size(); ++i) {
      linkage.origin[i] = frame.position[frame.directions[i]];
      linkage.turn[i] = frame.turn(i);
    }
    spec_.linkages.push_back(linkage);
    return static_cast<std::uint16_t>(spec_.linkages.size() - 1);
  }

  Compilation& compilation_;
  build::ProgramSpec& spec_;
  const DevicePlace& place_;
  std::string path_;
};

/// A mass at the tip: its weight, upwards, on the contact's coordinates.
void add_tip_weight(build::ProgramSpec& spec, const DevicePlace& place) {
  const std::optional<Gravity>& gravity = place.device.gravity;
  if (!gravity || gravity->tip_mass_kg == 0) return;
  control::GravityTip tip{.device = place.index};
  for (std::size_t i = 0; i < place.frame.directions.size(); ++i) {
    tip.weight[i] = -gravity->tip_mass_kg * gravity->acceleration_m_s2[place.frame.directions[i]] /
                    place.frame.scale;
  }
  spec.gravity_tips.push_back(tip);
}

/// Forces are measured at the hand; the scene has them in its own scale.
void add_force_sensor(Compilation& compilation, const DevicePlace& place) {
  if (!place.device.force_sensor) return;
  const std::vector<Direction>& channels = place.device.force_sensor->directions;
  control::ForceSensor sensor{.device = place.index,
                              .channels = static_cast<std::uint16_t>(channels.size())};
  for (std::size_t i = 0; i < place.frame.directions.size(); ++i) {
    const Vector3& row = place.frame.rotation[place.frame.directions[i]];
    for (std::size_t j = 0; j < channels.size(); ++j) {
      sensor.turn[i][j] = row[static_cast<std::size_t>(channels[j])] / place.frame.scale;
    }
  }
  compilation.spec.force_sensors.push_back(sensor);
}

}  // namespace

void compile_kinematics(Compilation& compilation, const DevicePlace& place) {
  KinematicsCompiler compiler(compilation, place);
  std::visit([&](const auto& kind) { compiler.add(kind); }, place.device.kinematics);
  add_tip_weight(compilation.spec, place);
  add_force_sensor(compilation, place);
}

}  // namespace hapticd::config
