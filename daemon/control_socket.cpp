#include "daemon/control_socket.h"

#include <fmt/format.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <list>
#include <optional>
#include <vector>

#include "daemon/file_descriptor.h"
#include "daemon/lock_file.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {
namespace {

tl::unexpected<Error> cannot_open(const std::string& path, int error, const std::string& advice) {
  const bool right = error == EACCES || error == EPERM || error == EROFS;
  return fail(right ? ExitCode::no_permission : ExitCode::cannot_create,
              fmt::format("control socket {}: {}; {}", path, std::strerror(error), advice));
}

/// The directory is made if only its last part is missing: /run/hapticd, which the service manager
/// otherwise makes.
Result<void> prepare_directory(const std::string& path) {
  const auto directory = std::filesystem::absolute(path).parent_path();
  if (::mkdir(directory.c_str(), 0755) != 0 && errno != EEXIST) {
    return cannot_open(
        path, errno,
        fmt::format("the directory {} does not exist and cannot be made: make it, or set "
                    "control.socket (or --socket) to a path that this user may write",
                    directory.string()));
  }
  return {};
}

/// Only called with the lock held, so a socket that is there has no living owner.
Result<void> remove_stale(const std::string& path) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0) return {};
  if (!S_ISSOCK(info.st_mode)) {
    return fail(
        ExitCode::cannot_create,
        fmt::format("control socket {}: a file that is no socket stands there; move it away or set "
                    "control.socket to another path",
                    path));
  }
  if (::unlink(path.c_str()) != 0)
    return cannot_open(path, errno, "cannot remove the stale socket");
  return {};
}

Result<FileDescriptor> listen_at(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) {
    return fail(
        ExitCode::bad_data,
        fmt::format("control socket {}: a socket path has at most {} characters, this one {}", path,
                    sizeof(address.sun_path) - 1, path.size()));
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  FileDescriptor fd(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd.valid()) return cannot_open(path, errno, "cannot make a socket");
  // By the umask the file has mode 0660 from its first moment on.
  const mode_t before = ::umask(0117);
  const int bound = ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  const int error = errno;
  ::umask(before);
  if (bound != 0)
    return cannot_open(path, error, "set control.socket to a path that this user may write");
  constexpr int kBacklog = 16;
  if (::listen(fd.get(), kBacklog) != 0) return cannot_open(path, errno, "cannot listen");
  return fd;
}

bool in_group(int client, gid_t primary, gid_t wanted) {
  if (primary == wanted) return true;
  std::array<gid_t, 1024> few{};
  socklen_t bytes = sizeof(few);
  if (::getsockopt(client, SOL_SOCKET, SO_PEERGROUPS, few.data(), &bytes) != 0) return false;
  const auto end = few.begin() + static_cast<std::ptrdiff_t>(bytes / sizeof(gid_t));
  return std::find(few.begin(), end, wanted) != end;
}

bool may_talk(int client, const std::string& path) {
  ucred peer{};
  socklen_t bytes = sizeof(peer);
  if (::getsockopt(client, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) != 0) return false;
  if (peer.uid == 0 || peer.uid == ::geteuid()) return true;
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && in_group(client, peer.gid, info.st_gid);
}

/// False: the client did not take it, or is gone.
bool send_now(int client, const std::string& text) {
  return ::send(client, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL) ==
         static_cast<ssize_t>(text.size());
}

}  // namespace

struct ControlSocket::Impl {
  std::string path;
  RequestHandler handler;
  std::optional<LockFile> lock;
  FileDescriptor listener, epoll;
  std::list<FileDescriptor> clients;  // the one that spoke longest ago comes first
  std::vector<char> buffer = std::vector<char>(kMaxMessageBytes + 1);

  ~Impl() {
    if (listener.valid()) ::unlink(path.c_str());
  }

  bool watch(int fd) const {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.fd = fd;
    return ::epoll_ctl(epoll.get(), EPOLL_CTL_ADD, fd, &event) == 0;
  }

  void accept_one() {
    FileDescriptor client(
        ::accept4(listener.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!client.valid()) {
      // Out of descriptors: without room made here the listener would stay readable and wake us for
      // ever.
      if ((errno == EMFILE || errno == ENFILE) && !clients.empty()) clients.pop_front();
      return;
    }
    if (!may_talk(client.get(), path)) {
      send_now(
          client.get(),
          to_text(error_reply(
              {"this user may not control hapticd; expected root, the user that it runs as, or a "
               "member of the group of " +
                   path,
               ExitCode::no_permission})));
      return;
    }
    // An operator's estop must get in whatever hangs on the socket: the client silent for longest
    // makes room.
    if (clients.size() >= kMaxClients) clients.pop_front();
    if (watch(client.get())) clients.push_back(std::move(client));
  }

  /// One message of one client. Dropped when it is gone or does not take its reply.
  void answer(int fd) {
    const auto client = std::find_if(clients.begin(), clients.end(),
                                     [&](const FileDescriptor& c) { return c.get() == fd; });
    if (client == clients.end()) return;
    const ssize_t got = ::recv(fd, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
    const bool answered =
        got > 0 && send_now(fd, handler({buffer.data(), static_cast<std::size_t>(got)}));
    if (!answered) {
      clients.erase(client);  // closing takes it out of the epoll set
      return;
    }
    clients.splice(clients.end(), clients, client);
  }
};

Result<ControlSocket> ControlSocket::open(const std::string& path, RequestHandler handler) {
  if (auto made = prepare_directory(path); !made) return tl::unexpected(made.error());
  auto lock = LockFile::acquire(path + ".lock", "the control socket " + path);
  if (!lock) return tl::unexpected(lock.error());
  if (auto removed = remove_stale(path); !removed) return tl::unexpected(removed.error());
  auto listener = listen_at(path);
  if (!listener) return tl::unexpected(listener.error());

  auto impl = std::make_unique<Impl>();
  impl->path = path;
  impl->handler = std::move(handler);
  impl->lock = std::move(*lock);
  impl->listener = std::move(*listener);
  impl->epoll = FileDescriptor(::epoll_create1(EPOLL_CLOEXEC));
  if (!impl->epoll.valid() || !impl->watch(impl->listener.get())) {
    return cannot_open(path, errno, "cannot watch the socket");
  }
  return ControlSocket(std::move(impl));
}

ControlSocket::ControlSocket(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ControlSocket::ControlSocket(ControlSocket&&) noexcept = default;
ControlSocket& ControlSocket::operator=(ControlSocket&&) noexcept = default;
ControlSocket::~ControlSocket() = default;

int ControlSocket::wait_fd() const noexcept {
  return impl_->epoll.get();
}

std::size_t ControlSocket::clients() const noexcept {
  return impl_->clients.size();
}

void ControlSocket::serve() {
  std::array<epoll_event, kMaxClients + 1> events{};
  const int ready =
      ::epoll_wait(impl_->epoll.get(), events.data(), static_cast<int>(events.size()), 0);
  for (int i = 0; i < ready; ++i) {
    const int fd = events[static_cast<std::size_t>(i)].data.fd;
    // A descriptor number may have been given anew within this round; answer() then finds nothing
    // to read.
    if (fd == impl_->listener.get()) {
      impl_->accept_one();
    } else {
      impl_->answer(fd);
    }
  }
}

}  // namespace hapticd::daemon
