// A plan with its storage, the state that goes with it and the names that people know things by.
// Made at set-up, handed to the servo thread as one pointer (control/rt/plan_mailbox.h).
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "control/build/coupling.h"
#include "control/build/mesh.h"
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
  /// One per device where there are encounters, coupling or networks, else none. Encounters name
  /// their contact; Program sorts them, and fills what ContactPlan says of groups and encounters.
  std::vector<control::ContactPlan> contacts;
  std::vector<control::Encounter> encounters;
  std::vector<control::Plane> free_planes;
  std::vector<control::Relief> reliefs;
  std::vector<control::Box> boxes;
  std::vector<control::Sphere> spheres;
  std::vector<control::Cylinder> cylinders;
  std::vector<control::Capsule> capsules;
  std::vector<std::shared_ptr<const MeshData>> meshes;
  std::vector<control::PointGuide> point_guides;
  std::vector<control::LineGuide> line_guides;
  std::vector<control::CurveGuide> curve_guides;
  std::vector<Vec3> curve_points;
  std::vector<control::ViscousField> viscous_fields;
  std::vector<control::ConstantField> constant_fields;
  std::vector<control::Detents> detents;
  std::vector<control::Magnet> magnets;
  std::vector<control::Vibration> vibrations;
  std::vector<control::Path> paths;
  std::vector<control::Waypoint> waypoints;
  std::vector<CouplingBlock> coupling;
  std::vector<Network> networks;
  Integrator integrator = Integrator::backward_euler;
  std::size_t network_substeps = 1;
  std::uint16_t max_sweeps = 50;
  double solver_tolerance = 1e-10;  ///< N
  std::vector<double> sharpen;      ///< per contact; empty: 0 (control/coupling/group.h)
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

struct Scene;

/// Not movable: plan and state hold spans into it.
class Program {
 public:
  explicit Program(ProgramSpec spec);
  ~Program();
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
  void make_scene_state();
  std::size_t coordinates() const noexcept;

  ProgramSpec spec_;
  std::unique_ptr<Scene> scene_;
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
  std::vector<control::EncounterState> encounters_;
  std::vector<control::MeshWalk> walks_;
  std::vector<std::uint32_t> segments_, near_;
  std::vector<control::ContactState> contacts_;
  std::vector<control::Member> members_;
  std::vector<double> coupling_memory_, network_;
  std::size_t jacobian_size_ = 0;
  control::Plan plan_;
  control::State state_;
};

}  // namespace hapticd::build
