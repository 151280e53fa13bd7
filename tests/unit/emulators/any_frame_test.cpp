// Whatever is on the bus: drives neither crash nor make a torque that they cannot.
#include <gtest/gtest.h>

#include <random>

#include "sim/can/cia402_drive.h"
#include "sim/can/moteus_drive.h"
#include "sim/can/odrive_drive.h"
#include "tests/unit/emulators/host_end.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;

class AnyFrame {
 public:
  explicit AnyFrame(unsigned seed) : engine_(seed) {}
  std::uint32_t number() { return static_cast<std::uint32_t>(engine_()); }

  // Bytes from a few that mean something, and from all.
  std::uint8_t byte() {
    constexpr std::array<std::uint8_t, 14> kTelling{0x00, 0x01, 0x0a, 0x0d, 0x0c, 0x11, 0x1f,
                                                    0x20, 0x23, 0x40, 0x60, 0x7f, 0x80, 0xff};
    const std::uint32_t n = number();
    return n % 3 == 0 ? static_cast<std::uint8_t>(n >> 8) : kTelling[(n >> 8) % kTelling.size()];
  }
  Frame any(const std::vector<std::uint32_t>& ids) {
    Frame frame{};
    frame.can_id = ids[number() % ids.size()];
    if (number() % 8 == 0) frame.can_id ^= 1U << (number() % 32);
    const bool fd = number() % 2 == 0;
    frame.flags = fd ? CANFD_FDF | CANFD_BRS : 0;
    constexpr std::array<std::uint8_t, 7> kLong{12, 16, 20, 24, 32, 48, 64};
    frame.len = fd ? kLong[number() % 7] : static_cast<std::uint8_t>(number() % 9);
    for (std::uint8_t i = 0; i < frame.len; ++i) frame.data[i] = byte();
    return frame;
  }

 private:
  std::mt19937 engine_;
};

void confront(Drive& drive, const std::vector<std::uint32_t>& ids, double most_Nm, unsigned seed) {
  AnyFrame any(seed);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 100'000; ++i) {
    now_ns += any.number() % (2 * kMs);
    drive.advance(now_ns);
    drive.move_to(0.1 * (any.number() % 7) - 0.3, 1);
    drive.receive(any.any(ids), now_ns);
    ASSERT_LE(std::abs(drive.torque_Nm()), most_Nm * (1 + 1e-12)) << i;  // and is a number
    ASSERT_GT(drive.next_ns(), now_ns - 1) << i;
    for (const auto& sent : drive.take_sent()) {
      ASSERT_GE(sent.at_ns, now_ns - 100 * kMs);
      ASSERT_LE(sent.frame.len, is_fd(sent.frame) ? 64 : 8);
    }
  }
}

TEST(AnyFrame, DoesNoHarmToAnOdrive) {
  OdriveDrive drive({}, 0);
  std::vector<std::uint32_t> ids;
  for (std::uint32_t command = 0; command < 32; ++command) ids.push_back(command);
  confront(drive, ids, 10, 1);
}

TEST(AnyFrame, DoesNoHarmToAMoteus) {
  MoteusOptions options;
  options.position_max = 0.2;
  MoteusDrive drive(options, 0);
  confront(drive, {0x8001 | CAN_EFF_FLAG, 0x1}, 10, 2);
}

TEST(AnyFrame, DoesNoHarmToACia402Drive) {
  Cia402Drive drive({}, 0);
  for (const Json& vector : vectors().at("cia402").at("sdo_configure_cst"))
    drive.receive(frame_of(vector), 0);
  confront(drive, {0x000, 0x080, 0x201, 0x601, 0x77f}, 3, 3);
}

}  // namespace
}  // namespace hapticd::test::emulator
