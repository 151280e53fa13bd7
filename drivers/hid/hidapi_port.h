// A HID device through hidapi on Linux' hidraw, which leaves the kernel's driver where it is.
//
// A write goes to the device before it returns: a frame of a healthy one, 5 s of one that hangs. So send() waits, nothing is
// ever on its way after it, and `last_took_ns` is how long it took. Reports are read at once whenever the thread comes by,
// because the kernel keeps 64 and drops the newest; of those only the newest of each id are handed out (ArrivalQueue).
#pragma once
#include "drivers/usb/host.h"
#include "drivers/usb/waker.h"

namespace hapticd::usb {
struct Roots;
}

namespace hapticd::hid {

/// `waker`: of the thread that uses the port; outlives it.
usb::Opened<usb::Found<usb::HidPort>> open_hidapi(const usb::Selection& selection,
                                                  const usb::Roots& roots, usb::Waker& waker);

/// The descriptor by which this process has opened a character device; -1: by none, or by several.
int descriptor_of(const std::string& node);

}  // namespace hapticd::hid
