// A Falcon's firmware, which its user has to supply: the file, and how it gets into the device.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "control/core/result.h"
#include "drivers/usb/options.h"
#include "drivers/usb/protocol.h"

namespace hapticd::usb::falcon {

struct Firmware {
  std::vector<std::uint8_t> bytes{};
  std::string sha256{};  ///< 64 hexadecimal digits
};

/// Errors name the file: not there, not a regular file, writable by others or of another user (not root, nor who runs
/// hapticd), too short or too long to be one, another digest than `sha256` where that is not empty.
Result<Firmware> read_firmware(const std::string& path, const std::string& sha256);

/// What came of one attempt.
enum class Upload : std::uint8_t { done, unplugged, no_greeting, no_start, wrong_echo };

/// From a device that may be in any state to one that has the firmware and runs at full speed: reset, greeting, chunks each
/// of which must come back as it went, run settings. `words` is told how far it is.
Upload upload(BulkPort& port, Host& host, Words& words, const Firmware& firmware);
/// The settings to speak packets with. False: the bridge did not take one.
bool set_up_run(BulkPort& port, bool flush_on_bracket);

}  // namespace hapticd::usb::falcon
