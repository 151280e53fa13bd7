#include "drivers/usb/protocol.h"

#include "drivers/hid/hid_report.h"
#include "drivers/hid/openffboard.h"
#include "drivers/usb/falcon.h"

namespace hapticd::usb {

std::unique_ptr<Protocol> make_protocol(const DeviceOptions& options) {
  switch (options.kind) {
    case Kind::falcon:
      return std::make_unique<Falcon>(options);
    case Kind::hid_report:
      return std::make_unique<hid::HidReport>(options);
    case Kind::openffboard:
      return hid::make_openffboard(options);
  }
  return nullptr;
}

}  // namespace hapticd::usb
