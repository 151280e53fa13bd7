// The scene as a whole: networks first, then object by object, one encounter for every contact that
// feels it.
#include <algorithm>
#include <variant>

#include "config/coordinates.h"
#include "config/describe.h"
#include "config/scene_compilation.h"

namespace hapticd::config {
namespace {

/// Indices of the named devices; of all where none is named.
std::vector<std::size_t> devices_of(Compilation& compilation, const Object& object,
                                    const std::string& path) {
  const std::vector<std::string>& known = compilation.spec.device_names;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; object.devices.empty() && i < known.size(); ++i) indices.push_back(i);
  for (std::size_t i = 0; i < object.devices.size(); ++i) {
    const std::string& name = object.devices[i];
    const std::string place = indexed(path + ".devices", i);
    const auto found = std::find(known.begin(), known.end(), name);
    const auto index = static_cast<std::size_t>(found - known.begin());
    if (found == known.end()) {
      compilation.refuse(place, unknown_name("device", name, known));
    } else if (std::find(indices.begin(), indices.end(), index) != indices.end()) {
      compilation.refuse(place, "device '" + name + "' is named twice");
    } else {
      indices.push_back(index);
    }
  }
  return indices;
}

SceneCompilation scene_compilation(Compilation& compilation,
                                   const std::vector<DevicePlace>& places) {
  SceneCompilation scene{.all = compilation,
                         .places = places,
                         .coupled = std::vector<bool>(compilation.spec.coordinate_names.size()),
                         .grouped = std::vector<bool>(places.size())};
  for (const build::CouplingBlock& block : compilation.spec.coupling) {
    for (const std::uint32_t coordinate : block.coordinates) {
      scene.coupled[coordinate] = true;
      scene.grouped[device_of(compilation, coordinate)] = true;
    }
  }
  for (const build::Network& network : compilation.spec.networks) {
    for (const build::NetworkElement& element : network.elements) {
      for (const build::NetworkEnd& end : {element.a, element.b}) {
        if (end.at == build::NetworkEnd::At::coordinate)
          scene.grouped[device_of(compilation, end.index)] = true;
      }
    }
  }
  return scene;
}

/// Calls `action(object, path)` for each object of the scene.
template <class Action>
void for_each_object(const Config& config, Action action) {
  for (std::size_t i = 0; i < config.scene.size(); ++i) {
    std::visit(
        [&]<class Kind>(const Kind& object) {
          action(object, indexed("scene", i) + "." + kKindOf<Kind>);
        },
        config.scene[i]);
  }
}

}  // namespace

void meet(SceneCompilation& scene, const ObjectPlace& place, control::Encounter made,
          Convex convex) {
  for (const std::size_t device : place.devices) {
    made.contact = static_cast<std::uint16_t>(device);
    scene.spec().encounters.push_back(made);
    FeltObjects& felt = scene.all.felt[device];
    if (made.path != control::kNoPath) felt.moving.push_back(place.label);
    if (made.kind == control::ObjectKind::vibration) felt.swinging.push_back(place.label);
    if (convex == Convex::no) felt.nonconvex.push_back(place.label);
  }
}

void compile_scene(Compilation& compilation, const std::vector<DevicePlace>& places) {
  const Config& config = compilation.config;
  for_each_object(config, [&]<class Kind>(const Kind& object, const std::string& path) {
    if constexpr (std::is_same_v<Kind, Network>) compile_network(compilation, object, path);
  });
  SceneCompilation scene = scene_compilation(compilation, places);
  for_each_object(config, [&]<class Kind>(const Kind& object, const std::string& path) {
    if constexpr (!std::is_same_v<Kind, Network>) {
      add(scene, object,
          ObjectPlace{.path = path,
                      .label = std::string(kKindOf<Kind>) + " '" + object.name + "'",
                      .devices = devices_of(compilation, object, path)});
    }
  });
}

}  // namespace hapticd::config
