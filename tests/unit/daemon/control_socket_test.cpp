#include "daemon/control_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "daemon/file_descriptor.h"
#include "daemon/protocol.h"
#include "tests/unit/daemon/temp_dir.h"

namespace hapticd::daemon {
namespace {

using testing::HasSubstr;

FileDescriptor connect_to(const std::string& path) {
  FileDescriptor fd(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
  EXPECT_EQ(::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  return fd;
}

void say(const FileDescriptor& fd, const std::string& text) {
  ASSERT_EQ(::send(fd.get(), text.data(), text.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(text.size()));
}

/// What has arrived; "" when the other side closed, "nothing" when there is nothing.
std::string hear(const FileDescriptor& fd) {
  std::vector<char> buffer(kMaxMessageBytes);
  const ssize_t got = ::recv(fd.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  return got < 0 ? "nothing" : std::string(buffer.data(), static_cast<std::size_t>(got));
}

/// All that is ready is served; the test's own thread stands for the supervisor.
void serve_all(ControlSocket& socket) {
  pollfd ready{socket.wait_fd(), POLLIN, 0};
  while (::poll(&ready, 1, 0) > 0) socket.serve();
}

class ControlSocketTest : public testing::Test {
 protected:
  ControlSocket open() {
    auto socket = ControlSocket::open(
        path_, [](std::string_view text) { return "got " + std::string(text); });
    EXPECT_TRUE(socket) << socket.error().text;
    return std::move(*socket);
  }
  test::TempDir dir_;
  std::string path_ = dir_.file("h.sock");
};

TEST_F(ControlSocketTest, AnswersEachMessageOnce) {
  auto socket = open();
  const auto client = connect_to(path_);
  say(client, "one");
  say(client, "two");
  serve_all(socket);
  EXPECT_EQ(hear(client), "got one");
  EXPECT_EQ(hear(client), "got two");
  EXPECT_EQ(hear(client), "nothing");
}

TEST_F(ControlSocketTest, IsForOwnerAndGroupOnly) {
  const auto socket = open();
  struct stat info {};
  ASSERT_EQ(::stat(path_.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0660u);
}

TEST_F(ControlSocketTest, ASecondDaemonIsRefusedAndTheFirstUnharmed) {
  auto socket = open();
  const auto second = ControlSocket::open(path_, [](std::string_view) { return "second"; });
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ExitCode::try_again);
  EXPECT_THAT(second.error().text, HasSubstr("another hapticd (pid "));
  const auto client = connect_to(path_);
  say(client, "still there?");
  serve_all(socket);
  EXPECT_EQ(hear(client), "got still there?");
}

TEST_F(ControlSocketTest, ASocketLeftBehindIsTakenOver) {
  {
    const FileDescriptor dead(::socket(AF_UNIX, SOCK_SEQPACKET, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof(address.sun_path) - 1);
    ASSERT_EQ(::bind(dead.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ASSERT_TRUE(std::filesystem::exists(path_));
  auto socket = open();
  const auto client = connect_to(path_);
  say(client, "hello");
  serve_all(socket);
  EXPECT_EQ(hear(client), "got hello");
}

TEST_F(ControlSocketTest, AFileThatIsNoSocketIsLeftAlone) {
  std::ofstream(path_) << "precious";
  const auto socket = ControlSocket::open(path_, [](std::string_view) { return ""; });
  ASSERT_FALSE(socket);
  EXPECT_THAT(socket.error().text, HasSubstr("no socket"));
  EXPECT_TRUE(std::filesystem::exists(path_));
}

TEST_F(ControlSocketTest, TheFileGoesWithTheDaemon) {
  { const auto socket = open(); }
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(ControlSocketTest, AMissingDirectoryIsMadeIfOnlyItIsMissing) {
  const auto made =
      ControlSocket::open(dir_.file("new/h.sock"), [](std::string_view) { return ""; });
  EXPECT_TRUE(made);
  const auto deep =
      ControlSocket::open(dir_.file("a/b/h.sock"), [](std::string_view) { return ""; });
  ASSERT_FALSE(deep);
  EXPECT_THAT(deep.error().text, HasSubstr("set control.socket"));
}

TEST_F(ControlSocketTest, APathTooLongForASocketIsNamedSo) {
  const auto socket =
      ControlSocket::open(dir_.file(std::string(200, 'x')), [](std::string_view) { return ""; });
  ASSERT_FALSE(socket);
  EXPECT_THAT(socket.error().text, HasSubstr("at most 107 characters"));
}

TEST_F(ControlSocketTest, TheClientSilentForLongestMakesRoom) {
  auto socket = open();
  std::vector<FileDescriptor> idle;
  for (std::size_t i = 0; i < ControlSocket::kMaxClients; ++i) {
    idle.push_back(connect_to(path_));
    serve_all(socket);
  }
  say(idle.front(), "I am alive");
  serve_all(socket);
  EXPECT_EQ(hear(idle.front()), "got I am alive");
  const auto urgent = connect_to(path_);
  say(urgent, "estop");
  serve_all(socket);
  EXPECT_EQ(hear(urgent), "got estop");
  EXPECT_EQ(socket.clients(), ControlSocket::kMaxClients);
  EXPECT_EQ(hear(idle[1]), "");
  EXPECT_EQ(hear(idle.front()), "nothing");
}

TEST_F(ControlSocketTest, AClientThatDoesNotReadIsDroppedWithoutWaiting) {
  auto socket =
      ControlSocket::open(path_, [](std::string_view) { return std::string(50'000, 'x'); });
  ASSERT_TRUE(socket);
  const auto deaf = connect_to(path_);
  serve_all(*socket);
  ASSERT_EQ(socket->clients(), 1u);
  // Far more replies than its receive queue holds.
  for (int i = 0; i < 100 && socket->clients() > 0; ++i) {
    (void)::send(deaf.get(), "?", 1, MSG_NOSIGNAL);
    serve_all(*socket);
  }
  EXPECT_EQ(socket->clients(), 0u);
}

TEST_F(ControlSocketTest, ADeadClientIsForgotten) {
  auto socket = open();
  {
    const auto client = connect_to(path_);
    say(client, "and gone");
  }
  serve_all(socket);
  EXPECT_EQ(socket.clients(), 0u);
}

TEST_F(ControlSocketTest, AnOversizeMessageReachesTheHandlerAsTooLong) {
  auto socket = ControlSocket::open(path_, [](std::string_view text) {
    const auto request = parse_request(text);
    return request ? "fine" : request.error().text;
  });
  ASSERT_TRUE(socket);
  const auto client = connect_to(path_);
  say(client, std::string(kMaxMessageBytes + 1000, ' '));
  serve_all(*socket);
  EXPECT_THAT(hear(client), HasSubstr("longer than 65536 bytes"));
  say(client, R"({"v":1,"verb":"status"})");
  serve_all(*socket);
  EXPECT_EQ(hear(client), "fine");
}

}  // namespace
}  // namespace hapticd::daemon
