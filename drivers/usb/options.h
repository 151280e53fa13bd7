// What a device on USB is: filled by config/, plain data.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/hid/report_map.h"

namespace hapticd::usb {

enum class Kind : std::uint8_t { falcon, hid_report, openffboard };
enum class Transport : std::uint8_t { hidapi, libusb };

/// Which device is meant. What is not given does not matter.
struct Selection {
  std::uint16_t vendor = 0, product = 0;
  std::string serial{};
  std::string path{};  ///< of the port that it is plugged into, as in sysfs: "1-2.3"
  std::optional<int> interface {};
  std::optional<std::uint32_t> usage{};     ///< HID: usage page << 16 | usage of a top collection
  Transport transport = Transport::hidapi;  ///< HID
  int reads = 2;                            ///< libusb: IN transfers in flight, 2 to 8
};

struct AxisOptions {
  std::string name{};  ///< for people: "left.x"
  /// Encoder counts per m or rad of the axis, negative: reversed. Samples are in counts.
  double counts_per_unit = 1;
  double max_effort = 1;  ///< N, N m
};

struct FalconOptions {
  std::string firmware{};  ///< path; empty: none, the device must have it already
  std::string sha256{};    ///< that it must have, 64 hexadecimal digits; empty: any
  int upload_tries = 10;
  double counts_per_Nm = -10000;  ///< of the motor command, not 0
  double max_command = 4096;      ///< either way, up to 32767
  bool flush_on_bracket = false;  ///< the bridge's event character sends each packet on at once
};

/// Positions are the first fields of `in`, one an axis, then `buttons` fields of digital inputs, then analogue ones.
/// Efforts are the fields of `out`, one an axis [N, N m].
struct ReportOptions {
  hid::InputMap in{};
  hid::OutputMap out{};
  std::size_t buttons = 0;  ///< up to 32 fields
  double every_s = 0.005;   ///< a report goes out at least so often
};

struct OpenFfboardOptions {
  double full_torque_Nm = 1;  ///< of an axis at the full magnitude, > 0
  double dead_man_s = 0.1;    ///< an effect ends by itself after so long; set anew in time
};

struct DeviceOptions {
  std::string name{};
  Kind kind = Kind::falcon;
  Selection selection{};
  double period_s = 1e-3;
  double arrival_age_s = 1e-3;         ///< of a sample when it arrives, at most
  double worst_sample_age_s = 2.5e-3;  ///< at collect; an older sample is missing
  double send_s = 1e-3;                ///< a command is with the device after so long, at most
  double drive_delay_s = 1e-4;         ///< and acts after so long
  double watchdog_s = 0.02;            ///< the loop gave no command for so long: zero force
  double silence_s = 0.1;              ///< the device said nothing for so long: it is lost
  int priority = 70;                   ///< SCHED_FIFO of the device's thread, below the loop's
  std::vector<AxisOptions> axes{};
  FalconOptions falcon{};
  ReportOptions report{};
  OpenFfboardOptions openffboard{};
};

}  // namespace hapticd::usb
