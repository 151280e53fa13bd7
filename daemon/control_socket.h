// The control socket: UNIX SOCK_SEQPACKET, served by the supervisor between its other events. It
// never waits for a client: who does not take a reply at once is dropped.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "control/core/result.h"

namespace hapticd::daemon {

/// Answers one request (JSON text) with one reply.
using RequestHandler = std::function<std::string(std::string_view)>;

/// Peers that may talk: root, the daemon's own user, members of the group of the socket file. The
/// kernel tells both (SO_PEERCRED, SO_PEERGROUPS), so no name service is asked.
class ControlSocket {
 public:
  static constexpr std::size_t kMaxClients = 16;

  /// Locks `path`.lock, takes the place of a socket that a dead process left behind, listens with
  /// mode 0660. Makes the directory if its parent lets it. Errors: try_again (another hapticd lives
  /// there), cannot_create, no_permission.
  static Result<ControlSocket> open(const std::string& path, RequestHandler handler);
  ControlSocket(ControlSocket&&) noexcept;
  ControlSocket& operator=(ControlSocket&&) noexcept;
  /// Removes the socket file.
  ~ControlSocket();

  /// Readable when serve() has something to do.
  int wait_fd() const noexcept;
  /// Answers what is there now; a client gets one answer a call, so none starves the others.
  void serve();
  std::size_t clients() const noexcept;

 private:
  struct Impl;
  explicit ControlSocket(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticd::daemon
