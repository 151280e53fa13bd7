// The scene of a program: encounters in the order that the loop walks them, groups, trees.
#pragma once
#include <vector>

#include "control/build/program.h"

namespace hapticd::build {

/// Up to so many encounters of a contact are all always near: a list would cost more than it saves.
inline constexpr std::size_t kFewEncounters = 8;

/// Storage that the plan's scene points into, beside ProgramSpec's own arrays.
struct Scene {
  Groups groups;
  std::vector<BoxTreeData> trees;     ///< per contact
  std::vector<control::Mesh> meshes;  ///< views of ProgramSpec::meshes
  std::size_t walks = 0;              ///< sizes of the state's arrays
  std::size_t segments = 0;
};

/// Sorts spec.encounters by contact, those without bounds last, and fills what spec.contacts say of
/// groups and encounters. problem(groups_spec(spec)) is empty.
Scene arrange_scene(ProgramSpec& spec);

/// What fold() is asked for.
GroupsSpec groups_spec(const ProgramSpec& spec);

}  // namespace hapticd::build
