// What a service manager sees, and a run without rights.
#include <fmt/format.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>

#include "daemon/file_descriptor.h"
#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using testing::HasSubstr;

/// The manager's end of $NOTIFY_SOCKET.
class Manager {
 public:
  explicit Manager(const std::string& path)
      : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
    EXPECT_EQ(::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }

  /// Takes what came; the longest time between two signs of life is kept.
  void listen() {
    std::array<char, 4096> buffer{};
    for (;;) {
      const ssize_t got = ::recv(fd_.get(), buffer.data(), buffer.size(), 0);
      if (got <= 0) return;
      const std::string message(buffer.data(), static_cast<std::size_t>(got));
      if (message == "WATCHDOG=1") note_feed();
      heard_ += message + "\n--\n";
    }
  }
  bool hears(const std::string& text) {
    return eventually([&] {
      listen();
      return heard_.find(text) != std::string::npos;
    });
  }
  void forget() { heard_.clear(); }
  const std::string& heard() const { return heard_; }
  std::chrono::duration<double> longest_silence() const { return longest_; }

 private:
  using Clock = std::chrono::steady_clock;
  void note_feed() {
    const auto now = Clock::now();
    if (last_ != Clock::time_point{} && now - last_ > longest_) longest_ = now - last_;
    last_ = now;
  }
  daemon::FileDescriptor fd_;
  std::string heard_;
  Clock::time_point last_{};
  std::chrono::duration<double> longest_{0};
};

class Service : public DaemonTest {
 protected:
  void start_under_manager(const Scenario& scenario) {
    start(scenario, {}, {}, {{"NOTIFY_SOCKET", dir_.file("notify")}, {"WATCHDOG_USEC", "400000"}});
  }
  Manager manager_{dir_.file("notify")};
};

TEST_F(Service, TellsReadyAliveReloadingAndStopping) {
  start_under_manager({});
  EXPECT_TRUE(manager_.hears("READY=1")) << hapticd_->err();
  EXPECT_TRUE(manager_.hears("WATCHDOG=1"));
  EXPECT_TRUE(manager_.hears("STATUS=enabled"));
  manager_.forget();
  write_config({.stiffness_N_m = 500});
  hapticd_->signal(SIGHUP);
  EXPECT_TRUE(manager_.hears("RELOADING=1\nMONOTONIC_USEC="));
  EXPECT_TRUE(manager_.hears("READY=1"));
  EXPECT_LT(manager_.heard().find("RELOADING=1"), manager_.heard().find("READY=1"));
  hapticd_->signal(SIGTERM);
  EXPECT_TRUE(manager_.hears("STOPPING=1"));
  EXPECT_EQ(hapticd_->wait(), 0);
}

TEST_F(Service, ARefusedReloadIsReadyAgainToo) {
  start_under_manager({});
  ASSERT_TRUE(manager_.hears("READY=1"));
  manager_.forget();
  write_file("config.yaml", "nonsense");
  hapticd_->signal(SIGHUP);
  EXPECT_TRUE(manager_.hears("RELOADING=1"));
  EXPECT_TRUE(manager_.hears("READY=1"));
  EXPECT_EQ(stop(), 0);
}

TEST_F(Service, TheWatchdogStarvesWithTheServoThreadAlthoughTheSupervisorLives) {
  start_under_manager({.failures = "{kind: slow, at_s: 0.5, for_s: 2}"});
  ASSERT_TRUE(manager_.hears("WATCHDOG=1"));
  ASSERT_TRUE(eventually([&] {
    manager_.listen();
    return hapticd_->err().find("has run no tick for more than a second") != std::string::npos;
  }));
  EXPECT_EQ(ctl({"status"}), 0) << ctl_err_;
  ASSERT_TRUE(eventually([&] {
    manager_.listen();
    return hapticd_->err().find("runs again") != std::string::npos;
  }));
  manager_.forget();
  ASSERT_TRUE(manager_.hears("WATCHDOG=1"));
  EXPECT_GT(manager_.longest_silence().count(), 0.8);
  EXPECT_EQ(stop(), 0);
}

TEST_F(Service, WithoutAWatchdogNoneIsFed) {
  start({}, {}, {}, {{"NOTIFY_SOCKET", dir_.file("notify")}});
  ASSERT_TRUE(manager_.hears("STATUS=enabled"));
  EXPECT_EQ(stop(), 0);
  manager_.listen();
  EXPECT_EQ(manager_.heard().find("WATCHDOG=1"), std::string::npos);
}

/// Runs as nobody, without any right to real time.
class Unprivileged : public DaemonTest {
 protected:
  /// What to put before the program; empty: this test already has no rights.
  std::vector<std::string> drop_rights() {
    std::filesystem::copy_file(HAPTICD_BINARY, dir_.file("hapticd"));
    std::filesystem::permissions(dir_.file("hapticd"), std::filesystem::perms(0755));
    if (::geteuid() != 0) return {"prlimit", "--rtprio=0", "--memlock=65536", "--"};
    EXPECT_EQ(::chown(dir_.path().c_str(), 65534, 65534), 0);
    return {"prlimit", "--rtprio=0", "--memlock=65536", "setpriv",         "--reuid", "65534",
            "--regid", "65534",      "--clear-groups",  "--inh-caps=-all", "--"};
  }
  std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  }
};

TEST_F(Unprivileged, RunsOnWithOneWarningThatNamesEachRightAndHowToGrantIt) {
  start({}, {"--duration", "1"}, drop_rights());
  EXPECT_EQ(hapticd_->wait(), 0) << hapticd_->err();
  const std::string log = hapticd_->err();
  EXPECT_EQ(count(log, "warning: real-time rights are missing"), 1u) << log;
  for (const char* part : {"SCHED_FIFO priority 80", "LimitRTPRIO", "grant it by"}) {
    EXPECT_THAT(log, HasSubstr(part));
  }
#ifndef HAPTICD_SANITIZED  // AddressSanitizer makes mlockall a call that always succeeds
  for (const char* part : {"mlockall", "LimitMEMLOCK"}) EXPECT_THAT(log, HasSubstr(part));
#endif
  EXPECT_THAT(log, HasSubstr("ready -> enabled"));
  EXPECT_THAT(hapticd_->out(), HasSubstr("SCHED_OTHER"));
}

TEST_F(Unprivileged, RequireRealtimeEndsWith77BeforeAnyDeviceIsArmed) {
  start({}, {"--require-realtime"}, drop_rights());
  EXPECT_EQ(hapticd_->wait(), 77) << hapticd_->err();
  const std::string log = hapticd_->err();
  EXPECT_THAT(log, HasSubstr("SCHED_FIFO priority 80"));
  EXPECT_EQ(count(log, "-> enabled"), 0u);
  const auto recorded = recording();
  const daemon::Field* armed = recorded.find("left.armed");
  ASSERT_NE(armed, nullptr);
  for (std::size_t i = 0; i < recorded.size(); ++i) ASSERT_EQ(recorded.value(i, *armed), 0.0);
}

TEST_F(Unprivileged, WithoutAPlaceForTheSocketItRunsOnAndSaysSo) {
  socket_ = "/nowhere/at/all/h.sock";
  start({}, {"--duration", "0.3"}, drop_rights());
  EXPECT_EQ(hapticd_->wait(), 0) << hapticd_->err();
  EXPECT_THAT(hapticd_->err(), HasSubstr("no control socket"));
  EXPECT_THAT(hapticd_->err(), HasSubstr("set control.socket"));
}

TEST_F(Unprivileged, ASocketAskedForOnTheCommandLineMustBeHad) {
  start({}, {"--socket", "/nowhere/at/all/h.sock"}, drop_rights());
  EXPECT_NE(hapticd_->wait(), 0);
  EXPECT_THAT(hapticd_->err(), HasSubstr("/nowhere/at/all"));
}

TEST_F(Unprivileged, AStrangerMayNotTalkToTheDaemon) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root to become another user";
  start({});
  ASSERT_TRUE(reaches("enabled"));
  std::filesystem::copy_file(HAPTICCTL_BINARY, dir_.file("hapticctl"));
  std::filesystem::permissions(dir_.path(), std::filesystem::perms(0755));
  const auto as_nobody = [&] {
    Process hapticctl({"setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups",
                       dir_.file("hapticctl"), "estop", "--socket", socket_},
                      dir_.file("nobody"));
    const auto code = hapticctl.wait();
    return std::pair(code, hapticctl.err());
  };
  EXPECT_EQ(as_nobody().first, 77);
  // Even with the file open to all the daemon asks the kernel who it is.
  std::filesystem::permissions(socket_, std::filesystem::perms(0666));
  const auto [code, words] = as_nobody();
  EXPECT_EQ(code, 77);
  EXPECT_THAT(words, HasSubstr("may not control hapticd"));
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_EQ(stop(), 0);
}

}  // namespace
}  // namespace hapticd::test
