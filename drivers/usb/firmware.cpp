#include "drivers/usb/firmware.h"

#include <fcntl.h>
#include <sha2.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "drivers/usb/falcon_codec.h"

namespace hapticd::usb::falcon {
namespace {

std::string sha256_of(std::span<const std::uint8_t> bytes) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> text{};
  ::SHA256Data(bytes.data(), bytes.size(), text.data());
  return text.data();
}

tl::unexpected<Error> refuse(ExitCode code, const std::string& path, const std::string& why) {
  return fail(code, "firmware " + path + ": " + why);
}

/// Whoever can write the file decides what the motors do.
std::string untrusted(const struct stat& file) {
  if (file.st_uid != 0 && file.st_uid != ::geteuid())
    return "it belongs to user " + std::to_string(file.st_uid) +
           "; expected root or the user that runs hapticd: chown root";
  if ((file.st_mode & (S_IWGRP | S_IWOTH)) != 0)
    return "group or others may write it; expected the owner alone: chmod go-w";
  return {};
}

class File {
 public:
  explicit File(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  const int descriptor_;
};

}  // namespace

Result<Firmware> read_firmware(const std::string& path, const std::string& sha256) {
  const File file(path);
  if (file.descriptor() < 0)
    return refuse(errno == EACCES ? ExitCode::no_permission : ExitCode::no_input, path,
                  std::strerror(errno));
  struct stat about {};
  if (::fstat(file.descriptor(), &about) != 0 || !S_ISREG(about.st_mode))
    return refuse(ExitCode::no_input, path, "expected a regular file");
  if (const std::string why = untrusted(about); !why.empty())
    return refuse(ExitCode::no_permission, path, why);
  const auto size = static_cast<std::size_t>(about.st_size);
  if (size < kLeastFirmwareBytes || size > kMostFirmwareBytes)
    return refuse(ExitCode::bad_data, path,
                  "expected 1024 to 65536 bytes, found " + std::to_string(size) +
                      "; this is no Falcon firmware");
  Firmware firmware;
  firmware.bytes.resize(size);
  if (::read(file.descriptor(), firmware.bytes.data(), size) != about.st_size)
    return refuse(ExitCode::no_input, path, "it cannot be read as a whole");
  firmware.sha256 = sha256_of(firmware.bytes);
  if (!sha256.empty() && firmware.sha256 != sha256)
    return refuse(ExitCode::bad_data, path,
                  "expected SHA-256 " + sha256 + ", found " + firmware.sha256);
  return firmware;
}

// -- into the device

namespace {

constexpr std::int64_t kGreeting_ns = 100'000'000;  ///< to wait for the answer to one greeting
constexpr int kGreetings = 20;
constexpr std::int64_t kEcho_ns = 200'000'000;  ///< of a chunk; it takes some 10 ms

/// The bytes of the serial line behind the bridge.
class Line {
 public:
  Line(BulkPort& port, Host& host) : port_(port), host_(host) {}

  bool requests(std::span<const ControlRequest> list) {
    return std::ranges::all_of(list, [&](const ControlRequest& one) {
      return note(port_.request(kVendorRequestType, one.request, one.value));
    });
  }
  /// Sends, and listens until `judge(all bytes since)` has an answer. `incomplete`: the time was over, or the device has gone.
  template <class Judge>
  Answer ask(std::span<const std::uint8_t> bytes, std::int64_t timeout_ns, Judge&& judge) {
    received_.clear();
    if (!note(port_.send(bytes))) return Answer::incomplete;
    const std::int64_t until_ns = host_.now_ns() + timeout_ns;
    Answer answer = judge(received_);
    while (answer == Answer::incomplete && listen(until_ns)) answer = judge(received_);
    return answer;
  }
  /// What still comes is not of interest.
  void settle(std::int64_t duration_ns) {
    const std::int64_t until_ns = host_.now_ns() + duration_ns;
    while (listen(until_ns)) {
    }
    received_.clear();
  }
  bool gone() const { return gone_; }

 private:
  bool note(Status status) {
    gone_ = gone_ || status == Status::gone;
    return status == Status::ok;
  }
  /// False: the time is over or the device has gone.
  bool listen(std::int64_t until_ns) {
    if (host_.now_ns() >= until_ns) return false;
    const Arrival arrival = port_.receive(until_ns);
    if (arrival.status == Status::nothing) return host_.now_ns() < until_ns;
    if (!note(arrival.status)) return false;
    for (std::size_t at = 0; at < arrival.bytes.size(); at += kUsbPacketBytes) {
      const auto packet =
          arrival.bytes.subspan(at, std::min(kUsbPacketBytes, arrival.bytes.size() - at));
      for (std::size_t i = kStatusBytes; i < packet.size(); ++i) received_.push_back(packet[i]);
    }
    return true;
  }

  BulkPort& port_;
  Host& host_;
  std::vector<std::uint8_t> received_;
  bool gone_ = false;
};

bool greet(Line& line) {
  for (int i = 0; i < kGreetings && !line.gone(); ++i) {
    const Answer answer = line.ask(kGreeting, kGreeting_ns,
                                   [](const auto& received) { return greeting_answer(received); });
    if (answer == Answer::right) return true;
  }
  return false;
}

bool comes_back(Line& line, std::span<const std::uint8_t> bytes) {
  return line.ask(bytes, kEcho_ns, [&](const auto& received) { return echo(bytes, received); }) ==
         Answer::right;
}

Upload send_all(Line& line, Words& words, const Firmware& firmware) {
  const std::size_t chunks = (firmware.bytes.size() + kChunkBytes - 1) / kChunkBytes;
  for (std::size_t i = 0; i < chunks; ++i) {
    if (i % 16 == 0) words.say("loads firmware, " + std::to_string(100 * i / chunks) + " %");
    if (words.abandoned()) return Upload::wrong_echo;
    if (!comes_back(line, chunk(firmware.bytes, i)))
      return line.gone() ? Upload::unplugged : Upload::wrong_echo;
  }
  return Upload::done;
}

}  // namespace

bool set_up_run(BulkPort& port, bool flush_on_bracket) {
  Status status = Status::ok;
  const auto ask = [&](const ControlRequest& one) {
    if (status == Status::ok) status = port.request(kVendorRequestType, one.request, one.value);
  };
  for (const ControlRequest& one : kBeforeRun) ask(one);
  if (flush_on_bracket) ask(kFlushOnBracket);
  return status == Status::ok;
}

Upload upload(BulkPort& port, Host& host, Words& words, const Firmware& firmware) {
  Line line(port, host);
  constexpr std::int64_t kSettle_ns = 20'000'000;
  if (!line.requests(kBeforeGreeting)) return line.gone() ? Upload::unplugged : Upload::no_greeting;
  line.settle(kSettle_ns);
  if (!greet(line)) return line.gone() ? Upload::unplugged : Upload::no_greeting;
  if (!line.requests(kBeforeUpload) || !comes_back(line, kStartUpload))
    return line.gone() ? Upload::unplugged : Upload::no_start;
  return send_all(line, words, firmware);
}

}  // namespace hapticd::usb::falcon
