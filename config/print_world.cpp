#include "config/print_world.h"

#include "config/print_values.h"

namespace hapticd::config {
namespace {

template <class T>
std::string words(const T& described) {
  TextValues values("name");  // stands at the beginning of the line
  T copy = described;
  describe(values, copy);
  return values.text;
}

std::string object_text(const Config&, const Network& network) {
  return words(network);
}
/// Who feels it is said whether somebody wrote it or not.
template <class Kind>
std::string object_text(const Config& config, Kind object) {
  std::string names;
  for (const std::string& name : felt_by(config, object))
    names += (names.empty() ? "" : ", ") + name;
  object.devices.clear();
  return words(object) + ", felt by " + names;
}

std::string coupling_text(const Coupling& coupling) {
  std::string text;
  for (const CouplingBlock& block : coupling.blocks) text += "coupling: " + words(block) + "\n";
  return text + "solver: " + words(coupling.solver) + "\n";
}

/// What was mended in the meshes that were read.
std::string repairs_text(const build::ProgramSpec& spec) {
  std::string text;
  for (std::size_t i = 0; i < spec.meshes.size(); ++i) {
    for (const std::string& repair : spec.meshes[i]->repairs)
      text += "mesh " + std::to_string(i) + " was mended: " + repair + "\n";
  }
  return text;
}

}  // namespace

std::string name_without_unit(std::string_view key, std::string_view unit) {
  std::string suffix = "_";
  for (const char c : unit) {
    if (c != ' ') suffix += c == '/' ? '_' : c;
  }
  if (unit.empty() || !key.ends_with(suffix)) return std::string(key);
  return std::string(key.substr(0, key.size() - suffix.size()));
}

std::vector<std::string> felt_by(const Config& config, const Object& object) {
  if (!object.devices.empty()) return object.devices;
  std::vector<std::string> all;
  for (const Device& device : config.devices) all.push_back(device.name);
  return all;
}

std::string world_text(const Compiled& compiled) {
  const Config& config = compiled.document.config;
  std::string text;
  if (config.coupling) text += coupling_text(*config.coupling);
  if (config.scene.empty()) text += "scene: empty\n";
  for (const SceneObject& entry : config.scene) {
    text += std::visit(
        [&]<class Kind>(const Kind& object) {
          return std::string(kKindOf<Kind>) + " " + object.name + ": " +
                 object_text(config, object) + "\n";
        },
        entry);
  }
  return text + repairs_text(compiled.program->spec());
}

}  // namespace hapticd::config
