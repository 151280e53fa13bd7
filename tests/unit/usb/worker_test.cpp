// What the device's thread does, alone and in virtual time: the test is the loop, in between.
#include "drivers/usb/worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <map>
#include <new>
#include <optional>
#include <vector>

namespace hapticd::usb {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kMillisecond_ns = 1'000'000;

/// A clock that goes on when somebody waits, and what happens on the way.
class ScriptHost final : public Host {
 public:
  std::int64_t now_ns() noexcept override { return now_ns_; }
  void wait(std::int64_t until_ns) override {
    while (now_ns_ < until_ns && !woken_) {
      const bool due = !events_.empty() && events_.begin()->first <= until_ns;
      now_ns_ = std::max(now_ns_, due ? events_.begin()->first : until_ns);
      if (!due) break;
      const auto happen = std::move(events_.extract(events_.begin()).mapped());
      happen();
    }
    woken_ = false;
  }
  void wake() noexcept override { woken_ = true; }
  Opened<Found<BulkPort>> open_bulk(const Selection&, std::uint8_t, std::uint8_t) override {
    return tl::unexpected(NotOpened{});
  }
  Opened<Found<HidPort>> open_hid(const Selection&) override { return tl::unexpected(NotOpened{}); }
  void at(std::int64_t milliseconds, std::function<void()> happen) {
    events_.emplace(milliseconds * kMillisecond_ns, std::move(happen));
  }
  std::int64_t now_ms() const { return now_ns_ / kMillisecond_ns; }

 private:
  std::multimap<std::int64_t, std::function<void()>> events_;
  std::int64_t now_ns_ = 0;
  bool woken_ = false;
};

class ScriptPort final : public Port {
 public:
  explicit ScriptPort(ScriptHost& host) : host_(host) {}
  Arrival receive(std::int64_t until_ns) override {
    if (arrivals.empty()) host_.wait(until_ns);
    if (arrivals.empty()) return {};
    Arrival arrival = arrivals.front();
    arrivals.pop_front();
    if (arrival.stamp_ns == 0) arrival.stamp_ns = host_.now_ns();
    return arrival;
  }
  Status send(std::span<const std::uint8_t>) override {
    ++sends;
    return next(taken);
  }
  Status flush(std::int64_t until_ns) override {
    const Status status = next(ended);
    if (status == Status::nothing) host_.wait(until_ns);
    return status;
  }
  const Outgoing& outgoing() const noexcept override { return out; }

  std::deque<Arrival> arrivals;
  std::deque<Status> taken, ended;  ///< what the next send() and flush() give; ok in the end
  int sends = 0;
  Outgoing out{};

 private:
  static Status next(std::deque<Status>& from) {
    if (from.empty()) return Status::ok;
    const Status status = from.front();
    from.pop_front();
    return status;
  }
  ScriptHost& host_;
};

struct Told {
  std::int64_t at_ms = 0;
  bool armed = false;
  double effort = 0;
  bool operator==(const Told&) const = default;
};

class ScriptProtocol final : public Protocol {
 public:
  ScriptProtocol(const DeviceOptions& options, ScriptHost& host) : Protocol(options), host_(host) {}
  double carried(std::size_t, double effort) const noexcept override { return effort; }
  Opened<Identity> open(Host&, Words&) override {
    opened_ms.push_back(host_.now_ms());
    if (opens) return opens();
    port_.emplace(host_);
    return Identity{"Device", "S1"};
  }
  Port* port() noexcept override { return port_ ? &*port_ : nullptr; }
  Heard take(std::span<const std::uint8_t>, std::int64_t, Reading&) override { return hears; }
  Status tell(const Command& command, std::int64_t now_ns) override {
    told.push_back({now_ns / kMillisecond_ns, command.armed, command.effort[0]});
    return Status::ok;
  }
  std::int64_t tell_again_ns(std::int64_t now_ns) const noexcept override {
    return now_ns + 5 * kMillisecond_ns;
  }
  void close(Host&, std::int64_t until_ns) noexcept override {
    closing();
    closed_ms.push_back(host_.now_ms());
    way_out_ns.push_back(until_ns - host_.now_ns());
    port_.reset();
  }
  std::string_view fault_text() const noexcept override { return "trouble"; }

  std::function<Opened<Identity>()> opens;
  std::function<void()> closing = [] {};
  Heard hears = Heard::sample;
  std::vector<Told> told;
  std::vector<std::int64_t> opened_ms, closed_ms, way_out_ns;

 private:
  ScriptHost& host_;
  std::optional<ScriptPort> port_;
};

class UsbWorker : public testing::Test {
 protected:
  /// The thread's life, to then.
  void run(std::int64_t until_ms) {
    host_.at(until_ms, [this] { worker_.end(); });
    worker_.run();
  }
  ScriptPort& port() { return static_cast<ScriptPort&>(*protocol_.port()); }
  /// Something comes from the device at that time.
  void arrives(std::int64_t at_ms, Status status = Status::ok, Heard heard = Heard::sample) {
    host_.at(at_ms, [=, this] {
      protocol_.hears = heard;
      port().arrivals.push_back({.status = status});
      host_.wake();
    });
  }
  /// The loop gives a force at that time.
  void loop_gives(std::int64_t at_ms, std::uint32_t link, double effort) {
    host_.at(at_ms, [=, this] {
      exchange_.command.store(
          {.effort = {effort}, .at_ns = host_.now_ns(), .link = link, .armed = true});
      host_.wake();
    });
  }
  std::vector<Told> forces() const {
    std::vector<Told> forces;
    for (const Told& told : protocol_.told)
      if (told.armed || told.effort != 0) forces.push_back(told);
    return forces;
  }

  DeviceOptions options_{.name = "device", .watchdog_s = 0.02, .silence_s = 0.1};
  ScriptHost host_;
  ScriptProtocol protocol_{options_, host_};
  Exchange exchange_;
  Worker worker_{options_, host_, protocol_, exchange_};
};

TEST_F(UsbWorker, NoForceIsToldToAnotherConnectionThanItsOwn) {
  loop_gives(10, 1, 1.5);
  arrives(12, Status::gone);
  loop_gives(13, 1, 2.5);   // nobody is there
  loop_gives(120, 1, 3.5);  // the second connection, and a loop that has not seen it yet
  loop_gives(130, 2, 4.5);
  run(131);
  EXPECT_EQ(exchange_.connections, 2U);
  EXPECT_THAT(forces(), ElementsAre(Told{10, true, 1.5}, Told{130, true, 4.5}));
}

TEST_F(UsbWorker, ForceIsTakenBackWhenTheLoopHasGivenNoneForTheWatchdogsTime) {
  loop_gives(7, 1, 1);
  run(60);
  const auto given = forces();
  ASSERT_FALSE(given.empty());
  EXPECT_EQ(given.front().at_ms, 7);
  EXPECT_LE(given.back().at_ms, 27);
  const auto zero = std::ranges::find_if(
      protocol_.told, [](const Told& told) { return told.at_ms > 7 && !told.armed; });
  ASSERT_NE(zero, protocol_.told.end());
  EXPECT_EQ(zero->at_ms, 27) << "not at the next time at which the device would hear something";
}

TEST_F(UsbWorker, LooksForItEverMoreSeldom) {
  protocol_.opens = [] {
    return tl::unexpected(NotOpened{true, {"not plugged in", ExitCode::unavailable}});
  };
  run(5000);
  EXPECT_THAT(protocol_.opened_ms, ElementsAre(0, 100, 300, 700, 1500, 2500, 3500, 4500));
  EXPECT_TRUE(protocol_.closed_ms.empty()) << "what was not opened is not closed";
  ASSERT_NE(worker_.first(), nullptr);
  EXPECT_TRUE(worker_.first()->why.absent);
}

TEST_F(UsbWorker, LooksOftenAgainOnceItWasThere) {
  int times = 0;
  protocol_.opens = [&]() -> Opened<Identity> {
    if (++times == 5) protocol_.opens = {};
    return tl::unexpected(NotOpened{true, {"not plugged in", ExitCode::unavailable}});
  };
  arrives(2510, Status::gone);
  run(2700);
  EXPECT_THAT(protocol_.opened_ms, ElementsAre(0, 100, 300, 700, 1500, 2500, 2610));
}

TEST_F(UsbWorker, WhatIsThrownWhileItIsSetUpEndsNothing) {
  protocol_.opens = [this]() -> Opened<Identity> {
    protocol_.opens = {};
    throw std::bad_alloc();
  };
  run(150);
  EXPECT_THAT(protocol_.opened_ms, ElementsAre(0, 100));
  EXPECT_THAT(protocol_.closed_ms, ElementsAre(0, 150));
  EXPECT_THAT(worker_.first()->why.error.text, HasSubstr("it could not be set up: "));
}

struct WayOut {
  const char* name;
  std::function<void(ScriptPort&)> happens;
  Heard heard;
  const char* words;
};
void PrintTo(const WayOut& way, std::ostream* out) {
  *out << way.name;
}
class UsbWorkerWaysOut : public UsbWorker, public testing::WithParamInterface<WayOut> {};
INSTANTIATE_TEST_SUITE_P(
    All, UsbWorkerWaysOut,
    testing::Values(
        WayOut{"gone", [](ScriptPort& port) { port.arrivals = {{.status = Status::gone}}; },
               Heard::sample, "unplugged"},
        WayOut{"stalled", [](ScriptPort& port) { port.arrivals = {{.status = Status::stalled}}; },
               Heard::sample, "it refuses transfers"},
        WayOut{"failed", [](ScriptPort& port) { port.arrivals = {{.status = Status::failed}}; },
               Heard::sample, "its transfers fail"},
        WayOut{"restarted", [](ScriptPort& port) { port.arrivals = {{.status = Status::ok}}; },
               Heard::restarted, "trouble"},
        WayOut{"takes_nothing", [](ScriptPort& port) { port.out.last_took_ns = 50'000'000; },
               Heard::sample, "it has not taken a command for 50 ms"},
        WayOut{"silent", [](ScriptPort&) {}, Heard::sample, "no sample came for"}),
    [](const auto& way) { return way.param.name; });

/// The loop knows before anything else is tried, and the device is left without force, once.
TEST_P(UsbWorkerWaysOut, TellsTheLoopAndThenTheDevice) {
  arrives(1);
  loop_gives(2, 1, 1);
  host_.at(10, [this] {
    protocol_.hears = GetParam().heard;
    GetParam().happens(port());
    host_.wake();
  });
  std::uint32_t link_when_closed = 99;
  protocol_.closing = [&] {
    if (protocol_.closed_ms.empty()) link_when_closed = exchange_.link.load();
  };
  run(150);
  EXPECT_EQ(link_when_closed, 0U);
  ASSERT_FALSE(protocol_.closed_ms.empty());
  EXPECT_GE(protocol_.closed_ms[0], 10);
  EXPECT_LE(protocol_.closed_ms[0], 110);
  EXPECT_EQ(protocol_.way_out_ns[0], 20 * kMillisecond_ns);
  EXPECT_THAT(exchange_.lost.text(), HasSubstr("device (Device, serial S1): "));
  EXPECT_THAT(exchange_.lost.text(), HasSubstr(GetParam().words));
}

TEST_F(UsbWorker, ASampleThatMayBeOldDoesNotMakeTheDeviceSilent) {
  for (int at_ms = 10; at_ms <= 200; at_ms += 50) arrives(at_ms);
  host_.at(210, [this] {
    port().arrivals.push_back({.status = Status::ok, .stamp_ns = 50 * kMillisecond_ns});
    host_.wake();
  });
  run(230);
  EXPECT_EQ(exchange_.lost.text(), "");
  EXPECT_THAT(protocol_.opened_ms, ElementsAre(0));
}

TEST_F(UsbWorker, WhatABabblingDeviceSendsIsNoSample) {
  for (int at_ms = 1; at_ms <= 120; ++at_ms)
    host_.at(at_ms, [this] {
      if (protocol_.port() == nullptr) return;
      protocol_.hears = Heard::malformed;
      port().arrivals.push_back({.status = Status::ok});
      host_.wake();
    });
  run(150);
  EXPECT_THAT(exchange_.lost.text(), HasSubstr("no sample came for 101 ms"));
  EXPECT_GE(exchange_.traffic.malformed.load(), 100U);
}

TEST_F(UsbWorker, EndIsAWayOutToo) {
  loop_gives(2, 1, 1);
  run(30);
  EXPECT_THAT(protocol_.closed_ms, ElementsAre(30));
  EXPECT_EQ(exchange_.link.load(), 0U);
}

// -- zero force on the way out

class SendLast : public testing::Test {
 protected:
  int sent(std::deque<Status> taken, std::deque<Status> ended) {
    ScriptPort port(host_);
    port.taken = std::move(taken);
    port.ended = std::move(ended);
    send_last(host_, port, 20 * kMillisecond_ns, [&] { return port.send({}); });
    return port.sends;
  }
  ScriptHost host_;
};

TEST_F(SendLast, GoesOnceWhereItIsTaken) {
  EXPECT_EQ(sent({}, {}), 1);
}
TEST_F(SendLast, GoesAgainWhereItIsRefusedOrDoesNotEndWell) {
  EXPECT_EQ(sent({Status::stalled, Status::failed}, {}), 3);
  EXPECT_EQ(sent({}, {Status::failed, Status::stalled, Status::failed}), 4);
}
TEST_F(SendLast, GoesAgainFiveTimesAtMost) {
  EXPECT_EQ(sent({}, std::deque<Status>(9, Status::failed)), 5);
}
TEST_F(SendLast, EndsWithTheDevice) {
  EXPECT_EQ(sent({Status::gone}, {}), 1);
  EXPECT_EQ(sent({}, {Status::gone}), 1);
}
TEST_F(SendLast, EndsWithTheTime) {
  EXPECT_EQ(sent({}, {Status::failed, Status::nothing}), 2);
  EXPECT_EQ(host_.now_ms(), 20);
}

}  // namespace
}  // namespace hapticd::usb
