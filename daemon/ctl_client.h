// hapticctl's end of the control socket.
#pragma once
#include <string>

#include "control/core/result.h"
#include "daemon/file_descriptor.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {

class CtlClient {
 public:
  /// Errors: unavailable (no daemon there), no_permission.
  static Result<CtlClient> connect(const std::string& socket_path);
  /// The reply, or the daemon's error with its code; unavailable when it does not answer within
  /// five seconds.
  Result<Json> ask(const Request& request);

 private:
  CtlClient(FileDescriptor fd, std::string path) : fd_(std::move(fd)), path_(std::move(path)) {}
  FileDescriptor fd_;
  std::string path_;
};

}  // namespace hapticd::daemon
