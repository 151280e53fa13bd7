#include "drivers/usb/node_access.h"

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <system_error>

namespace hapticd::usb {
namespace {

std::string owner(uid_t id) {
  std::array<char, 4096> buffer{};
  passwd entry{}, *found = nullptr;
  if (getpwuid_r(id, &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr)
    return found->pw_name;
  return std::to_string(id);
}

std::string group(gid_t id) {
  std::array<char, 4096> buffer{};
  ::group entry{}, *found = nullptr;
  if (getgrgid_r(id, &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr)
    return found->gr_name;
  return std::to_string(id);
}

/// "root:root 0600".
std::string rights(const std::string& node) {
  struct stat status {};
  if (::stat(node.c_str(), &status) != 0) return "unknown";
  std::string mode = "0";
  for (const int shift : {6, 3, 0}) mode += static_cast<char>('0' + (status.st_mode >> shift & 7));
  return owner(status.st_uid) + ":" + group(status.st_gid) + " " + mode;
}

}  // namespace

Error open_problem(const std::string& node, int error) {
  if (error == EACCES)
    return {
        "no right to read and write " + node + ", which is " + rights(node) +
            ": install hapticd's udev rule (60-hapticd.rules; for other products with a line of "
            "their own), run `udevadm control --reload && udevadm trigger`, and run as a member "
            "of group hapticd",
        ExitCode::no_permission};
  if (error == EPERM)
    return {
        "the service manager forbids " + node +
            ": allow it in the unit (DeviceAllow=char-usb_device rw, DeviceAllow=char-hidraw rw)",
        ExitCode::no_permission};
  const std::string reason = std::generic_category().message(error);
  if (error == ENOENT)
    return {"the device has no node " + node +
                ": no udev or devtmpfs here makes it (in a container, "
                "pass /dev on)",
            ExitCode::unavailable};
  return {node + " cannot be opened: " + reason, ExitCode::unavailable};
}

NotOpened not_opened(const std::string& what, const std::string& node, const Error& problem) {
  constexpr std::time_t kUdevTakes_s = 3;
  struct stat status {};
  const bool is_new =
      ::stat(node.c_str(), &status) == 0 && std::time(nullptr) - status.st_ctime < kUdevTakes_s;
  return {.absent = is_new && problem.code == ExitCode::no_permission,
          .error = {what + ": " + problem.text, problem.code}};
}

std::optional<Error> access_problem(const std::string& node) {
  if (::access(node.c_str(), R_OK | W_OK) == 0) return {};
  return open_problem(node, errno);
}

}  // namespace hapticd::usb
