// What the parts of the scene's compiler share. Each kind of object has an add(): shape or field
// into the packed array of its kind, and an encounter for every device that feels it.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "config/compilation.h"
#include "config/schema_scene.h"

namespace hapticd::config {

/// An object of the scene that is being compiled.
struct ObjectPlace {
  std::string path;                  ///< "scene[3].box"
  std::string label;                 ///< "box 'lid'"
  std::vector<std::size_t> devices;  ///< that feel it
};

struct SceneCompilation {
  Compilation& all;
  const std::vector<DevicePlace>& places;
  std::vector<bool> coupled;  ///< per coordinate: a block of the coupling names it
  std::vector<bool> grouped;  ///< per device: a block or a network names one of its coordinates
  /// Meshes that stand in spec.meshes, by file, scale, position and rotation.
  using MeshPose = std::tuple<std::string, double, Vector3, std::array<double, 4>>;
  std::map<MeshPose, std::uint32_t> meshes{};

  build::ProgramSpec& spec() const { return all.spec; }
};

/// Is the set of free points, or the potential, convex?
enum class Convex : bool { no, yes };

/// One encounter like `made` for each device; `made` has kind, shape, path and surface.
void meet(SceneCompilation& scene, const ObjectPlace& place, control::Encounter made,
          Convex convex);

/// Path of what moves, in spec.paths; kNoPath for what stays, or moves in a way that is reported.
std::uint32_t compile_motion(SceneCompilation& scene, const std::optional<Motion>& motion,
                             const ObjectPlace& place);

/// Number of the entry that is put at the end of one of the plan's arrays.
template <class T>
std::uint32_t put(std::vector<T>& array, T entry) {
  array.push_back(std::move(entry));
  return static_cast<std::uint32_t>(array.size() - 1);
}

// Surfaces.
void add(SceneCompilation& scene, const Plane& plane, const ObjectPlace& place);
void add(SceneCompilation& scene, const Texture& texture, const ObjectPlace& place);
void add(SceneCompilation& scene, const Box& box, const ObjectPlace& place);
void add(SceneCompilation& scene, const Sphere& sphere, const ObjectPlace& place);
void add(SceneCompilation& scene, const Cylinder& cylinder, const ObjectPlace& place);
void add(SceneCompilation& scene, const Capsule& capsule, const ObjectPlace& place);
void add(SceneCompilation& scene, const Mesh& mesh, const ObjectPlace& place);
// Guides and fields.
void add(SceneCompilation& scene, const PointGuide& guide, const ObjectPlace& place);
void add(SceneCompilation& scene, const LineGuide& guide, const ObjectPlace& place);
void add(SceneCompilation& scene, const CurveGuide& guide, const ObjectPlace& place);
void add(SceneCompilation& scene, const Viscous& field, const ObjectPlace& place);
void add(SceneCompilation& scene, const Constant& field, const ObjectPlace& place);
void add(SceneCompilation& scene, const Detents& field, const ObjectPlace& place);
void add(SceneCompilation& scene, const Magnet& field, const ObjectPlace& place);
void add(SceneCompilation& scene, const Vibration& field, const ObjectPlace& place);

/// Networks tie contacts together, so they come before what feels whether a contact is tied.
void compile_network(Compilation& compilation, const Network& network, const std::string& path);

/// What a surface feels like; nothing where its keys contradict each other (reported).
std::optional<control::Surface> compile_surface(SceneCompilation& scene, const Surface& surface,
                                                const ObjectPlace& place);

}  // namespace hapticd::config
