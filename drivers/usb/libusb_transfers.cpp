#include "drivers/usb/libusb_transfers.h"

#include <algorithm>
#include <new>

namespace hapticd::usb {
namespace {

constexpr unsigned kSetReport_ms = 1000;
constexpr std::uint8_t kToInterface = 0x21;  // class request, to the device
constexpr std::uint8_t kSetReport = 0x09;
constexpr std::uint16_t kOutputReport = 0x0200;

TransferPointer new_transfer() {
  TransferPointer transfer(libusb_alloc_transfer(0));
  if (transfer == nullptr) throw std::bad_alloc();
  return transfer;
}

}  // namespace

Status worse(Status one, Status other) noexcept {
  for (const Status status : {Status::gone, Status::stalled, Status::failed})
    if (one == status || other == status) return status;
  return Status::ok;
}

Reads::Reads(LibusbSession& session, const Endpoint& endpoint, std::size_t transfer_bytes,
             int count, ArrivalQueue& queue)
    : session_(session),
      endpoint_(endpoint),
      queue_(queue),
      reads_(static_cast<std::size_t>(std::clamp(count, 2, 8))) {
  for (Read& read : reads_) {
    read.owner = this;
    read.transfer = new_transfer();
    read.bytes.resize(transfer_bytes);
  }
}

void Reads::begin() noexcept {
  if (failure_ == Status::gone || !idle()) return;
  if (failure_ == Status::stalled)
    failure_ = status_of_call(libusb_clear_halt(session_.handle(), endpoint_.address));
  else
    failure_ = Status::ok;
  for (Read& read : reads_)
    if (failure_ == Status::ok) submit(read);
}

void Reads::submit(Read& read) noexcept {
  const auto done = [](libusb_transfer* transfer) {
    auto& one = *static_cast<Read*>(transfer->user_data);
    one.owner->completed(one);
  };
  auto* const transfer = read.transfer.get();
  const auto size = static_cast<int>(read.bytes.size());
  libusb_fill_bulk_transfer(transfer, session_.handle(), endpoint_.address, read.bytes.data(), size,
                            done, &read, 0);
  if (endpoint_.type == EndpointType::interrupt) transfer->type = LIBUSB_TRANSFER_TYPE_INTERRUPT;
  const Status status = status_of_call(libusb_submit_transfer(transfer));
  if (status != Status::ok) {
    failure_ = worse(failure_, status);
    return;
  }
  read.under_way = true;
  ++under_way_;
}

void Reads::completed(Read& read) noexcept {
  read.under_way = false;
  --under_way_;
  const auto size = static_cast<std::size_t>(std::max(0, read.transfer->actual_length));
  const Status status = status_of_transfer(read.transfer->status);
  if (status == Status::ok)
    queue_.push(std::span(read.bytes).first(size), last_look_.stamp(monotonic_ns()));
  if (ending_) return;
  const bool first_failure = failure_ == Status::ok && status != Status::ok;
  failure_ = worse(failure_, status);
  // After a failure the others are ended, and begin() begins anew: not at once, or a device that is being pulled out would
  // keep this thread busy.
  if (first_failure) cancel_all();
  if (failure_ == Status::ok) submit(read);
}

void Reads::cancel_all() noexcept {
  for (Read& read : reads_)
    if (read.under_way) (void)libusb_cancel_transfer(read.transfer.get());
}

void Reads::cancel() noexcept {
  ending_ = true;
  cancel_all();
}

void Writes::Message::set(std::span<const std::uint8_t> from) noexcept {
  size = from.size();
  std::ranges::copy(from, bytes.begin());
}

Writes::Writes(LibusbSession& session, const WriteTo& to, std::size_t most_bytes)
    : session_(session),
      to_(to),
      transfer_(new_transfer()),
      sent_(most_bytes + LIBUSB_CONTROL_SETUP_SIZE) {
  waiting_.bytes.resize(most_bytes);
}

Status Writes::take_failure() noexcept {
  const Status status = failure_;
  if (status != Status::gone) failure_ = Status::ok;
  return status;
}

Status Writes::send(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.empty() || bytes.size() > waiting_.bytes.size()) return Status::failed;
  if (failure_ == Status::gone) return Status::gone;
  if (under_way_) {
    if (waiting_.size != 0) ++outgoing_.replaced;
    waiting_.set(bytes);
    outgoing_.waits = true;
    return Status::ok;
  }
  const Status before = take_failure();
  if (before == Status::stalled && to_.endpoint.address != 0)
    (void)libusb_clear_halt(session_.handle(), to_.endpoint.address);
  return worse(before, begin(bytes));
}

Status Writes::begin(std::span<const std::uint8_t> bytes) noexcept {
  const auto done = [](libusb_transfer* transfer) {
    static_cast<Writes*>(transfer->user_data)->completed();
  };
  const bool control = to_.endpoint.address == 0;
  length_ = static_cast<int>(bytes.size());
  const std::size_t before = control ? LIBUSB_CONTROL_SETUP_SIZE : 0;
  std::ranges::copy(bytes, sent_.begin() + static_cast<std::ptrdiff_t>(before));
  if (control) {
    const auto id = static_cast<std::uint16_t>(to_.numbered ? bytes.front() : 0);
    libusb_fill_control_setup(sent_.data(), kToInterface, kSetReport,
                              static_cast<std::uint16_t>(kOutputReport | id),
                              static_cast<std::uint16_t>(session_.interface_number()),
                              static_cast<std::uint16_t>(bytes.size()));
    libusb_fill_control_transfer(transfer_.get(), session_.handle(), sent_.data(), done, this,
                                 kSetReport_ms);
  } else {
    libusb_fill_bulk_transfer(transfer_.get(), session_.handle(), to_.endpoint.address,
                              sent_.data(), length_, done, this, 0);
    if (to_.endpoint.type == EndpointType::interrupt)
      transfer_->type = LIBUSB_TRANSFER_TYPE_INTERRUPT;
  }
  const Status status = status_of_call(libusb_submit_transfer(transfer_.get()));
  under_way_ = status == Status::ok;
  outgoing_.since_ns = under_way_ ? monotonic_ns() : 0;
  if (status == Status::gone) failure_ = status;
  return status;
}

void Writes::completed() noexcept {
  under_way_ = false;
  Status status = status_of_transfer(transfer_->status);
  // A device that is pulled out may end a transfer as if all were well, with nothing sent.
  if (status == Status::ok && transfer_->actual_length < length_) status = Status::failed;
  count();
  if (status == Status::ok)
    ++outgoing_.sent;
  else if (!ending_)
    failure_ = worse(failure_, status);
  if (waiting_.size == 0 || ending_) return;
  const std::size_t size = waiting_.size;
  waiting_.size = 0;
  outgoing_.waits = false;
  // What waits behind a failure is not sent: whoever is told of it knows better.
  if (failure_ == Status::ok) failure_ = begin(std::span(waiting_.bytes).first(size));
}

void Writes::count() noexcept {
  outgoing_.last_took_ns = monotonic_ns() - outgoing_.since_ns;
  outgoing_.worst_took_ns = std::max(outgoing_.worst_took_ns, outgoing_.last_took_ns);
  outgoing_.since_ns = 0;
}

void Writes::cancel() noexcept {
  ending_ = true;
  if (under_way_) (void)libusb_cancel_transfer(transfer_.get());
}

}  // namespace hapticd::usb
