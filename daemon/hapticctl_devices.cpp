#include "daemon/hapticctl_devices.h"

#include <fmt/format.h>
#include <net/if_arp.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "daemon/ctl_verbs.h"
#include "daemon/lock_file.h"
#include "drivers/can/scan.h"
#include "drivers/usb/choose.h"
#include "drivers/usb/scan.h"

namespace hapticd::daemon {
namespace {

/// An interface, what is on it, and what keeps it from being used.
struct FoundBus {
  std::string interface {};
  std::string problem{}, note{};
  bool asked = false;
  std::vector<can::FoundDrive> drives{};
};

struct Found {
  bool only_can = false;  ///< one interface was asked for
  std::vector<FoundBus> buses{};
  std::vector<usb::FoundDevice> devices{};

  bool any_usable() const {
    return std::ranges::any_of(buses, [](const FoundBus& bus) { return bus.problem.empty(); }) ||
           std::ranges::any_of(
               devices, [](const usb::FoundDevice& device) { return device.refused.empty(); });
  }
};

int number_in(const std::filesystem::path& file) {
  int number = 0;
  std::ifstream(file) >> number;
  return number;
}

std::vector<std::string> can_interfaces() {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/class/net", none))
    if (number_in(entry.path() / "type") == ARPHRD_CAN)
      names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

std::vector<can::Protocol> protocols(const std::vector<std::string>& words) {
  std::vector<can::Protocol> list;
  for (const auto protocol : {can::Protocol::odrive, can::Protocol::moteus, can::Protocol::cia402})
    if (std::ranges::find(words, can::word_of(protocol)) != words.end()) list.push_back(protocol);
  return list;
}

FoundBus look(const std::string& interface, const DevicesOptions& options) {
  FoundBus found{.interface = interface};
  const bool fd = number_in("/sys/class/net/" + interface + "/mtu") >= 72;
  can::SocketOptions wanted{.interface = interface, .fd = fd};
  for (const bool extended : {false, true})
    wanted.filters.push_back({.id = 0, .mask = 0, .extended = extended});
  auto socket = can::Socket::open(wanted);
  if (!socket) {
    found.problem = socket.error().text;
    return found;
  }
  // A question would be another master's frame to who drives them.
  const bool driven = is_locked("can-" + interface + "-", device_lock_directories());
  found.asked = !driven;
  if (driven) found.note = "hapticd drives this bus: nothing was asked, only listened";
  const auto ask = protocols(options.ask);
  if (!driven && !fd && std::ranges::find(ask, can::Protocol::moteus) != ask.end())
    found.note = "classic frames only, so no moteus can answer";
  can::SocketConversation conversation(*socket, can::this_host());
  found.drives =
      can::scan(conversation, {.listen_s = options.listen_s, .ask = ask, .questions = !driven});
  if (socket->trouble() != can::Trouble::none) found.problem = can::word_of(socket->trouble());
  return found;
}

std::vector<usb::FoundDevice> look_at_usb() {
  std::vector<usb::FoundDevice> found = usb::scan({});
  for (usb::FoundDevice& device : found) {
    // As UsbDevice::lock_names() begins; which one of several it drives, the lock may not say.
    std::string lock = "usb-" + usb::id_of(device.about.vendor, device.about.product);
    std::ranges::replace(lock, ':', '-');
    if (is_locked(lock, device_lock_directories()))
      device.refused = "hapticd drives it, or another of its kind";
  }
  return found;
}

Json or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json to_json(const FoundBus& bus) {
  Json drives = Json::array();
  for (const can::FoundDrive& drive : bus.drives)
    drives.push_back({{"driver", can::word_of(drive.protocol)},
                      {"node", drive.node},
                      {"what", drive.what},
                      {"refused", or_null(drive.refused)}});
  return {{"interface", bus.interface},
          {"problem", or_null(bus.problem)},
          {"note", or_null(bus.note)},
          {"drives", drives}};
}

Json to_json(const usb::FoundDevice& device) {
  return {{"driver", usb::word_of(device.kind)},
          {"what", device.about.name},
          {"id", usb::id_of(device.about.vendor, device.about.product)},
          {"serial", or_null(device.about.serial)},
          {"path", device.about.path},
          {"interface", device.interface ? Json(*device.interface) : Json(nullptr)},
          {"usages", or_null(device.usages)},
          {"node", device.node},
          {"refused", or_null(device.refused)}};
}

std::string refusal(const std::string& refused) {
  return refused.empty() ? "" : "; refused: " + refused;
}

std::string to_lines(const FoundBus& bus) {
  std::string text = bus.interface + (bus.problem.empty() ? "" : ": " + bus.problem) +
                     (bus.note.empty() ? "" : ": " + bus.note) + "\n";
  if (bus.drives.empty() && bus.problem.empty())
    text += bus.asked ? "  nobody was heard; a drive that says nothing by itself is found with "
                        "--ask odrive, moteus or cia402\n"
                      : "  nobody was heard\n";
  for (const can::FoundDrive& drive : bus.drives)
    text += fmt::format("  node {:<4}{:<8}{}{}\n", drive.node, can::word_of(drive.protocol),
                        drive.what, refusal(drive.refused));
  return text;
}

std::string to_line(const usb::FoundDevice& device) {
  std::string part;
  if (device.interface) part += fmt::format(", interface {}", *device.interface);
  if (!device.usages.empty()) part += ", usage " + device.usages;
  return fmt::format("  {:<12}{}{}, {}{}\n", usb::word_of(device.kind), usb::words(device.about),
                     part, device.node, refusal(device.refused));
}

std::string to_lines(const Found& found) {
  std::string text;
  for (const FoundBus& bus : found.buses) text += to_lines(bus);
  if (!found.only_can && found.buses.empty())
    text +=
        "CAN: no interface on this machine; a virtual one: modprobe vcan, then ip link add can0 "
        "type vcan; ip link set can0 mtu 72 up\n";
  if (found.only_can) return text;
  text += found.devices.empty() ? "USB: no device that a driver knows, and no HID device with a "
                                  "vendor's usages\n"
                                : "USB\n";
  for (const usb::FoundDevice& device : found.devices) text += to_line(device);
  return text;
}

Json to_json(const Found& found) {
  Json answer{{"ok", found.any_usable()}, {"can", Json::array()}, {"usb", Json::array()}};
  for (const FoundBus& bus : found.buses) answer["can"].push_back(to_json(bus));
  for (const usb::FoundDevice& device : found.devices) answer["usb"].push_back(to_json(device));
  return answer;
}

}  // namespace

ExitCode run_devices(const DevicesOptions& options, bool json) {
  Found found{.only_can = !options.interface.empty()};
  const std::vector<std::string> interfaces =
      found.only_can ? std::vector{options.interface} : can_interfaces();
  for (const std::string& interface : interfaces) found.buses.push_back(look(interface, options));
  if (!found.only_can) found.devices = look_at_usb();
  std::fputs(json ? (to_text(to_json(found)) + "\n").c_str() : to_lines(found).c_str(), stdout);
  return found.any_usable() ? ExitCode::ok : ExitCode::unavailable;
}

}  // namespace hapticd::daemon
