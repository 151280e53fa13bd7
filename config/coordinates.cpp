#include "config/coordinates.h"

#include <algorithm>

#include "config/compilation.h"

namespace hapticd::config {

std::vector<std::uint32_t> coordinates_named(Compilation& compilation, const std::string& name,
                                             const std::string& path) {
  const build::ProgramSpec& spec = compilation.spec;
  const auto device =
      std::find(spec.device_names.begin(), spec.device_names.end(), name.substr(0, name.find('.')));
  if (device == spec.device_names.end()) {
    compilation.refuse(path,
                       unknown_name("device", name.substr(0, name.find('.')), spec.device_names));
    return {};
  }
  const auto index = static_cast<std::size_t>(device - spec.device_names.begin());
  const control::DevicePlan& plan = spec.devices[index];
  std::vector<std::uint32_t> all;
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < plan.coordinates; ++i) {
    all.push_back(plan.first_coordinate + i);
    names.push_back(spec.coordinate_names[all.back()]);
  }
  if (name == *device) return all;
  const auto one = std::find(names.begin(), names.end(), name);
  if (one != names.end()) return {all[static_cast<std::size_t>(one - names.begin())]};
  compilation.refuse(path, unknown_name("coordinate", name, names));
  return {};
}

std::vector<std::uint32_t> coordinates_named(Compilation& compilation,
                                             const std::vector<std::string>& names,
                                             const std::string& path) {
  std::vector<std::uint32_t> all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string place = indexed(path, i);
    const auto own = coordinates_named(compilation, names[i], place);
    if (own.empty()) return {};
    for (const std::uint32_t coordinate : own) {
      if (std::find(all.begin(), all.end(), coordinate) != all.end()) {
        compilation.refuse(place, compilation.spec.coordinate_names[coordinate] +
                                      " is named twice; keep one of them");
        return {};
      }
      all.push_back(coordinate);
    }
  }
  return all;
}

std::size_t device_of(const Compilation& compilation, std::uint32_t coordinate) {
  const auto& devices = compilation.spec.devices;
  const auto after = std::upper_bound(
      devices.begin(), devices.end(), coordinate,
      [](std::uint32_t c, const control::DevicePlan& d) { return c < d.first_coordinate; });
  return static_cast<std::size_t>(after - devices.begin()) - 1;
}

}  // namespace hapticd::config
