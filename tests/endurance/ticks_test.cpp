// Very many ticks in virtual time with the inputs that wear numbers out: counters that wrap,
// readings that are denormal, forces that saturate, positions between two counts. 10^6 ticks in
// every run, 10^8 with HAPTICD_LONG=1 (tests/run.sh --long).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <utility>

#include "control/core/flush_denormals.h"
#include "tests/support/full_program.h"

namespace hapticd::control {
namespace {

using test::Rig;

/// `of`: a million without a scene; a crowded scene costs a hundred times as much.
std::int64_t ticks(std::int64_t of = 1'000'000) {
  return std::getenv("HAPTICD_LONG") != nullptr ? 100 * of : of;
}

/// No objects but planes, no coupling.
build::ProgramSpec without_scene(build::ProgramSpec spec) {
  spec.contacts.clear();
  spec.encounters.clear();
  spec.coupling.clear();
  spec.networks.clear();
  return spec;
}

constexpr double kModulus = 65536;

/// Axis 0 runs on for ever behind a 16-bit counter; axis 1 reads denormal numbers; axis 2 is thrown
/// against a hard wall; the joints of the other devices tremble by single counts.
build::ProgramSpec worn_spec() {
  auto spec = test::full_spec();
  spec.travels.clear();
  spec.workspaces.clear();
  spec.homings.clear();
  spec.axes[0].modulus_raw = kModulus;
  spec.axes[1].unit_per_raw = 1;
  spec.planes.push_back(test::wall(1e5, 5, 3));
  spec.planes.back().normal = {0, 0, 1};
  return spec;
}

/// Small integers that repeat only after 2^32 ticks (Weyl sequence, Marsaglia 2003).
struct Jitter {
  std::uint32_t state = 1;
  int operator()(int most) {
    state += 2654435769u;
    return static_cast<int>((state >> 16) % static_cast<std::uint32_t>(2 * most + 1)) - most;
  }
};

class Wear {
 public:
  explicit Wear(build::ProgramSpec spec) : rig_(std::move(spec)) {
    for (Aux& aux : rig_.aux) aux.digital = 1;
    rig_.input.enable = true;
  }

  void tick(std::int64_t k) {
    travelled_ += 700 + jitter_(600);
    rig_.samples[0].raw = static_cast<double>(travelled_ & 65535);
    rig_.samples[1].raw = 5e-324 * static_cast<double>(1 + (k & 1023));
    const double phase = 6.283185307179586e-3 * static_cast<double>(k % 1000);
    rig_.samples[2].raw = std::round(-8000 * std::sin(phase));
    for (std::size_t i = 3; i < rig_.samples.size(); ++i) rig_.samples[i].raw = jitter_(2);
    rig_.aux[0].analogue = {1e-310, -5e-324, 0.3, 0, 0, 0};
    rig_.again();
  }

  const State& state() const { return rig_.program.state(); }
  const Plan& plan() const { return rig_.program.plan(); }
  std::int64_t travelled() const { return travelled_; }

 private:
  Rig rig_;
  Jitter jitter_;
  std::int64_t travelled_ = 0;
};

bool bounded(const Wear& wear) {
  for (const double value : wear.state().recorded) {
    if (!std::isfinite(value)) return false;
  }
  for (std::size_t i = 0; i < wear.plan().axes.size(); ++i) {
    if (std::abs(wear.state().effort[i]) > wear.plan().axes[i].max_effort) return false;
  }
  return true;
}

/// True: the throws against the wall reached the force limit.
bool wear_out(Wear& wear, std::int64_t count) {
  const FlushDenormals flush;
  bool saturated = false;
  for (std::int64_t k = 0; k < count; ++k) {
    wear.tick(k);
    saturated =
        saturated || std::abs(wear.state().effort[2]) > 0.99 * wear.plan().devices[0].max_force;
    EXPECT_TRUE(bounded(wear)) << "tick " << k;
    EXPECT_EQ(wear.state().mode, Mode::enabled)
        << "tick " << k << ": " << entry(wear.state().fault.code).name;
    // The first reading is taken as signed: 700 + jitter is below half of the range.
    EXPECT_EQ(wear.state().axes[0].unwrapped, static_cast<double>(wear.travelled()))
        << "tick " << k;
    if (testing::Test::HasFailure()) break;
  }
  EXPECT_GT(wear.travelled(), count * 600);
  EXPECT_EQ(wear.state().q[0], wear.plan().axes[0].unit_per_raw * wear.state().axes[0].unwrapped);
  return saturated;
}

TEST(Endurance, StaysFiniteBoundedAndWithoutDrift) {
  Wear wear(without_scene(worn_spec()));
  EXPECT_TRUE(wear_out(wear, ticks()));
}

TEST(Endurance, SoDoesACrowdedSceneThatItsSolverCannotFinish) {
  build::ProgramSpec spec = worn_spec();
  spec.max_sweeps = 3;
  Wear wear(std::move(spec));
  wear_out(wear, ticks(10'000));
}

}  // namespace
}  // namespace hapticd::control
