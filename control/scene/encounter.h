// An encounter: one object and one contact that may feel it. All of a scene but the planes that are
// rendered directly (plane.h) is a list of encounters; the shapes and fields themselves stand in
// packed arrays per kind.
#pragma once
#include <array>
#include <cstdint>

#include "control/core/vec3.h"
#include "control/scene/mesh.h"
#include "control/scene/path.h"

namespace hapticd::control {

enum class ObjectKind : std::uint8_t {
  plane,
  relief,
  box,
  sphere,
  cylinder,
  capsule,
  mesh,  // bodies
  point,
  line,
  curve,  // guides: bodies that pull from both sides
  viscous,
  constant,
  detents,
  magnet,
  vibration,  // fields
};
constexpr bool is_guide(ObjectKind kind) noexcept {
  return kind >= ObjectKind::point && kind < ObjectKind::viscous;
}
constexpr bool is_field(ObjectKind kind) noexcept {
  return kind >= ObjectKind::viscous;
}

/// Compliance of a surface that is called rigid [m/N]: 10 N sink in by a picometre. Finite, so that
/// the theory has one case.
inline constexpr double kRigidCompliance = 1e-13;

/// What a body feels like.
struct Surface {
  double compliance = 0;        ///< m/N, > 0: 1 / stiffness
  double damping = 0;           ///< N s/m, >= 0, along the normal, while it pushes
  double static_friction = 0;   ///< mu, >= dynamic_friction; guides have none
  double dynamic_friction = 0;  ///< mu, >= 0
};

struct Encounter {
  ObjectKind kind = ObjectKind::plane;
  std::uint16_t contact = 0;
  std::uint32_t shape = 0;       ///< in the array of its kind
  std::uint32_t path = kNoPath;  ///< of an object that moves
  std::uint32_t walk = 0;        ///< meshes: in state.walks; curves: in state.segments
  Surface surface{};
};

/// What an encounter remembers. Points in the object's frame, so that they move with it.
struct Touch {
  Vec3 proxy{};       ///< m: the free point that the contact holds on to; meant where `touching`
  Vec3 normal{};      ///< unit
  Vec3 force{};       ///< N, world, on the contact
  double rest = 0;    ///< m: without friction its force is (rest - n.y) / yields along the normal n
  double yields = 0;  ///< m/N
  double pushed = 0;  ///< J: of a body that moves and was not touched: see visit.h
  bool touching = false;
  bool sliding = false;  ///< the proxy went with the hand in its last tick: dynamic friction
};

struct EncounterState {
  Touch now;   ///< as of the last tick
  Touch next;  ///< of this tick, while it is solved
};

/// A contact as the scene sees it: a point in space that may have fewer coordinates than three.
struct ContactPlan {
  std::uint16_t device = 0;
  std::uint16_t first_coordinate = 0;
  std::uint16_t coordinates = 0;
  std::uint16_t group = kNoGroup;           ///< of the coupling; kNoGroup: rendered directly
  std::uint16_t first_row = 0;              ///< of its coordinates in the group
  std::array<std::uint8_t, 3> direction{};  ///< of coordinate i: 0 x, 1 y, 2 z
  Vec3 fixed{};                             ///< m: where it stays in the directions it has not
  Mat3 give{};           ///< m/N: how its proxy yields to a force on it, world axes; 0: not at all
  bool even = true;      ///< `give` is the same in all three directions
  double radius = 0;     ///< m, >= 0: of its ball
  double max_force = 0;  ///< N: what a coupled contact never exceeds
  std::uint32_t first_encounter = 0;
  std::uint32_t encounters = 0;
  /// m: the list of near objects holds while the contact stays this near to where it was made; 0:
  /// too few objects to choose from, all are always near.
  double margin = 0;
  BoxTree objects{};  ///< items are encounters; bounds are those of the object on all of its path
  std::uint32_t first_boundless = 0;  ///< encounters from here to the end have no bounds

  static constexpr std::uint16_t kNoGroup = 0xffff;
};

struct ContactState;

/// A contact of a group while its tick is solved; nothing of it outlives the tick.
struct Member {
  const ContactPlan* plan = nullptr;
  ContactState* state = nullptr;
  Vec3 last{};                        ///< m: proxy of the last tick
  Vec3 proxy{};                       ///< m
  Vec3 slack{};                       ///< m: of the force limit
  Vec3 bodies{};                      ///< N: of all bodies and fields on it
  double changed = 0;                 ///< N: largest change of a force in the last sweep
  Vec3 found_proxy{}, found_slack{};  ///< aside, while the old ones are looked at
};

/// What a contact remembers.
struct ContactState {
  Vec3 proxy{};        ///< m: y, world; of a contact that is rendered directly its position
  Vec3 slack{};        ///< m: s of the force limit
  Vec3 near_centre{};  ///< where the list of near objects was made
  std::uint32_t near_count = 0;  ///< entries of the contact's part of state.near
  bool near_made = false;
};

}  // namespace hapticd::control
