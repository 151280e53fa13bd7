#include "daemon/cost_rig.h"

#include <algorithm>
#include <utility>

namespace hapticd::daemon {
namespace {

std::int64_t no_clock() noexcept {
  return 0;
}

/// What its dead-man and e-stop inputs show when all is well.
std::uint32_t held_inputs(const build::ProgramSpec& spec, std::size_t device) {
  std::uint32_t digital = 0;
  for (const control::EnableInput& input : spec.enable_inputs) {
    if (input.device == device) digital = (digital & ~input.mask) | input.active;
  }
  return digital;
}

}  // namespace

class WalkingDevice final : public drivers::Device {
 public:
  WalkingDevice(const control::DevicePlan& plan, std::uint32_t digital)
      : axes_(plan.axes), first_axis_(plan.first_axis), digital_(digital) {
    for (auto& raw : raw_) raw.assign(axes_, 0.0);
  }
  void walk(const Walk& walk) {
    for (std::size_t i = 0; i < kWalkTicks; ++i)
      std::copy_n(walk[i].begin() + static_cast<std::ptrdiff_t>(first_axis_), axes_,
                  raw_[i].begin());
  }

  Result<drivers::DeviceInfo> connect() override { return drivers::DeviceInfo{.model = "walk"}; }
  void disconnect() noexcept override {}
  void request(const drivers::TickTime&) noexcept override {
    at_ = at_ + 1 < kWalkTicks ? at_ + 1 : 0;
  }
  drivers::Collected collect(std::span<AxisSample> axes, Aux& aux) noexcept override {
    aux.armed = true;
    aux.digital = digital_;
    for (std::size_t i = 0; i < axes.size(); ++i)
      axes[i] = {.raw = raw_[at_][i], .freshness = Freshness::fresh, .homed = true};
    return drivers::Collected::complete;
  }
  void command(std::span<const double> effort, std::span<double> delivered) noexcept override {
    std::copy(effort.begin(), effort.end(), delivered.begin());
  }
  void set_armed(bool) noexcept override {}
  void stop() noexcept override {}

 private:
  const std::size_t axes_, first_axis_;
  const std::uint32_t digital_;
  std::array<std::vector<double>, kWalkTicks> raw_;
  std::size_t at_ = 0;
};

double walked(std::size_t i) noexcept {
  const auto step = static_cast<double>(i % kWalkTicks);
  constexpr double quarter = kWalkTicks / 4.0;
  return step < quarter       ? step / quarter
         : step < 3 * quarter ? 2 - step / quarter
                              : step / quarter - 4;
}

CostRig::CostRig(build::ProgramSpec spec)
    : program_(std::move(spec)),
      slot_(program_.plan().record.bytes / sizeof(std::uint64_t)),
      ring_(std::as_writable_bytes(std::span(slot_)), program_.plan().record.bytes) {
  std::vector<drivers::Device*> pointers;
  for (std::size_t i = 0; i < program_.spec().devices.size(); ++i) {
    devices_.push_back(std::make_unique<WalkingDevice>(program_.spec().devices[i],
                                                       held_inputs(program_.spec(), i)));
    pointers.push_back(devices_.back().get());
  }
  cycle_ = std::make_unique<Cycle>(std::move(pointers), program_.plan());
  // The number of the tick, and with it the time of the scene, stands still: objects that move are
  // asked for their pose as ever, and wait where they are at time 0.
  input_.enable = true;
}

CostRig::~CostRig() = default;

void CostRig::walk(const Walk& walk) {
  for (const auto& device : devices_) device->walk(walk);
}

void CostRig::run(std::size_t ticks) noexcept {
  for (std::size_t i = 0; i < ticks; ++i) {
    cycle_->run(program_, input_, no_clock, &ring_);
    ring_.front();
    ring_.pop();
  }
}

}  // namespace hapticd::daemon
