#include "tests/unit/usb/vectors.h"

#include <set>

namespace hapticd::usb {
namespace {

/// Groups that tests of this folder run.
const std::set<std::string> kTested{"falcon_encode",
                                    "falcon_encode_saturate_policy",
                                    "falcon_decode",
                                    "falcon_decode_reject",
                                    "falcon_stream",
                                    "falcon_boot_transcript",
                                    "ftdi_baud",
                                    "openffboard_hidcmd",
                                    "openffboard_reject",
                                    "openffboard_gamepad_in16",
                                    "pid_session",
                                    "pid_constant_force",
                                    "woodenhaptics_in",
                                    "woodenhaptics_out",
                                    "counter_unwrap16",
                                    "sequence_loss",
                                    "report_map_decode",
                                    "report_map_encode",
                                    "nonfinite_force",
                                    "report_map_config_reject",
                                    "haply_hapi_serial_read",
                                    "haply_hapi_serial_write",
                                    "falcon_counts_to_theta",
                                    "falcon_kinematics",
                                    "falcon_ik_unreachable",
                                    "falcon_fk_from_counts"};
/// What is said of the file, and the bus that an emulator speaks: its tests are in unit/emulators.
const std::set<std::string> kNotTestedHere{"meta", "usbip"};

TEST(UsbVectors, NoGroupIsLeftOut) {
  if (other_vectors() != nullptr) GTEST_SKIP() << "another file may have groups of its own";
  for (const auto& [group, all] : vectors().items())
    EXPECT_TRUE(kTested.contains(group) || kNotTestedHere.contains(group)) << group;
}

}  // namespace
}  // namespace hapticd::usb
