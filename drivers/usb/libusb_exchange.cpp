#include "drivers/usb/libusb_exchange.h"

#include <algorithm>
#include <utility>

namespace hapticd::usb {
namespace {

constexpr std::int64_t kDrain_ns = 1'000'000'000;

}  // namespace

LibusbExchange::LibusbExchange(std::unique_ptr<LibusbSession> session,
                               const ExchangeOptions& options)
    : session_(std::move(session)),
      queue_(options.in_bytes, options.superseding),
      reads_(*session_, options.in, options.in_bytes, options.reads, queue_),
      writes_(*session_, options.out, options.out_bytes) {
  reads_.begin();
}

LibusbExchange::~LibusbExchange() {
  reads_.cancel();
  writes_.cancel();
  const std::int64_t until_ns = monotonic_ns() + kDrain_ns;
  session_->pump();
  while (!(reads_.idle() && writes_.idle()) && monotonic_ns() < until_ns) {
    session_->wait(until_ns, false);
    session_->pump();
  }
  // Before the transfers are freed: so libusb lets go even of those that did not end. They need the session's context.
  session_->close();
}

void LibusbExchange::pump() noexcept {
  const std::int64_t before_ns = monotonic_ns();
  session_->pump();
  reads_.looked(before_ns);
}

Arrival LibusbExchange::receive(std::int64_t until_ns) noexcept {
  for (;;) {
    pump();
    if (const Arrival arrival = queue_.take(); arrival.status == Status::ok) return arrival;
    if (const Status failure = reads_.failure(); failure == Status::gone || reads_.idle()) {
      reads_.begin();
      if (failure != Status::ok) return {.status = failure};
    }
    if (session_->waker().take() || monotonic_ns() >= until_ns) return {};
    session_->wait(std::min(until_ns, monotonic_ns() + LastLook::kEvery_ns), true);
  }
}

Status LibusbExchange::send(std::span<const std::uint8_t> bytes) noexcept {
  pump();
  return writes_.send(bytes);
}

Status LibusbExchange::flush(std::int64_t until_ns) noexcept {
  for (;;) {
    pump();
    if (writes_.idle()) return writes_.take_failure();
    if (monotonic_ns() >= until_ns) return Status::nothing;
    session_->wait(until_ns, false);
  }
}

}  // namespace hapticd::usb
