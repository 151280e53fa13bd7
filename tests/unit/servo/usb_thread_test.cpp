// A device on USB with its real thread, between a loop and a board that comes and goes: what the two share is ordered
// (ThreadSanitizer), the loop's calls take nothing from the heap, and no force reaches another connection than that whose
// readings it rests on.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "drivers/usb/usb_device.h"
#include "drivers/usb/waker_host.h"
#include "tests/support/heap_guard.h"

namespace hapticd::usb {
namespace {

constexpr std::int64_t kReport_ns = 200'000;
constexpr int kCountsEach = 1000;  // positions begin with the connection's number
constexpr double kForceEach_N = 0.01;
constexpr double kNewtonsPerStep = 0.001;
constexpr int kStepsEach = 10;

/// What a test and the device's thread share of the board: nothing of it puts their other accesses in order.
struct Board {
  template <class T>
  struct Loose {
    std::atomic<T> value{};
    T get() const { return value.load(std::memory_order_relaxed); }
    void set(T to) { value.store(to, std::memory_order_relaxed); }
    void count() { value.fetch_add(1, std::memory_order_relaxed); }
  };
  Loose<bool> plugged{true};
  Loose<int> opened, closed;
  Loose<long> forces;          ///< reports with a force
  Loose<long> foreign;         ///< of these with one that another connection was meant to have
  Loose<int> left_with_force;  ///< closed while it was plugged in, and the last report had a force
};

class BoardPort final : public HidPort {
 public:
  BoardPort(Board& board, Waker& waker) : board_(board), waker_(waker) {
    board_.opened.count();
    number_ = board_.opened.get();
  }
  ~BoardPort() override {
    if (steps_ != 0 && !gone_) board_.left_with_force.count();
    board_.closed.count();
  }
  Arrival receive(std::int64_t until_ns) override {
    if (!waker_.take()) {
      std::array waker{waker_.descriptor()};
      wait_for(waker, std::min(until_ns, last_ns_ + kReport_ns));
    }
    gone_ = gone_ || !board_.plugged.get();
    if (gone_) return {.status = Status::gone};
    const std::int64_t now_ns = monotonic_ns();
    if (now_ns < last_ns_ + kReport_ns) return {};
    last_ns_ = now_ns;
    const std::int32_t position = number_ * kCountsEach + ++reports_ % kCountsEach;
    std::memcpy(report_.data(), &position, sizeof(position));
    return {.status = Status::ok, .bytes = report_, .stamp_ns = now_ns};
  }
  Status send(std::span<const std::uint8_t> bytes) override {
    gone_ = gone_ || !board_.plugged.get();
    if (gone_) return Status::gone;
    std::memcpy(&steps_, bytes.data(), sizeof(steps_));
    if (steps_ != 0) board_.forces.count();
    if (steps_ != 0 && steps_ != number_ * kStepsEach) board_.foreign.count();
    ++outgoing_.sent;
    return Status::ok;
  }
  Status flush(std::int64_t) override { return Status::ok; }
  const Outgoing& outgoing() const noexcept override { return outgoing_; }
  Status set_feature(std::span<const std::uint8_t>) override { return Status::ok; }
  std::size_t get_feature(std::span<std::uint8_t>) override { return 0; }
  const std::vector<std::uint8_t>& report_descriptor() const noexcept override {
    return descriptor_;
  }

 private:
  Board& board_;
  Waker& waker_;
  int number_ = 0, reports_ = 0;
  bool gone_ = false;
  std::int32_t steps_ = 0;
  std::int64_t last_ns_ = 0;
  std::array<std::uint8_t, 8> report_{};
  Outgoing outgoing_{};
  /// Usage ff00:0001, 8 bytes in and out, without ids.
  const std::vector<std::uint8_t> descriptor_{0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x15, 0x00,
                                              0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x08, 0x09, 0x01,
                                              0x81, 0x02, 0x09, 0x01, 0x91, 0x02, 0xc0};
};

class BoardHost final : public WakerHost {
 public:
  explicit BoardHost(Board& board) : board_(board) {}
  Opened<Found<BulkPort>> open_bulk(const Selection&, std::uint8_t, std::uint8_t) override {
    return tl::unexpected(NotOpened{});
  }
  Opened<Found<HidPort>> open_hid(const Selection&) override {
    if (!board_.plugged.get())
      return tl::unexpected(NotOpened{true, {"not plugged in", ExitCode::unavailable}});
    return Found<HidPort>{.port = std::make_unique<BoardPort>(board_, waker_),
                          .product = "board",
                          .serial = std::to_string(board_.opened.get())};
  }

 private:
  Board& board_;
};

/// Times so long that a machine that is busy, or slow with a sanitizer, fails nothing.
DeviceOptions options() {
  constexpr hid::Place kNumber{.offset_bits = 0, .width_bits = 32, .is_signed = true};
  DeviceOptions options{.name = "board", .kind = Kind::hid_report};
  options.worst_sample_age_s = options.send_s = options.watchdog_s = options.silence_s = 5;
  options.axes = {{.name = "board.x", .max_effort = 100}};
  options.report.in = {.report_bytes = 8, .fields = {{.place = kNumber}}};
  options.report.out = {.report_bytes = 8,
                        .fields = {{.place = kNumber, .scale = kNewtonsPerStep}}};
  return options;
}

/// A loop that wants a force as large as the number of the connection whose sample it has, until a fault.
struct Loop {
  UsbDevice& device;
  std::array<AxisSample, 1> samples{};
  std::array<double, 1> effort{}, delivered{};
  Aux aux{};
  std::int64_t ticks = 0;
  long heap_calls = 0;

  void tick() {
    const test::HeapGuard guard;
    device.request({.tick = ++ticks});
    (void)device.collect(samples, aux);
    if (aux.faulted)
      effort[0] = 0;
    else if (samples[0].freshness >= Freshness::fresh)
      effort[0] = kForceEach_N * std::floor(samples[0].raw / kCountsEach);
    device.set_armed(!aux.faulted);
    device.command(effort, delivered);
    if (aux.faulted) device.stop();
    heap_calls += guard.calls();
  }
};

TEST(UsbThread, ComesAndGoesBesideALoopAndNoForceGoesAstray) {
  constexpr int kConnections = 12;
  Board board;
  UsbDevice device(options(), std::make_unique<BoardHost>(board), thread_runner(1));
  const auto info = device.connect();
  ASSERT_TRUE(info) << info.error().text;

  std::atomic<bool> ended{false};
  std::size_t letters = 0;
  std::thread watches([&] {  // as the supervisor does
    while (!ended.load(std::memory_order_relaxed)) {
      letters += device.fault_text().size() + device.status_text().size();
      letters += device.traffic()->connections.load(std::memory_order_relaxed);
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
  });

  Loop loop{device};
  long forces = 0;
  int up_ticks = 0, forced_connections = 0;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (forced_connections < kConnections && std::chrono::steady_clock::now() < give_up) {
    loop.tick();
    if (board.plugged.get() && board.forces.get() > forces && ++up_ticks > 50) {
      board.plugged.set(false);
      up_ticks = 0;
      ++forced_connections;
    } else if (!board.plugged.get() && (loop.aux.faulted || forced_connections % 3 == 0)) {
      forces = board.forces.get();
      board.plugged.set(true);
      // Now and then the loop stands still meanwhile, and its last force is still there.
      const int before = board.opened.get();
      while (forced_connections % 3 == 0 && board.opened.get() == before &&
             std::chrono::steady_clock::now() < give_up)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  // Once more, to be ended while it makes a force.
  board.plugged.set(true);
  forces = board.forces.get();
  while (board.forces.get() < forces + 20 && std::chrono::steady_clock::now() < give_up) {
    loop.tick();
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  EXPECT_GE(board.forces.get(), forces + 20) << "it never made a force again";
  device.disconnect();
  ended.store(true, std::memory_order_relaxed);
  watches.join();

  EXPECT_EQ(forced_connections, kConnections);
  EXPECT_EQ(board.foreign.get(), 0);
  EXPECT_EQ(board.left_with_force.get(), 0);
  EXPECT_EQ(board.closed.get(), board.opened.get());
  EXPECT_GT(letters, 0U);
  if (test::HeapGuard::available()) {
    EXPECT_EQ(loop.heap_calls, 0) << "in " << loop.ticks << " ticks";
  }
}

}  // namespace
}  // namespace hapticd::usb
