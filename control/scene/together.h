// A group of contacts in the tick that is being solved: its linear part (control/coupling/group.h)
// and the forces of bodies and fields on each contact.
#pragma once
#include <span>

#include "control/scene/gains.h"

namespace hapticd::control {

struct Together {
  Together(const Plan& plan, State& state, std::size_t group) noexcept;

  /// Calls use(encounter, its EncounterState) for all that are near the contact.
  template <class Use>
  void for_near(const Member& m, Use&& use) noexcept {
    for (std::uint32_t i = 0; i < m.state->near_count; ++i) {
      const std::uint32_t encounter = state.near[m.plan->first_encounter + i];
      use(encounter, state.encounters[encounter]);
    }
  }
  /// A vector per member as one number per row; the others stay.
  template <class Of>
  void rows(Rows& out, Of&& of) const noexcept {
    for (const Member& m : members) put(*m.plan, of(m), &out[m.plan->first_row]);
  }

  /// Sets y0 for the members' slack.
  void free_proxies() noexcept;
  /// y = y0 + give F of all members.
  void place_proxies() noexcept;
  /// Adds to the force of bodies on one member; all proxies follow.
  void add_force(Member& at, const Vec3& change) noexcept;
  /// How the proxy of `to` moves with a force on `from` [m].
  Vec3 give(const Member& to, const Member& from, const Vec3& force) const noexcept;
  /// Of the whole scene on the contacts [N]: bodies, fields and networks.
  Rows contact_force() const noexcept;
  /// Keeps what was found: state.scene_force, proxies, memories, touches.
  void finish() noexcept;

  const Plan& plan;
  State& state;
  const GroupPlan& group;
  const bool starts;  ///< forces are off: the scene is at rest, each proxy at its contact
  const std::span<Member> members;
  const std::span<double> memory, network;
  Rows x;
  Rows y0;
  std::uint32_t near_count = 0;  ///< encounters of all members
  std::uint16_t sweeps_left;     ///< of this tick

 private:
  void gather() noexcept;
  void begin() noexcept;
  void remember(const Rows& y, const Rows& force) noexcept;
};

}  // namespace hapticd::control
