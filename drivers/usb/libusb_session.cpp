#include "drivers/usb/libusb_session.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <mutex>
#include <utility>

#include "drivers/usb/node_access.h"

namespace hapticd::usb {
namespace {

constexpr unsigned kControl_ms = 1000;

/// For all contexts to come: no search at the start, no thread that listens.
void switch_discovery_off() {
  static std::once_flag once;
  std::call_once(once, [] { (void)libusb_set_option(nullptr, LIBUSB_OPTION_NO_DEVICE_DISCOVERY); });
}

NotOpened gone_meanwhile(const About& about) {
  return {.absent = true,
          .error = {words(about) + " was unplugged while it was opened", ExitCode::unavailable}};
}

tl::unexpected<NotOpened> no_node(const ChosenInterface& chosen, int error) {
  const std::string& node = chosen.device.node;
  if (error == ENODEV || error == ENXIO) return tl::unexpected(gone_meanwhile(chosen.device.about));
  return tl::unexpected(not_opened(words(chosen.device.about), node, open_problem(node, error)));
}

tl::unexpected<NotOpened> not_claimed(const ChosenInterface& chosen, int error) {
  const std::string what =
      words(chosen.device.about) + ", interface " + std::to_string(chosen.interface.number);
  if (error == LIBUSB_ERROR_NO_DEVICE) return tl::unexpected(gone_meanwhile(chosen.device.about));
  if (error != LIBUSB_ERROR_BUSY)
    return refused(ExitCode::unavailable, what + " cannot be claimed: " + libusb_strerror(error));
  const bool program = chosen.interface.driver.empty() || chosen.interface.driver == "usbfs";
  return refused(ExitCode::unavailable,
                 what + " is in use by " +
                     (program ? "another program: end it (`fuser -v " + chosen.device.node + "`)"
                              : "the kernel's driver " + chosen.interface.driver));
}

}  // namespace

Status status_of_call(int result) noexcept {
  if (result >= 0) return Status::ok;
  switch (result) {
    case LIBUSB_ERROR_NO_DEVICE:
      return Status::gone;
    case LIBUSB_ERROR_PIPE:
      return Status::stalled;
    default:
      return Status::failed;
  }
}

Status status_of_transfer(libusb_transfer_status status) noexcept {
  switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return Status::ok;
    case LIBUSB_TRANSFER_NO_DEVICE:
      return Status::gone;
    case LIBUSB_TRANSFER_STALL:
      return Status::stalled;
    default:
      return Status::failed;
  }
}

Opened<std::unique_ptr<LibusbSession>> LibusbSession::open(const ChosenInterface& chosen,
                                                           Waker& waker) {
  const int node = ::open(chosen.device.node.c_str(), O_RDWR | O_CLOEXEC);
  if (node < 0) return no_node(chosen, errno);
  std::unique_ptr<LibusbSession> session(new LibusbSession(waker));
  if (const int error = session->wrap(node); error != 0)
    return refused(ExitCode::unavailable, words(chosen.device.about) + ": libusb cannot use " +
                                              chosen.device.node + ": " + libusb_strerror(error));
  if (!session->is_still(chosen.device.about))
    return tl::unexpected(gone_meanwhile(chosen.device.about));
  // Not every kernel can detach; then the claim fails if a driver has the interface.
  (void)libusb_set_auto_detach_kernel_driver(session->handle_, 1);
  const int claimed = libusb_claim_interface(session->handle_, chosen.interface.number);
  if (claimed != 0) return not_claimed(chosen, claimed);
  session->interface_ = chosen.interface.number;
  session->read_descriptors();
  return session;
}

int LibusbSession::wrap(int node) noexcept {
  node_ = node;
  switch_discovery_off();
  if (const int error = libusb_init(&context_); error != 0) return error;
  return libusb_wrap_sys_device(context_, node, &handle_);
}

/// Another may have been plugged in since sysfs was read, and have got the node's name.
bool LibusbSession::is_still(const About& about) const noexcept {
  libusb_device_descriptor found{};
  return libusb_get_device_descriptor(libusb_get_device(handle_), &found) == 0 &&
         found.idVendor == about.vendor && found.idProduct == about.product;
}

void LibusbSession::read_descriptors() {
  const libusb_pollfd** const list = libusb_get_pollfds(context_);
  for (std::size_t i = 0; list != nullptr && list[i] != nullptr; ++i)
    waited_for_.push_back({.fd = list[i]->fd, .events = list[i]->events, .revents = 0});
  libusb_free_pollfds(list);
  waited_for_.push_back(waker_.descriptor());
}

LibusbSession::~LibusbSession() {
  close();
  if (context_ != nullptr) libusb_exit(context_);
}

void LibusbSession::pump() noexcept {
  timeval none{};
  (void)libusb_handle_events_timeout_completed(context_, &none, nullptr);
}

void LibusbSession::wait(std::int64_t until_ns, bool may_be_woken) noexcept {
  wait_for(std::span(waited_for_).first(waited_for_.size() - (may_be_woken ? 0 : 1)), until_ns);
}

/// A stall is an answer, too.
bool LibusbSession::answers() noexcept {
  constexpr unsigned kAnswer_ms = 100;
  constexpr std::uint8_t kFromDevice = 0x80;
  std::array<std::uint8_t, 2> status{};
  const int result =
      libusb_control_transfer(handle_, kFromDevice, LIBUSB_REQUEST_GET_STATUS, 0, 0, status.data(),
                              static_cast<std::uint16_t>(status.size()), kAnswer_ms);
  return result >= 0 || result == LIBUSB_ERROR_PIPE;
}

void LibusbSession::close() noexcept {
  if (handle_ != nullptr) {
    // The kernel's driver would ask the device what it is, 5 s for each question: not one that is gone, or that hangs.
    if (interface_ >= 0 && !answers()) (void)libusb_set_auto_detach_kernel_driver(handle_, 0);
    if (interface_ >= 0) (void)libusb_release_interface(handle_, interface_);
    libusb_close(handle_);
  }
  if (node_ >= 0) ::close(node_);
  handle_ = nullptr;
  node_ = interface_ = -1;
}

Status LibusbSession::control_out(std::uint8_t type, std::uint8_t request, std::uint16_t value,
                                  std::uint16_t index,
                                  std::span<const std::uint8_t> data) noexcept {
  // libusb's one signature for both directions: of a request to the device it only reads.
  auto* const bytes = const_cast<std::uint8_t*>(data.data());
  const auto size = static_cast<std::uint16_t>(data.size());
  const int result =
      libusb_control_transfer(handle_, type, request, value, index, bytes, size, kControl_ms);
  if (result >= 0 && result != size) return Status::failed;
  return status_of_call(result);
}

int LibusbSession::control_in(std::uint8_t type, std::uint8_t request, std::uint16_t value,
                              std::uint16_t index, std::span<std::uint8_t> data) noexcept {
  return libusb_control_transfer(handle_, type, request, value, index, data.data(),
                                 static_cast<std::uint16_t>(data.size()), kControl_ms);
}

}  // namespace hapticd::usb
