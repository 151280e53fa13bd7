// What the kernel may hand over, and what is handed to it: bytes of any length into a socket, and
// frames out of it and back.
#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/can/socket.h"
#include "tests/fuzz/input.h"

namespace hapticd::fuzz {
namespace {

/// A socket and the other end of its pair.
struct Pair {
  Pair() { must(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends) == 0, "a pair"); }
  ~Pair() { ::close(ends[0]); }
  int ends[2] = {-1, -1};
};

void receive(Input& input, can::Socket& socket, int far) {
  constexpr std::size_t kLengths[] = {CAN_MTU, CANFD_MTU, 1, 8, 15, 17, 71, 40};
  std::size_t good = 0;
  for (int i = input.byte() % 40; i > 0; --i) {
    const std::size_t length = kLengths[input.byte() & 7];
    std::array<std::uint8_t, CANFD_MTU> bytes{};
    for (std::size_t k = 0; k < length; ++k) bytes[k] = input.byte();
    const bool error = (bytes[3] & 0x20) != 0;
    if (length >= CAN_MTU && (length == CAN_MTU || length == CANFD_MTU)) good += error ? 0 : 1;
    must(::send(far, bytes.data(), length, 0) == static_cast<ssize_t>(length), "it is taken");
  }
  std::size_t seen = 0;
  do {
    for (const can::Received& received : socket.receive(7)) {
      const can::Frame& frame = received.frame;
      must(!frame.error && received.stamp_ns == 7, "errors are no frames");
      must(frame.size <= (frame.fd ? 64 : 8), "a length that there is");
      must(frame.id <= (frame.extended ? 0x1fffffffu : 0x7ffu), "an id has 11 or 29 bits");
      ++seen;
    }
  } while (socket.more());
  must(seen == good && socket.counters().received == good, "whole frames, and all of them");
  must(!can::word_of(socket.trouble()).empty(), "a word for any trouble");
}

void send(Input& input, can::Socket& socket, int far) {
  std::array<can::Frame, can::Socket::kMost + 3> frames;
  const std::size_t count = input.byte() % frames.size();
  for (std::size_t i = 0; i < count; ++i) {
    frames[i] = frame_of(input, [](auto&, auto) {});
    frames[i].error = false;
    frames[i].id &= frames[i].extended ? 0x1fffffffu : 0x7ffu;
  }
  const std::size_t sent = socket.send({frames.data(), count});
  must(sent == std::min(count, can::Socket::kMost), "a batch is taken");
  must(socket.counters().not_sent == count - sent, "the others are counted");
  can::Socket back = can::Socket::of(::dup(far));
  std::size_t i = 0;
  do {
    for (const can::Received& received : back.receive(0)) {
      must(received.frame.id == frames[i].id && received.frame.extended == frames[i].extended &&
               received.frame.remote == frames[i].remote && received.frame.fd == frames[i].fd &&
               received.frame.fast == frames[i].fast && received.frame.size == frames[i].size,
           "a frame comes as it went");
      must(std::ranges::equal(received.frame.payload(), frames[i].payload()), "so do its data");
      ++i;
    }
  } while (back.more());
  must(i == sent, "all of them");
}

}  // namespace
}  // namespace hapticd::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hapticd::fuzz;
  Input input(data, size);
  Pair pair;
  auto socket = hapticd::can::Socket::of(pair.ends[1]);
  if ((input.byte() & 1) != 0)
    send(input, socket, pair.ends[0]);
  else
    receive(input, socket, pair.ends[0]);
  return 0;
}
