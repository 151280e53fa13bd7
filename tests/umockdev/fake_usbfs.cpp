#include "tests/umockdev/fake_usbfs.h"

#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace hapticd::test {
namespace {

std::uint16_t word_at(const std::uint8_t* bytes) {
  return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8);
}

std::string hex(unsigned number) {
  char text[16];
  std::snprintf(text, sizeof text, "%x", number);
  return text;
}

}  // namespace

FakeUsbfs::FakeUsbfs() : testbed_(umockdev_testbed_new()), handler_(umockdev_ioctl_base_new()) {
  g_signal_connect(handler_.get(), "handle-ioctl", G_CALLBACK(&FakeUsbfs::called), this);
}

FakeUsbfs::~FakeUsbfs() {
  umockdev_testbed_detach_ioctl(testbed_.get(), kNode, nullptr);
}

std::string FakeUsbfs::root() const {
  char* const path = umockdev_testbed_get_root_dir(testbed_.get());
  std::string text(path);
  g_free(path);
  return text;
}

void FakeUsbfs::plug(const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    GError* error = nullptr;
    if (umockdev_testbed_add_from_string(testbed_.get(), text.c_str(), &error)) continue;
    std::fprintf(stderr, "umockdev: %s\n%s\n", error->message, text.c_str());
    std::abort();
  }
  umockdev_testbed_attach_ioctl(testbed_.get(), kNode, handler_.get(), nullptr);
}

// -- what the device does

void FakeUsbfs::finish(usbdevfs_urb* urb, int status) {
  urb->status = status;
  done_.push_back(urb);
}

/// One packet to the oldest IN transfer, which ends when it is full or the packet is short.
void FakeUsbfs::deliver(const Bytes& packet, int status) {
  usbdevfs_urb* const urb = in_.front();
  const auto room = static_cast<std::size_t>(urb->buffer_length - urb->actual_length);
  const std::size_t size = std::min(packet.size(), room);
  if (size != 0)
    std::memcpy(static_cast<std::uint8_t*>(urb->buffer) + urb->actual_length, packet.data(), size);
  urb->actual_length += static_cast<int>(size);
  if (status == 0 && packet.size() == kPacketBytes && size < room) return;
  in_.pop_front();
  finish(urb, status);
}

void FakeUsbfs::say(const Bytes& packet, int status) {
  const std::lock_guard lock(mutex_);
  if (in_.empty()) return said_.emplace_back(packet, status), void();
  deliver(packet, status);
}

void FakeUsbfs::hold_out(bool hold) {
  const std::lock_guard lock(mutex_);
  hold_out_ = hold;
}

void FakeUsbfs::end_out(int status) {
  const std::lock_guard lock(mutex_);
  usbdevfs_urb* const urb = out_.front();
  urb->actual_length = status == 0 ? urb->buffer_length : 0;
  finish(urb, status);
  out_.pop_front();
}

void FakeUsbfs::unplug(int status) {
  const std::lock_guard lock(mutex_);
  unplugged_ = true;
  for (auto* const list : {&in_, &out_}) {
    for (usbdevfs_urb* urb : *list) finish(urb, status);
    list->clear();
  }
}

// -- what came of it

std::size_t FakeUsbfs::reads_under_way() {
  const std::lock_guard lock(mutex_);
  return in_.size();
}
std::vector<Bytes> FakeUsbfs::sent() {
  const std::lock_guard lock(mutex_);
  return sent_;
}
std::vector<ControlRequest> FakeUsbfs::requests() {
  const std::lock_guard lock(mutex_);
  return requests_;
}
std::vector<std::string> FakeUsbfs::log() {
  const std::lock_guard lock(mutex_);
  return log_;
}

void FakeUsbfs::forget() {
  const std::lock_guard lock(mutex_);
  log_.clear();
  sent_.clear();
  requests_.clear();
}

// -- the kernel

gboolean FakeUsbfs::called(UMockdevIoctlBase*, UMockdevIoctlClient* client, FakeUsbfs* self) {
  // The program under test is this process: its pointers are good here.
  const UMockdevIoctlData* const data = umockdev_ioctl_client_get_arg(client);
  void* argument = nullptr;
  std::memcpy(&argument, data->data, sizeof(argument));
  int error = 0;
  const long result = self->handle(umockdev_ioctl_client_get_request(client), argument, error);
  umockdev_ioctl_client_complete(client, result, error);
  return TRUE;
}

long FakeUsbfs::handle(unsigned long request, void* argument, int& error) {
  const std::lock_guard lock(mutex_);
  const auto fails = [&error](int code) {
    error = code;
    return -1L;
  };
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) =
          USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
          USBDEVFS_CAP_REAP_AFTER_DISCONNECT | USBDEVFS_CAP_ZERO_PACKET;
      return 0;
    case USBDEVFS_CONNECTINFO:
      *static_cast<usbdevfs_connectinfo*>(argument) = {.devnum = 2, .slow = 0};
      return 0;
    case USBDEVFS_DISCONNECT_CLAIM:
      if (unplugged_) return fails(ENODEV);
      if (claimed_) return fails(EBUSY);
      log_.push_back("claim " + hex(static_cast<usbdevfs_disconnect_claim*>(argument)->interface));
      return 0;
    case USBDEVFS_RELEASEINTERFACE:
      if (unplugged_) return fails(ENODEV);
      log_.push_back("release " + hex(*static_cast<unsigned*>(argument)));
      return 0;
    case USBDEVFS_IOCTL: {
      const auto& inner = *static_cast<usbdevfs_ioctl*>(argument);
      if (inner.ioctl_code != static_cast<int>(USBDEVFS_CONNECT)) return fails(ENODATA);
      log_.push_back("attach " + std::to_string(inner.ifno));
      return 1;
    }
    case USBDEVFS_CLEAR_HALT:
      log_.push_back("clear halt " + hex(*static_cast<unsigned*>(argument)));
      return 0;
    case USBDEVFS_CONTROL:
      return run_control(static_cast<usbdevfs_ctrltransfer*>(argument), error);
    case USBDEVFS_SUBMITURB:
      return submit(static_cast<usbdevfs_urb*>(argument), error);
    case USBDEVFS_DISCARDURB:
      return cancel(static_cast<usbdevfs_urb*>(argument), error);
    case USBDEVFS_REAPURBNDELAY:
      return reap(static_cast<void**>(argument), error);
    default:
      return fails(ENOTTY);
  }
}

long FakeUsbfs::submit(usbdevfs_urb* urb, int& error) {
  if (unplugged_) {
    error = ENODEV;
    return -1;
  }
  const auto* const bytes = static_cast<std::uint8_t*>(urb->buffer);
  if (urb->type == USBDEVFS_URB_TYPE_CONTROL) {
    submit_control(urb);
  } else if ((urb->endpoint & 0x80) != 0) {
    urb->actual_length = 0;
    in_.push_back(urb);
    while (!said_.empty() && !in_.empty()) {
      deliver(said_.front().first, said_.front().second);
      said_.pop_front();
    }
  } else {
    sent_.emplace_back(bytes, bytes + urb->buffer_length);
    urb->status = 0;
    urb->actual_length = hold_out_ ? 0 : urb->buffer_length;
    (hold_out_ ? out_ : done_).push_back(urb);
  }
  return 0;
}

std::optional<Bytes> FakeUsbfs::answer(const ControlRequest& request) {
  requests_.push_back(request);
  return control ? control(request) : Bytes{};
}

/// The eight bytes of the set-up packet, then data.
void FakeUsbfs::submit_control(usbdevfs_urb* urb) {
  auto* const bytes = static_cast<std::uint8_t*>(urb->buffer);
  const bool in = (bytes[0] & 0x80) != 0;
  ControlRequest request{.type = bytes[0],
                         .request = bytes[1],
                         .value = word_at(bytes + 2),
                         .index = word_at(bytes + 4),
                         .data = {},
                         .wanted = word_at(bytes + 6)};
  if (!in) request.data.assign(bytes + 8, bytes + urb->buffer_length);
  if (hangs_) return out_.push_back(urb);
  const auto reply = answer(request);
  urb->status = reply ? 0 : -EPIPE;
  const std::size_t size = !reply ? 0
                           : in   ? std::min(reply->size(), request.wanted)
                                  : request.wanted;
  if (in && size != 0) std::memcpy(bytes + 8, reply->data(), size);
  urb->actual_length = static_cast<int>(size);
  done_.push_back(urb);
}

/// GET_CONFIGURATION, as libusb asks when it is handed a node.
long FakeUsbfs::run_control(usbdevfs_ctrltransfer* transfer, int& error) {
  if (transfer->bRequest != 0x08) {
    error = EPIPE;
    return -1;
  }
  *static_cast<std::uint8_t*>(transfer->data) = 1;
  return 1;
}

long FakeUsbfs::cancel(usbdevfs_urb* urb, int& error) {
  log_.emplace_back("discard");
  if (ignores_cancelling_) return 0;
  for (auto* const list : {&in_, &out_}) {
    const auto found = std::ranges::find(*list, urb);
    if (found == list->end()) continue;
    list->erase(found);
    finish(urb, -ENOENT);
    return 0;
  }
  error = EINVAL;
  return -1;
}

long FakeUsbfs::reap(void** argument, int& error) {
  if (done_.empty()) {
    error = unplugged_ ? ENODEV : EAGAIN;
    return -1;
  }
  *argument = done_.front();
  done_.pop_front();
  return 0;
}

}  // namespace hapticd::test
