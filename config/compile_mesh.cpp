// Meshes: read once for each file, scale and pose, and put into the world (or the moving frame).
#include "config/describe.h"
#include "config/geometry.h"
#include "config/mesh_file.h"
#include "config/scene_compilation.h"

namespace hapticd::config {
namespace {

void place_vertices(build::TriangleSoup& soup, double scale, const Frame& frame) {
  for (Vec3& vertex : soup.vertices) vertex = to_world(frame, scale * vertex);
}

/// Number in spec.meshes; nothing where the file is none (reported).
std::optional<std::uint32_t> load(SceneCompilation& scene, const Mesh& mesh, const Frame& frame,
                                  const std::string& path) {
  auto made = read_mesh(mesh.file, static_cast<std::size_t>(mesh.max_triangles))
                  .and_then([&](build::TriangleSoup soup) {
                    place_vertices(soup, mesh.scale, frame);
                    return build::make_mesh(std::move(soup));
                  });
  if (!made) {
    const std::string& text = made.error().text;
    const bool named = text.find(mesh.file) != std::string::npos;
    scene.all.refuse(path, named ? text : mesh.file + ": " + text);
    return {};
  }
  return put(scene.spec().meshes, std::shared_ptr<const build::MeshData>(
                                      std::make_shared<build::MeshData>(std::move(*made))));
}

}  // namespace

void add(SceneCompilation& scene, const Mesh& mesh, const ObjectPlace& place) {
  const auto feel = compile_surface(scene, mesh, place);
  const std::uint32_t path = compile_motion(scene, mesh.motion, place);
  const auto turn =
      unit_quaternion(scene.all, mesh.rotation_quaternion, place.path + ".rotation_quaternion");
  const SceneCompilation::MeshPose pose{mesh.file, mesh.scale, mesh.position_m, turn};
  auto known = scene.meshes.find(pose);
  if (known == scene.meshes.end()) {
    const Frame frame{to_mat3(rotation_of(turn)), to_vec3(mesh.position_m)};
    const auto number = load(scene, mesh, frame, place.path + ".file");
    if (!number) return;
    known = scene.meshes.emplace(pose, *number).first;
  }
  if (!feel) return;
  meet(scene, place,
       {.kind = control::ObjectKind::mesh, .shape = known->second, .path = path, .surface = *feel},
       Convex::no);
}

}  // namespace hapticd::config
