// A drive on an emulated CAN bus, as its firmware behaves towards the host.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/can/frame.h"
#include "sim/motor.h"

namespace hapticd::sim::can {

/// Time of what does not happen.
inline constexpr std::int64_t kNever = INT64_MAX;

/// Time is the host's [ns]; a drive's own clock may run off by `clock_drift` (share; > 0: fast).
class Drive : public Motor {
 public:
  /// What it wants to send, and the time from which on it may go.
  struct Outgoing {
    std::int64_t at_ns = 0;
    Frame frame{};
  };

  Drive() = default;
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  /// The frame is complete on the bus at `now_ns`.
  virtual void receive(const Frame& frame, std::int64_t now_ns) = 0;
  /// Its own timers (cyclic messages, heartbeat, watchdog) up to now.
  virtual void advance(std::int64_t now_ns) = 0;
  /// Of its next timer; kNever: it has none.
  virtual std::int64_t next_ns() const = 0;
  /// That the motor makes now; 0 unless the power stage is on.
  virtual double torque_Nm() const = 0;
  double torque() const final { return torque_Nm(); }
  /// Power cycle: all is as after boot.
  virtual void reset(std::int64_t now_ns) = 0;
  /// The drive finds a fault of its own (its protocol's code) and disarms.
  virtual void fail(int code, std::int64_t now_ns) = 0;
  /// A new frame takes the place of one that has not yet got onto the bus.
  virtual bool newest_only() const { return false; }

  /// Sends nothing any more: the cable is broken towards the host.
  void mute(bool muted) { muted_ = muted; }
  std::vector<Outgoing> take_sent() { return std::exchange(sent_, {}); }

 protected:
  void send(std::int64_t at_ns, const Frame& frame) {
    if (!muted_) sent_.push_back({at_ns, frame});
  }

 private:
  bool muted_ = false;
  std::vector<Outgoing> sent_;
};

}  // namespace hapticd::sim::can
