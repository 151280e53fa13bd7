#include "drivers/usb/this_host.h"

#include "drivers/hid/hidapi_port.h"
#include "drivers/usb/libusb_port.h"
#include "drivers/usb/waker_host.h"

namespace hapticd::usb {
namespace {

class ThisHost final : public WakerHost {
 public:
  explicit ThisHost(const Roots& roots) : roots_(roots) {}

  Opened<Found<BulkPort>> open_bulk(const Selection& selection, std::uint8_t bulk_in,
                                    std::uint8_t bulk_out) override {
    return open_libusb_bulk(selection, bulk_in, bulk_out, roots_, waker_);
  }
  Opened<Found<HidPort>> open_hid(const Selection& selection) override {
    if (selection.transport == Transport::libusb) return open_libusb_hid(selection, roots_, waker_);
    return hid::open_hidapi(selection, roots_, waker_);
  }

 private:
  const Roots roots_;
};

}  // namespace

std::unique_ptr<Host> host_at(const Roots& roots) {
  return std::make_unique<ThisHost>(roots);
}

std::unique_ptr<Host> this_host() {
  return host_at({});
}

}  // namespace hapticd::usb
