// What the parts of compile() share: the config, what is made of it so far, and the errors.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/axis_values.h"
#include "config/compile.h"
#include "config/contact_frame.h"
#include "config/effective_guard.h"

namespace hapticd::config {

/// Objects that a device feels and that a proof has to know by name: "sphere 'ball'".
struct FeltObjects {
  std::vector<std::string> moving;
  std::vector<std::string> swinging;
  std::vector<std::string> nonconvex;  ///< their free side, or their potential, is
};

class Compilation {
 public:
  explicit Compilation(const Document& document) : config(document.config), document_(document) {}

  /// An error at the value of `path`, or at what is nearest to it in the file.
  void refuse(const std::string& path, std::string message);

  const Config& config;
  build::ProgramSpec spec;
  std::vector<sim::DeviceOptions> simulated;
  std::optional<sim::SharedHandOptions> shared_hand;
  std::vector<FeltObjects> felt;  ///< per device
  std::vector<check::DeviceAssumption> assumed;
  std::vector<std::optional<can::DeviceOptions>> can;  ///< per device
  std::vector<can::BusLoad> buses;
  std::vector<std::optional<usb::DeviceOptions>> usb;  ///< per device
  double collect_s = 0;
  std::vector<ConfigError> errors;

  const Document& document() const { return document_; }

 private:
  const Document& document_;
};

/// One device with all that its parts are compiled from.
struct DevicePlace {
  const Device& device;
  std::uint16_t index = 0;
  std::string path;  ///< that errors name it by: "devices[0]"
  EffectiveGuard guard;
  ContactFrame frame;
  std::vector<AxisValues> axes;
  std::uint16_t first_axis = 0;
  std::uint16_t first_coordinate = 0;

  std::uint16_t axis(std::size_t own) const { return static_cast<std::uint16_t>(first_axis + own); }
  std::uint16_t coordinate(std::size_t own) const {
    return static_cast<std::uint16_t>(first_coordinate + own);
  }
};

/// "devices" and 3: "devices[3]".
std::string indexed(std::string_view list, std::size_t index);
/// "no device 'x'; did you mean 'y'?" or "; there are: ...".
std::string unknown_name(std::string_view what, const std::string& name,
                         const std::vector<std::string>& known);

// In this order; the devices have to be sound for what follows.
void check_capacities(Compilation& compilation);
void check_names(Compilation& compilation);
/// Of the device that comes after those that are in `compilation.spec`.
DevicePlace device_place(Compilation& compilation, std::size_t index);
// Each adds one part of the device to `compilation.spec`.
void compile_device(Compilation& compilation, const DevicePlace& place);
void compile_kinematics(Compilation& compilation, const DevicePlace& place);
void compile_axes(Compilation& compilation, const DevicePlace& place);
void compile_observers(Compilation& compilation, const DevicePlace& place);
void compile_guard(Compilation& compilation, const DevicePlace& place);
void compile_simulated(Compilation& compilation, const DevicePlace& place);
/// Refuses a cutoff of half the rate or more, at `path`.cutoff_Hz.
void check_cutoff(Compilation& compilation, const std::string& path, double cutoff_Hz);
/// Devices of CAN drives, and whether their buses have room for them.
void compile_buses(Compilation& compilation, const std::vector<DevicePlace>& places);
/// Devices on USB; after the buses of CAN, which the loop may wait for.
void compile_usb(Compilation& compilation, const std::vector<DevicePlace>& places);
/// Of all devices; what follows knows what it names.
void compile_coupling(Compilation& compilation);
void compile_scene(Compilation& compilation, const std::vector<DevicePlace>& places);
/// Where the scene or a coupling needs them.
void compile_contacts(Compilation& compilation, const std::vector<DevicePlace>& places);
/// How much sharper the descent check has to be under latency.
void compile_sharpening(Compilation& compilation, const std::vector<DevicePlace>& places);
void compile_shared_hand(Compilation& compilation);
/// What the stability check may assume of each device, and what keeps it from a proof.
void compile_assumptions(Compilation& compilation, const std::vector<DevicePlace>& places);
/// Of a designed coupling, held against what is compiled; fills the last two of `compiled`.
void compile_certificate(Compiled& compiled);
/// Relative paths are relative to the config's directory.
void resolve_paths(Config& config, const std::string& config_path);
void check_paths(Compilation& compilation);
/// Ranges and weights of `stability`.
void check_stability(Compilation& compilation);
/// Of the file that `document.config.coupling` names, into it. Empty: it is sound.
std::vector<ConfigError> read_coupling(Document& document);
/// Of all model files that axes of `document.config` name, into them.
std::vector<ConfigError> read_models(Document& document);
/// Of the file that `document.config.stability.proof` names.
std::vector<ConfigError> read_proofs(Document& document);

}  // namespace hapticd::config
