// One interface of one USB device, claimed, in a libusb context of its own: what completes is told to one thread, in order.
// libusb allocates and locks: this is for the device's thread, never for the servo thread.
//
// The node is opened here and handed to libusb, which so neither looks for devices nor listens for them.
#pragma once
#include <libusb-1.0/libusb.h>

#include <memory>
#include <vector>

#include "drivers/usb/choose.h"
#include "drivers/usb/waker.h"

namespace hapticd::usb {

/// Of a call; 0 and above: ok.
Status status_of_call(int result) noexcept;
Status status_of_transfer(libusb_transfer_status status) noexcept;

class LibusbSession {
 public:
  /// Takes the interface from the kernel's driver until close().
  static Opened<std::unique_ptr<LibusbSession>> open(const ChosenInterface& chosen, Waker& waker);
  LibusbSession(const LibusbSession&) = delete;
  LibusbSession& operator=(const LibusbSession&) = delete;
  ~LibusbSession();  ///< after all transfers are freed

  libusb_device_handle* handle() const noexcept { return handle_; }
  int interface_number() const noexcept { return interface_; }
  Waker& waker() const noexcept { return waker_; }

  /// Calls back for what has completed. Does not wait.
  void pump() noexcept;
  /// Until something may have completed, at most until then; or until woken, if it `may_be_woken`.
  void wait(std::int64_t until_ns, bool may_be_woken) noexcept;
  /// Gives the interface back to the kernel's driver, if the device still answers. Transfers still on their way are never called back after it.
  void close() noexcept;

  /// Control transfers, which wait 1 s at most.
  Status control_out(std::uint8_t type, std::uint8_t request, std::uint16_t value,
                     std::uint16_t index, std::span<const std::uint8_t> data) noexcept;
  /// How many bytes came, or libusb's error.
  int control_in(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
                 std::span<std::uint8_t> data) noexcept;

 private:
  explicit LibusbSession(Waker& waker) : waker_(waker) {}
  int wrap(int node) noexcept;
  bool is_still(const About& about) const noexcept;
  void read_descriptors();
  bool answers() noexcept;

  Waker& waker_;
  int node_ = -1, interface_ = -1;  ///< -1: not claimed
  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  std::vector<pollfd> waited_for_{};  ///< libusb's, then the waker's
};

}  // namespace hapticd::usb
