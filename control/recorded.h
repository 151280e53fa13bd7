// The one list of what a record holds of the state: which span of State, which array of
// RecordLayout, the name and quantity that recordings give it. Program lays the state out in this
// order, write_record() copies it, daemon/recording names it. A new term of force is one row.
#pragma once
#include <array>

#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

enum class Per : std::uint8_t { axis, coordinate, device };

/// Of one value; `position`, `velocity` and `effort` have the axis' units (m or rad, ...).
enum class Quantity : std::uint8_t { position, velocity, effort, metre, newton, joule, share };

struct RecordedField {
  std::span<double> State::*state;
  RecordArray RecordLayout::*layout;
  const char* suffix;  ///< "left.x" + suffix
  Per per;
  Quantity quantity;
  bool (*named)(const Plan&);  ///< whether a plan has anything of the kind
};

namespace recorded_detail {
constexpr bool always(const Plan&) {
  return true;
}
constexpr bool gravity(const Plan& p) {
  if (!p.gravity_axes.empty() || !p.gravity_tips.empty()) return true;
  for (const Serial& serial : p.serials) {
    for (std::size_t i = 0; i < serial.joints; ++i) {
      if (serial.joint[i].mass > 0) return true;
    }
  }
  return false;
}
constexpr bool friction(const Plan& p) {
  return !p.frictions.empty();
}
constexpr bool observer(const Plan& p) {
  return !p.axis_observers.empty();
}
constexpr bool contact_observer(const Plan& p) {
  return !p.contact_observers.empty();
}
constexpr bool travel(const Plan& p) {
  return !p.travels.empty();
}
constexpr bool sensor(const Plan& p) {
  return !p.force_sensors.empty();
}
constexpr bool coupling(const Plan& p) {
  return !p.groups.empty();
}
constexpr bool encounters(const Plan& p) {
  return !p.encounters.empty() || !p.groups.empty();
}
constexpr bool controller(const Plan& p) {
  return !p.passivity_controllers.empty();
}
}  // namespace recorded_detail

inline constexpr std::array kRecorded = {
    RecordedField{&State::q, &RecordLayout::q, ".q", Per::axis, Quantity::position,
                  recorded_detail::always},
    RecordedField{&State::qd, &RecordLayout::qd, ".qd", Per::axis, Quantity::velocity,
                  recorded_detail::always},
    RecordedField{&State::gravity, &RecordLayout::gravity, ".gravity", Per::axis, Quantity::effort,
                  recorded_detail::gravity},
    RecordedField{&State::friction, &RecordLayout::friction, ".friction", Per::axis,
                  Quantity::effort, recorded_detail::friction},
    RecordedField{&State::observer, &RecordLayout::observer, ".observer", Per::axis,
                  Quantity::effort, recorded_detail::observer},
    RecordedField{&State::residual, &RecordLayout::residual, ".residual", Per::axis,
                  Quantity::effort, recorded_detail::observer},
    RecordedField{&State::travel, &RecordLayout::travel, ".travel", Per::axis, Quantity::effort,
                  recorded_detail::travel},
    RecordedField{&State::effort, &RecordLayout::effort, ".effort", Per::axis, Quantity::effort,
                  recorded_detail::always},
    RecordedField{&State::x, &RecordLayout::x, ".position", Per::coordinate, Quantity::metre,
                  recorded_detail::always},
    RecordedField{&State::hand_force, &RecordLayout::hand_force, ".hand_force", Per::coordinate,
                  Quantity::newton, recorded_detail::sensor},
    RecordedField{&State::proxy, &RecordLayout::proxy, ".proxy", Per::coordinate, Quantity::metre,
                  recorded_detail::coupling},
    RecordedField{&State::scene_force, &RecordLayout::scene_force, ".scene_force", Per::coordinate,
                  Quantity::newton, recorded_detail::always},
    RecordedField{&State::observer_force, &RecordLayout::observer_force, ".observer_force",
                  Per::coordinate, Quantity::newton, recorded_detail::contact_observer},
    RecordedField{&State::contact_residual, &RecordLayout::contact_residual, ".contact_residual",
                  Per::coordinate, Quantity::newton, recorded_detail::contact_observer},
    RecordedField{&State::limited, &RecordLayout::limited, ".limited", Per::coordinate,
                  Quantity::newton, recorded_detail::always},
    RecordedField{&State::force, &RecordLayout::force, ".force", Per::coordinate, Quantity::newton,
                  recorded_detail::always},
    RecordedField{&State::solve_error, &RecordLayout::solve_error, ".solve_error", Per::device,
                  Quantity::newton, recorded_detail::encounters},
    RecordedField{&State::injected, &RecordLayout::injected, ".injected", Per::device,
                  Quantity::joule, recorded_detail::encounters},
    RecordedField{&State::work, &RecordLayout::work, ".work", Per::device, Quantity::joule,
                  recorded_detail::always},
    RecordedField{&State::reserve, &RecordLayout::reserve, ".reserve", Per::device, Quantity::joule,
                  recorded_detail::controller},
    RecordedField{&State::gain, &RecordLayout::gain, ".gain", Per::device, Quantity::share,
                  recorded_detail::controller},
    RecordedField{&State::fade, &RecordLayout::fade, ".fade", Per::device, Quantity::share,
                  recorded_detail::always},
};

}  // namespace hapticd::control
