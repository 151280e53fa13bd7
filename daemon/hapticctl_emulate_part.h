// Of `hapticctl emulate`: the devices of one kind of bus, and what befalls them.
#pragma once
#include <poll.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "config/compile.h"
#include "control/core/result.h"
#include "daemon/hapticctl_emulate.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {

struct Fault {
  std::string kind{}, name{};
  std::int64_t at_ns = 0;           ///< since the start
  std::optional<double> percent{};  ///< instead: when so much firmware is loaded
};
/// "KIND:NAME@SECONDS", "KIND:NAME@PER CENT%"; `at_once`: "KIND:NAME" is now.
Result<Fault> parse_fault(const std::string& text, bool at_once = false);
/// Neither the device's sim section nor the models of its axes say what its motors move.
tl::unexpected<Error> nothing_to_move(const std::string& device);

class EmulatedPart {
 public:
  EmulatedPart() = default;
  EmulatedPart(const EmulatedPart&) = delete;
  EmulatedPart& operator=(const EmulatedPart&) = delete;
  virtual ~EmulatedPart() = default;

  /// Makes what the config has of this kind; that may be nothing.
  virtual Result<void> start(const config::Compiled& compiled, std::int64_t start_ns) = 0;
  /// What faults may name.
  virtual std::vector<std::string> names() const = 0;
  virtual std::span<const char* const> fault_kinds() const = 0;
  /// Only of one who loads firmware is it known how much of it there is.
  virtual bool has_firmware(const std::string& name) const = 0;
  /// `name` is one of names(), `kind` one of fault_kinds().
  virtual void befall(const Fault& fault, std::int64_t now_ns) = 0;
  virtual Result<void> advance(std::int64_t now_ns) = 0;
  /// When something happens after `now_ns` without news from the host; adds what to wait on.
  virtual std::int64_t next_ns(std::int64_t now_ns, std::vector<pollfd>& wait_on) const = 0;
  /// Adds what it did.
  virtual void add_to(Json& answer) const = 0;
  virtual std::string text() const = 0;
};

std::unique_ptr<EmulatedPart> emulated_can(const EmulateOptions& options);
std::unique_ptr<EmulatedPart> emulated_usb(const EmulateOptions& options);

}  // namespace hapticd::daemon
