// What one object of a scene costs, measured in a program that has it and nothing else to touch.
#pragma once
#include <string>

#include "config/compile.h"
#include "daemon/cost.h"

namespace hapticd::daemon {

/// "sphere"
std::string kind_name(const config::SceneObject& object);

class ObjectCosting {
 public:
  ObjectCosting(const config::Compiled& compiled, std::size_t ticks, double floor_ns);

  /// Far away and touched by the first device that can; against the same contacts with nothing there.
  ObjectCost measure(const config::SceneObject& object) const;

 private:
  bool held_back(const build::Program& only) const;
  void measure(const build::ProgramSpec& only, ObjectCost& cost) const;

  const control::Plan& scene_;
  config::Document bare_;  ///< without a scene
  std::vector<config::SceneObject> networks_;
  std::size_t ticks_;
  double floor_ns_;
};

}  // namespace hapticd::daemon
