#include "daemon/ctl_client.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <vector>

namespace hapticd::daemon {
namespace {

tl::unexpected<Error> cannot_connect(const std::string& path, int error) {
  if (error == EACCES || error == EPERM) {
    return fail(
        ExitCode::no_permission,
        fmt::format(
            "no permission to talk to hapticd at {}; become a member of the group of that file",
            path));
  }
  return fail(ExitCode::unavailable, fmt::format("no hapticd answers at {} ({}); start it, or name "
                                                 "its socket by --socket or $HAPTICD_SOCKET",
                                                 path, std::strerror(error)));
}

/// Neither code nor text of a reply is believed blindly: another program may listen there.
Error daemon_error(const Json& json) {
  const auto code =
      json.contains("code") && json["code"].is_number_integer() ? json["code"].get<int>() : 1;
  const auto text = json.contains("error") && json["error"].is_string()
                        ? json["error"].get<std::string>()
                        : to_text(json);
  return {text, static_cast<ExitCode>(code)};
}

}  // namespace

Result<CtlClient> CtlClient::connect(const std::string& socket_path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_path.size() >= sizeof(address.sun_path))
    return cannot_connect(socket_path, ENAMETOOLONG);
  std::memcpy(address.sun_path, socket_path.c_str(), socket_path.size() + 1);
  FileDescriptor fd(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  if (!fd.valid()) return cannot_connect(socket_path, errno);
  const timeval patience{5, 0};
  ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  ::setsockopt(fd.get(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
  if (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return cannot_connect(socket_path, errno);
  }
  return CtlClient(std::move(fd), socket_path);
}

Result<Json> CtlClient::ask(const Request& request) {
  const std::string message = format_request(request);
  std::vector<char> buffer(kMaxMessageBytes);
  // A daemon that refuses this user says so and closes at once. Its words are there although sending
  // fails, or although the kernel first tells, once, that our request was thrown away.
  const bool sent = ::send(fd_.get(), message.data(), message.size(), MSG_NOSIGNAL) >= 0;
  const auto receive = [&] { return ::recv(fd_.get(), buffer.data(), buffer.size(), 0); };
  ssize_t got = receive();
  if (got < 0 && errno == ECONNRESET) got = receive();
  if (got <= 0) {
    return fail(ExitCode::unavailable,
                fmt::format("hapticd at {} did not answer ({})", path_,
                            got == 0 || !sent ? "it closed the connection" : std::strerror(errno)));
  }
  const Json json = Json::parse(buffer.begin(), buffer.begin() + got, nullptr, false);
  if (!json.is_object() || !json.contains("ok")) {
    return fail(ExitCode::unavailable, fmt::format("what answers at {} is not hapticd", path_));
  }
  if (json["ok"] != true) return tl::unexpected(daemon_error(json));
  return json;
}

}  // namespace hapticd::daemon
