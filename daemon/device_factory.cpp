#include "daemon/device_factory.h"

#include "drivers/can/can_device.h"
#include "drivers/usb/usb_device.h"
#include "sim/shared_hand.h"
#include "sim/sim_device.h"

namespace hapticd::daemon {

std::vector<std::unique_ptr<drivers::Device>> make_devices(const config::Compiled& compiled) {
  std::vector<std::unique_ptr<drivers::Device>> devices;
  const auto& described = compiled.document.config.devices;
  std::shared_ptr<sim::SharedHand> hand;
  if (compiled.shared_hand)
    hand = std::make_shared<sim::SharedHand>(*compiled.shared_hand, compiled.simulated);
  for (std::size_t i = 0; i < described.size(); ++i) {
    switch (described[i].driver) {
      case config::Driver::odrive:
      case config::Driver::moteus:
      case config::Driver::cia402:
        devices.push_back(std::make_unique<can::CanDevice>(*compiled.can[i]));
        break;
      case config::Driver::falcon:
      case config::Driver::hid_report:
      case config::Driver::openffboard:
        devices.push_back(std::make_unique<usb::UsbDevice>(
            *compiled.usb[i], usb::this_host(), usb::thread_runner(compiled.usb[i]->priority)));
        break;
      case config::Driver::sim:
        devices.push_back(hand && hand->holds(i)
                              ? std::make_unique<sim::SimDevice>(hand, i)
                              : std::make_unique<sim::SimDevice>(compiled.simulated[i]));
        break;
    }
  }
  return devices;
}

}  // namespace hapticd::daemon
