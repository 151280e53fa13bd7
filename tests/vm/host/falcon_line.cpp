// falcon_line SOCKET CONFIG FIRMWARE: the Falcon behind its USB bridge, for QEMU's `usb-serial`: speaks over a socket what the
// board speaks over its line. QEMU's bridge passes on neither pins nor baud rates, so they are guessed from what is said.
// It begins without firmware. One second after its motors first make torque it is unplugged, for one second. Ends with
// QEMU, and says then what it saw, as JSON.
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "config/compile.h"
#include "sim/emulated_device.h"
#include "sim/usb/falcon.h"

namespace {

using namespace hapticd;
using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t now_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

Bytes content_of(const char* path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// QEMU listens; -1: not yet, or not any more.
int connect_to(const char* path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path, sizeof address.sun_path - 1);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  ::close(fd);
  return -1;
}

sim::usb::FalconOptions falcon_options(const usb::DeviceOptions& options, Bytes firmware) {
  sim::usb::FalconOptions falcon;
  falcon.board.firmware = std::move(firmware);
  falcon.board.torque_per_command_Nm = 1 / options.falcon.counts_per_Nm;
  falcon.board.home_after_s = 0.2;
  return falcon;
}

/// What the board hears and says, with the requests that its driver must have made.
class Line {
 public:
  explicit Line(sim::usb::Falcon& falcon) : falcon_(falcon) {}

  void power_on(std::int64_t at_ns) {
    falcon_.replug(false, at_ns);
    request(kLatency, 1, at_ns);
  }

  void hear(const Bytes& bytes, std::int64_t at_ns) {
    guess(bytes, at_ns);
    for (std::size_t i = 0; i < bytes.size(); i += kChunk) {
      const auto part = std::span(bytes).subspan(i, std::min(kChunk, bytes.size() - i));
      // The board is as quick as it must be: its line takes time, and its bridge has room for two chunks.
      while (falcon_.out(sim::usb::Falcon::kOut, part, at_ns).kind == sim::usb::Answer::Kind::nak) {
        falcon_.advance(at_ns += 100'000);
      }
    }
  }

  Bytes say(std::int64_t at_ns) {
    falcon_.advance(at_ns);
    Bytes all;
    while (true) {
      const auto answer = falcon_.in(sim::usb::Falcon::kIn, 64, at_ns);
      if (answer.bytes.size() <= sim::usb::FtdiBridge::kStatusBytes) return all;
      all.insert(all.end(), answer.bytes.begin() + sim::usb::FtdiBridge::kStatusBytes,
                 answer.bytes.end());
    }
  }

 private:
  static constexpr std::size_t kChunk = 62;
  static constexpr std::uint8_t kPins = 1, kBaud = 3, kLatency = 9;

  void request(std::uint8_t request, std::uint16_t value, std::int64_t at_ns) {
    (void)falcon_.control({.request_type = 0x40, .request = request, .value = value}, {}, at_ns);
  }

  void guess(const Bytes& bytes, std::int64_t at_ns) {
    if (falcon_.board().loaded_share()) return;
    if (bytes.front() == 0x0a) {
      for (const std::uint16_t pins : std::array<std::uint16_t, 3>{0x0200, 0x0100, 0x0101})
        request(kPins, pins, at_ns);
      request(kBaud, 0x4138, at_ns);
    } else if (bytes.size() == 1 && bytes.front() == 'A') {
      request(kPins, 0x0100, at_ns);
      request(kBaud, 0x0015, at_ns);
    } else if (bytes.front() == '<') {
      request(kBaud, 0x0002, at_ns);
    }
  }

  sim::usb::Falcon& falcon_;
};

class Board {
 public:
  Board(const config::Compiled& compiled, Bytes firmware)
      : falcon_(falcon_options(*compiled.usb[0], std::move(firmware))),
        mechanics_(compiled.simulated[0], joints(compiled), 1e-3) {}

  bool start() { return mechanics_.start().has_value(); }

  /// Until QEMU hangs up, or until it is time to unplug. False: QEMU did.
  bool serve(int fd) {
    line_.power_on(now_ns());
    while (true) {
      pollfd ready{.fd = fd, .events = POLLIN, .revents = 0};
      (void)::poll(&ready, 1, 1);
      const std::int64_t at_ns = now_ns();
      mechanics_.advance(at_ns);
      if (ready.revents != 0) {
        std::array<std::uint8_t, 4096> bytes{};
        const ssize_t size = ::read(fd, bytes.data(), bytes.size());
        if (size <= 0) return false;
        line_.hear({bytes.begin(), bytes.begin() + size}, at_ns);
      }
      const Bytes said = line_.say(now_ns());
      if (!said.empty() && ::send(fd, said.data(), said.size(), MSG_NOSIGNAL) < 0) return false;
      look(at_ns);
      if (unplug_ns_ != 0 && at_ns >= unplug_ns_) {
        unplug_ns_ = 0;
        return true;
      }
    }
  }

  void print() {
    std::printf("{\"commands\":%llu,\"firmware\":%s,\"largest_torque_Nm\":%.6g,\"unplugged\":%s}\n",
                static_cast<unsigned long long>(falcon_.board().commands()),
                falcon_.board().firmware_runs() ? "true" : "false", largest_Nm_,
                unplugged_ ? "true" : "false");
  }

 private:
  std::vector<sim::EmulatedDevice::Joint> joints(const config::Compiled& compiled) {
    std::vector<sim::EmulatedDevice::Joint> all;
    const auto& axes = compiled.usb[0]->axes;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const double counts = axes[i].counts_per_unit;
      all.push_back({.motor = &falcon_.motor(i),
                     .turns_per_unit = counts,
                     .offset_turns = -counts * compiled.simulated[0].axes[i].zero_m});
    }
    return all;
  }

  void look(std::int64_t at_ns) {
    for (std::size_t i = 0; i < falcon_.motors(); ++i)
      largest_Nm_ = std::max(largest_Nm_, std::abs(falcon_.motor(i).torque()));
    if (largest_Nm_ == 0 || unplugged_) return;
    unplugged_ = true;
    unplug_ns_ = at_ns + kSecond_ns;
  }

  sim::usb::Falcon falcon_;
  sim::EmulatedDevice mechanics_;
  Line line_{falcon_};
  double largest_Nm_ = 0;
  std::int64_t unplug_ns_ = 0;
  bool unplugged_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: falcon_line SOCKET CONFIG FIRMWARE\n");
    return 64;
  }
  const auto compiled = config::load(argv[2]);
  if (!compiled || compiled->usb.empty() || !compiled->usb[0]) {
    std::fprintf(stderr, "falcon_line: %s: expected a good config whose first device is on USB\n",
                 argv[2]);
    return 65;
  }
  Board board(*compiled, content_of(argv[3]));
  if (!board.start()) return 65;
  int fd = -1;
  for (int i = 0; i < 100 && (fd = connect_to(argv[1])) < 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  while (fd >= 0) {
    const bool unplugged = board.serve(fd);
    ::close(fd);
    if (!unplugged) break;
    std::this_thread::sleep_for(std::chrono::seconds(1));
    fd = connect_to(argv[1]);
  }
  board.print();
  return 0;
}
