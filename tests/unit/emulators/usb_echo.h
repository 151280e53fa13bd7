// A USB device for tests: what it is sent comes back, and it says "not yet" as long as a test wants. Beside it the host's
// end of a USB/IP connection.
#pragma once
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "sim/usb/device.h"
#include "sim/usb/usbip.h"

namespace hapticd::test::emulator {

using UsbBytes = std::vector<std::uint8_t>;
namespace usbip = sim::usb::usbip;

inline constexpr std::int64_t kUsbFrame_ns = 1'000'000;

/// Interface 0: HID with interrupt endpoints 1 in and 2 out. Interface 1: bulk 3 in and 4 out.
class EchoUsb final : public sim::usb::Device {
 public:
  using Answer = sim::usb::Answer;

  UsbBytes device_descriptor() const override {
    return {18, 1, 0, 2, 0, 0, 0, 64, 0x34, 0x12, 0x78, 0x56, 1, 2, 1, 2, 3, 1};
  }
  UsbBytes configuration_descriptor() const override {
    const auto reports = static_cast<std::uint8_t>(report_descriptor(0).size());
    UsbBytes all{9, 2, 0, 0, 2, 1, 0, 0x80, 50};
    for (const UsbBytes& part :
         {UsbBytes{9, 4, 0, 0, 2, 3, 0, 0, 0}, UsbBytes{9, 0x21, 0x11, 1, 0, 1, 0x22, reports, 0},
          UsbBytes{7, 5, 0x81, 3, 64, 0, 1}, UsbBytes{7, 5, 0x02, 3, 64, 0, 1},
          UsbBytes{9, 4, 1, 0, 2, 0xff, 0, 0, 0}, UsbBytes{7, 5, 0x83, 2, 64, 0, 0},
          UsbBytes{7, 5, 0x04, 2, 64, 0, 0}})
      all.insert(all.end(), part.begin(), part.end());
    all[2] = static_cast<std::uint8_t>(all.size());
    return all;
  }
  sim::usb::Names names() const override {
    return {.manufacturer = "maker", .product = "echo", .serial = "E1"};
  }
  UsbBytes report_descriptor(int interface) const override {
    if (interface != 0) return {};
    return {0x06, 0xab, 0xff, 0x0a, 0x00, 0x02, 0xa1, 0x01, 0x75, 0x08, 0x95,
            0x08, 0x09, 0x01, 0x81, 0x02, 0x09, 0x02, 0x91, 0x02, 0xc0};
  }

  Answer control(const sim::usb::Setup& setup, std::span<const std::uint8_t> data,
                 std::int64_t) override {
    asked.emplace_back(setup, UsbBytes(data.begin(), data.end()));
    if (busy) return {.kind = Answer::Kind::nak};
    if (setup.request == 0x99) return {.kind = Answer::Kind::stall};
    return {.bytes = (setup.request_type & 0x80) != 0 ? UsbBytes{9, 8, 7} : UsbBytes{}};
  }
  Answer out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, std::int64_t) override {
    got.emplace_back(endpoint, UsbBytes(bytes.begin(), bytes.end()));
    if (echoes) to_say.push_back(got.back());
    return {};
  }
  Answer in(std::uint8_t endpoint, std::size_t, std::int64_t) override {
    for (auto it = to_say.begin(); it != to_say.end(); ++it) {
      if (it->first - 1 != endpoint) continue;  // 1 in answers 2 out, 3 in 4 out
      Answer answer{.bytes = it->second};
      to_say.erase(it);
      return answer;
    }
    return {.kind = Answer::Kind::nak};
  }
  void advance(std::int64_t) override {}
  std::int64_t next_ns() const override { return sim::usb::kNever; }
  void replug(bool power_lost, std::int64_t) override { lost_power = power_lost; }
  std::size_t motors() const override { return 0; }
  sim::Motor& motor(std::size_t) override { throw std::logic_error("no motor"); }

  std::vector<std::pair<sim::usb::Setup, UsbBytes>> asked;
  std::vector<std::pair<std::uint8_t, UsbBytes>> got;
  std::deque<std::pair<std::uint8_t, UsbBytes>> to_say;  ///< by the endpoint that it came by
  bool busy = false, echoes = true, lost_power = false;
};

/// As the kernel writes and reads it.
class UsbipHost {
 public:
  static constexpr std::uint32_t kDevice = 0x10002;

  UsbipHost() {
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends_.data()) != 0)
      throw std::bad_alloc();
  }
  UsbipHost(const UsbipHost&) = delete;
  UsbipHost& operator=(const UsbipHost&) = delete;
  ~UsbipHost() { hang_up(); }

  int device_fd() const { return ends_[1]; }  ///< the server's own from then on
  int fd() const { return ends_[0]; }
  void hang_up() {
    if (ends_[0] >= 0) close(ends_[0]);
    ends_[0] = -1;
  }

  void write(std::span<const std::uint8_t> bytes) const {
    ASSERT_EQ(send(ends_[0], bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  void submit(usbip::Request request, const UsbBytes& payload = {}) const {
    request.device = kDevice;
    if (!request.in) request.length = static_cast<std::uint32_t>(payload.size());
    const auto header = usbip::encode(request);
    UsbBytes all(header.begin(), header.end());
    all.insert(all.end(), payload.begin(), payload.end());
    write(all);
  }
  void control(std::uint32_t number, const sim::usb::Setup& setup,
               const UsbBytes& payload = {}) const {
    submit({.number = number,
            .in = (setup.request_type & 0x80) != 0,
            .length = setup.length,
            .setup = setup},
           payload);
  }
  void unlink(std::uint32_t number, std::uint32_t unlinked) const {
    submit({.command = usbip::Command::unlink, .number = number, .unlinked = unlinked});
  }

  struct Got {
    usbip::Reply reply{};
    UsbBytes bytes{};
  };
  /// The next answer that has come whole; `in`: was the transfer one to the host?
  std::optional<Got> read(bool in) {
    std::array<std::uint8_t, 4096> bytes{};
    for (ssize_t size; (size = recv(ends_[0], bytes.data(), bytes.size(), 0)) > 0;)
      heard_.insert(heard_.end(), bytes.begin(), bytes.begin() + size);
    if (heard_.size() < usbip::kHeaderBytes) return std::nullopt;
    usbip::Header header{};
    std::copy_n(heard_.begin(), header.size(), header.begin());
    const auto reply = usbip::decode_reply(header);
    if (!reply) {
      ADD_FAILURE() << "not a reply";
      return std::nullopt;
    }
    const bool follow = in && reply->command == usbip::Command::submitted;
    const std::size_t end = header.size() + (follow ? reply->length : 0);
    if (heard_.size() < end) return std::nullopt;
    const auto from = heard_.begin(), to = from + static_cast<std::ptrdiff_t>(end);
    Got got{*reply, {from + usbip::kHeaderBytes, to}};
    heard_.erase(from, to);
    return got;
  }
  /// The device's end is closed, and nothing is left to read.
  bool is_over() const {
    std::uint8_t byte = 0;
    return heard_.empty() && recv(ends_[0], &byte, 1, MSG_PEEK) == 0;
  }

 private:
  std::array<int, 2> ends_{};
  UsbBytes heard_;
};

}  // namespace hapticd::test::emulator
