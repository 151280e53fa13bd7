// What a host controller may send an emulated device, and what it may not: headers of any bytes, and sessions of transfers
// that are answered, taken back, cut off and unplugged. The host here keeps books: Linux drops a device for an answer to a
// transfer that it does not wait for.
#include <sys/socket.h>
#include <unistd.h>

#include <deque>
#include <map>
#include <vector>

#include "sim/usb/usbip.h"
#include "sim/usb/usbip_server.h"
#include "tests/fuzz/input.h"

namespace hapticd::fuzz {
namespace {

using namespace sim::usb;
using usbip::Command;

constexpr std::uint32_t kDevice = 0x10002;
constexpr std::int64_t kFrame_ns = 1'000'000;

/// Endpoints: 1 in and out by interrupt, 2 in and out by bulk. What goes out comes in.
class Mirror final : public Device {
 public:
  std::vector<std::uint8_t> device_descriptor() const override {
    return {18, 1, 0, 2, 0, 0, 0, 64, 1, 0, 2, 0, 0, 1, 0, 0, 0, 1};
  }
  std::vector<std::uint8_t> configuration_descriptor() const override {
    return {9, 2, 46, 0, 1, 1, 0,  0x80, 50, 9, 4, 0,    0, 4,  0xff, 0, 0, 0, 7, 5, 0x81, 3, 64,
            0, 1, 7,  5, 1, 3, 64, 0,    1,  7, 5, 0x82, 2, 64, 0,    0, 7, 5, 2, 2, 64,   0, 0};
  }
  sim::usb::Names names() const override { return {}; }
  std::vector<std::uint8_t> report_descriptor(int) const override { return {}; }
  Answer control(const Setup& setup, std::span<const std::uint8_t>, std::int64_t) override {
    return {.kind = static_cast<Answer::Kind>(setup.value % 3),
            .bytes = std::vector<std::uint8_t>(setup.index % 100)};
  }
  Answer out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, std::int64_t) override {
    said_[endpoint].emplace_back(bytes.begin(), bytes.end());
    return {};
  }
  Answer in(std::uint8_t endpoint, std::size_t, std::int64_t) override {
    auto& waiting = said_[endpoint];
    if (waiting.empty()) return {.kind = Answer::Kind::nak};
    Answer answer{.bytes = std::move(waiting.front())};
    waiting.pop_front();
    return answer;
  }
  void advance(std::int64_t) override {}
  std::int64_t next_ns() const override { return kNever; }
  void replug(bool, std::int64_t) override {}
  std::size_t motors() const override { return 0; }
  sim::Motor& motor(std::size_t) override { std::abort(); }

 private:
  std::map<std::uint8_t, std::deque<std::vector<std::uint8_t>>> said_;
};

/// The kernel's end.
class Host {
 public:
  Host() { must(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends_) == 0, "a pair"); }
  ~Host() { ::close(ends_[0]); }
  int far() const { return ends_[1]; }

  void write(std::span<const std::uint8_t> bytes) const {
    (void)::send(ends_[0], bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void submit(Input& input) {
    usbip::Request request{.number = number(input),
                           .device = kDevice,
                           .in = (input.byte() & 1) != 0,
                           .endpoint = static_cast<std::uint8_t>(input.byte() & 3),
                           .length = input.byte(),
                           .setup = input.take<Setup>()};
    if (waits_.contains(request.number)) return;
    waits_[request.number] = request;
    write(usbip::encode(request));
    const std::vector<std::uint8_t> payload(request.payload_bytes(), 7);
    write(payload);
  }
  void unlink(Input& input) {
    const std::uint32_t of = number(input);
    const usbip::Request request{
        .command = Command::unlink, .number = 1000 + ++unlinks_, .device = kDevice, .unlinked = of};
    waits_[request.number] = request;
    write(usbip::encode(request));
  }
  /// All that has come; each is waited for.
  void read() {
    usbip::Header header{};
    while (::recv(ends_[0], header.data(), header.size(), 0) ==
           static_cast<ssize_t>(header.size())) {
      const auto reply = usbip::decode_reply(header);
      must(reply.has_value(), "an answer");
      const auto found = waits_.find(reply->number);
      must(found != waits_.end(), "it is waited for");
      const usbip::Request asked = found->second;
      waits_.erase(found);
      must((asked.command == Command::unlink) == (reply->command == Command::unlinked),
           "the answer to what was asked");
      if (asked.command == Command::unlink) {
        must(reply->status == 0 || reply->status == -104, "taken back, or not");
        must(reply->status == -104 || !waits_.contains(asked.unlinked), "what is answered is done");
        waits_.erase(asked.unlinked);
        continue;
      }
      must(reply->status == 0 || reply->status == -32 || reply->status == -108, "an end");
      must(reply->length <= asked.length, "no more than was asked for");
      std::vector<std::uint8_t> bytes(asked.in ? reply->length : 0);
      must(::recv(ends_[0], bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()) ||
               bytes.empty(),
           "all its bytes");
    }
  }
  std::size_t waits() const { return waits_.size(); }

 private:
  static std::uint32_t number(Input& input) { return input.byte() % 16; }

  int ends_[2] = {-1, -1};
  std::map<std::uint32_t, usbip::Request> waits_;
  std::uint32_t unlinks_ = 0;
};

void session(Input& input) {
  Mirror device;
  Wire wire(device, {.jitter_s = 2e-3 * (input.byte() & 1),
                     .drop = 0.1 * (input.byte() & 1),
                     .duplicate = 0.1 * (input.byte() & 1),
                     .runt = 0.1 * (input.byte() & 1)});
  Host host;
  UsbipServer server(wire, host.far(), kDevice);
  std::int64_t now_ns = 0;
  bool wild = false;  // what the host says is no protocol any more: its books are void
  while (!input.empty()) {
    const std::uint8_t what = input.byte();
    switch (what & 7) {
      case 0:
      case 1:
      case 2:
        host.submit(input);
        break;
      case 3:
        host.unlink(input);
        break;
      case 4:
        wire.stall(static_cast<std::uint8_t>(0x80 | (input.byte() & 3)));
        break;
      case 5:
        wire.hang(now_ns + kFrame_ns * (input.byte() & 7));
        break;
      case 6:
        if ((what >> 3 & 7) == 0) wire.unplug();
        break;
      default:
        if ((what >> 3 & 7) != 0) break;
        wild = true;
        for (int i = input.byte() % 64; i > 0; --i) {
          const std::uint8_t byte = input.byte();
          host.write({&byte, 1});
        }
        break;
    }
    if ((what & 0x40) != 0) now_ns += kFrame_ns;
    const bool goes_on = server.advance(now_ns);
    must(goes_on == (server.fd() >= 0) && goes_on == server.over().empty(), "it says how it is");
    must(server.pending() <= UsbipServer::kMostPending, "a bounded number");
    if (!wild) host.read();
    if (!goes_on) return;
    must(wild || server.pending() <= host.waits(), "it knows of no others");
  }
}

void header(Input& input) {
  usbip::Header bytes{};
  for (std::uint8_t& byte : bytes) byte = input.byte();
  if (const auto request = usbip::decode_request(bytes)) {
    must(request->endpoint < 16 && request->length <= usbip::kMostBytes, "within bounds");
    must(request->payload_bytes() <= usbip::kMostBytes, "so is what follows");
    const auto again = usbip::decode_request(usbip::encode(*request));
    must(again && usbip::encode(*again) == usbip::encode(*request), "it survives being sent");
  }
  if (const auto reply = usbip::decode_reply(bytes))
    must(usbip::decode_reply(usbip::encode(*reply)) == reply, "so does an answer");
  if (const auto id = usbip::decode_import(std::span(bytes).first<usbip::kImportBytes>()))
    must(usbip::decode_import(*usbip::encode_import(*id)) == id, "so does an import");
}

}  // namespace
}  // namespace hapticd::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hapticd::fuzz::Input input(data, size);
  if (input.byte() % 4 == 0)
    hapticd::fuzz::header(input);
  else
    hapticd::fuzz::session(input);
  return 0;
}
