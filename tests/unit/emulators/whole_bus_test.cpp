// A host's conversation with drives over the descriptor, as a driver would have it.
#include <gtest/gtest.h>

#include "sim/can/emulated_bus.h"
#include "sim/can/moteus_drive.h"
#include "sim/can/odrive_drive.h"
#include "tests/unit/emulators/host_end.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;

TEST(WholeBus, ThreeMoteusAnswerWithinATick) {
  HostEnd host;
  EmulatedBus bus(host.bus_fd(), {});
  MoteusOptions options;
  MoteusDrive one(options, 0);
  options.servo = 2;
  MoteusDrive two(options, 0);
  options.servo = 3;
  MoteusDrive three(options, 0);
  for (Drive* drive :
       {static_cast<Drive*>(&one), static_cast<Drive*>(&two), static_cast<Drive*>(&three)})
    bus.add(*drive);
  bus.advance(0);
  for (const std::uint32_t servo : {1U, 2U, 3U})
    host.write(fd_frame(0x8000 | servo, "01000a0d22000000000222000011001f01130d50"));
  bus.advance(0);
  bus.advance(kMs);
  EXPECT_EQ(ids_of(host.read_all()), (std::vector<std::uint32_t>{0x100, 0x200, 0x300}));
  EXPECT_EQ(three.mode(), MoteusMode::enabling);
}

TEST(WholeBus, AnOdriveThatIsFedStaysArmedAndOneThatIsNotDoesNot) {
  HostEnd host;
  EmulatedBus bus(host.bus_fd(), {});
  OdriveDrive drive({}, 0);
  bus.add(drive);
  bus.advance(0);
  host.write(data_frame(0x0b, "0100000001000000"));
  host.write(data_frame(0x07, "08000000"));
  std::size_t estimates = 0;
  for (int ms = 1; ms <= 200; ++ms) {
    if (ms <= 150) host.write(data_frame(0x0e, hex_le(0.5F)));
    bus.advance(ms * kMs);
    for (const Frame& frame : host.read_all()) estimates += frame.can_id == 0x09 ? 1 : 0;
    const std::int64_t heard_ms = 151 + 20;  // a frame takes its time on the bus
    EXPECT_EQ(drive.enabled(), ms > 1 && ms < heard_ms) << ms;
  }
  EXPECT_NEAR(static_cast<double>(estimates), 200, 2);
}

TEST(WholeBus, ClocksThatRunApartBeat) {
  HostEnd host;
  EmulatedBus bus(host.bus_fd(), {});
  OdriveOptions options;
  options.clock_drift = 0.01;
  OdriveDrive drive(options, 0);
  bus.add(drive);
  int twice = 0;
  for (int ms = 1; ms <= 1000; ++ms) {
    bus.advance(ms * kMs);
    int now = 0;
    for (const Frame& frame : host.read_all()) now += frame.can_id == 0x09 ? 1 : 0;
    twice += now == 2 ? 1 : 0;
  }
  EXPECT_NEAR(twice, 10, 1);
}

}  // namespace
}  // namespace hapticd::test::emulator
