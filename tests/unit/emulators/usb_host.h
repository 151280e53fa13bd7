// Vectors of the USB protocols for the emulated devices, HAPTICD_USB_VECTORS names others; and a host that drives one over
// a Wire in virtual time.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/usb/wire.h"
#include "tests/unit/emulators/vectors.h"

namespace hapticd::test::emulator {

using UsbBytes = std::vector<std::uint8_t>;

inline const Json& usb_vectors() {
  static const Json read = [] {
    const char* other = std::getenv("HAPTICD_USB_VECTORS");
    const std::string path =
        other != nullptr ? other : HAPTICD_SOURCE_DIR "/tests/data/usb/vectors.json";
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot read the vectors in " + path);
    return Json::parse(file);
  }();
  return read;
}

/// Of other vectors a group may be missing.
template <class Check>
void each_usb_vector(const char* group, Check&& check) {
  const Json all = usb_vectors().value(group, Json::array());
  EXPECT_TRUE(!all.empty() || std::getenv("HAPTICD_USB_VECTORS") != nullptr) << group;
  for (const Json& vector : all) {
    SCOPED_TRACE(std::string(group) + ": " + vector.value("name", vector.dump()));
    check(vector);
  }
}

inline UsbBytes usb_bytes(const Json& vector, const char* key = "hex") {
  return bytes_of(vector.at(key).get<std::string>());
}

/// Bits of each report of a descriptor, by main item (0x80 input, 0x90 output, 0xb0 feature) and id; 0: none.
inline std::map<std::pair<int, int>, std::size_t> usb_report_bits(const UsbBytes& descriptor) {
  std::map<std::pair<int, int>, std::size_t> bits;
  int id = 0;
  std::size_t size = 0, count = 0;
  for (std::size_t i = 0; i < descriptor.size();) {
    const int tag = descriptor[i] & 0xfc;
    const std::size_t bytes = (descriptor[i] & 3) == 3 ? 4 : descriptor[i] & 3u;
    std::size_t value = 0;
    for (std::size_t b = 0; b < bytes; ++b) value |= std::size_t{descriptor.at(i + 1 + b)} << 8 * b;
    if (tag == 0x74) size = value;
    if (tag == 0x94) count = value;
    if (tag == 0x84) id = static_cast<int>(value);
    if (tag == 0x80 || tag == 0x90 || tag == 0xb0) bits[{tag, id}] += size * count;
    i += 1 + bytes;
  }
  return bits;
}

class UsbHost {
 public:
  explicit UsbHost(sim::usb::Device& device, const sim::usb::WireOptions& options = {})
      : wire(device, options) {}

  void run_for(double time_s) { run_to(now_ns + std::llround(1e9 * time_s)); }
  void run_to(std::int64_t until_ns) {
    for (;;) {
      const std::int64_t next_ns = std::min(until_ns, std::max(now_ns, wire.next_ns()));
      for (auto& done : wire.advance(next_ns)) all.push_back(std::move(done));
      now_ns = next_ns;
      if (wire.next_ns() > until_ns) break;
    }
    now_ns = until_ns;
    for (auto& done : wire.advance(until_ns)) all.push_back(std::move(done));
  }
  std::uint64_t out(std::uint8_t endpoint, const UsbBytes& bytes) {
    wire.submit_out(++last_id, endpoint, bytes, now_ns);
    return last_id;
  }
  std::uint64_t in(std::uint8_t endpoint, std::size_t most_bytes = 64) {
    wire.submit_in(++last_id, endpoint, most_bytes, now_ns);
    return last_id;
  }
  const sim::usb::Wire::Done* done(std::uint64_t id) const {
    for (const auto& one : all)
      if (one.id == id) return &one;
    return nullptr;
  }
  /// Waits for one; nothing: it did not come in `time_s`, and is cancelled.
  std::optional<UsbBytes> read(std::uint8_t endpoint, double time_s = 0.05,
                               std::size_t most_bytes = 64) {
    const std::uint64_t id = in(endpoint, most_bytes);
    const std::int64_t until_ns = now_ns + std::llround(1e9 * time_s);
    while (done(id) == nullptr && now_ns < until_ns) run_for(1e-3);
    const auto* one = done(id);
    if (one != nullptr && one->end == sim::usb::End::ok) return one->bytes;
    (void)wire.cancel(id);
    return std::nullopt;
  }
  /// Time for it to go out.
  void write(std::uint8_t endpoint, const UsbBytes& bytes, double time_s = 1e-3) {
    const std::uint64_t id = out(endpoint, bytes);
    run_for(time_s);
    ASSERT_NE(done(id), nullptr);
    ASSERT_EQ(done(id)->end, sim::usb::End::ok);
  }
  sim::usb::Answer ask(const sim::usb::Setup& setup, const UsbBytes& data = {}) {
    return wire.control(setup, data, now_ns);
  }

  sim::usb::Wire wire;
  std::vector<sim::usb::Wire::Done> all;
  std::int64_t now_ns = 0;
  std::uint64_t last_id = 0;
};

inline bool usb_acked(const sim::usb::Answer& answer) {
  return answer.kind == sim::usb::Answer::Kind::ack;
}
inline bool usb_stalled(const sim::usb::Answer& answer) {
  return answer.kind == sim::usb::Answer::Kind::stall;
}

}  // namespace hapticd::test::emulator
