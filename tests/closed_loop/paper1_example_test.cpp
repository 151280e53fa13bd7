// Paper 1 (Bianchini et al. 2010), Example 1, in motion: three devices of one axis in one hand
// H(s), a star of springs and dampers round a mass, and the paper's couplings
// (26), (27), (28) or none, in which case it shakes. Three computations are held together: the real
// loop with simulated devices, the coupled network written out below, and trajectories computed
// elsewhere (tests/data/paper1_loop).
//
// No limit bites. What is left is rounding, of which the encoder's step has the largest part: 2^-52
// m times 3900 N/m times T/m is 4e-15 m/s a tick. It adds up to less than 2e-13 m/s, most of all in
// the loop that shakes, whose motion grows ninefold in 3000 ticks.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "control/build/program.h"
#include "daemon/cycle.h"
#include "sim/sim_device.h"

namespace hapticd::test {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kDevices = 3;
constexpr double kCountsPerMetre = 4503599627370496.0;  // 2^52
constexpr double kTolerance_m_s = 1e-12;

Json example() {
  std::ifstream file(HAPTICD_SOURCE_DIR "/tests/data/paper1_loop/example1.json");
  return Json::parse(file);
}

Eigen::MatrixXd matrix(const Json& rows) {
  const auto values = rows.get<std::vector<std::vector<double>>>();
  Eigen::MatrixXd result(values.size(), values[0].size());
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t j = 0; j < values[i].size(); ++j)
      result(static_cast<int>(i), static_cast<int>(j)) = values[i].at(j);
  return result;
}

/// 0.02 (s^2 + 60 s + 1000)/(s^2 + 10.3 s + 100) = 0.02 + 0.02 (49.7 s + 900)/(s^2 + 10.3 s + 100)
/// from an axis to itself: two states; 0.1 to the others.
sim::SharedHandOptions paper_hand(const Json& start_velocity_m_s) {
  constexpr std::size_t m = kDevices, n = 2 * kDevices;
  sim::SharedHandOptions hand{.axes = {},
                              .states = n,
                              .A = std::vector<double>(n * n),
                              .B = std::vector<double>(n * m),
                              .C = std::vector<double>(m * n),
                              .D = std::vector<double>(m * m, 0.1)};
  for (std::size_t i = 0; i < m; ++i) {
    const std::size_t state = 2 * i, rate = 2 * i + 1;
    hand.axes.push_back({.device = i, .axis = 0, .velocity_m_s = start_velocity_m_s.at(i)});
    hand.A[state * n + rate] = 1;
    hand.A[rate * n + state] = -100;
    hand.A[rate * n + rate] = -10.3;
    hand.B[rate * m + i] = 1;
    hand.C[i * n + state] = 0.02 * 900;
    hand.C[i * n + rate] = 0.02 * 49.7;
    hand.D[i * m + i] = 0.02;
  }
  return hand;
}

/// The three devices, power on.
std::vector<std::unique_ptr<sim::SimDevice>> devices_of(const Json& data) {
  sim::DeviceOptions device;
  device.period_s = data.at("period_s");
  device.axes = {{.mass_kg = data.at("mass_kg"),
                  .damping_Ns_m = data.at("damping_Ns_m"),
                  .counts_per_m = kCountsPerMetre,
                  .encoder_bits = 0,
                  .max_effort_N = 1e12}};
  const auto hand = std::make_shared<sim::SharedHand>(paper_hand(data.at("start_velocity_m_s")),
                                                      std::vector(kDevices, device));
  std::vector<std::unique_ptr<sim::SimDevice>> devices;
  for (std::size_t i = 0; i < kDevices; ++i) {
    devices.push_back(std::make_unique<sim::SimDevice>(hand, i));
    const auto connected = devices[i]->connect();
    if (!connected) throw std::invalid_argument(connected.error().text);
    devices[i]->set_armed(true);
  }
  return devices;
}

drivers::TickTime time_of(std::int64_t tick) {
  return {tick, tick * 1'000'000, tick * 1'000'000};
}

/// Runs `tick(number)` from 0 on; after it the devices stand at the start of that tick.
template <class Tick>
void expect_trajectory(const Json& loop,
                       const std::vector<std::unique_ptr<sim::SimDevice>>& devices, Tick tick) {
  std::int64_t done = -1;
  ASSERT_EQ(loop.at("velocity_m_s").size(), 9u);
  for (const Json& point : loop.at("velocity_m_s")) {
    while (done < point.at("tick").get<std::int64_t>()) tick(++done);
    for (std::size_t i = 0; i < kDevices; ++i) {
      EXPECT_NEAR(devices[i]->truth(0).velocity_m_s, point.at("v").at(i).get<double>(),
                  kTolerance_m_s)
          << "coupling " << loop.at("coupling") << ", tick " << done << ", axis " << i;
    }
  }
}

/// f = (1 + E V)^-1 E x written out: the network's displacements x_e are where its force and the
/// coupling's, K d + B (d - d_prev)/T with d = x - x_e, are the same. Without coupling x_e = x.
class CoupledNetwork {
 public:
  CoupledNetwork(const Json& data, const Json& loop)
      : A_(matrix(data.at("E").at("A"))),
        B_(matrix(data.at("E").at("B"))),
        C_(matrix(data.at("E").at("C"))),
        D_(matrix(data.at("E").at("D"))),
        coupled_(loop.contains("stiffness_N_m")),
        state_(Eigen::VectorXd::Zero(A_.rows())) {
    if (!coupled_) return;
    damper_ = matrix(loop.at("damping_Ns_m")) / data.at("period_s").get<double>();
    coupling_ = matrix(loop.at("stiffness_N_m")) + damper_;
    joint_.compute(D_ + coupling_);
  }

  Eigen::Vector3d force_N(const Eigen::Vector3d& x_m) {
    Eigen::Vector3d held_m = x_m;
    if (coupled_) held_m = joint_.solve(coupling_ * x_m - damper_ * stretch_m_ - C_ * state_);
    const Eigen::Vector3d force = C_ * state_ + D_ * held_m;
    stretch_m_ = x_m - held_m;
    state_ = (A_ * state_ + B_ * held_m).eval();
    return force;
  }

 private:
  Eigen::MatrixXd A_, B_, C_, D_;
  bool coupled_;
  Eigen::Matrix3d damper_, coupling_;  ///< B/T, K + B/T
  Eigen::PartialPivLU<Eigen::Matrix3d> joint_;
  Eigen::VectorXd state_;
  Eigen::Vector3d stretch_m_ = Eigen::Vector3d::Zero();
};

TEST(Paper1Example, DevicesInOneHandFollowTheTrajectoriesUnderAWrittenOutNetwork) {
  const Json data = example();
  ASSERT_EQ(data.at("loops").size(), 4u);
  for (const Json& loop : data.at("loops")) {
    const auto devices = devices_of(data);
    CoupledNetwork network(data, loop);
    expect_trajectory(loop, devices, [&](std::int64_t tick) {
      for (const auto& device : devices) device->request(time_of(tick));
      Eigen::Vector3d x_m;
      for (std::size_t i = 0; i < kDevices; ++i) {
        std::array<AxisSample, 1> sample;
        Aux aux;
        devices[i]->collect(sample, aux);
        x_m[static_cast<int>(i)] = sample[0].raw / kCountsPerMetre;
      }
      const Eigen::Vector3d force_N = network.force_N(x_m);
      for (std::size_t i = 0; i < kDevices; ++i) {
        std::array<double, 1> delivered;
        devices[i]->command(std::array{-force_N[static_cast<int>(i)]}, delivered);
      }
    });
  }
}

build::Network star(const Json& values) {
  using At = build::NetworkEnd::At;
  build::Network network{.nodes = {{.mass = values.at("mass_kg")}}, .elements = {}};
  const build::NetworkEnd mass{.at = At::node, .index = 0};
  for (std::uint32_t i = 0; i < kDevices; ++i) {
    network.elements.push_back({.a = {.at = At::coordinate, .index = i},
                                .b = mass,
                                .stiffness = values.at("contact_stiffness_N_m").at(i),
                                .damping = values.at("contact_damping_Ns_m").at(i)});
  }
  network.elements.push_back({.a = mass,
                              .b = {},
                              .stiffness = values.at("ground_stiffness_N_m"),
                              .damping = values.at("ground_damping_Ns_m")});
  return network;
}

build::Matrix rows(const Json& values) {
  build::Matrix result{.rows = kDevices, .columns = kDevices, .values = {}};
  for (const Json& row : values)
    for (const Json& value : row) result.values.push_back(value);
  return result;
}

/// Forces fully on from the first tick, limits far out of the way.
build::ProgramSpec spec_of(const Json& data, const Json& loop) {
  build::ProgramSpec spec;
  spec.period_s = data.at("period_s");
  for (std::uint16_t i = 0; i < kDevices; ++i) {
    spec.axes.push_back({.unit_per_raw = 1 / kCountsPerMetre,
                         .max_effort = 1e12,
                         .max_velocity = 1e9,
                         .max_step = 1e9});
    spec.devices.push_back({.first_axis = i,
                            .axes = 1,
                            .first_coordinate = i,
                            .coordinates = 1,
                            .max_force = 1e12,
                            .max_slew = 1e12,
                            .ramp_per_tick = 1});
    control::ContactPlan contact;
    contact.device = contact.first_coordinate = i;
    contact.coordinates = 1;
    contact.max_force = 1e12;
    spec.contacts.push_back(contact);
    spec.device_names.push_back("device" + std::to_string(i));
    spec.axis_names.push_back(spec.device_names[i] + ".x");
  }
  spec.coordinate_names = spec.axis_names;
  spec.networks = {star(data.at("network"))};
  if (!loop.contains("stiffness_N_m")) return spec;
  spec.coupling.push_back({.coordinates = {0, 1, 2},
                           .stiffness = rows(loop.at("stiffness_N_m")),
                           .damping = rows(loop.at("damping_Ns_m")),
                           .state_space = {}});
  return spec;
}

TEST(Paper1Example, TheLoopFollowsTheTrajectoriesWithEachCouplingAndWithNone) {
  const Json data = example();
  ASSERT_EQ(data.at("loops").size(), 4u);
  for (const Json& loop : data.at("loops")) {
    const auto devices = devices_of(data);
    std::vector<drivers::Device*> slots;
    for (const auto& device : devices) slots.push_back(device.get());
    build::Program program(spec_of(data, loop));
    daemon::Cycle cycle(slots, program.plan());
    expect_trajectory(loop, devices, [&](std::int64_t tick) {
      daemon::CycleInput input;
      input.time = time_of(tick);
      input.enable = true;
      cycle.run(
          program, input, []() noexcept -> std::int64_t { return 0; }, nullptr);
      ASSERT_EQ(cycle.output().mode, control::Mode::enabled) << "tick " << tick;
    });
  }
}

}  // namespace
}  // namespace hapticd::test
