// Very many exchanges over a wire that drops, doubles and cuts: no value is taken that the device did not send.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "tests/drivers/usb_configs.h"

namespace hapticd::test {
namespace {

/// A million with HAPTICD_LONG, a hundredth else; less under a sanitizer.
int exchanges() {
#ifdef HAPTICD_SANITIZED
  constexpr int kUsual = 2'000;
#else
  constexpr int kUsual = 10'000;
#endif
  return std::getenv("HAPTICD_LONG") != nullptr ? 1'000'000 : kUsual;
}

class UsbExchanges : public testing::TestWithParam<UsbCase> {};
INSTANTIATE_TEST_SUITE_P(All, UsbExchanges, testing::ValuesIn(kUsbCases), usb_case_name);

/// Positions as the mechanics had them: a sample is right if the axis was there within what its age says.
TEST_P(UsbExchanges, NoWrongPositionIsTakenOfABadWire) {
  std::string text = GetParam().text();
  const std::string guard = "guard: {";
  text.replace(text.find(guard), guard.size(), guard + "max_stale_ticks: 20, ");
  auto rig = usb_rig(text, GetParam().electronics());
  ASSERT_TRUE(rig->connect());
  rig->input.enable = true;
  ASSERT_TRUE(rig->until([&] { return rig->enabled(); })) << rig->fault_text();
  rig->wire().set({.drop = 0.01, .duplicate = 0.01, .runt = 0.01, .seed = 5});
  const std::size_t axes = rig->compiled().usb[0]->axes.size();
  std::vector<std::deque<double>> truth(axes);
  // An OpenFFBoard reports what has changed: a report that is lost is made up for after 100 ms.
  const std::size_t remembered = std::string(GetParam().name) == "openffboard" ? 120 : 12;
  const int count = exchanges();
  int held = 0;
  for (int i = 0; i < count; ++i) {
    for (std::size_t a = 0; a < axes; ++a) {
      truth[a].push_back(rig->counts(a));
      if (truth[a].size() > remembered) truth[a].pop_front();
    }
    rig->tick();
    if (!rig->enabled()) {  // too many in a row were lost: an operator's case
      const auto clear = [&] {
        rig->input.enable = rig->input.clear_fault = true;
        return rig->enabled();
      };
      ASSERT_TRUE(rig->until(clear, 5000)) << rig->fault_text();
      truth.assign(axes, {});
      continue;
    }
    for (std::size_t a = 0; a < axes; ++a) {
      const AxisSample& sample = rig->sample(a);
      if (sample.freshness < Freshness::fresh) {
        ++held;
        continue;
      }
      const auto [least, most] = std::ranges::minmax(truth[a]);
      ASSERT_GE(sample.raw, least - 2) << "axis " << a << ", exchange " << i;
      ASSERT_LE(sample.raw, most + 2) << "axis " << a << ", exchange " << i;
    }
  }
  RecordProperty("held", held);
  EXPECT_GT(rig->wire().befallen(), static_cast<std::uint64_t>(count) / 100);
  EXPECT_GT(rig->device().traffic()->malformed.load(), 0u);
}

}  // namespace
}  // namespace hapticd::test
