// Scene objects to the plan's packed arrays, one entry per object and contact that feels it.
#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "config/compilation.h"
#include "config/describe.h"

namespace hapticd::config {
namespace {

/// Below this share of the unit normal a contact does not feel the plane: rounding, not geometry.
constexpr double kLeastShare = 1e-9;

class SceneCompiler {
 public:
  SceneCompiler(Compilation& compilation, const std::vector<DevicePlace>& places)
      : compilation_(compilation), places_(places) {
    for (const Device& device : compilation.config.devices) device_names_.push_back(device.name);
  }

  void add(const Plane& plane, const std::string& path) {
    const double length = std::hypot(plane.normal[0], plane.normal[1], plane.normal[2]);
    if (!(length > kLeastShare)) {
      compilation_.refuse(path + ".normal",
                          "a normal of length 0 points nowhere; for example [1, 0, 0]");
      return;
    }
    std::array<double, 3> unit{};
    for (std::size_t i = 0; i < unit.size(); ++i) unit[i] = plane.normal[i] / length;
    for (const std::size_t device : devices_of(plane.devices, path))
      add_contact(plane, unit, device, path);
  }

 private:
  /// Indices of the named devices; of all where none is named.
  std::vector<std::size_t> devices_of(const std::vector<std::string>& names,
                                      const std::string& path) {
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; names.empty() && i < device_names_.size(); ++i) indices.push_back(i);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string place = indexed(path + ".devices", i);
      const auto found = std::find(device_names_.begin(), device_names_.end(), names[i]);
      const auto index = static_cast<std::size_t>(found - device_names_.begin());
      if (found == device_names_.end()) {
        compilation_.refuse(place, unknown_name("device", names[i], device_names_));
      } else if (std::find(indices.begin(), indices.end(), index) != indices.end()) {
        compilation_.refuse(place, "device '" + names[i] + "' is named twice");
      } else {
        indices.push_back(index);
      }
    }
    return indices;
  }

  /// In world directions that the contact does not have it stays where its device stands.
  void add_contact(const Plane& plane, const std::array<double, 3>& unit, std::size_t device,
                   const std::string& path) {
    const DevicePlace& place = places_[device];
    const std::vector<std::size_t>& directions = place.frame.directions;
    control::PlaneContact made{.first_coordinate = place.first_coordinate,
                               .coordinates = static_cast<std::uint16_t>(directions.size()),
                               .offset = plane.offset_m - fixed_part(place.frame, unit),
                               .stiffness = plane.stiffness_N_m,
                               .damping = plane.damping_Ns_m};
    bool felt = false;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      made.normal[i] = unit[directions[i]];
      felt = felt || std::abs(made.normal[i]) > kLeastShare;
    }
    if (!felt) {
      compilation_.refuse(path + ".normal",
                          "device '" + device_names_[device] + "' (directions " +
                              words(directions) + ") moves along this plane and cannot feel it; " +
                              "turn the normal, or name in 'devices' only those that can");
    }
    compilation_.spec.planes.push_back(made);
  }

  /// n.x of the directions that the contact does not have [m].
  static double fixed_part(const ContactFrame& frame, const std::array<double, 3>& unit) {
    double sum = 0;
    for (std::size_t i = 0; i < unit.size(); ++i) {
      const bool moves =
          std::find(frame.directions.begin(), frame.directions.end(), i) != frame.directions.end();
      if (!moves) sum += unit[i] * frame.position[i];
    }
    return sum;
  }

  static std::string words(const std::vector<std::size_t>& directions) {
    std::string text;
    for (const std::size_t direction : directions) {
      text += (text.empty() ? "" : ", ") + std::string(word_of(static_cast<Direction>(direction)));
    }
    return text;
  }

  Compilation& compilation_;
  const std::vector<DevicePlace>& places_;
  std::vector<std::string> device_names_;
};

}  // namespace

void compile_scene(Compilation& compilation, const std::vector<DevicePlace>& places) {
  SceneCompiler compiler(compilation, places);
  for (std::size_t i = 0; i < compilation.config.scene.size(); ++i) {
    std::visit(
        [&]<class Object>(const Object& object) {
          compiler.add(object, indexed("scene", i) + "." + kKindOf<Object>);
        },
        compilation.config.scene[i]);
  }
}

}  // namespace hapticd::config
