// Locks between processes: one per control socket, one per physical device, so that two configs
// cannot drive one device. They are advisory locks on small files (flock), so the kernel lets go of
// them when a process dies in whatever way.
#pragma once
#include <string>
#include <vector>

#include "control/core/result.h"
#include "drivers/device.h"

namespace hapticd::daemon {

/// Held as long as the object lives. The file stays: removing it would let two processes lock two
/// files of one name.
class LockFile {
 public:
  /// Locks `path`, made if need be, and writes this process' id into it. `what` names the thing
  /// locked, for the error "another hapticd (pid 123) holds the control socket /run/..." with code
  /// try_again. A file that may not be written is locked all the same if it may be read. Other
  /// errors: no_permission, cannot_create.
  static Result<LockFile> acquire(const std::string& path, const std::string& what);
  LockFile(LockFile&& other) noexcept;
  LockFile& operator=(LockFile&& other) noexcept;
  ~LockFile();

 private:
  explicit LockFile(int fd) : fd_(fd) {}
  int fd_ = -1;
};

/// Locks a physical device by a name of Device::lock_names() in each of `directories`: a hardened service
/// and a program that a user starts by hand can write to different ones, but read each other's.
/// Fails where none of them can hold the lock.
Result<std::vector<LockFile>> lock_device(const std::string& lock_name,
                                          const std::vector<std::string>& directories);

/// Connects a device that nobody else drives, and holds its locks: where it says before who it is, nothing reaches it
/// that another program holds. On an error it is not connected. `locks` gets more.
Result<drivers::DeviceInfo> connect_locked(drivers::Device& device,
                                           const std::vector<std::string>& directories,
                                           std::vector<LockFile>& locks);
/// Whether a program holds a device whose name starts so; true, too, where that may not be read.
bool is_locked(const std::string& name_start, const std::vector<std::string>& directories);

/// Where device locks stand: the service's own directory, and the one for all.
std::vector<std::string> device_lock_directories();

}  // namespace hapticd::daemon
