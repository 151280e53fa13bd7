#include "drivers/can/cia402_setup.h"

#include <cmath>
#include <cstdio>
#include <span>

namespace hapticd::can::cia402 {
namespace {

constexpr int kTries = 3;
constexpr double kAnswer_s = 0.15;

constexpr Object kDeviceType{0x1000, 0}, kConsumerHeartbeat{0x1016, 1},
    kProducerHeartbeat{0x1017, 0}, kCyclePeriod{0x1006, 0}, kModes{0x6060, 0},
    kModesDisplay{0x6061, 0}, kSupportedModes{0x6502, 0}, kRatedTorque{0x6076, 0},
    kMaxTorque{0x6072, 0}, kControl{0x6040, 0}, kTargetTorque{0x6071, 0},
    kAbortConnection{0x6007, 0}, kIncrements{0x608f, 1}, kTurns{0x608f, 2},
    kInterpolation{0x60c2, 1}, kInterpolationExponent{0x60c2, 2};
constexpr std::uint32_t kProfile = 402;
constexpr std::uint32_t kSupportsTorque = 1u << 9;
constexpr int kTorqueMode = 10;
constexpr int kQuickStop = 3;

std::string name_of(Object object) {
  char text[16];
  std::snprintf(text, sizeof text, "%04X:%u", object.index, static_cast<unsigned>(object.sub));
  return text;
}

std::string hex(std::uint32_t code) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08X", static_cast<unsigned>(code));
  return text;
}

class Sdo {
 public:
  Sdo(Conversation& conversation, const SetUp& wanted)
      : conversation_(conversation), wanted_(wanted) {}

  Result<std::uint32_t> read(Object object) {
    return ask(sdo_read(wanted_.node, object), object, SdoReply::Kind::read);
  }
  Result<void> write(Object object, std::int64_t value, int size) {
    const auto frame = sdo_write(wanted_.node, object, value, size);
    if (!frame)
      return fail(ExitCode::software, wanted_.place + ": " + std::to_string(value) +
                                          " does not fit into " + name_of(object));
    auto done = ask(*frame, object, SdoReply::Kind::written);
    if (!done) return tl::unexpected(done.error());
    return {};
  }
  /// And has it afterwards.
  Result<void> set(Object object, std::int64_t value, int size) {
    if (auto written = write(object, value, size); !written) return written;
    auto found = read(object);
    if (!found) return tl::unexpected(found.error());
    if (*found == static_cast<std::uint32_t>(value)) return {};
    return fail(ExitCode::unavailable, wanted_.place + ": object " + name_of(object) +
                                           " was set to " + std::to_string(value) +
                                           " and reads back " + std::to_string(*found));
  }
  /// Where the drive has such an object.
  Result<void> set_if_there(Object object, std::int64_t value, int size) {
    auto written = write(object, value, size);
    return written || answered_ ? Result<void>{} : written;
  }

 private:
  Result<std::uint32_t> ask(const Frame& frame, Object object, SdoReply::Kind expected) {
    answered_ = false;
    for (int i = 0; i < kTries; ++i) {
      conversation_.send(frame);
      const std::int64_t until_ns = conversation_.now_ns() + std::llround(kAnswer_s * 1e9);
      while (conversation_.now_ns() < until_ns) {
        const auto answer = conversation_.next(kAnswer_s);
        if (!answer) break;
        const Decoded decoded = decode(*answer, wanted_.node);
        if (!decoded.sdo || decoded.sdo->object.index != object.index ||
            decoded.sdo->object.sub != object.sub)
          continue;
        answered_ = true;
        if (decoded.sdo->kind == expected) return decoded.sdo->value;
        return fail(ExitCode::unavailable, wanted_.place + ": the drive refused object " +
                                               name_of(object) + " (SDO abort " +
                                               hex(decoded.sdo->value) + ")");
      }
    }
    return fail(ExitCode::unavailable,
                wanted_.place + ": no answer about object " + name_of(object) +
                    "; check the drive's power, the cable, its node id and bit rate");
  }

  Conversation& conversation_;
  const SetUp& wanted_;
  bool answered_ = false;
};

Result<Found> identify(Sdo& sdo, const SetUp& wanted) {
  auto type = sdo.read(kDeviceType);
  if (!type) return tl::unexpected(type.error());
  if ((*type & 0xffff) != kProfile)
    return fail(ExitCode::unavailable, wanted.place + ": this device follows profile " +
                                           std::to_string(*type & 0xffff) +
                                           ", expected 402, a drive");
  auto modes = sdo.read(kSupportedModes);
  if (!modes) return tl::unexpected(modes.error());
  if ((*modes & kSupportsTorque) == 0)
    return fail(ExitCode::unavailable,
                wanted.place + ": this drive has no cyclic synchronous torque mode (6502:0 is " +
                    hex(*modes) + ", bit 9 is missing)");
  auto rated_mNm = sdo.read(kRatedTorque);
  if (!rated_mNm) return tl::unexpected(rated_mNm.error());
  auto increments = sdo.read(kIncrements);
  if (!increments) return tl::unexpected(increments.error());
  auto turns = sdo.read(kTurns);
  if (!turns) return tl::unexpected(turns.error());
  if (*rated_mNm == 0 || *increments == 0 || *turns == 0)
    return fail(ExitCode::unavailable,
                wanted.place +
                    ": rated torque (6076) and encoder resolution (608F) must be set in "
                    "the drive, found 0");
  const double rated_Nm = 1e-3 * *rated_mNm;
  const auto most = sdo.read(kMaxTorque);  // optional: in thousandths of the rated one
  return Found{.rated_torque_Nm = rated_Nm,
               .counts_per_turn = static_cast<double>(*increments) / *turns,
               .max_torque_Nm = most ? 1e-3 * *most * rated_Nm : INFINITY};
}

/// Whatever it was left with by who drove it before.
Result<void> switch_off(Sdo& sdo) {
  return sdo.write(kControl, 0, 2).and_then([&] { return sdo.write(kTargetTorque, 0, 2); });
}

/// A drive for which it cannot be set what it does when the host falls silent would keep its torque.
Result<void> watch(Sdo& sdo, const SetUp& wanted) {
  const auto watchdog_ms = static_cast<std::int64_t>(std::ceil(1e3 * wanted.watchdog_s - 1e-6));
  return sdo.set(kProducerHeartbeat, std::llround(1e3 * wanted.heartbeat_every_s), 2)
      .and_then([&] {
        return sdo.set(kConsumerHeartbeat,
                       static_cast<std::int64_t>(wanted.host_node) << 16 | watchdog_ms, 4);
      })
      .and_then([&] { return sdo.set(kAbortConnection, kQuickStop, 2); });
}

/// One PDO: off, what it carries, when, on.
struct Pdo {
  std::uint16_t communication = 0, mapping = 0;
  std::uint32_t id = 0;
  int type = 0;
  std::span<const std::uint32_t> objects{};
};

Result<void> map(Sdo& sdo, const Pdo& pdo) {
  constexpr std::uint32_t kOff = 1u << 31;
  const Object id{pdo.communication, 1}, type{pdo.communication, 2}, count{pdo.mapping, 0};
  if (auto done = sdo.write(id, pdo.id | kOff, 4); !done) return done;
  if (auto done = sdo.write(count, 0, 1); !done) return done;
  for (std::size_t i = 0; i < pdo.objects.size(); ++i) {
    const Object entry{pdo.mapping, static_cast<std::uint8_t>(i + 1)};
    if (auto done = sdo.write(entry, pdo.objects[i], 4); !done) return done;
  }
  if (auto done = sdo.write(count, static_cast<std::int64_t>(pdo.objects.size()), 1); !done)
    return done;
  if (auto done = sdo.write(type, pdo.type, 1); !done) return done;
  return sdo.write(id, pdo.id, 4);
}

Result<void> map_all(Sdo& sdo, const SetUp& wanted) {
  constexpr std::uint32_t kControlAndTorque[] = {0x60400010, 0x60710010};
  constexpr std::uint32_t kStatusPositionTorque[] = {0x60410010, 0x60640020, 0x60770010};
  constexpr int kAtOnce = 255, kEachSync = 1;
  const Pdo to_drive{0x1400, 0x1600, 0x200u + wanted.node, kAtOnce, kControlAndTorque};
  const Pdo from_drive{0x1800, 0x1a00, 0x180u + wanted.node, kEachSync, kStatusPositionTorque};
  if (auto done = map(sdo, to_drive); !done) return done;
  if (auto done = map(sdo, from_drive); !done) return done;
  for (std::uint16_t other = 1; other < 4; ++other) {  // they would take room on the bus
    const Object id{static_cast<std::uint16_t>(0x1800 + other), 1};
    const std::uint32_t off = (1u << 31) + 0x180u + 0x100u * other + wanted.node;
    if (auto done = sdo.set_if_there(id, off, 4); !done) return done;
  }
  return {};
}

Result<void> choose_mode(Sdo& sdo, const SetUp& wanted) {
  if (auto done = sdo.set_if_there(kCyclePeriod, std::llround(1e6 * wanted.period_s), 4); !done)
    return done;
  const auto period_us = std::llround(1e6 * wanted.period_s);
  const int exponent = period_us % 1000 == 0 ? -3 : -4;
  const std::int64_t value = period_us / (exponent == -3 ? 1000 : 100);
  if (auto done = sdo.set_if_there(kInterpolation, value, 1); !done) return done;
  if (auto done = sdo.set_if_there(kInterpolationExponent, exponent, 1); !done) return done;
  if (auto done = sdo.write(kModes, kTorqueMode, 1); !done) return done;
  auto found = sdo.read(kModesDisplay);
  if (!found) return tl::unexpected(found.error());
  if (*found == kTorqueMode) return {};
  return fail(ExitCode::unavailable, wanted.place +
                                         ": asked for cyclic synchronous torque (mode 10), "
                                         "the drive shows mode " +
                                         std::to_string(*found));
}

Result<void> start(Conversation& conversation, const SetUp& wanted) {
  conversation.send(nmt(Nmt::start, wanted.node));
  const std::int64_t until_ns =
      conversation.now_ns() + std::llround(1e9 * (3 * wanted.heartbeat_every_s + 0.2));
  while (conversation.now_ns() < until_ns) {
    const auto frame =
        conversation.next(1e-9 * static_cast<double>(until_ns - conversation.now_ns()));
    if (!frame) break;
    const Decoded decoded = decode(*frame, wanted.node);
    if (decoded.guard && decoded.guard->state == NodeState::operational) return {};
  }
  return fail(ExitCode::unavailable,
              wanted.place + ": the drive did not become operational, or sends no heartbeat");
}

}  // namespace

Result<Found> set_up(Conversation& conversation, const SetUp& wanted) {
  conversation.send(nmt(Nmt::pre_operational, wanted.node));
  Sdo sdo(conversation, wanted);
  auto found = identify(sdo, wanted);
  if (!found) return found;
  auto done = switch_off(sdo)
                  .and_then([&] { return watch(sdo, wanted); })
                  .and_then([&] { return map_all(sdo, wanted); })
                  .and_then([&] { return choose_mode(sdo, wanted); })
                  .and_then([&] { return start(conversation, wanted); });
  if (!done) return tl::unexpected(done.error());
  return found;
}

}  // namespace hapticd::can::cia402
