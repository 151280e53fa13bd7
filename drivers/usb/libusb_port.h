// Ports on libusb. What goes out and comes in is always under way in the kernel, so that no frame is missed between two
// calls. A transfer that failed is told by the next receive, send or flush; the call after it begins anew.
#pragma once
#include <memory>

#include "drivers/usb/host.h"
#include "drivers/usb/waker.h"

namespace hapticd::usb {

struct Roots;

/// `waker`: of the thread that uses the port; outlives it.
Opened<Found<BulkPort>> open_libusb_bulk(const Selection& selection, std::uint8_t bulk_in,
                                         std::uint8_t bulk_out, const Roots& roots, Waker& waker);
Opened<Found<HidPort>> open_libusb_hid(const Selection& selection, const Roots& roots,
                                       Waker& waker);

}  // namespace hapticd::usb
