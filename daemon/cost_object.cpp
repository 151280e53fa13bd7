#include "daemon/cost_object.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <variant>

#include "config/key.h"
#include "control/build/bounds.h"
#include "daemon/cost_parts.h"
#include "daemon/cost_place.h"
#include "daemon/cost_predict.h"

namespace hapticd::daemon {
namespace {

/// All coordinates at 0: of ideal devices, whose raw values are metres.
Walk standing(const control::Plan& plan) {
  Walk walk;
  for (auto& raw : walk) raw.assign(plan.coordinates, 0.0);
  return walk;
}

void put(Walk& walk, const control::ContactPlan& contact, const Stand& stand) {
  for (std::size_t tick = 0; tick < kWalkTicks; ++tick) {
    const Vec3 at = stand.at + (stand.amplitude * walked(tick)) * stand.along;
    for (std::size_t i = 0; i < contact.coordinates; ++i)
      walk[tick][contact.first_coordinate + i] = at[contact.direction[i]];
  }
}

/// A metre towards the free side.
Vec3 beyond(const control::PlaneContact& plane) {
  Vec3 normal;
  for (std::size_t i = 0; i < plane.coordinates; ++i) normal[i] = plane.normal[i];
  return (1 / squared_norm(normal)) * normal;
}

/// Every contact away from the object. None: one feels it everywhere.
std::optional<Walk> distant_walk(const build::Program& program) {
  Walk walk = standing(program.plan());
  for (const control::Encounter& encounter : program.plan().encounters) {
    const auto stand = distant_stand(program, encounter);
    if (!stand) return std::nullopt;
    put(walk, program.plan().contacts[encounter.contact], *stand);
  }
  for (const control::PlaneContact& plane : program.plan().planes) {
    Stand stand = touching_stand(plane);
    stand.at += beyond(plane);
    put(walk, contact_of(plane), stand);
  }
  return walk;
}

/// One contact in the object, the others away from it. None: no contact gets there.
std::optional<Walk> touching_walk(build::Program& program) {
  Walk walk = distant_walk(program).value_or(standing(program.plan()));
  for (const control::Encounter& encounter : program.plan().encounters) {
    const auto stand = touching_stand(program, encounter);
    if (!stand) continue;
    put(walk, program.plan().contacts[encounter.contact], *stand);
    return walk;
  }
  if (program.plan().planes.empty()) return std::nullopt;
  put(walk, contact_of(program.plan().planes.front()),
      touching_stand(program.plan().planes.front()));
  return walk;
}

/// The body is touched after the run, or there is none that could be.
bool touches(const build::Program& program) {
  const auto& plan = program.plan();
  if (plan.encounters.empty() || control::is_field(plan.encounters.front().kind)) return true;
  const auto& states = program.state().encounters;
  return std::any_of(states.begin(), states.end(),
                     [](const control::EncounterState& at) { return at.now.touching; });
}

std::string first_error(const std::vector<config::ConfigError>& errors) {
  return errors.empty() ? "cannot be compiled alone" : errors.front().message;
}

}  // namespace

std::string kind_name(const config::SceneObject& object) {
  return std::visit([]<class Kind>(const Kind&) { return std::string(config::kKindOf<Kind>); },
                    object);
}

ObjectCosting::ObjectCosting(const config::Compiled& compiled, std::size_t ticks, double floor_ns)
    : scene_(compiled.program->plan()),
      networks_(networks(compiled.document.config)),
      ticks_(ticks),
      floor_ns_(floor_ns) {
  // Without its folder: the names of files in the config are paths already, and would be put below
  // that folder once more.
  bare_.path = std::filesystem::path(compiled.document.path).filename().string();
  bare_.config = compiled.document.config;
  bare_.config.scene.clear();
  bare_.coupling_places = compiled.document.coupling_places;
}

ObjectCost ObjectCosting::measure(const config::SceneObject& object) const {
  ObjectCost cost{.kind = kind_name(object),
                  .name = std::visit([](const auto& kind) { return kind.name; }, object)};
  std::vector<config::SceneObject> objects = networks_;
  objects.push_back(object);
  auto only = with_objects(bare_, std::move(objects));
  if (only) {
    measure(with_ideal_devices(std::move(*only)), cost);
  } else {
    cost.distant.note = cost.touched.note = first_error(only.error());
  }
  return cost;
}

/// In the whole scene it is on no list while it is far away.
bool ObjectCosting::held_back(const build::Program& only) const {
  const auto& encounters = only.plan().encounters;
  return !encounters.empty() && only.plan().planes.empty() &&
         std::all_of(encounters.begin(), encounters.end(), [&](const control::Encounter& e) {
           const bool lists =
               e.contact < scene_.contacts.size() && scene_.contacts[e.contact].margin > 0;
           return lists && build::bounds_of(only.spec(), e);
         });
}

void ObjectCosting::measure(const build::ProgramSpec& only, ObjectCost& cost) const {
  CostRig with(only), without(without_objects(only));
  const auto run = [&](const Walk& walk) {
    with.walk(walk);
    without.walk(walk);
    return difference(with, without, ticks_, floor_ns_);
  };
  const control::Plan& plan = with.program().plan();
  cost.touched.predicted_ns = predicted_touched_ns(cost.kind, plan);
  if (const auto walk = touching_walk(with.program())) {
    const Figure figure = run(*walk);
    if (with.enabled() && touches(with.program())) cost.touched.measured = figure;
  }
  if (!cost.touched.measured) cost.touched.note = "no device reaches it";
  const auto away = distant_walk(with.program());
  if (held_back(with.program())) {
    cost.distant = {.measured = Figure{}, .note = "the broad phase holds it back"};
  } else if (away) {
    cost.distant.predicted_ns = predicted_distant_ns(cost.kind, plan);
    cost.distant.measured = run(*away);
  } else {
    cost.distant = cost.touched;
    cost.distant.note = "felt everywhere";
  }
}

}  // namespace hapticd::daemon
