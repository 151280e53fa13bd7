// What the parts of compile() share: the config, what is made of it so far, and the errors.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "config/compile.h"
#include "config/effective_guard.h"

namespace hapticd::config {

class Compilation {
 public:
  explicit Compilation(const Document& document) : config(document.config), document_(document) {}

  /// An error at the value of `path`, or at what is nearest to it in the file.
  void refuse(const std::string& path, std::string message);

  const Config& config;
  build::ProgramSpec spec;
  std::vector<sim::DeviceOptions> simulated;
  std::vector<check::DeviceAssumption> assumed;
  std::vector<ConfigError> errors;

 private:
  const Document& document_;
};

/// Device `index` with the path that errors name it by.
struct DevicePlace {
  const Device& device;
  std::string path;  ///< "devices[0]"
  EffectiveGuard guard;
};

/// "devices" and 3: "devices[3]".
std::string indexed(std::string_view list, std::size_t index);
/// "no device 'x'; did you mean 'y'?" or "; there are: ...".
std::string unknown_name(std::string_view what, const std::string& name,
                         const std::vector<std::string>& known);

// In this order; the devices have to be sound for what follows.
void check_capacities(Compilation& compilation);
void check_names(Compilation& compilation);
void compile_device(Compilation& compilation, const DevicePlace& place);
void compile_simulated(Compilation& compilation, const DevicePlace& place);
void compile_scene(Compilation& compilation);
/// Relative paths are relative to the config's directory.
void resolve_paths(Config& config, const std::string& config_path);
void check_paths(Compilation& compilation);

}  // namespace hapticd::config
