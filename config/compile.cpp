#include "config/compile.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "config/compilation.h"
#include "config/describe.h"
#include "config/nearest.h"
#include "config/number.h"
#include "config/places.h"
#include "config/text_check.h"
#include "config/yaml_tree.h"
#include "control/core/capacity.h"

namespace hapticd::config {
namespace {

constexpr std::size_t kMaxSocketBytes = 107;  // sockaddr_un::sun_path less its end

/// Reports names that come twice. `path_of(i)` is the path of name i.
template <class PathOf>
void check_unique(Compilation& compilation, const std::vector<std::string>& names, PathOf path_of) {
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [before, is_new] = first.emplace(names[i], i);
    if (is_new) continue;
    compilation.refuse(path_of(i), quote(names[i]) + " is the name of " + path_of(before->second) +
                                       " already; give each its own");
  }
}

std::vector<std::string> object_names(const Config& config) {
  std::vector<std::string> names;
  for (const SceneObject& object : config.scene) {
    names.push_back(std::visit([](const auto& shape) { return shape.name; }, object));
  }
  return names;
}

std::string object_path(const Config& config, std::size_t index) {
  const auto kind = [](const auto& shape) {
    return std::string(kKindOf<std::decay_t<decltype(shape)>>);
  };
  return indexed("scene", index) + "." + std::visit(kind, config.scene[index]) + ".name";
}

void make_relative_to(const std::filesystem::path& directory, std::string& path) {
  if (path.empty() || path.front() == '/') return;
  path = (directory / path).lexically_normal().string();
}

/// All that devices have in common.
void compile_world(Compilation& compilation, const std::vector<DevicePlace>& places) {
  compilation.felt.resize(places.size());
  compile_coupling(compilation);
  compile_scene(compilation, places);
  compile_shared_hand(compilation);
  if (!compilation.errors.empty()) return;
  compile_contacts(compilation, places);
  compile_sharpening(compilation, places);
}

void compile_all(Compilation& compilation) {
  check_capacities(compilation);
  if (!compilation.errors.empty()) return;  // the rest would say it again, once for each axis
  check_names(compilation);
  check_paths(compilation);
  check_stability(compilation);
  const Config& config = compilation.config;
  compilation.spec.period_s = 1 / config.loop.rate_Hz;
  std::vector<DevicePlace> places;
  for (std::size_t i = 0; i < config.devices.size(); ++i) {
    places.push_back(device_place(compilation, i));
    const DevicePlace& place = places.back();
    compile_device(compilation, place);
    compile_kinematics(compilation, place);
    compile_axes(compilation, place);
    compile_observers(compilation, place);
    compile_guard(compilation, place);
    compile_simulated(compilation, place);
  }
  compile_buses(compilation, places);
  compile_usb(compilation, places);
  if (compilation.errors.empty()) compile_world(compilation, places);
  compile_assumptions(compilation, places);
}

}  // namespace

namespace {

/// Where in which file a value of the config stands.
struct Origin {
  std::string file;
  const Places* places = nullptr;
  std::string path;  ///< within the file
};

Origin origin_of(const Document& document, const std::string& path) {
  constexpr std::string_view coupling = "coupling.";
  if (document.coupling_places && path.starts_with(coupling) && path != "coupling.file") {
    return {*document.config.coupling->file, document.coupling_places.get(),
            path.substr(coupling.size())};
  }
  for (const NamedModel& model : document.models) {
    if (path.starts_with(model.path + "."))
      return {model.file, model.places.get(), path.substr(model.path.size() + 1)};
  }
  return {document.path, document.places.get(), path};
}

}  // namespace

void Compilation::refuse(const std::string& path, std::string message) {
  if (errors.size() >= kMaxErrors) return;
  Origin origin = origin_of(document_, path);
  const Mark mark = origin.places != nullptr ? origin.places->find(origin.path) : Mark{};
  errors.push_back({.file = std::move(origin.file),
                    .line = mark.line,
                    .column = mark.column,
                    .path = std::move(origin.path),
                    .message = std::move(message)});
}

std::string indexed(std::string_view list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

std::string unknown_name(std::string_view what, const std::string& name,
                         const std::vector<std::string>& known) {
  const std::string near = nearest(name, known);
  std::string text = "there is no " + std::string(what) + " " + quote(name);
  if (!near.empty()) return text + "; did you mean '" + near + "'?";
  text += "; there are:";
  for (const std::string& word : known) text += " " + word;
  return text;
}

void check_capacities(Compilation& compilation) {
  const Config& config = compilation.config;
  const auto check = [&](const std::string& path, std::size_t count, std::size_t max,
                         const std::string& what) {
    if (count <= max) return;
    compilation.refuse(path, "expected at most " + std::to_string(max) + " " + what + ", found " +
                                 std::to_string(count) + "; split the set-up over several daemons");
  };
  check("devices", config.devices.size(), kMaxDevices, "devices");
  check("scene", config.scene.size(), kMaxObjects, "objects");
  std::size_t axes = 0;
  for (std::size_t i = 0; i < config.devices.size(); ++i) {
    const std::size_t own = config.devices[i].axes.size();
    check(indexed("devices", i) + ".axes", own, kMaxAxesPerDevice, "axes of a device");
    axes += own;
  }
  check("devices", axes, kMaxAxes, "axes over all devices");
  static_assert(kMaxCoordinates >= kMaxDevices * kMaxContactCoordinates);
}

void check_names(Compilation& compilation) {
  const Config& config = compilation.config;
  std::vector<std::string> devices;
  for (std::size_t i = 0; i < config.devices.size(); ++i) {
    devices.push_back(config.devices[i].name);
    std::vector<std::string> axes;
    for (const Axis& axis : config.devices[i].axes) axes.push_back(axis.name);
    const std::string list = indexed("devices", i) + ".axes";
    check_unique(compilation, axes,
                 [&](std::size_t axis) { return indexed(list, axis) + ".name"; });
  }
  check_unique(compilation, devices, [](std::size_t i) { return indexed("devices", i) + ".name"; });
  check_unique(compilation, object_names(config),
               [&](std::size_t i) { return object_path(config, i); });
}

void resolve_paths(Config& config, const std::string& config_path) {
  const std::filesystem::path directory = std::filesystem::path(config_path).parent_path();
  make_relative_to(directory, config.control.socket);
  make_relative_to(directory, config.telemetry.flight_dir);
  if (config.telemetry.record) make_relative_to(directory, *config.telemetry.record);
  if (config.coupling && config.coupling->file) make_relative_to(directory, *config.coupling->file);
  if (config.stability.proof) make_relative_to(directory, *config.stability.proof);
  for (Device& device : config.devices) {
    if (device.falcon && device.falcon->firmware)
      make_relative_to(directory, *device.falcon->firmware);
    for (Axis& axis : device.axes) {
      if (axis.model && axis.model->file) make_relative_to(directory, *axis.model->file);
    }
  }
  for (SceneObject& object : config.scene) {
    if (auto* mesh = std::get_if<Mesh>(&object)) make_relative_to(directory, mesh->file);
  }
}

void check_paths(Compilation& compilation) {
  const std::string& socket = compilation.config.control.socket;
  if (socket.empty()) compilation.refuse("control.socket", "expected a path, found an empty text");
  if (socket.size() > kMaxSocketBytes) {
    compilation.refuse("control.socket",
                       "expected a path of at most 107 bytes (the system's limit), found " +
                           std::to_string(socket.size()) + ": " + socket +
                           "; choose a shorter one");
  }
  const std::optional<std::string>& record = compilation.config.telemetry.record;
  if (record && record->empty()) {
    compilation.refuse("telemetry.record",
                       "expected a path, found an empty text; null means no recording");
  }
}

void check_stability(Compilation& compilation) {
  const std::optional<HandRange>& hand = compilation.config.stability.hand;
  const auto check = [&](const char* key, const Range& range) {
    if (range[0] <= range[1]) return;
    compilation.refuse(std::string("stability.hand.") + key,
                       "expected the least and then the greatest, found " +
                           format_number(range[0]) + ", " + format_number(range[1]));
  };
  const PaperModel& paper = compilation.config.stability.paper;
  const auto all_zero = [](const std::vector<double>& powers) {
    return std::ranges::all_of(powers, [](double x) { return x == 0; });
  };
  if (all_zero(paper.weight_numerator))
    compilation.refuse("stability.paper.weight_numerator",
                       "expected some coefficient that is not 0");
  if (all_zero(paper.weight_denominator) || paper.weight_denominator.back() == 0)
    compilation.refuse("stability.paper.weight_denominator",
                       "expected the highest power's coefficient not to be 0");
  if (paper.weight_numerator.size() > paper.weight_denominator.size())
    compilation.refuse("stability.paper.weight_numerator",
                       "expected no higher powers than in weight_denominator");
  if (!hand) return;
  check("mass_kg", hand->mass_kg);
  check("damping_Ns_m", hand->damping_Ns_m);
  check("stiffness_N_m", hand->stiffness_N_m);
}

Checked<Compiled> compile(Document document) {
  resolve_paths(document.config, document.path);
  const std::optional<Coupling>& coupling = document.config.coupling;
  if (coupling && coupling->file && !document.coupling_places) {
    if (auto errors = read_coupling(document); !errors.empty()) return tl::unexpected(errors);
  }
  if (auto errors = read_models(document); !errors.empty()) return tl::unexpected(errors);
  if (auto errors = read_proofs(document); !errors.empty()) return tl::unexpected(errors);
  Compilation compilation(document);
  compile_all(compilation);
  if (!compilation.errors.empty()) return tl::unexpected(std::move(compilation.errors));
  Compiled compiled;
  compiled.program = std::make_unique<build::Program>(std::move(compilation.spec));
  compiled.simulated = std::move(compilation.simulated);
  compiled.shared_hand = std::move(compilation.shared_hand);
  compiled.can = std::move(compilation.can);
  compiled.buses = std::move(compilation.buses);
  compiled.usb = std::move(compilation.usb);
  compiled.collect_s = compilation.collect_s;
  compiled.assumed = std::move(compilation.assumed);
  compiled.document = std::move(document);
  compile_certificate(compiled);
  return compiled;
}

Checked<Compiled> load(const std::string& path) {
  return read_file(path).and_then(compile);
}

}  // namespace hapticd::config
