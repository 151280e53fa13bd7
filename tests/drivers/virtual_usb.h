// USB in virtual time: ports over an emulated wire, and the device's own thread. It is a real one, but it runs only while
// the rig waits for it: one of the two runs at a time, so every run is the same.
#pragma once
#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <semaphore>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/usb/host.h"
#include "drivers/usb/runner.h"
#include "sim/emulated_device.h"
#include "sim/usb/wire.h"

namespace hapticd::test {

/// Time, wire, mechanics, and the device's thread as far as it waits for them.
class VirtualUsb {
 public:
  VirtualUsb(sim::usb::Device& device, const sim::usb::WireOptions& options,
             std::unique_ptr<sim::EmulatedDevice> body)
      : wire(device, options), body_(std::move(body)) {}
  ~VirtualUsb() {
    if (thread_.joinable()) thread_.join();
  }

  std::int64_t now_ns() const { return now_ns_; }
  void pass_until(std::int64_t time_ns) {
    run_thread();
    while (now_ns_ < time_ns) {
      const std::int64_t next_ns = std::min({time_ns, wire.next_ns(), thread_wakes_ns_});
      now_ns_ = std::max(now_ns_ + 1, next_ns);
      carry();
      run_thread();
    }
  }
  /// Every completion of a transfer of the host.
  std::function<void(const sim::usb::Wire::Done&)> completed = [](const auto&) {};

  // -- the device's thread
  void start(std::function<void()> body) {
    if (thread_.joinable()) thread_.join();
    ended_ = false;
    thread_wakes_ns_ = now_ns_;
    thread_ = std::thread([this, body = std::move(body)] {
      go_.acquire();
      body();
      ended_ = true;
      back_.release();
    });
  }
  void join() {
    while (thread_.joinable() && !ended_) pass_until(now_ns_ + 100'000);
    if (thread_.joinable()) thread_.join();
  }
  /// Called by it: until then, or until wake().
  void wait(std::int64_t until_ns) {
    if (woken_ || until_ns <= now_ns_) {
      woken_ = false;
      return;
    }
    thread_wakes_ns_ = until_ns;
    back_.release();
    go_.acquire();
    woken_ = false;
  }
  void wake() noexcept { woken_ = true; }

  const sim::EmulatedDevice& body() const { return *body_; }

  sim::usb::Wire wire;

 private:
  void carry() {
    body_->advance(now_ns_);
    for (const auto& done : wire.advance(now_ns_)) completed(done);
  }
  void run_thread() {
    while (!ended_ && (woken_ || now_ns_ >= thread_wakes_ns_)) {
      thread_wakes_ns_ = INT64_MAX;
      go_.release();
      back_.acquire();
      carry();
    }
  }

  std::unique_ptr<sim::EmulatedDevice> body_;
  std::int64_t now_ns_ = 1'000'000'000;
  std::int64_t thread_wakes_ns_ = 0;
  bool woken_ = false, ended_ = true;
  std::binary_semaphore go_{0}, back_{0};
  std::thread thread_;
};

/// Endpoints of one interface.
struct Endpoints {
  int interface = 0;
  std::uint8_t in = 0x81, out = 0x02;  ///< out 0: reports go by control transfers
};

/// A port of the device's thread over the wire, with reads in flight and newest-wins writes.
class VirtualPort {
 public:
  VirtualPort(VirtualUsb& usb, const Endpoints& endpoints, int reads)
      : usb_(usb), ends_(endpoints) {
    usb_.completed = [this](const sim::usb::Wire::Done& done) { take(done); };
    for (int i = 0; i < reads; ++i) submit_in();
  }
  ~VirtualPort() {
    usb_.completed = [](const auto&) {};
    for (const std::uint64_t id : pending_) usb_.wire.cancel(id);
  }

  usb::Arrival receive(std::int64_t until_ns) {
    if (arrived_.empty() && !gone_ && !stalled_) usb_.wait(until_ns);
    if (!arrived_.empty()) {
      shown_ = std::move(arrived_.front());
      arrived_.pop_front();
      return {.status = usb::Status::ok, .bytes = shown_.bytes, .stamp_ns = shown_.at_ns};
    }
    if (gone_) return {.status = usb::Status::gone};
    if (stalled_) return {.status = usb::Status::stalled};
    return {};
  }
  usb::Status send(std::span<const std::uint8_t> bytes) {
    if (!usb_.wire.plugged()) return usb::Status::gone;
    if (out_id_ != 0) {
      outgoing_.replaced += waiting_.empty() ? 0 : 1;
      waiting_.assign(bytes.begin(), bytes.end());
      outgoing_.waits = true;
      return usb::Status::ok;
    }
    begin(bytes);
    return usb::Status::ok;
  }
  usb::Status flush(std::int64_t until_ns) {
    while (out_id_ != 0 && !gone_ && usb_.now_ns() < until_ns) usb_.wait(until_ns);
    if (gone_) return usb::Status::gone;
    return out_id_ == 0 ? usb::Status::ok : usb::Status::nothing;
  }
  usb::Status control(const sim::usb::Setup& setup, std::span<const std::uint8_t> data,
                      std::vector<std::uint8_t>* answer = nullptr) {
    const std::int64_t until_ns = usb_.now_ns() + 1'000'000;
    while (usb_.now_ns() < until_ns) usb_.wait(until_ns);
    if (!usb_.wire.plugged()) return usb::Status::gone;
    const auto given = usb_.wire.control(setup, data, usb_.now_ns());
    if (given.kind != sim::usb::Answer::Kind::ack) return usb::Status::stalled;
    if (answer != nullptr) *answer = given.bytes;
    return usb::Status::ok;
  }
  const usb::Outgoing& outgoing() const { return outgoing_; }
  const Endpoints& ends() const { return ends_; }

 private:
  static constexpr std::size_t kMost = 512;

  void submit_in() {
    pending_.push_back(++next_id_);
    usb_.wire.submit_in(next_id_, ends_.in & 0x0f, kMost, usb_.now_ns());
  }
  void begin(std::span<const std::uint8_t> bytes) {
    out_id_ = ++next_id_;
    pending_.push_back(out_id_);
    outgoing_.since_ns = usb_.now_ns();
    usb_.wire.submit_out(out_id_, ends_.out & 0x0f, bytes, usb_.now_ns());
  }
  void take(const sim::usb::Wire::Done& done) {
    std::erase(pending_, done.id);
    gone_ = gone_ || done.end == sim::usb::End::gone;
    if (done.end == sim::usb::End::stalled) stalled_ = true;
    usb_.wake();
    if (done.id == out_id_) return sent(done.at_ns);
    if (done.end != sim::usb::End::ok) return;
    arrived_.push_back(done);
    submit_in();
  }
  void sent(std::int64_t at_ns) {
    out_id_ = 0;
    outgoing_.last_took_ns = at_ns - outgoing_.since_ns;
    outgoing_.worst_took_ns = std::max(outgoing_.worst_took_ns, outgoing_.last_took_ns);
    outgoing_.since_ns = 0;
    ++outgoing_.sent;
    if (waiting_.empty() || gone_) return;
    const std::vector<std::uint8_t> bytes = std::exchange(waiting_, {});
    outgoing_.waits = false;
    begin(bytes);
  }

  VirtualUsb& usb_;
  Endpoints ends_;
  std::deque<sim::usb::Wire::Done> arrived_;
  sim::usb::Wire::Done shown_;
  std::vector<std::uint64_t> pending_;
  std::vector<std::uint8_t> waiting_;
  std::uint64_t next_id_ = 0, out_id_ = 0;
  bool gone_ = false, stalled_ = false;
  usb::Outgoing outgoing_;
};

class VirtualBulkPort final : public usb::BulkPort {
 public:
  VirtualBulkPort(VirtualUsb& usb, int reads) : port_(usb, {}, reads) {}
  usb::Arrival receive(std::int64_t until_ns) override { return port_.receive(until_ns); }
  usb::Status send(std::span<const std::uint8_t> bytes) override { return port_.send(bytes); }
  usb::Status flush(std::int64_t until_ns) override { return port_.flush(until_ns); }
  const usb::Outgoing& outgoing() const noexcept override { return port_.outgoing(); }
  usb::Status request(std::uint8_t type, std::uint8_t request, std::uint16_t value) override {
    return port_.control({.request_type = type, .request = request, .value = value}, {});
  }

 private:
  VirtualPort port_;
};

class VirtualHidPort final : public usb::HidPort {
 public:
  VirtualHidPort(VirtualUsb& usb, const Endpoints& ends, int reads)
      : port_(usb, ends, reads), descriptor_(usb.wire.device().report_descriptor(ends.interface)) {}
  usb::Arrival receive(std::int64_t until_ns) override { return port_.receive(until_ns); }
  usb::Status send(std::span<const std::uint8_t> bytes) override { return port_.send(bytes); }
  usb::Status flush(std::int64_t until_ns) override { return port_.flush(until_ns); }
  const usb::Outgoing& outgoing() const noexcept override { return port_.outgoing(); }
  usb::Status set_feature(std::span<const std::uint8_t> report) override {
    return port_.control(feature(0x21, 9, report[0], report.size()), report);
  }
  std::size_t get_feature(std::span<std::uint8_t> report) override {
    std::vector<std::uint8_t> answer;
    if (port_.control(feature(0xa1, 1, report[0], report.size()), {}, &answer) != usb::Status::ok)
      return 0;
    const std::size_t size = std::min(answer.size(), report.size());
    std::copy_n(answer.begin(), size, report.begin());
    return size;
  }
  const std::vector<std::uint8_t>& report_descriptor() const noexcept override {
    return descriptor_;
  }

 private:
  sim::usb::Setup feature(std::uint8_t type, std::uint8_t request, std::uint8_t id,
                          std::size_t size) const {
    return {.request_type = type,
            .request = request,
            .value = static_cast<std::uint16_t>(0x300 | id),
            .index = static_cast<std::uint16_t>(port_.ends().interface),
            .length = static_cast<std::uint16_t>(size)};
  }

  VirtualPort port_;
  std::vector<std::uint8_t> descriptor_;
};

class VirtualHost final : public usb::Host {
 public:
  explicit VirtualHost(VirtualUsb& usb) : usb_(usb) {}
  std::int64_t now_ns() noexcept override { return usb_.now_ns(); }
  void wait(std::int64_t until_ns) override { usb_.wait(until_ns); }
  void wake() noexcept override { usb_.wake(); }
  usb::Opened<usb::Found<usb::BulkPort>> open_bulk(const usb::Selection& selection, std::uint8_t,
                                                   std::uint8_t) override {
    if (!usb_.wire.plugged()) return absent();
    return found<usb::BulkPort>(std::make_unique<VirtualBulkPort>(usb_, selection.reads));
  }
  usb::Opened<usb::Found<usb::HidPort>> open_hid(const usb::Selection& selection) override {
    if (!usb_.wire.plugged()) return absent();
    return found<usb::HidPort>(
        std::make_unique<VirtualHidPort>(usb_, ends_of(selection), selection.reads));
  }

 private:
  static tl::unexpected<usb::NotOpened> absent() {
    return tl::unexpected(usb::NotOpened{true, {"not plugged in", ExitCode::unavailable}});
  }
  template <class P>
  usb::Found<P> found(std::unique_ptr<P> port) {
    const sim::usb::Names names = usb_.wire.device().names();
    return {
        .port = std::move(port), .product = names.product, .serial = names.serial, .path = "1-1"};
  }
  /// Of the interface that is asked for; else of the first with endpoints both ways.
  Endpoints ends_of(const usb::Selection& selection) {
    Endpoints ends{.in = 0, .out = 0};
    int interface = -1;
    const auto bytes = usb_.wire.device().configuration_descriptor();
    for (std::size_t at = 0; at + 2 < bytes.size() && bytes[at] > 1; at += bytes[at]) {
      if (bytes[at + 1] == 4) interface = bytes[at + 2];
      const bool wanted = bytes[at + 1] == 5 &&
                          !usb_.wire.device().report_descriptor(interface).empty() &&
                          (!selection.interface || *selection.interface == interface);
      if (!wanted || (ends.in != 0 && ends.interface != interface)) continue;
      ends.interface = interface;
      ((bytes[at + 2] & 0x80) != 0 ? ends.in : ends.out) = bytes[at + 2];
    }
    return ends;
  }

  VirtualUsb& usb_;
};

class VirtualRunner final : public usb::Runner {
 public:
  explicit VirtualRunner(VirtualUsb& usb) : usb_(usb) {}
  void start(std::function<void()> body) override { usb_.start(std::move(body)); }
  void join() override { usb_.join(); }
  void pause(std::int64_t duration_ns) override { usb_.pass_until(usb_.now_ns() + duration_ns); }

 private:
  VirtualUsb& usb_;
};

}  // namespace hapticd::test
