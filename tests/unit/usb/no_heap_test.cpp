#include "drivers/hid/openffboard_codec.h"
#include "drivers/usb/falcon_codec.h"
#include "tests/support/heap_guard.h"
#include "tests/unit/usb/falcon_packets.h"

namespace hapticd::usb {
namespace {

TEST(UsbCodecs, TakeNothingFromTheHeap) {
  if (!test::HeapGuard::available())
    GTEST_SKIP() << "heap calls cannot be counted under this sanitizer";
  hid::OutputMap out = woodenhaptics_out();
  out.constants = {{.at = 6, .value = 1}};
  out.safe = bytes("0000000000000100");
  const hid::InputMap in = woodenhaptics_in();
  hid::InputState state;
  const Bytes transfer = bytes("01603c454741414d4a505043444141b1413e");
  falcon::Receiver receiver;
  std::size_t done = 0;
  const test::HeapGuard guard;
  for (int i = 0; i < 100; ++i) {
    const auto report = hid::encode(out, std::array{1.0, -2.0, 5.0}, 0);
    hid::Reading reading = hid::decode(in, report->report());
    hid::follow(in, state, reading);
    done += hid::safe_report(out, 0).size;
    done += falcon::encode({.motor_counts = {1, 2, 1e9}})->saturated ? 1 : 0;
    done += receiver.take(transfer).newest ? 1 : 0;
    done += hid::openffboard::encode_magnitude(1, 1e9)->saturated ? 1 : 0;
    done += hid::openffboard::decode_command(hid::openffboard::encode({})) ? 1 : 0;
  }
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_EQ(done, 1200U);
}

}  // namespace
}  // namespace hapticd::usb
