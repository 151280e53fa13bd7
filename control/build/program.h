// A plan with its storage, the state that goes with it and the names that people know things by.
// Made at set-up, handed to the servo thread as one pointer (control/rt/plan_mailbox.h).
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "control/plan.h"
#include "control/state.h"

namespace hapticd::build {

/// What is needed to make a program; filled by config/compile.
struct ProgramSpec {
  double period_s = 1e-3;
  std::vector<control::AxisPlan> axes;
  std::vector<control::DevicePlan> devices;
  std::vector<control::StuckWatch> stuck_watches;
  std::vector<control::PlaneContact> planes;
  std::vector<std::string> device_names;      ///< "left"
  std::vector<std::string> axis_names;        ///< "left.x"
  std::vector<std::string> coordinate_names;  ///< "left.x"
};

/// Not movable: plan and state hold spans into it.
class Program {
 public:
  explicit Program(ProgramSpec spec);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  const control::Plan& plan() const noexcept { return plan_; }
  control::State& state() noexcept { return state_; }
  const control::State& state() const noexcept { return state_; }
  const ProgramSpec& spec() const noexcept { return spec_; }

 private:
  ProgramSpec spec_;
  std::vector<control::AxisState> axis_states_;
  std::vector<control::CartesianAxis> cartesian_axes_;
  std::vector<double> recorded_, v_, ramp_;
  control::Plan plan_;
  control::State state_;
};

}  // namespace hapticd::build
