// Parts of a config as programs of their own, for `hapticctl cost`.
#pragma once
#include <vector>

#include "config/compile.h"
#include "control/build/program.h"

namespace hapticd::daemon {

/// The config with these objects for its scene. `document` is copied: one without a scene of its own
/// makes that cheap. Networks belong to the coupling: add them where that is wanted.
config::Checked<build::ProgramSpec> with_objects(const config::Document& document,
                                                 std::vector<config::SceneObject> objects);

/// The networks of a scene.
std::vector<config::SceneObject> networks(const config::Config& config);

/// Contacts and coupling, but nothing to touch.
build::ProgramSpec without_objects(build::ProgramSpec spec);
/// No scene, no coupling.
build::ProgramSpec without_scene(build::ProgramSpec spec);
/// No disturbance observers.
build::ProgramSpec without_observers(build::ProgramSpec spec);
/// No search for references: it is over before anything is felt.
build::ProgramSpec without_homing(build::ProgramSpec spec);

/// The same contacts moved by ideal devices: axis i is coordinate i, raw values are metres, nothing
/// but the force limit bounds anything. What a scene costs does not depend on who moves the contact,
/// and an ideal device can put it anywhere.
build::ProgramSpec with_ideal_devices(build::ProgramSpec spec);

/// Raw values of all axes about a pose that the device's kinematics has: mid of the travel where one
/// is given, a linkage's home else; every axis goes 0.1 mm (0.1 mrad) per tick, or half its speed
/// limit.
struct Pose {
  std::vector<double> raw;   ///< per axis
  std::vector<double> step;  ///< raw units per tick
};
Pose working_pose(const build::ProgramSpec& spec);

}  // namespace hapticd::daemon
