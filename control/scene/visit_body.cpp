#include <algorithm>
#include <array>
#include <cmath>

#include "control/scene/ask.h"
#include "control/scene/object_place.h"
#include "control/scene/visit.h"

namespace hapticd::control {
namespace {

constexpr int kMaxSlides = 6;          ///< of the search for the normal where a proxy slides to
constexpr double kSameNormal = 1e-14;  ///< squared difference of unit normals
constexpr double kTurned = 1e-13;  ///< of the depth: no farther did the last turn move the point

Mat3 sum(Mat3 a, double on_diagonal) noexcept {
  a.row[0].x += on_diagonal;
  a.row[1].y += on_diagonal;
  a.row[2].z += on_diagonal;
  return a;
}

class BodyVisit {
 public:
  BodyVisit(const Plan& plan, State& state, std::uint32_t index, const Visitor& visitor,
            const Vec3& without) noexcept
      : plan_(plan),
        state_(state),
        encounter_(plan.encounters[index]),
        surface_(encounter_.surface),
        now_(state.encounters[index].now),
        next_(state.encounters[index].next),
        visitor_(visitor),
        place_(plan, state, encounter_),
        without_(without),
        last_(place_.carried(visitor.last)) {}

  Vec3 run() noexcept {
    if (!find_goal()) {
      next_ = {};
      now_.pushed = 0;
      return {};
    }
    Vec3 force = push_ * normal_;
    Vec3 proxy = goal_;
    next_.sliding = false;
    next_.rest = rest_;
    next_.yields = yields_;
    if (surface_.static_friction > 0 && !is_guide(encounter_.kind)) force = with_friction(proxy);
    next_.touching = true;
    next_.pushed = 0;
    if (!now_.touching && encounter_.path != kNoPath)
      now_.pushed = 0.5 * squared_norm(last_ - visitor_.last) / surface_.compliance;
    next_.proxy = place_.local(proxy);
    next_.normal = place_.turned_to_local(normal_);
    next_.force = force;
    return force;
  }

 private:
  Nearest ask(const Vec3& world) noexcept {
    const Vec3 from = now_.touching ? now_.proxy : place_.local(last_);
    Nearest found = nearest_free(plan_, state_, encounter_, now_.touching, place_.local(world),
                                 from, visitor_.contact.radius);
    found.point = place_.world(found.point);
    found.normal = place_.turned_to_world(found.normal);
    return found;
  }

  /// Normal, force and proxy without friction. False: `without` is free.
  bool find_goal() noexcept {
    Vec3 asked = without_;
    for (int turn = 0;; ++turn) {
      const Nearest found = ask(asked);
      if (!(found.depth > 0)) {
        if (turn > 0) break;  // the last turn stands
        return false;
      }
      normal_ = found.normal;
      surface_at_ = dot(normal_, found.point);
      push();
      if (visitor_.contact.even || turn == visitor_.max_turns) break;
      // The point below the surface whose nearest free point would be where this force takes z.
      const Vec3 next = without_ + push_ * (gives_ - give_ * normal_);
      const Vec3 moved = next - asked;
      asked = next;
      if (!(squared_norm(moved) > kTurned * kTurned * found.depth * found.depth)) break;
    }
    const Vec3 y = without_ + push_ * gives_;
    goal_ = y + (surface_at_ - dot(normal_, y)) * normal_;
    return true;
  }

  /// Forces along the normal of spring and damper; together they never pull.
  void push() noexcept {
    const double compliance = surface_.compliance;
    gives_ = visitor_.contact.give * normal_;
    give_ = dot(normal_, gives_);
    const double depth = surface_at_ - dot(normal_, without_);
    push_ = depth / (give_ + compliance);
    damper_ = 0;
    rest_ = surface_at_;
    yields_ = compliance;
    if (surface_.damping > 0) damp(depth);
  }

  void damp(double depth) noexcept {
    const double compliance = surface_.compliance;
    if (visitor_.directly) {
      const Vec3 objects = plan_.rate_Hz * (last_ - visitor_.last);  // velocity of the object
      damper_ = -surface_.damping * dot(normal_, visitor_.velocity - objects);
      push_ += damper_;
    } else {
      const double b = surface_.damping * plan_.rate_Hz;
      const double entered = std::min(dot(normal_, last_), surface_at_);
      yields_ = compliance / (1 + compliance * b);
      rest_ = (surface_at_ + compliance * b * entered) / (1 + compliance * b);
      push_ = (rest_ - dot(normal_, without_)) / (give_ + yields_);
      damper_ = b * (entered - dot(normal_, without_) - give_ * push_);
    }
    if (push_ < 0) {  // not max(0, push_): that would turn a NaN into a silent zero
      push_ = 0;
      damper_ = -depth / compliance;
    }
  }

  /// Where the proxy would stay if nothing slid: the old one, or where the contact came in.
  Vec3 held() const noexcept {
    if (now_.touching) return place_.world(now_.proxy);
    const Vec3 way = without_ - last_;
    const double fall = dot(normal_, way);
    const double gap = surface_at_ - dot(normal_, last_);
    const double share = fall < 0 ? std::clamp(gap / fall, 0.0, 1.0) : 0.0;
    return last_ + share * way;
  }

  /// Force of the body's spring with its proxy there, the damper's force as it is.
  Vec3 spring_at(const Vec3& proxy) const noexcept {
    const ContactPlan& contact = visitor_.contact;
    const Vec3 stretch = proxy - without_ - damper_ * gives_;
    if (contact.even && contact.coordinates == 3)
      return (1 / (contact.give.row[0].x + surface_.compliance)) * stretch;
    return solve_on(contact, sum(contact.give, surface_.compliance), stretch);
  }

  Vec3 with_friction(Vec3& proxy) noexcept {
    const Vec3 old = held();
    const double mu = now_.sliding ? surface_.dynamic_friction : surface_.static_friction;
    const Vec3 old_normal = now_.touching ? place_.turned_to_world(now_.normal) : normal_;
    const Vec3 sticking = spring_at(old);
    const double press = dot(old_normal, sticking);
    const Vec3 along = sticking - press * old_normal;
    if (norm(along) <= mu * (press + damper_)) {
      proxy = old;
      normal_ = old_normal;
      return sticking + damper_ * old_normal;
    }
    next_.sliding = true;
    // On a curved surface the tangent plane is that of where the proxy ends, not of the goal.
    for (int turn = 0; turn < kMaxSlides; ++turn) {
      proxy = slide(old);
      const Nearest back = ask(proxy - (surface_at_ - dot(normal_, without_)) * normal_);
      if (!(back.depth > 0)) break;
      const bool flat = squared_norm(back.normal - normal_) <= kSameNormal;
      proxy = back.point;
      normal_ = back.normal;
      surface_at_ = dot(normal_, proxy);
      if (flat) break;
    }
    return spring_at(proxy) + damper_ * normal_;
  }

  /// In the tangent plane, from the frictionless goal towards the old proxy: the force changes
  /// linearly on the way, its tangential part reaches the cone of dynamic friction at one place.
  Vec3 slide(const Vec3& old) const noexcept {
    const Vec3 gives = visitor_.contact.give * normal_ + surface_.compliance * normal_;
    const Vec3 base = without_ + damper_ * gives_;
    const double push = (surface_at_ - dot(normal_, base)) / dot(normal_, gives);
    const Vec3 goal = base + push * gives;
    const Vec3 flat = old + (surface_at_ - dot(normal_, old)) * normal_;
    const Vec3 change = spring_at(flat) - push * normal_;
    const double press = dot(normal_, change);
    const double drag = norm(change - press * normal_);
    const double mu = surface_.dynamic_friction;
    const double most = mu * std::max(0.0, push + damper_);
    const double room = drag - mu * press;
    return goal + (room > most ? most / room : 1.0) * (flat - goal);
  }

  const Plan& plan_;
  State& state_;
  const Encounter& encounter_;
  const Surface& surface_;
  Touch& now_;
  Touch& next_;
  const Visitor& visitor_;
  const ObjectPlace place_;
  const Vec3 without_;
  const Vec3 last_;  ///< the contact's proxy of the last tick, carried on by the object

  Vec3 normal_{};
  Vec3 goal_{};
  Vec3 gives_{};           ///< m/N: how y moves with a force along the normal
  double give_ = 0;        ///< m/N: that along the normal
  double surface_at_ = 0;  ///< m: normal.z on the tangent plane
  double push_ = 0;        ///< N, along the normal: spring and damper, >= 0
  double damper_ = 0;      ///< N: the damper's part of it
  double rest_ = 0;        ///< m: (rest - normal.y) / yields is push, with the damper
  double yields_ = 0;      ///< m/N
};

}  // namespace

Vec3 solve_on(const ContactPlan& contact, const Mat3& s, const Vec3& f) noexcept {
  Mat3 m = s;
  Vec3 r = f;
  std::array<bool, 3> has{};
  for (std::size_t i = 0; i < contact.coordinates; ++i) has[contact.direction[i]] = true;
  for (std::size_t i = 0; i < 3; ++i) {
    if (has[i]) continue;
    m.row[i] = {};
    for (Vec3& row : m.row) row[i] = 0;
    m.row[i][i] = 1;
    r[i] = 0;
  }
  return solve(m, r);
}

Vec3 visit_body(const Plan& plan, State& state, std::uint32_t index, const Visitor& visitor,
                const Vec3& without) noexcept {
  return BodyVisit(plan, state, index, visitor, without).run();
}

}  // namespace hapticd::control
