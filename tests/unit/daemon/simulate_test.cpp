#include "daemon/simulate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "daemon/recording.h"
#include "tests/unit/daemon/temp_dir.h"

namespace hapticd::daemon {
namespace {

constexpr const char* kConfig = R"(version: 1
devices:
  - name: left
    driver: sim
    sim: {hand: {mass_kg: 0.2, script: [{at_s: 0, force_N: -3}]}}
    kinematics: {cartesian: {directions: [x]}}
    latency_s: 0
    axes:
      - name: x
        encoder: {counts_per_m: 1e7}
        actuator: {max_force_N: 8}
        model: {mass_kg: 0.05, damping_Ns_m: 2}
scene:
  - plane: {name: wall, normal: [1, 0, 0], stiffness_N_m: 1000, damping_Ns_m: 0.5}
guard: {ramp_s: 0.05}
)";

class Simulate : public testing::Test {
 protected:
  config::Compiled compiled() {
    auto document = config::read_text(kConfig, "test.yaml");
    EXPECT_TRUE(document) << config::to_string(document.error().front());
    auto result = config::compile(std::move(*document));
    EXPECT_TRUE(result);
    return std::move(*result);
  }
  test::TempDir dir_;
  std::string file_ = dir_.file("a");
  std::atomic<bool> interrupt_{false};
};

TEST_F(Simulate, EndsAtTheForceThatTheHandPressesWith) {
  auto config = compiled();
  const auto result = simulate(config, {.duration_s = 3, .output = file_}, interrupt_);
  ASSERT_TRUE(result) << result.error().text;
  EXPECT_EQ(result->ticks, 3000);
  EXPECT_TRUE(result->enabled);
  EXPECT_EQ(result->fault.code, Fault::none);
  const auto recording = read_recording(file_);
  ASSERT_TRUE(recording);
  const Field* force = recording->find("left.x.force");
  ASSERT_NE(force, nullptr);
  EXPECT_NEAR(recording->value(2999, *force), 3, 0.05);
}

TEST_F(Simulate, RecordsEveryTickInVirtualTime) {
  auto config = compiled();
  ASSERT_TRUE(simulate(config, {.duration_s = 0.1, .output = file_}, interrupt_));
  const auto recording = read_recording(file_);
  ASSERT_TRUE(recording);
  ASSERT_EQ(recording->size(), 100u);
  for (std::size_t i = 0; i < recording->size(); ++i) {
    EXPECT_EQ(recording->value(i, *recording->find("tick")), static_cast<double>(i));
    EXPECT_EQ(recording->value(i, *recording->find("time_ns")), static_cast<double>(i) * 1e6);
    EXPECT_EQ(recording->value(i, *recording->find("step_ns")), 0.0);
  }
}

TEST_F(Simulate, AnInterruptEndsItWithAWholeFile) {
  auto config = compiled();
  interrupt_ = true;
  const auto result = simulate(config, {.duration_s = 10, .output = file_}, interrupt_);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->interrupted);
  EXPECT_EQ(result->ticks, 0);
  EXPECT_TRUE(read_recording(file_));
}

}  // namespace
}  // namespace hapticd::daemon
