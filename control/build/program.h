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

/// What is needed to make a program; filled by config/compile. The vectors are the plan's arrays.
struct ProgramSpec {
  double period_s = 1e-3;
  std::vector<control::AxisPlan> axes;
  std::vector<control::DevicePlan> devices;
  std::vector<control::StuckWatch> stuck_watches;
  std::vector<control::HomingPlan> homings;
  std::vector<control::LowPassPlan> low_passes;
  std::vector<control::LeastSquaresPlan> least_squares;
  std::vector<control::FoawPlan> foaws;
  std::vector<control::AlphaBetaGammaPlan> alpha_beta_gammas;
  /// A device that is neither here nor in `linkages` is Cartesian: coordinate i is axis i.
  std::vector<control::CartesianAxis> cartesian_axes;
  std::vector<control::Linkage> linkages;  ///< Linkage::jacobian is set by Program
  std::vector<control::LinearMap> linear_maps;
  std::vector<control::FiveBar> five_bars;
  std::vector<control::Delta> deltas;
  std::vector<control::Serial> serials;
  std::vector<control::ForceSensor> force_sensors;
  std::vector<control::GravityAxis> gravity_axes;
  std::vector<control::GravityTip> gravity_tips;
  std::vector<control::FrictionAxis> frictions;
  std::vector<control::ObserverPlan> axis_observers;
  std::vector<control::ObserverPlan> contact_observers;
  std::vector<control::PlaneContact> planes;
  std::vector<control::TravelPlan> travels;
  std::vector<control::PowerLimit> power_limits;
  std::vector<control::ThermalPlan> thermals;
  std::vector<control::WorkspacePlan> workspaces;
  std::vector<control::EnableInput> enable_inputs;
  std::vector<control::PassivityPlan> passivity_controllers;
  std::vector<std::string> device_names;      ///< "left"
  std::vector<std::string> axis_names;        ///< "left.x"
  std::vector<std::string> coordinate_names;  ///< "left.x"
  std::vector<bool> rotary;  ///< per axis: rad, N m instead of m, N; empty: none is
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
  void complete_kinematics();
  void make_plan();
  void make_state();
  std::size_t coordinates() const noexcept;

  ProgramSpec spec_;
  std::vector<control::AxisState> axes_;
  std::vector<control::LedgerState> ledger_;
  std::vector<control::HomingState> homings_;
  std::vector<control::LowPassState> low_passes_;
  std::vector<control::WindowState> least_squares_, foaws_;
  std::vector<control::AlphaBetaGammaState> alpha_beta_gammas_;
  std::vector<control::LinkageState> linkages_;
  std::vector<control::ObserverState> axis_observers_, contact_observers_;
  std::vector<control::PassivityState> passivity_controllers_;
  std::vector<double> heat_, jacobian_, recorded_, unrecorded_;
  std::size_t jacobian_size_ = 0;
  control::Plan plan_;
  control::State state_;
};

}  // namespace hapticd::build
