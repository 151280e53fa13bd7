#include "tests/unit/usb/vectors.h"

#include <set>

namespace hapticd::usb {
namespace {

/// Groups that tests of this folder run.
const std::set<std::string> kTested{"falcon_encode",      "falcon_encode_saturate_policy",
                                    "falcon_decode",      "falcon_decode_reject",
                                    "falcon_stream",      "falcon_boot_transcript",
                                    "ftdi_baud",          "openffboard_hidcmd",
                                    "openffboard_reject", "openffboard_gamepad_in16",
                                    "pid_session",        "pid_constant_force",
                                    "woodenhaptics_in",   "woodenhaptics_out",
                                    "counter_unwrap16",   "sequence_loss",
                                    "report_map_decode",  "report_map_encode",
                                    "nonfinite_force",    "report_map_config_reject"};
/// No codec: geometry, and the bus that an emulator speaks. Haply's serial boards have no driver.
const std::set<std::string> kNotOfACodec{
    "meta",  "falcon_counts_to_theta", "falcon_kinematics",      "falcon_ik_unreachable",
    "usbip", "falcon_fk_from_counts",  "haply_hapi_serial_read", "haply_hapi_serial_write"};

TEST(UsbVectors, NoGroupIsLeftOut) {
  if (other_vectors() != nullptr) GTEST_SKIP() << "another file may have groups of its own";
  for (const auto& [group, all] : vectors().items())
    EXPECT_TRUE(kTested.contains(group) || kNotOfACodec.contains(group)) << group;
}

}  // namespace
}  // namespace hapticd::usb
