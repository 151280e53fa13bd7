// The host's end of an emulated bus, and frames as a host writes them.
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "sim/can/drive.h"
#include "sim/can/emulated_bus.h"
#include "tests/unit/emulators/vectors.h"

namespace hapticd::test::emulator {

using sim::can::Frame;

inline constexpr std::int64_t kUs = 1000, kMs = 1'000'000;

class HostEnd {
 public:
  HostEnd() {
    if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends_.data()) != 0) throw std::bad_alloc();
  }
  HostEnd(const HostEnd&) = delete;
  HostEnd& operator=(const HostEnd&) = delete;
  ~HostEnd() {
    for (const int end : ends_) close(end);
  }
  int bus_fd() const { return ends_[1]; }

  void write(const Frame& frame) const {
    write_bytes(&frame, sim::can::is_fd(frame) ? CANFD_MTU : CAN_MTU);
  }
  void write_bytes(const void* bytes, std::size_t size) const {
    ASSERT_EQ(send(ends_[0], bytes, size, MSG_DONTWAIT), static_cast<ssize_t>(size));
  }
  std::vector<Frame> read_all() const {
    std::vector<Frame> frames;
    while (true) {
      Frame frame{};
      const ssize_t size = recv(ends_[0], &frame, sizeof frame, MSG_DONTWAIT);
      if (size <= 0) return frames;
      EXPECT_EQ(size, sim::can::is_fd(frame) ? CANFD_MTU : CAN_MTU);
      frames.push_back(frame);
    }
  }

 private:
  std::array<int, 2> ends_{};
};

inline Frame data_frame(std::uint32_t id, const std::string& hex) {
  return frame_of({{"can_id", id}, {"data", hex}});
}
inline Frame fd_frame(std::uint32_t id, const std::string& hex, bool speed = true) {
  return frame_of(
      {{"can_id", id}, {"data", hex}, {"extended", id >= 2048}, {"fd", true}, {"brs", speed}});
}

template <class T>
std::string hex_le(T value) {
  Frame frame = sim::can::classic_frame(0, sizeof(T));
  sim::can::put(frame, 0, value);
  return hex_of(frame);
}

/// A drive that repeats what it hears under another id, and has a timer.
class EchoDrive final : public sim::can::Drive {
 public:
  explicit EchoDrive(std::uint32_t id, std::int64_t turnaround_ns = 0)
      : id_(id), turnaround_ns_(turnaround_ns) {}
  void receive(const Frame& frame, std::int64_t now_ns) override {
    heard.emplace_back(now_ns, frame);
    Frame echo = frame;
    echo.can_id = id_;
    if (answers) send(now_ns + turnaround_ns_, echo);
  }
  void advance(std::int64_t now_ns) override {
    if (now_ns < timer_ns) return;
    send(timer_ns, sim::can::classic_frame(id_, 0));
    timer_ns = sim::can::kNever;
  }
  std::int64_t next_ns() const override { return timer_ns; }
  double torque_Nm() const override { return on ? torque : 0; }
  bool enabled() const override { return on; }
  void move_to(double new_turns, double new_turns_s) override {
    turns = new_turns;
    turns_s = new_turns_s;
  }
  void reset(std::int64_t) override {}
  void fail(int, std::int64_t) override { on = false; }
  bool newest_only() const override { return newest; }

  std::vector<std::pair<std::int64_t, Frame>> heard;
  std::int64_t timer_ns = sim::can::kNever;
  bool answers = true, newest = false, on = false;
  double torque = 0, turns = 0, turns_s = 0;

 private:
  std::uint32_t id_;
  std::int64_t turnaround_ns_;
};

inline std::vector<std::uint32_t> ids_of(const std::vector<Frame>& frames) {
  std::vector<std::uint32_t> ids;
  for (const Frame& frame : frames) ids.push_back(sim::can::id_of(frame));
  return ids;
}

/// Frames that a drive sent, in the order of sending.
inline std::vector<Frame> sent_by(sim::can::Drive& drive) {
  std::vector<Frame> frames;
  for (const auto& sent : drive.take_sent()) frames.push_back(sent.frame);
  return frames;
}

}  // namespace hapticd::test::emulator
