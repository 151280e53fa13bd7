// Bad configs, bad command lines and bad clients, through the real programs.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "daemon/ctl_client.h"
#include "daemon/file_descriptor.h"
#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using daemon::FileDescriptor;
using testing::AllOf;
using testing::HasSubstr;

class BadConfig : public DaemonTest {
 protected:
  int run(const std::string& path) {
    hapticd_ = std::make_unique<Process>(std::vector<std::string>{HAPTICD_BINARY, "--config", path},
                                         dir_.file("hapticd-log"));
    return hapticd_->wait().value_or(-1);
  }
};

TEST_F(BadConfig, AMisspeltKeyIsNamedWithItsPlaceAndTheNearestKey) {
  write_file("config.yaml", "version: 1\nlop: {rate_Hz: 1000}\ndevices: []\n");
  EXPECT_EQ(run(config_), 65);
  EXPECT_THAT(hapticd_->err(),
              AllOf(HasSubstr("config.yaml:2:1"), HasSubstr("lop"), HasSubstr("loop")));
}

TEST_F(BadConfig, EveryErrorIsToldAtOnce) {
  write_file("config.yaml", "version: 2\nloop: {rate_Hz: 0, priority: high}\ndevices: []\n");
  EXPECT_EQ(run(config_), 65);
  EXPECT_THAT(hapticd_->err(),
              AllOf(HasSubstr("version"), HasSubstr("rate_Hz"), HasSubstr("priority")));
}

TEST_F(BadConfig, AMissingFileIs66) {
  EXPECT_EQ(run(dir_.file("none.yaml")), 66);
  EXPECT_THAT(hapticd_->err(), HasSubstr("none.yaml"));
}

TEST_F(BadConfig, ADirectoryIs66) {
  EXPECT_EQ(run(dir_.path()), 66);
  EXPECT_THAT(hapticd_->err(), HasSubstr("directory"));
}

TEST_F(BadConfig, AnEmptyFileIs65) {
  write_file("config.yaml", "");
  EXPECT_EQ(run(config_), 65);
  EXPECT_NE(hapticd_->err(), "");
}

TEST_F(BadConfig, AFileThatMayNotBeReadIs77) {
  write_config({});
  std::filesystem::permissions(config_, std::filesystem::perms::none);
  std::vector<std::string> command = {HAPTICD_BINARY, "--config", config_};
  if (::geteuid() == 0) {
    std::filesystem::permissions(dir_.path(), std::filesystem::perms(0777));
    std::filesystem::copy_file(HAPTICD_BINARY, dir_.file("hapticd"));
    command = {
        "setpriv",  "--reuid", "65534", "--regid", "65534", "--clear-groups", dir_.file("hapticd"),
        "--config", config_};
  }
  Process refused(command, dir_.file("refused"));
  EXPECT_EQ(refused.wait(), 77);
  EXPECT_THAT(refused.err(), HasSubstr("ermission"));
}

TEST_F(BadConfig, CheckSaysTheSame) {
  write_file("config.yaml", "version: 1\nlop: 1\n");
  EXPECT_EQ(ctl({"check", config_}), 65);
  EXPECT_THAT(ctl_err_, HasSubstr("lop"));
  EXPECT_EQ(ctl({"check", config_, "--json"}), 65);
  const auto json = daemon::Json::parse(ctl_out_, nullptr, false);
  ASSERT_TRUE(json.is_object()) << ctl_out_;
  EXPECT_GE(json["errors"].size(), 2u);
}

TEST_F(BadConfig, ABadCommandLineIs64) {
  for (const std::vector<std::string>& more : {std::vector<std::string>{},
                                               {"--config"},
                                               {"--config", "x", "--durations", "1"},
                                               {"--config", "x", "--duration", "long"}}) {
    std::vector<std::string> command = {HAPTICD_BINARY};
    command.insert(command.end(), more.begin(), more.end());
    EXPECT_EQ(Process(command, dir_.file("usage")).wait(), 64);
  }
  EXPECT_EQ(ctl({}), 64);
  EXPECT_EQ(ctl({"stop"}), 64);
  EXPECT_EQ(ctl({"--help"}), 0);
}

class BadClient : public DaemonTest {
 protected:
  FileDescriptor connect() const {
    FileDescriptor fd(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, socket_.c_str(), sizeof(address.sun_path) - 1);
    EXPECT_EQ(::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    const timeval patience{60, 0};
    ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    return fd;
  }
  static daemon::Json ask(const FileDescriptor& fd, const std::string& text) {
    EXPECT_EQ(::send(fd.get(), text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
    std::string buffer(daemon::kMaxMessageBytes, '\0');
    const ssize_t got = ::recv(fd.get(), buffer.data(), buffer.size(), 0);
    buffer.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return daemon::Json::parse(buffer, nullptr, false);
  }
};

TEST_F(BadClient, GarbageIsAnsweredAndTheConnectionStays) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  const FileDescriptor client = connect();
  for (const std::string& garbage :
       {std::string("hello"), std::string(1000, '\0'), std::string("{\"v\":2,\"verb\":\"status\"}"),
        std::string("{\"v\":1,\"verb\":\"dance\"}"),
        std::string("{\"v\":1,\"verb\":\"enable\",\"x\":1}"),
        std::string(daemon::kMaxMessageBytes + 5000, '['), std::string("\xff\xff")}) {
    const auto reply = ask(client, garbage);
    ASSERT_TRUE(reply.is_object()) << garbage.substr(0, 40);
    EXPECT_EQ(reply["ok"], false);
    EXPECT_EQ(reply["code"], 64);
    EXPECT_THAT(reply["error"].get<std::string>(),
                HasSubstr(garbage.size() > 60'000 ? "longer than" : "xpected"))
        << garbage.substr(0, 40);
  }
  EXPECT_EQ(ask(client, R"({"v":1,"verb":"status"})")["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

TEST_F(BadClient, HangingClientsDoNotKeepAnEstopOut) {
  start({});
  ASSERT_TRUE(reaches("enabled"));
  std::vector<FileDescriptor> idle;
  for (int i = 0; i < 40; ++i) idle.push_back(connect());
  EXPECT_EQ(ctl({"estop"}), 0) << ctl_err_;
  EXPECT_TRUE(reaches("fault"));
  EXPECT_EQ(stop(), 0);
}

}  // namespace
}  // namespace hapticd::test
