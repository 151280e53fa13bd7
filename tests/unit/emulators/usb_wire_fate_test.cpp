// What befalls packets on the wire, and how often.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/emulators/usb_numbering_device.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::usb;

/// The number of hits of n lots is within five standard deviations.
void expect_share(std::size_t hits, double share, std::size_t n) {
  const double mean = share * static_cast<double>(n);
  EXPECT_NEAR(static_cast<double>(hits), mean, 5 * std::sqrt(mean * (1 - share)));
}

constexpr std::size_t kTransfers = 100'000;

TEST(Wire, InPacketsAreLostAsOftenAsAsked) {
  NumberingDevice device;
  UsbHost host(device, {.drop = 0.01});
  std::size_t got = 0, skipped = 0;
  std::uint8_t last = 0;
  for (std::int64_t frame = 0; got < kTransfers; ++frame) {
    if (host.wire.next_ns() == kNever) host.wire.submit_in(got, 1, 64, frame * 1'000'000);
    for (const auto& done : host.wire.advance(frame * 1'000'000)) {
      skipped += static_cast<std::uint8_t>(done.bytes[0] - last - 1);
      last = done.bytes[0];
      ++got;
    }
  }
  EXPECT_EQ(skipped, host.wire.befallen());
  EXPECT_EQ(skipped + got, static_cast<std::size_t>(device.given));
  expect_share(skipped, 0.01, skipped + got);
}

TEST(Wire, OutTransfersAreLostOrDoubledAsOftenAsAsked) {
  NumberingDevice device;
  UsbHost lossy(device, {.drop = 0.02});
  for (std::size_t i = 0; i < kTransfers; ++i) lossy.wire.submit_out(i, 1, UsbBytes{1}, 0);
  std::size_t completed = lossy.wire.advance(10'000'000'000).size();
  EXPECT_EQ(completed, kTransfers);
  expect_share(kTransfers - device.taken.size(), 0.02, kTransfers);
  EXPECT_EQ(kTransfers - device.taken.size(), lossy.wire.befallen());

  device.taken.clear();
  UsbHost doubling(device, {.duplicate = 0.02});
  for (std::size_t i = 0; i < kTransfers; ++i) doubling.wire.submit_out(i, 1, UsbBytes{1}, 0);
  completed = doubling.wire.advance(10'000'000'000).size();
  EXPECT_EQ(completed, kTransfers);
  expect_share(device.taken.size() - kTransfers, 0.02, kTransfers);
}

TEST(Wire, InPacketsAreDoubledAndCutAsOftenAsAsked) {
  NumberingDevice device;
  UsbHost host(device, {.duplicate = 0.02, .runt = 0.03});
  for (std::size_t i = 0; i < kTransfers; ++i) host.wire.submit_in(i, 1, 64, 0);
  std::size_t runts = 0, same = 0, empty = 0;
  int last = -1;
  for (const auto& done : host.wire.advance(10'000'000'000)) {
    runts += done.bytes.size() < 8;
    empty += done.bytes.empty();
    if (done.bytes.empty()) continue;
    same += done.bytes[0] == last;
    last = done.bytes[0];
  }
  const auto asked = static_cast<std::size_t>(device.given);
  expect_share(kTransfers - asked, 0.02, asked);
  expect_share(runts, 0.03, asked);
  expect_share(empty, 0.03 / 8, asked);  // each length as likely
  expect_share(same, 0.02 * (1 - 0.03 / 8), asked);
}

TEST(Wire, TheSameSeedIsTheSameFate) {
  const auto fate = [](std::uint64_t seed) {
    NumberingDevice device;
    UsbHost host(device,
                 {.jitter_s = 2e-3, .drop = 0.1, .duplicate = 0.1, .runt = 0.1, .seed = seed});
    for (int i = 0; i < 200; ++i) host.in(1);
    host.run_for(0.1);
    std::vector<std::pair<std::int64_t, std::size_t>> all;
    for (const auto& done : host.all) all.emplace_back(done.at_ns, done.bytes.size());
    return all;
  };
  EXPECT_EQ(fate(3), fate(3));
  EXPECT_NE(fate(3), fate(4));
}

TEST(Wire, JitterIsBoundedAndKeepsTheOrderOfAnEndpoint) {
  NumberingDevice device;
  UsbHost host(device, {.jitter_s = 5e-3});
  for (int i = 0; i < 50; ++i) host.in(3);
  host.run_for(0.3);
  ASSERT_EQ(host.all.size(), 50u);
  bool late = false;
  std::int64_t most_ns = 0;
  for (std::size_t i = 0; i < 50; ++i) {
    const std::int64_t late_ns = host.all[i].at_ns - static_cast<std::int64_t>(i) * 4'000'000;
    EXPECT_EQ(host.all[i].id, i + 1);
    EXPECT_GE(late_ns, 0);
    EXPECT_LE(late_ns, 5'000'000);
    late = late || late_ns > 4'000'000;
    most_ns = std::max(most_ns, late_ns);
  }
  EXPECT_TRUE(late) << most_ns;
}

}  // namespace
}  // namespace hapticd::test::emulator
