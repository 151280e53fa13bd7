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

namespace hapticd::daemon {
namespace {

/// An interface, what is on it, and what keeps it from being used.
struct FoundBus {
  std::string interface {};
  std::string problem{}, note{};
  bool asked = false;
  std::vector<can::FoundDrive> drives{};
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

Json to_json(const std::vector<FoundBus>& all, bool any) {
  Json list = Json::array();
  for (const FoundBus& found : all) {
    Json drives = Json::array();
    for (const can::FoundDrive& drive : found.drives)
      drives.push_back({{"driver", can::word_of(drive.protocol)},
                        {"node", drive.node},
                        {"what", drive.what},
                        {"refused", drive.refused.empty() ? Json(nullptr) : Json(drive.refused)}});
    list.push_back({{"interface", found.interface},
                    {"problem", found.problem.empty() ? Json(nullptr) : Json(found.problem)},
                    {"note", found.note.empty() ? Json(nullptr) : Json(found.note)},
                    {"drives", drives}});
  }
  return {{"ok", any}, {"can", list}};
}

std::string to_lines(const std::vector<FoundBus>& all) {
  std::string text;
  for (const FoundBus& found : all) {
    text += found.interface + (found.problem.empty() ? "" : ": " + found.problem) +
            (found.note.empty() ? "" : ": " + found.note) + "\n";
    if (found.drives.empty() && found.problem.empty())
      text += found.asked ? "  nobody was heard; a drive that says nothing by itself is found with "
                            "--ask odrive, moteus or cia402\n"
                          : "  nobody was heard\n";
    for (const can::FoundDrive& drive : found.drives)
      text += fmt::format("  node {:<4}{:<8}{}{}\n", drive.node, can::word_of(drive.protocol),
                          drive.what, drive.refused.empty() ? "" : "; refused: " + drive.refused);
  }
  return text;
}

}  // namespace

ExitCode run_devices(const DevicesOptions& options, bool json) {
  std::vector<std::string> interfaces = can_interfaces();
  if (!options.interface.empty()) interfaces = {options.interface};
  if (interfaces.empty()) {
    return print_error(Error{"no CAN interface on this machine; a virtual one: modprobe vcan, then "
                             "ip link add can0 type vcan; ip link set can0 mtu 72 up",
                             ExitCode::unavailable},
                       json);
  }
  std::vector<FoundBus> all;
  for (const std::string& interface : interfaces) all.push_back(look(interface, options));
  const bool any =
      std::ranges::any_of(all, [](const FoundBus& one) { return one.problem.empty(); });
  std::fputs(json ? (to_text(to_json(all, any)) + "\n").c_str() : to_lines(all).c_str(), stdout);
  return any ? ExitCode::ok : ExitCode::unavailable;
}

}  // namespace hapticd::daemon
