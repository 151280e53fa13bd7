// What parts of a tick cost on the reference machine [ns]: figures of `bench_cost` (tests/bench),
// medians over six runs of it, point tool, without friction and motion. Others used that machine at
// the time: single runs were up to twice as fast. It is what `hapticctl cost` predicts from; on
// another machine the measured column is the one that counts, and their ratio says how much slower
// or faster that is.
#pragma once
#include <array>
#include <string_view>

namespace hapticd::daemon {

inline constexpr std::string_view kReferenceMachine =
    "a virtual machine of 2 AMD EPYC threads, Linux 6.18, GCC 12 -O3, shared with others";

/// One object that one device meets.
struct KindCost {
  std::string_view kind;
  double distant_ns;  ///< looked at, not touched
  double touched_ns;  ///< rendered directly
  double coupled_ns;  ///< touched through a coupling
};

inline constexpr std::array kKindCosts = {
    KindCost{"plane", 65, 80, 160},     KindCost{"texture", 74, 205, 281},
    KindCost{"box", 78, 151, 226},      KindCost{"sphere", 71, 98, 172},
    KindCost{"cylinder", 71, 150, 228}, KindCost{"capsule", 94, 122, 192},
    KindCost{"mesh", 80, 164, 242},     KindCost{"point", 74, 110, 171},
    KindCost{"line", 92, 128, 193},     KindCost{"curve", 111, 127, 204},
    KindCost{"viscous", 52, 52, 268},   KindCost{"constant", 66, 134, 726},
    KindCost{"detents", 111, 111, 800}, KindCost{"magnet", 64, 68, 448},
    KindCost{"vibration", 68, 72, 286},
};

/// A plane that a PlaneContact renders (control/scene/plane.h), touched or not.
inline constexpr double kPlainPlane_ns = 16;
/// More for each encounter with an object that moves, for a touch that slides with friction.
inline constexpr double kMotion_ns = 73;
inline constexpr double kFriction_ns = 469;

/// The loop: collect, sense, kinematics, guard, actuate, command, record.
inline constexpr double kLoop_ns = 130;
inline constexpr double kLoopDevice_ns = 42;
inline constexpr double kLoopAxis_ns = 23.5;
inline constexpr double kLinkage_ns = 146;  ///< a device with a Jacobian, more than a Cartesian one
inline constexpr double kDelta_ns = 428;    ///< a delta, more than another linkage

inline constexpr double kObserver_ns = 18;   ///< of one axis or coordinate
inline constexpr double kContact_ns = 37;    ///< a contact of a scene, with or without coupling
inline constexpr double kGroup_ns = 250;     ///< a group of contacts
inline constexpr double kGain_ns = 2.2;      ///< one number of a group's gains
inline constexpr double kBroadPhase_ns = 6;  ///< of a contact that has a list of near objects

}  // namespace hapticd::daemon
