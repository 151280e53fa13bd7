#include "drivers/hid/openffboard.h"

#include <algorithm>

#include "drivers/hid/openffboard_codec.h"
#include "drivers/hid/openffboard_force.h"
#include "drivers/hid/openffboard_setup.h"
#include "drivers/hid/openffboard_talk.h"

namespace hapticd::hid {
namespace openffboard {
namespace {

using usb::Heard;

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kSetUp_ns = 5000 * kMillisecond_ns;
constexpr std::int64_t kWayOut_ns = 100 * kMillisecond_ns;
/// A board that still looks at its positions sends one every 100 ms, or a little later.
constexpr std::int64_t kPositionsStopped_ns = 150 * kMillisecond_ns;
constexpr Usage kJoystick = 0x0001'0004;

class OpenFfboard final : public usb::Protocol {
 public:
  explicit OpenFfboard(const usb::DeviceOptions& options) : Protocol(options), force_(options) {}

  double carried(std::size_t axis, double effort) const noexcept override;
  usb::Opened<usb::Identity> open(usb::Host& host, usb::Words& words) override;
  usb::Port* port() noexcept override { return port_.get(); }
  Heard take(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns,
             usb::Reading& reading) override;
  usb::Status tell(const usb::Command& command, std::int64_t now_ns) override {
    return port_ ? force_.tell(*port_, command, now_ns, sample_ns_) : usb::Status::gone;
  }
  std::int64_t tell_again_ns(std::int64_t now_ns) const noexcept override {
    return force_.tell_again_ns(now_ns, sample_ns_);
  }
  void close(usb::Host& host, std::int64_t until_ns) noexcept override;
  std::string_view fault_text() const noexcept override { return fault_; }
  double round_trip_s() const noexcept override { return board_.round_trip_s; }

 private:
  usb::Selection selection() const;
  void forget() noexcept;
  Heard take_gamepad(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns);
  Heard take_state(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns);
  Heard take_answer(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns);
  /// Of a report that came where a changed position would have.
  Heard unchanged(std::int64_t stamp_ns) const noexcept;
  std::string_view trouble() const noexcept;
  std::uint32_t drive_faults() const noexcept;

  std::unique_ptr<usb::HidPort> port_{};
  bool touched_ = false;
  Settings settings_{};
  Board board_{};
  Force force_;

  usb::Reading position_{};                       ///< as the last gamepad report has it
  std::int64_t position_ns_ = 0, sample_ns_ = 0;  ///< when the last of each came
  std::optional<State> state_{};
  bool stopped_ = false;  ///< by the emergency stop
  std::string_view fault_{};
};

// -- the servo thread

double OpenFfboard::carried(std::size_t axis, double effort) const noexcept {
  const auto encoded = encode_magnitude(1, magnitude_of(options_, axis, effort));
  const double unit = magnitude_of(options_, axis, 1);
  return encoded ? encoded->magnitude / unit : 0;
}

// -- from closed to opened, and back

usb::Selection OpenFfboard::selection() const {
  usb::Selection wanted = options_.selection;
  if (wanted.vendor == 0 && wanted.product == 0) {
    wanted.vendor = kVendor;
    wanted.product = kProduct;
  }
  if (!wanted.usage && !wanted.interface) wanted.usage = kJoystick;
  return wanted;
}

void OpenFfboard::forget() noexcept {
  touched_ = stopped_ = false;
  settings_ = {};
  position_ = {};
  position_ns_ = sample_ns_ = 0;
  state_.reset();
  fault_ = {};
}

usb::Opened<usb::Identity> OpenFfboard::open(usb::Host& host, usb::Words& words) {
  auto found = host.open_hid(selection());
  if (!found) return tl::unexpected(found.error());
  forget();
  port_ = std::move(found->port);
  words.say("sets the board up");
  Talk talk(*port_, host, words, host.now_ns() + kSetUp_ns);
  auto board = set_up(talk, options_, settings_, touched_);
  if (!board) {
    close(host, host.now_ns() + kWayOut_ns);
    return tl::unexpected(board.error());
  }
  board_ = std::move(*board);
  force_.begin(board_);
  return usb::Identity{.model = found->product.empty() ? "OpenFFBoard" : std::move(found->product),
                       .serial = std::move(found->serial)};
}

/// Nothing that fails here can be helped: the effects end by themselves.
void OpenFfboard::close(usb::Host& host, std::int64_t until_ns) noexcept {
  if (port_ && touched_) {
    try {
      force_.end(*port_, host, until_ns);
      settings_.restore(*port_, host, until_ns);
    } catch (...) {
    }
  }
  touched_ = false;
  port_.reset();
}

// -- what comes

Heard OpenFfboard::take(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns,
                        usb::Reading& reading) {
  if (bytes.empty()) return Heard::malformed;
  Heard heard = Heard::nothing;
  if (bytes[0] == kGamepadReport) heard = take_gamepad(bytes, stamp_ns);
  if (bytes[0] == kStateReport) heard = take_state(bytes, stamp_ns);
  if (bytes[0] == kCommandReport) heard = take_answer(bytes, stamp_ns);
  if (heard == Heard::malformed) return heard;
  if (heard == Heard::sample) sample_ns_ = stamp_ns;
  if (const std::string_view why = trouble(); !why.empty()) {
    fault_ = why;
    heard = Heard::fault;
  }
  if (heard == Heard::nothing) return heard;
  reading.drive_faults = drive_faults();
  reading.counts = position_.counts;
  reading.digital = position_.digital;
  reading.analogue = position_.analogue;
  reading.homed = static_cast<std::uint8_t>((1U << board_.layout.axes) - 1);
  reading.armed = heard != Heard::fault && force_.on();
  return heard;
}

Heard OpenFfboard::take_gamepad(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) {
  const Layout& layout = board_.layout;
  const hid::Reading gamepad = decode(layout.gamepad, bytes);
  if (gamepad.received != Received::ok) {
    position_ns_ = 0;  // it said something else than before, and nobody knows what
    return Heard::malformed;
  }
  for (std::size_t i = 0; i < layout.axes; ++i)
    position_.counts[i] = static_cast<double>(gamepad.raw[i]);
  if (layout.buttons) position_.digital = static_cast<std::uint32_t>(gamepad.raw[layout.axes]);
  const std::size_t first = layout.first_analogue();
  for (std::size_t i = first; i < layout.gamepad.fields.size(); ++i)
    position_.analogue[i - first] = gamepad.value[i];
  position_ns_ = stamp_ns;
  return Heard::sample;
}

Heard OpenFfboard::take_state(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) {
  state_ = decode_state(bytes);
  if (!state_) return Heard::malformed;
  force_.is_said(state_->actuators_enabled && state_->power && !state_->paused);
  return unchanged(stamp_ns);
}

/// Answers to others and notifications mean nothing here.
Heard OpenFfboard::take_answer(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) {
  if (bytes.size() != kCommandBytes) return Heard::malformed;
  const auto reply = decode_command(bytes);
  if (!reply || !answers(*reply, kIsForceOn)) return Heard::nothing;
  if (force_.is_answered() && reply->type == Type::read) {
    stopped_ = reply->data < 0;
    force_.is_said(reply->data > 0);
  }
  return unchanged(stamp_ns);
}

Heard OpenFfboard::unchanged(std::int64_t stamp_ns) const noexcept {
  const bool alive = position_ns_ != 0 && stamp_ns - position_ns_ < kPositionsStopped_ns;
  return alive ? Heard::sample : Heard::nothing;
}

/// Empty: none, or nobody wants a force.
std::string_view OpenFfboard::trouble() const noexcept {
  if (!force_.wanted()) return {};
  if (stopped_) return "the board's emergency stop is pressed; release it";
  if (state_ && state_->safety) return "the board's safety switch is on; switch it off";
  if (state_ && !state_->power) return "the board's motors have no power; switch it on";
  if (force_.lost()) return "the board has switched its force off; does another program use it?";
  return {};
}

std::uint32_t OpenFfboard::drive_faults() const noexcept {
  const auto bit = [](bool set, std::uint32_t which) { return set ? which : 0U; };
  return bit(stopped_, kEmergencyStop) | bit(state_ && state_->safety, kSafetySwitch) |
         bit(state_ && !state_->power, kNoPower) | bit(state_ && state_->paused, kPaused) |
         bit(force_.lost(), kForceOff);
}

}  // namespace
}  // namespace openffboard

std::unique_ptr<usb::Protocol> make_openffboard(const usb::DeviceOptions& options) {
  return std::make_unique<openffboard::OpenFfboard>(options);
}

}  // namespace hapticd::hid
