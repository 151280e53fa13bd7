// What can be touched, one struct a kind. What kinds have in common is said once, in what they
// derive from.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace hapticd::config {

/// What every object but a network has.
struct Object {
  std::string name;
  std::vector<std::string> devices;  ///< empty: all
  bool operator==(const Object&) const = default;
};

struct Friction {
  double at_rest = 0;  ///< key `static`
  double dynamic = 0;
  bool operator==(const Friction&) const = default;
};

struct MotionWaypoint {
  double at_s = 0;
  std::array<double, 3> position_m{};
  std::array<double, 4> rotation_quaternion{1, 0, 0, 0};  ///< w, x, y, z
  bool operator==(const MotionWaypoint&) const = default;
};
struct Motion {
  std::vector<MotionWaypoint> waypoints;
  bool repeat = false;
  bool operator==(const Motion&) const = default;
};

/// What every surface has.
struct Surface : Object {
  std::optional<double> stiffness_N_m;  ///< or `rigid`
  bool rigid = false;
  double damping_Ns_m = 0;
  std::optional<Friction> friction;
  std::optional<Motion> motion;
  bool operator==(const Surface&) const = default;
};

struct Plane : Surface {
  std::array<double, 3> normal{};  ///< towards the free side; any length but 0
  double offset_m = 0;  ///< distance of the surface from the origin along the unit normal
  bool operator==(const Plane&) const = default;
};

enum class Profile { sinusoid, groove };
struct Texture : Surface {
  std::array<double, 3> normal{};
  double offset_m = 0;
  std::array<double, 3> along{};  ///< any length but 0; its part along the surface counts
  Profile profile = Profile::sinusoid;
  double amplitude_m = 0;
  double wavelength_m = 0;
  bool operator==(const Texture&) const = default;
};

enum class FreeSide { outside, inside };
struct Box : Surface {
  std::array<double, 3> center_m{};
  std::array<double, 3> size_m{};
  std::array<double, 4> rotation_quaternion{1, 0, 0, 0};
  FreeSide free = FreeSide::outside;
  bool operator==(const Box&) const = default;
};
struct Sphere : Surface {
  std::array<double, 3> center_m{};
  double radius_m = 0;
  FreeSide free = FreeSide::outside;
  bool operator==(const Sphere&) const = default;
};

/// Cylinders and capsules.
struct Round : Surface {
  std::array<double, 3> center_m{};
  std::array<double, 3> axis{};  ///< any length but 0
  double radius_m = 0;
  double length_m = 0;  ///< of a capsule without its caps
  FreeSide free = FreeSide::outside;
  bool operator==(const Round&) const = default;
};
struct Cylinder : Round {
  bool operator==(const Cylinder&) const = default;
};
struct Capsule : Round {
  bool operator==(const Capsule&) const = default;
};

struct Mesh : Surface {
  std::string file;
  double scale = 1;
  std::array<double, 3> position_m{};
  std::array<double, 4> rotation_quaternion{1, 0, 0, 0};
  int max_triangles = 2'000'000;
  bool operator==(const Mesh&) const = default;
};

/// What every guide has.
struct Guide : Object {
  double stiffness_N_m = 0;
  double damping_Ns_m = 0;
  std::optional<double> range_m;  ///< none: without end
  bool operator==(const Guide&) const = default;
};
struct PointGuide : Guide {
  std::array<double, 3> center_m{};
  bool operator==(const PointGuide&) const = default;
};
struct LineGuide : Guide {
  std::array<double, 3> center_m{};
  std::array<double, 3> axis{};
  std::optional<double> length_m;  ///< none: without end
  bool operator==(const LineGuide&) const = default;
};
struct CurveGuide : Guide {
  std::vector<std::array<double, 3>> points_m;
  bool closed = false;
  bool operator==(const CurveGuide&) const = default;
};

/// What fields in a ball have.
struct Field : Object {
  std::array<double, 3> center_m{};
  std::optional<double> radius_m;  ///< none: everywhere
  bool operator==(const Field&) const = default;
};
struct Viscous : Field {
  double damping_Ns_m = 0;
  bool operator==(const Viscous&) const = default;
};
struct Constant : Field {
  std::array<double, 3> force_N{};
  bool operator==(const Constant&) const = default;
};
struct Vibration : Field {
  std::array<double, 3> force_N{};
  double frequency_Hz = 0;
  double phase_rad = 0;
  bool operator==(const Vibration&) const = default;
};

struct Detents : Object {
  std::array<double, 3> along{};
  double offset_m = 0;
  double spacing_m = 0;
  double max_force_N = 0;
  int count = 0;  ///< 0: without end
  bool operator==(const Detents&) const = default;
};
struct Magnet : Object {
  std::array<double, 3> center_m{};
  double radius_m = 0;
  double range_m = 0;
  double max_force_N = 0;
  bool operator==(const Magnet&) const = default;
};

struct NetworkNode {
  std::string name;
  double mass_kg = 0;
  double position_m = 0;
  double load_N = 0;
  bool operator==(const NetworkNode&) const = default;
};
struct NetworkElement {
  std::array<std::string, 2> between;  ///< a device's coordinate, a node's name, or `ground`
  double stiffness_N_m = 0;
  double damping_Ns_m = 0;
  double rest_m = 0;
  bool operator==(const NetworkElement&) const = default;
};
struct Network {
  std::string name;
  std::vector<NetworkNode> nodes;
  std::vector<NetworkElement> elements;
  bool operator==(const Network&) const = default;
};

/// A scene entry is a map with one key, the kind.
using SceneObject =
    std::variant<Plane, Texture, Box, Sphere, Cylinder, Capsule, Mesh, PointGuide, LineGuide,
                 CurveGuide, Viscous, Constant, Detents, Magnet, Vibration, Network>;

}  // namespace hapticd::config
