// Devices as umockdev wants them described: what sysfs shows, and the descriptors that their nodes give.
#pragma once
#include <string>
#include <vector>

#include "tests/umockdev/fake_usbfs.h"

namespace hapticd::test {

inline std::string as_hex(const Bytes& bytes) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 0xf];
  }
  return text;
}

struct UsbEndpointText {
  std::string address{};  ///< "81"
  std::string type{};     ///< "02" bulk, "03" interrupt
};

inline std::string endpoint_lines(const UsbEndpointText& endpoint) {
  const std::string ep = "A: ep_" + endpoint.address + "/";
  return ep + "bEndpointAddress=" + endpoint.address + "\\n\n" + ep +
         "bmAttributes=" + endpoint.type + "\\n\n" + ep + "wMaxPacketSize=0040\\n\n" + ep +
         "bInterval=01\\n\n";
}

/// The device and its one interface.
inline std::vector<std::string> usb_texts(const std::string& vendor, const std::string& product,
                                          const std::string& interface_class,
                                          const std::vector<UsbEndpointText>& endpoints,
                                          const Bytes& descriptors) {
  std::string interface =
      "P: /devices/usb1/1-2/1-2:1.0\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\n"
      "A: bInterfaceNumber=00\\n\nA: bInterfaceClass=" +
      interface_class + "\\n\n";
  for (const UsbEndpointText& endpoint : endpoints) interface += endpoint_lines(endpoint);
  return {"P: /devices/usb1/1-2\nN: bus/usb/001/002=" + as_hex(descriptors) +
              "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DEVNAME=/dev/bus/usb/001/002\n"
              "E: BUSNUM=001\nE: DEVNUM=002\nA: idVendor=" +
              vendor + "\\n\nA: idProduct=" + product +
              "\\n\nA: serial=S1\\n\nA: product=Device\\n\nA: manufacturer=Maker\\n\n"
              "A: busnum=1\\n\nA: devnum=2\\n\nA: speed=12\\n\nA: bDeviceClass=00\\n\n",
          interface};
}

/// Bulk 0x81 and 0x02, 64 bytes.
inline std::vector<std::string> falcon_texts() {
  return usb_texts("0403", "cb48", "ff", {{"81", "02"}, {"02", "02"}},
                   {0x12, 0x01, 0x00, 0x02, 0x00, 0x00, 0x00, 0x40, 0x03,
                    0x04, 0x48, 0xcb, 0x00, 0x04, 0x01, 0x02, 0x03, 0x01,  // device
                    0x09, 0x02, 0x20, 0x00, 0x01, 0x01, 0x00, 0x80, 0x32,  // configuration
                    0x09, 0x04, 0x00, 0x00, 0x02, 0xff, 0xff, 0xff, 0x00,  // interface
                    0x07, 0x05, 0x81, 0x02, 0x40, 0x00, 0x00,              // bulk in
                    0x07, 0x05, 0x02, 0x02, 0x40, 0x00, 0x00});            // bulk out
}

/// Usage ff00:0001, reports of 8 bytes in and out, feature of 4, without ids.
inline const Bytes kPlainReports{0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff,
                                 0x00, 0x75, 0x08, 0x95, 0x08, 0x09, 0x01, 0x81, 0x02, 0x09, 0x01,
                                 0x91, 0x02, 0x95, 0x04, 0x09, 0x01, 0xb1, 0x02, 0xc0};
/// The same with id 3 for all three.
inline const Bytes kNumberedReports{0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x85, 0x03,
                                    0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x08,
                                    0x09, 0x01, 0x81, 0x02, 0x09, 0x01, 0x91, 0x02, 0x95,
                                    0x04, 0x09, 0x01, 0xb1, 0x02, 0xc0};

/// Interrupt 0x81, and 0x02 where it has an OUT endpoint.
inline std::vector<std::string> hid_texts(bool with_out) {
  std::vector<UsbEndpointText> endpoints{{"81", "03"}};
  Bytes descriptors{0x12, 0x01, 0x00, 0x02, 0x00, 0x00, 0x00, 0x40, 0x34,
                    0x12, 0x06, 0x00, 0x00, 0x01, 0x01, 0x02, 0x03, 0x01};
  const std::uint8_t total = with_out ? 41 : 34, count = with_out ? 2 : 1;
  const Bytes configuration{0x09, 0x02, total, 0x00, 0x01,  0x01, 0x00, 0x80, 0x32,  //
                            0x09, 0x04, 0x00,  0x00, count, 0x03, 0x00, 0x00, 0x00,  // interface
                            0x09, 0x21, 0x11,  0x01, 0x00,  0x01, 0x22, 0x1f, 0x00,  // HID
                            0x07, 0x05, 0x81,  0x03, 0x40,  0x00, 0x01};             // interrupt in
  descriptors.insert(descriptors.end(), configuration.begin(), configuration.end());
  if (with_out) {
    endpoints.push_back({"02", "03"});
    const Bytes out{0x07, 0x05, 0x02, 0x03, 0x40, 0x00, 0x01};
    descriptors.insert(descriptors.end(), out.begin(), out.end());
  }
  return usb_texts("1234", "0006", "03", endpoints, descriptors);
}

}  // namespace hapticd::test
