#include "sim/usb/usbip_server.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace hapticd::sim::usb {

UsbipServer::UsbipServer(Wire& wire, int fd, std::uint32_t device)
    : wire_(wire), fd_(fd), device_(device) {}

UsbipServer::~UsbipServer() {
  end("closed");
}

void UsbipServer::end(std::string_view why) {
  if (fd_ < 0) return;
  over_ = why;
  for (const auto& [id, pending] : pending_) (void)wire_.cancel(id);
  pending_.clear();
  out_.clear();
  ::close(fd_);
  fd_ = -1;
}

bool UsbipServer::advance(std::int64_t now_ns) {
  if (fd_ < 0) return false;
  run(now_ns);
  hear(now_ns);
  if (fd_ >= 0) run(now_ns);
  if (fd_ >= 0) send_out();
  // All that waited was told that the device is gone.
  if (fd_ >= 0 && !wire_.plugged() && out_.empty()) end("unplugged");
  return fd_ >= 0;
}

std::int64_t UsbipServer::next_ns() const {
  return fd_ < 0 ? kNever : std::min(wire_.next_ns(), controls_.next_ns());
}

// -- from the host

void UsbipServer::hear(std::int64_t now_ns) {
  std::array<std::uint8_t, 16384> bytes{};
  while (fd_ >= 0) {
    const ssize_t size = ::recv(fd_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (size <= 0) return end("the host has let go of it");
    heard_.insert(heard_.end(), bytes.begin(), bytes.begin() + size);
    take_requests(now_ns);
  }
}

void UsbipServer::take_requests(std::int64_t now_ns) {
  std::span<const std::uint8_t> rest(heard_);
  while (fd_ >= 0 && rest.size() >= usbip::kHeaderBytes) {
    const auto request = usbip::decode_request(rest.first<usbip::kHeaderBytes>());
    if (!request) return end("the host sent what is no request");
    if (request->device != device_) return end("the host means another device");
    const std::size_t payload_bytes = request->payload_bytes();
    if (rest.size() < usbip::kHeaderBytes + payload_bytes) break;
    take(*request, rest.subspan(usbip::kHeaderBytes, payload_bytes), now_ns);
    rest = rest.subspan(usbip::kHeaderBytes + payload_bytes);
  }
  heard_.erase(heard_.begin(), heard_.end() - static_cast<std::ptrdiff_t>(rest.size()));
}

void UsbipServer::take(const usbip::Request& request, std::span<const std::uint8_t> payload,
                       std::int64_t now_ns) {
  if (request.command == usbip::Command::unlink)
    unlink(request);
  else
    submit(request, payload, now_ns);
}

void UsbipServer::submit(const usbip::Request& request, std::span<const std::uint8_t> payload,
                         std::int64_t now_ns) {
  if (pending_.size() >= kMostPending) return end("the host has too many transfers");
  const bool fresh =
      pending_.emplace(request.number, Pending{request.endpoint, request.in, request.length})
          .second;
  if (!fresh) return end("the host used a number twice");
  if (request.endpoint == 0)
    controls_.add(request.number, request.setup, payload);
  else if (request.in)
    wire_.submit_in(request.number, request.endpoint, request.length, now_ns);
  else
    wire_.submit_out(request.number, request.endpoint, payload, now_ns);
}

/// After the answer the host has forgotten the transfer: one that it gets all the same makes it drop the device.
void UsbipServer::unlink(const usbip::Request& request) {
  const auto found = pending_.find(request.unlinked);
  usbip::Reply reply{.command = usbip::Command::unlinked, .number = request.number};
  if (found != pending_.end()) {
    if (found->second.endpoint == 0)
      controls_.cancel(request.unlinked);
    else
      (void)wire_.cancel(request.unlinked);
    pending_.erase(found);
    reply.status = static_cast<std::int32_t>(End::unlinked);
  }
  say(reply);
}

// -- to the host

void UsbipServer::run(std::int64_t now_ns) {
  for (const Wire::Done& done : wire_.advance(now_ns)) finish(done);
  for (const Wire::Done& done : controls_.advance(wire_, now_ns)) finish(done);
}

void UsbipServer::finish(const Wire::Done& done) {
  const auto found = pending_.find(done.id);
  if (found == pending_.end()) return;
  const Pending asked = found->second;
  pending_.erase(found);
  usbip::Reply reply{.number = static_cast<std::uint32_t>(done.id),
                     .status = static_cast<std::int32_t>(done.end)};
  if (!asked.in) {
    reply.length = done.end == End::ok ? asked.length : 0;
    return say(reply);
  }
  const auto bytes =
      std::span(done.bytes).first(std::min<std::size_t>(done.bytes.size(), asked.length));
  reply.length = static_cast<std::uint32_t>(bytes.size());
  say(reply, bytes);
}

void UsbipServer::say(const usbip::Reply& reply, std::span<const std::uint8_t> payload) {
  const usbip::Header header = usbip::encode(reply);
  out_.insert(out_.end(), header.begin(), header.end());
  out_.insert(out_.end(), payload.begin(), payload.end());
}

void UsbipServer::send_out() {
  std::size_t sent = 0;
  while (sent < out_.size()) {
    const ssize_t size =
        ::send(fd_, out_.data() + sent, out_.size() - sent, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
    if (size <= 0) return end("the host has let go of it");
    sent += static_cast<std::size_t>(size);
  }
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(sent));
}

}  // namespace hapticd::sim::usb
