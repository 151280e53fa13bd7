// Who is on a bus. Listening disturbs nobody; a protocol is asked for only where its frames were heard, or by name: a
// question of one protocol may be a command of another.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/can/conversation.h"
#include "drivers/can/options.h"

namespace hapticd::can {

struct FoundDrive {
  Protocol protocol = Protocol::odrive;
  int node = 0;
  std::string what{};     ///< "ODrive, firmware 0.6.11"
  std::string refused{};  ///< why no device can be made of it; empty: one can
};

struct ScanOptions {
  double listen_s = 0.5;
  std::vector<Protocol> ask{};  ///< beside those that were heard
  bool questions = true;        ///< false: nothing is sent
};

/// By protocol and node.
std::vector<FoundDrive> scan(Conversation& conversation, const ScanOptions& options);

std::string_view word_of(Protocol protocol) noexcept;

}  // namespace hapticd::can
