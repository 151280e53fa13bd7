#include "control/build/scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "control/build/bounds.h"

namespace hapticd::build {
namespace {

using control::ContactPlan;
using control::Encounter;
using control::ObjectKind;

/// World axes from the contact's rows of its group.
void set_give(ContactPlan& contact, const Groups& groups) {
  contact.give = {};
  contact.even = true;
  if (contact.group == ContactPlan::kNoGroup) return;
  const control::GroupPlan& group = groups.groups[contact.group];
  for (std::size_t i = 0; i < contact.coordinates; ++i) {
    for (std::size_t j = 0; j < contact.coordinates; ++j) {
      const std::size_t entry = (contact.first_row + i) * group.coordinates + contact.first_row + j;
      contact.give.row[contact.direction[i]][contact.direction[j]] =
          groups.gains[group.give.offset + entry];
    }
  }
  contact.even = contact.give == diagonal(contact.give.row[0].x);
}

void join_groups(ProgramSpec& spec, const Groups& groups) {
  for (std::size_t c = 0; c < spec.contacts.size(); ++c) {
    ContactPlan& contact = spec.contacts[c];
    contact.group = groups.group_of[c];
    contact.first_row = 0;
    if (contact.group != ContactPlan::kNoGroup) {
      const control::GroupPlan& group = groups.groups[contact.group];
      for (std::size_t k = 0; groups.group_contacts[group.first_contact + k] != c; ++k) {
        const ContactPlan& before = spec.contacts[groups.group_contacts[group.first_contact + k]];
        contact.first_row = static_cast<std::uint16_t>(contact.first_row + before.coordinates);
      }
    }
    set_give(contact, groups);
  }
}

/// A quarter of the mean distance between objects: few are near, and the list holds for long.
double margin(const std::vector<Bounds>& bounds) {
  Bounds all = bounds.front();
  for (const Bounds& one : bounds) {
    for (std::size_t i = 0; i < 3; ++i) {
      all.min[i] = std::min(all.min[i], one.min[i]);
      all.max[i] = std::max(all.max[i], one.max[i]);
    }
  }
  const Vec3 size = all.max - all.min;
  const double longest = std::max({size.x, size.y, size.z});
  const double volume = std::max(size.x, 1e-3 * longest) * std::max(size.y, 1e-3 * longest) *
                        std::max(size.z, 1e-3 * longest);
  return 0.25 * std::cbrt(volume / static_cast<double>(bounds.size()));
}

/// Items of the tree are numbers of encounters.
BoxTreeData sort_contact(ProgramSpec& spec, ContactPlan& contact) {
  const auto begin = spec.encounters.begin() + contact.first_encounter;
  const auto end = begin + contact.encounters;
  const auto bounded = [&](const Encounter& e) { return bounds_of(spec, e).has_value(); };
  const auto boundless = std::stable_partition(begin, end, bounded);
  contact.first_boundless = static_cast<std::uint32_t>(boundless - spec.encounters.begin());
  contact.margin = 0;
  if (contact.encounters <= kFewEncounters || boundless == begin) return {};
  std::vector<Bounds> bounds;
  for (auto e = begin; e != boundless; ++e) bounds.push_back(*bounds_of(spec, *e));
  contact.margin = margin(bounds);
  BoxTreeData tree = make_box_tree(bounds, 1);
  for (std::uint32_t& item : tree.items) item += contact.first_encounter;
  return tree;
}

}  // namespace

namespace {

control::Gain append(std::vector<double>& gains, const std::vector<double>& values,
                     std::size_t rows, std::size_t columns) {
  const control::Gain gain{.offset = static_cast<std::uint32_t>(gains.size()),
                           .rows = static_cast<std::uint16_t>(rows),
                           .columns = static_cast<std::uint16_t>(columns)};
  gains.insert(gains.end(), values.begin(), values.end());
  return gain;
}

/// What the networks' first states are made of.
void add_beginnings(Groups& groups) {
  for (std::size_t g = 0; g < groups.groups.size(); ++g) {
    control::GroupPlan& group = groups.groups[g];
    if (group.states == 0) continue;
    const auto first = groups.start_offset.begin() + group.first_state;
    group.begin =
        append(groups.gains, groups.start_gain[g].values, group.states, group.coordinates);
    group.begin_rest =
        append(groups.gains, std::vector<double>(first, first + group.states), group.states, 1);
  }
}

}  // namespace

GroupsSpec groups_spec(const ProgramSpec& spec) {
  GroupsSpec made{.period_s = spec.period_s,
                  .blocks = spec.coupling,
                  .networks = spec.networks,
                  .integrator = spec.integrator,
                  .substeps = spec.network_substeps,
                  .contacts = {},
                  .max_sweeps = spec.max_sweeps,
                  .tolerance = spec.solver_tolerance,
                  .sharpen = spec.sharpen};
  made.sharpen.resize(spec.contacts.size());
  for (const ContactPlan& contact : spec.contacts)
    made.contacts.push_back({contact.first_coordinate, contact.coordinates});
  return made;
}

Scene arrange_scene(ProgramSpec& spec) {
  Scene scene;
  if (spec.contacts.empty()) return scene;
  scene.groups = fold(groups_spec(spec));
  add_beginnings(scene.groups);
  join_groups(spec, scene.groups);
  std::stable_sort(spec.encounters.begin(), spec.encounters.end(),
                   [](const Encounter& a, const Encounter& b) { return a.contact < b.contact; });
  std::uint32_t next = 0;
  for (std::size_t c = 0; c < spec.contacts.size(); ++c) {
    ContactPlan& contact = spec.contacts[c];
    contact.first_encounter = next;
    while (next < spec.encounters.size() && spec.encounters[next].contact == c) ++next;
    contact.encounters = next - contact.first_encounter;
    scene.trees.push_back(sort_contact(spec, contact));
  }
  for (std::size_t c = 0; c < spec.contacts.size(); ++c)
    spec.contacts[c].objects = scene.trees[c].view();
  for (Encounter& encounter : spec.encounters) {
    if (encounter.kind == ObjectKind::mesh)
      encounter.walk = static_cast<std::uint32_t>(scene.walks++);
    if (encounter.kind == ObjectKind::curve)
      encounter.walk = static_cast<std::uint32_t>(scene.segments++);
  }
  for (const auto& mesh : spec.meshes) scene.meshes.push_back(mesh->view());
  return scene;
}

}  // namespace hapticd::build
