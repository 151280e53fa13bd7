#include "drivers/can/bus_time.h"

#include <random>

#include "tests/unit/can/vectors.h"

namespace hapticd::can {
namespace {

TEST(BusTime, ClassicBitsOfEveryVector) {
  for (const Json& vector : vectors()["bus_time"]["classic"]) {
    SCOPED_TRACE(vector.dump());
    const Frame frame = frame_of(vector);
    EXPECT_EQ(classic_bits(frame), vector["bits_incl_interframe"].get<int>());
    EXPECT_EQ(worst_classic_bits(frame.size, frame.extended), vector["worst_case_bits"].get<int>());
  }
}

TEST(BusTime, FdTimesOfEveryVector) {
  for (const Json& vector : vectors()["bus_time"]["fd_bounds"]) {
    SCOPED_TRACE(vector.dump());
    const BitRates rates{vector["nominal_bps"], vector["data_bps"]};
    EXPECT_NEAR(1e6 * least_fd_s(vector["len"], vector["extended"], rates),
                vector["min_us"].get<double>(), 0.05);
    EXPECT_NEAR(1e6 * worst_fd_s(vector["len"], vector["extended"], rates),
                vector["worst_us"].get<double>(), 0.05);
  }
}

TEST(BusTime, LengthsOfEveryVector) {
  for (const Json& vector : vectors()["fd_length_rounding"])
    EXPECT_EQ(fd_length(vector["size"]), vector["fd_len"].get<int>()) << vector.dump();
}

TEST(BusTime, NoFrameIsLongerThanTheWorst) {
  std::mt19937 random(3);
  for (int i = 0; i < 100'000; ++i) {
    Frame frame{.extended = random() % 2 == 0, .size = static_cast<std::uint8_t>(random() % 9)};
    frame.id = static_cast<std::uint32_t>(random()) & (frame.extended ? 0x1fffffff : 0x7ff);
    const std::uint8_t run = random() % 3 == 0 ? 0x00 : 0xf0;  // runs make stuff bits
    for (auto& byte : frame.data)
      byte = random() % 2 == 0 ? run : static_cast<std::uint8_t>(random());
    EXPECT_LE(classic_bits(frame), worst_classic_bits(frame.size, frame.extended));
  }
}

}  // namespace
}  // namespace hapticd::can
