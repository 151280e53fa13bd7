#include "daemon/live.h"

#include <gtest/gtest.h>

#include "tests/unit/daemon/recording_fixture.h"

namespace hapticd::daemon {
namespace {

class LiveTest : public RecordingTest {
 protected:
  LiveTest() { live_.begin(program_.plan().record); }

  template <class T>
  static void put(std::vector<std::byte>& record, std::size_t offset, T value) {
    std::memcpy(record.data() + offset, &value, sizeof value);
  }

  Live live_;
};

TEST_F(LiveTest, KnowsNothingBeforeTheFirstRecord) {
  EXPECT_FALSE(live_.view().known);
}

TEST_F(LiveTest, TellsTheNewestRecord) {
  const control::RecordLayout& at = program_.plan().record;
  live_.add(record(0).data());
  auto newest = record(1);
  put(newest, at.work.offset + 8, 0.5);
  put(newest, at.fade.offset, 0.25);
  put(newest, at.homed.offset + 2, std::uint8_t{1});
  put(newest, at.aux.offset + sizeof(Aux) + offsetof(Aux, digital), std::uint32_t{5});
  live_.add(newest.data());
  const LiveView view = live_.view();
  EXPECT_TRUE(view.known);
  EXPECT_EQ(view.work_J, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(view.fade, (std::vector<double>{0.25, 0}));
  EXPECT_EQ(view.homed, (std::vector<bool>{false, false, true}));
  EXPECT_EQ(view.digital, (std::vector<std::uint32_t>{0, 5}));
}

TEST_F(LiveTest, CountsEachLimitOverEveryRecordAndOverLayouts) {
  constexpr auto kForce = static_cast<std::uint32_t>(Limit::force),
                 kPassivity = static_cast<std::uint32_t>(Limit::passivity);
  for (const std::uint32_t bits : {kForce, kForce | kPassivity, 0u}) {
    auto bytes = record(0);
    put(bytes, offsetof(control::RecordHeader, limits), bits);
    live_.add(bytes.data());
  }
  live_.begin(program_.plan().record);
  const LiveView view = live_.view();
  EXPECT_FALSE(view.known);
  EXPECT_EQ(view.limit_ticks[1], 2u);
  EXPECT_EQ(view.limit_ticks[12], 1u);
  EXPECT_EQ(view.limit_ticks[0], 0u);
}

}  // namespace
}  // namespace hapticd::daemon
